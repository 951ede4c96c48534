//! Probe: how a real board is programmed and reset. Without the feature `probe` no rig has one.
//!
//! [`emulated`] does the same to an emulated board, and reads its log.

#[cfg(feature = "probe")]
mod attached;
#[cfg(not(feature = "probe"))]
#[path = "absent.rs"]
mod attached;
pub mod emulated;

use dermatome::link::program::{
    firmware::{Firmware, FirmwareError},
    probe::{ChoiceError, DebugProbe, choose},
};
use std::path::Path;

/// A real board's debug probe, and the firmware that goes through it.
#[derive(Clone, Debug)]
pub struct Programmer {
    probe: DebugProbe,
    firmware: Option<Firmware>,
}

/// Why a board cannot be programmed or reset.
#[derive(Debug, thiserror::Error)]
pub enum ProgrammerError {
    /// This program cannot use probes.
    #[error(
        "its `probe` is `{id}`, but this program was built without debug probes: build it with `--features \
         probe`, or take `probe` and `elf` out of the rig file"
    )]
    NotBuilt {
        /// The probe that is asked for.
        id: String,
    },
    /// The firmware is no firmware.
    #[error(transparent)]
    Firmware(#[from] FirmwareError),
    /// The probe is not there.
    #[error("the rig has no board: {0}")]
    Choice(#[from] ChoiceError),
    /// The probe, or the board behind it, does not do what it must.
    #[error("{0}")]
    Board(String),
}

impl Programmer {
    /// The probe that `id` names, and the firmware that it is to program.
    pub fn open(id: &str, elf: Option<&Path>) -> Result<Self, ProgrammerError> {
        let firmware = elf.map(Firmware::load).transpose()?;
        let probes = attached::probes().ok_or_else(|| ProgrammerError::NotBuilt { id: id.to_owned() })?;
        let probe = choose(&probes, Some(id))?.clone();
        Ok(Self { probe, firmware })
    }

    /// Whether it has a firmware to program.
    #[must_use]
    pub fn can_program(&self) -> bool {
        self.firmware.is_some()
    }

    /// Programs the firmware, if it has one, and starts the board anew.
    pub fn program(&self) -> Result<(), ProgrammerError> {
        attached::restart(&self.probe, self.firmware.as_ref())
    }

    /// Starts the board anew.
    pub fn reset(&self) -> Result<(), ProgrammerError> {
        attached::restart(&self.probe, None)
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;

    /// The smallest firmware: a vector table, and an instruction that jumps to itself.
    pub(crate) fn firmware() -> Firmware {
        let header = [0x464C_457F, 0x0001_0101, 0, 0, 0x0028_0002, 1, 0x0800_0009, 52, 0, 0];
        let header_ends = [0x0020_0034, 0x0028_0001, 0];
        let program_header = [1, 84, 0x0800_0000, 0x0800_0000, 12, 12, 5, 4];
        let content = [0x2002_0000, 0x0800_0009, 0xE7FE_E7FE_u32];
        let words = [&header[..], &header_ends, &program_header, &content].concat();
        Firmware::new(words.into_iter().flat_map(u32::to_le_bytes).collect()).unwrap()
    }

    pub(crate) fn programmer(firmware: Option<Firmware>) -> Programmer {
        let probe = DebugProbe {
            name: "STLink V3".to_owned(),
            vendor_id: 0x0483,
            product_id: 0x374E,
            serial_number: Some("no such probe".to_owned()),
            accessible: true,
        };
        Programmer { probe, firmware }
    }

    #[test]
    fn a_missing_probe_is_an_error_whatever_is_asked_of_it() {
        let known = ["no debug probe", "built without debug probes"];
        let says = |error: ProgrammerError| {
            let words = error.to_string();
            assert!(known.iter().any(|part| words.contains(part)), "{words}");
        };
        says(Programmer::open("no such probe", None).unwrap_err());
        let words = programmer(Some(firmware())).program().unwrap_err().to_string();
        assert!(words.contains("no such probe"), "{words}");
        let words = programmer(None).reset().unwrap_err().to_string();
        assert!(words.contains("no such probe"), "{words}");
    }

    #[test]
    fn the_firmware_is_checked_before_a_probe_is_looked_for() {
        let error = Programmer::open("no such probe", Some(Path::new("no/such.elf"))).unwrap_err();
        assert!(error.to_string().contains("no/such.elf"), "{error}");
    }
}
