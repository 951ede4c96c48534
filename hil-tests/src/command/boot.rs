//! What `run` and `trace` have in common: which firmware, and a board with it.

use dermatome::{link::program::firmware, skin::Skin};
use dermatome_hil::{
    board::VirtualBoard,
    fault::{Fault, What},
    rig::{Rig, START_TIME, VirtualRig},
};
use std::{error::Error, path::PathBuf, sync::Arc};

/// Which firmware on which emulated board.
#[derive(clap::Args)]
pub(super) struct Firmware {
    /// Rig file of an emulated board.
    #[arg(long, default_value = concat!(env!("CARGO_MANIFEST_DIR"), "/rigs/virtual.toml"))]
    rig: PathBuf,
    /// Firmware to run instead of the rig's.
    #[arg(long)]
    elf: Option<PathBuf>,
}

impl Firmware {
    pub(super) fn name(&self) -> String {
        self.elf.as_ref().unwrap_or(&self.rig).display().to_string()
    }
}

/// A board that has started, and its firmware; `skin` takes the place of the one that the rig's board
/// measures.
pub(super) fn boot(
    firmware: &Firmware,
    keep_trace: bool,
    skin: Option<Skin>,
) -> Result<(VirtualBoard, Arc<firmware::Firmware>), Box<dyn Error>> {
    let Rig::Virtual(VirtualRig { firmware, elf, mut options, .. }) =
        Rig::open(&firmware.rig, firmware.elf.as_deref())?
    else {
        return Err(format!("rig `{}` is a real board; it needs no emulator", firmware.rig.display()).into());
    };
    options.keep_trace = keep_trace;
    if let (Some(world), Some(skin)) = (&mut options.world, skin) {
        *world = world.with_skin(skin)?.into();
    }
    let VirtualRig { board, firmware, .. } = VirtualRig::start(firmware, elf, options)?;
    board.run(START_TIME)?;
    Ok((board, firmware))
}

/// Faults of skin and front end need both.
pub(super) fn check_faults(faults: &[Fault], board: &VirtualBoard) -> Result<(), Box<dyn Error>> {
    let outside = faults.iter().find(|fault| matches!(fault.what, What::World(_)));
    match outside {
        Some(fault) if board.world().is_none() => {
            Err(format!("`--fault`: {}, but the rig has no `[world]`", fault.what).into())
        }
        _ => Ok(()),
    }
}
