//! Cases of uploads: what arrives is stored, what does not leaves the old patch.

use super::{Case, Failure, ensure, patches};
use crate::rig::{Capability, Rig};
use dermatome::link;
use dermatome_shared::{
    patch::PatchView,
    protocol::{MAX_CHUNK_BYTES, Request},
};
use std::time::Duration;

pub(super) const CASES: &[Case] = &[
    Case {
        name: "a patch is flashed and read back by its identity after a reset",
        needs: &[Capability::Reset],
        run: survives_reset,
    },
    Case {
        name: "a patch stays when the firmware is programmed again",
        needs: &[Capability::Program],
        run: survives_programming,
    },
    Case { name: "three uploads in a row: the last one counts", needs: &[], run: thrice },
    Case {
        name: "a host that vanishes in the middle of an upload leaves the old patch",
        needs: &[],
        run: vanishes,
    },
    Case {
        name: "a full-size patch is uploaded within 4.5 s at 2 Mbaud",
        needs: &[Capability::VirtualTime],
        run: full_size,
    },
];

fn crc(patch: &[u8]) -> u32 {
    PatchView::validate(patch).map_or(0, |view| view.crc())
}

fn ensure_patch(rig: &Rig, patch: &[u8]) -> Result<(), Failure> {
    let info = rig.link()?.info()?;
    let found = info.patch.as_ref().map(|patch| patch.crc);
    ensure(found == Some(crc(patch)), || format!("it holds {found:x?}, not {:08x}", crc(patch)))
}

fn survives_reset(rig: &Rig) -> Result<String, Failure> {
    let patch = patches::patch(36, true, 1);
    link::upload(&mut rig.link()?, &patch, |_| ())?;
    rig.reset()?;
    ensure_patch(rig, &patch)?;
    Ok(format!("{} bytes", patch.len()))
}

fn survives_programming(rig: &Rig) -> Result<String, Failure> {
    let patch = patches::patch(36, true, 7);
    link::upload(&mut rig.link()?, &patch, |_| ())?;
    rig.program()?;
    ensure_patch(rig, &patch)?;
    Ok(String::new())
}

/// The third one goes where the first one was.
fn thrice(rig: &Rig) -> Result<String, Failure> {
    let patches = [patches::patch(36, true, 2), patches::patch(49, true, 3), patches::patch(36, true, 8)];
    for patch in &patches {
        link::upload(&mut rig.link()?, patch, |_| ())?;
        ensure_patch(rig, patch)?;
    }
    Ok(String::new())
}

fn vanishes(rig: &Rig) -> Result<String, Failure> {
    let (old, new) = (patches::patch(36, true, 4), patches::patch(36, true, 5));
    link::upload(&mut rig.link()?, &old, |_| ())?;
    {
        let mut link = rig.link()?;
        link.request(&Request::BeginUpload { length: new.len() as u32, crc: crc(&new) })?;
        let bytes = heapless::Vec::from_slice(&new[..MAX_CHUNK_BYTES]).unwrap_or_default();
        link.request(&Request::UploadChunk { offset: 0, bytes })?;
    }
    rig.wait(Duration::from_secs(2))?;
    ensure_patch(rig, &old)?;
    link::upload(&mut rig.link()?, &new, |_| ())?;
    ensure_patch(rig, &new)?;
    Ok(String::new())
}

fn full_size(rig: &Rig) -> Result<String, Failure> {
    let patch = patches::patch(812, true, 6);
    let mut link = rig.link()?;
    let start = rig.emulated().with(|machine| machine.now());
    link::upload(&mut link, &patch, |_| ())?;
    let seconds = rig.emulated().with(|machine| machine.now()).since(start).seconds();
    ensure_patch(rig, &patch)?;
    ensure(seconds <= 4.5, || format!("{} bytes took {seconds:.2} s", patch.len()))?;
    Ok(format!("{} bytes in {seconds:.2} s of virtual time", patch.len()))
}
