//! What commands have in common: which firmware on which board, and an emulated one that has started.

use dermatome::{link::program::firmware, skin::Skin};
use dermatome_hil::{
    board::{START_TIME, VirtualBoard},
    fault::{Fault, What},
    rig::{Rig, RigError, VirtualRig},
};
use std::{
    env,
    error::Error,
    path::{Path, PathBuf},
    sync::Arc,
};

/// Where a checkout keeps the rig of its emulated board.
const RIG: &str = "hil-tests/rigs/virtual.toml";
/// The checkout that this program was built in.
const BUILT_IN: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/..");

/// Which firmware on which board.
#[derive(clap::Args)]
pub(super) struct Firmware {
    /// Rig file: which board [default: hil-tests/rigs/virtual.toml, the emulated one, of the checkout that holds the
    /// ELF; without `--elf`, this program].
    #[arg(long)]
    rig: Option<PathBuf>,
    /// Firmware to run instead of the rig's.
    #[arg(long)]
    elf: Option<PathBuf>,
}

impl Firmware {
    pub(super) fn name(&self) -> String {
        self.elf.clone().unwrap_or_else(|| self.rig_file()).display().to_string()
    }

    /// The rig, its board switched on.
    pub(super) fn open(&self) -> Result<Rig, RigError> {
        Rig::open(&self.rig_file(), self.elf.as_deref())
    }

    /// The rig's file, wherever this program is started.
    pub(super) fn rig_file(&self) -> PathBuf {
        let program = env::current_exe().ok();
        let own = || self.elf.as_deref().and_then(rig_beside).or_else(|| rig_beside(program.as_deref()?));
        self.rig.clone().or_else(own).unwrap_or_else(|| Path::new(BUILT_IN).join(RIG))
    }
}

/// The rig of the checkout that holds this file.
fn rig_beside(file: &Path) -> Option<PathBuf> {
    let file = file.canonicalize().ok()?;
    file.ancestors().map(|folder| folder.join(RIG)).find(|rig| rig.is_file())
}

/// A board that has started, and its firmware; `skin` takes the place of the one that the rig's board
/// measures.
pub(super) fn boot(
    firmware: &Firmware,
    keep_trace: bool,
    skin: Option<Skin>,
) -> Result<(VirtualBoard, Arc<firmware::Firmware>), Box<dyn Error>> {
    boot_on(firmware.open()?, &firmware.rig_file(), keep_trace, skin)
}

/// The same on a rig that is open.
pub(super) fn boot_on(
    opened: Rig,
    rig: &Path,
    keep_trace: bool,
    skin: Option<Skin>,
) -> Result<(VirtualBoard, Arc<firmware::Firmware>), Box<dyn Error>> {
    let (firmware, elf, mut options) = match opened {
        Rig::Virtual(VirtualRig { firmware, elf, options, .. }) => (firmware, elf, options),
        Rig::Bus(_) => {
            return Err(format!(
                "rig `{}` puts boards on one line: only `run` and `cases` do",
                rig.display()
            )
            .into());
        }
        Rig::Board { .. } => {
            return Err(format!("rig `{}` is a real board; it needs no emulator", rig.display()).into());
        }
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

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs;

    fn firmware(rig: Option<&Path>, elf: Option<&Path>) -> Firmware {
        Firmware { rig: rig.map(Path::to_owned), elf: elf.map(Path::to_owned) }
    }

    #[test]
    fn the_rig_is_that_of_the_checkout_that_holds_the_elf() {
        let checkout = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../target/another-checkout");
        let elf = checkout.join("firmware/target/dermatome-firmware");
        for file in [&checkout.join(RIG), &elf] {
            fs::create_dir_all(file.parent().unwrap()).unwrap();
            fs::write(file, "").unwrap();
        }
        let canonical = |path: PathBuf| path.canonicalize().unwrap();
        assert_eq!(firmware(None, Some(&elf)).rig_file(), canonical(checkout.join(RIG)));
        let own = canonical(Path::new(BUILT_IN).join(RIG));
        assert_eq!(canonical(firmware(None, None).rig_file()), own);
        let nowhere = firmware(None, Some(Path::new("/no/such/elf")));
        assert_eq!(canonical(nowhere.rig_file()), own, "an error will name the ELF");
        assert_eq!(firmware(Some(Path::new("my.toml")), Some(&elf)).rig_file(), Path::new("my.toml"));
    }
}
