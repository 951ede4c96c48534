//! Cases of boards on one CAN bus.

use super::{Case, Failure, TIMEOUT, ensure, ensure_complete, next_frame, patches};
use crate::{
    bus::can::{CanBus, Traffic, Wire, host::Host},
    chip::{flash::Flash, time::Time},
    rig::{Capability, Rig},
};
use dermatome::link::{self, Link};
use dermatome_shared::{
    drive::Drive,
    frame::FrameFlags,
    protocol::{Request, Selection},
};
use std::sync::{Mutex, PoisonError};

const NEEDS: &[Capability] = &[Capability::CanBus];

pub(super) const CASES: &[Case] = &[Case {
    name: "three boards on one CAN bus stream contacts and images, and lose none",
    needs: NEEDS,
    run: three_stream,
}];

/// All that a frame shows of contacts.
const CONTACTS: Selection =
    Selection { images: 0, contacts: 1, measurements: 0, health: 100, scope: 0, scope_slot: 0 };

/// A flash with the firmware and the rig's skin's patch, which a board of its own has taken over the bus. Cases that need it
/// share it.
fn flashed(rig: &Rig) -> Result<Flash, Failure> {
    static FLASH: Mutex<Option<Flash>> = Mutex::new(None);
    let mut made = FLASH.lock().unwrap_or_else(PoisonError::into_inner);
    let flash = if let Some(flash) = made.take() { flash } else { flash_one(rig)? };
    Ok(made.insert(flash).clone())
}

fn flash_one(rig: &Rig) -> Result<Flash, Failure> {
    let bus = rig.bus().start_can(&[0], &rig.bus().flash())?;
    link::upload(&mut Host::new(bus.clone()).link(0)?, &patches::shipped("disc-210mm")?, |_| ())?;
    Ok(bus.with(|wire| wire.machine(0).chip(|chip| chip.flash.clone())))
}

fn now(bus: &CanBus) -> Time {
    bus.with(|wire| wire.now())
}

/// Boards at these addresses with the disc's patch, tared, and their links.
fn tared(rig: &Rig, addresses: &[u8]) -> Result<(CanBus, Vec<Link>), Failure> {
    let bus = rig.bus().start_can(addresses, &flashed(rig)?)?;
    let host = Host::new(bus.clone());
    let mut links: Vec<Link> =
        addresses.iter().map(|&address| host.link(address)).collect::<Result<_, _>>()?;
    for link in &mut links {
        let drive = link.info()?.drive.ok_or_else(|| Failure::wrong("the board has no drive"))?;
        link.request(&Request::Drive(Some(Drive { frame_rate: 200.0, ..drive })))?;
        link::tare(link, 20, TIMEOUT)?;
    }
    Ok((bus, links))
}

fn three_stream(rig: &Rig) -> Result<String, Failure> {
    const FRAMES: usize = 300;
    let start = std::time::Instant::now();
    let (bus, mut links) = tared(rig, &[0, 1, 2])?;
    eprintln!("tared {:?} at {}", start.elapsed(), now(&bus));
    bus.with(Wire::take_traffic);
    let since = now(&bus);
    let mut streams = links
        .iter_mut()
        .map(|link| link.subscribe(Selection { images: 7, ..CONTACTS }))
        .collect::<Result<Vec<_>, _>>()?;
    let (mut load, mut missed) = (0.0_f32, 0);
    for _ in 0..FRAMES {
        for stream in &mut streams {
            let frame = next_frame(stream)?;
            missed += usize::from(frame.at.is_some_and(|at| at.flags.contains(FrameFlags::MISSED)));
            ensure(frame.contacts.is_some(), || "a frame has no contacts".to_owned())?;
            load = load.max(frame.health.map_or(0.0, |health| health.vitals.load));
        }
    }
    let rate = FRAMES as f64 / now(&bus).since(since).seconds();
    streams.iter_mut().try_for_each(ensure_complete)?;
    drop(streams);
    let Traffic { frames, bytes, errors, busy, .. } = bus.with(Wire::take_traffic);
    let share = 100.0 * busy.seconds() / now(&bus).since(since).seconds();
    eprintln!("{:?} at {}", start.elapsed(), now(&bus));
    Ok(format!(
        "{rate:.1} a second, {missed} missed, {frames} frames {bytes} bytes {errors} errors busy {share:.0} %; load {load}"
    ))
}
