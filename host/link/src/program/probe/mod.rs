//! Debug probes: which one to use, and whether the chip behind it is the board's.
//!
//! What talks to a probe is in `attached`, and only there with the feature `probe`.

#[cfg(feature = "probe")]
pub mod attached;

use std::fmt::Write as _;

/// A debug probe of this machine.
#[derive(Clone, Debug, PartialEq, Eq, serde::Serialize)]
pub struct DebugProbe {
    /// What the probe calls itself.
    pub name: String,
    /// USB vendor number.
    pub vendor_id: u16,
    /// USB product number.
    pub product_id: u16,
    /// Serial number, if it has one.
    pub serial_number: Option<String>,
    /// Whether this user may open it.
    pub accessible: bool,
}

/// Why no probe was chosen.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum ChoiceError {
    /// None is plugged in.
    #[error(
        "no debug probe found: connect the board's ST-LINK (the USB socket of the NUCLEO) with a cable that \
         carries data"
    )]
    None,
    /// More than one fits.
    #[error("{} debug probes fit: choose one; there are\n{}", probes.len(), table(probes))]
    Several {
        /// Those that fit.
        probes: Vec<DebugProbe>,
    },
    /// None has this ID.
    #[error("no debug probe has the ID `{id}`; there are\n{}", table(probes))]
    Unknown {
        /// What was asked for.
        id: String,
        /// All there are.
        probes: Vec<DebugProbe>,
    },
    /// The system does not let this user use it.
    #[error(
        "no permission to use debug probe {probe} (on Linux, install the udev rules of \
         https://probe.rs/docs/getting-started/probe-setup/ and plug it in again)"
    )]
    Permission {
        /// Which one.
        probe: DebugProbe,
    },
}

impl DebugProbe {
    /// What names it: the serial number, or without one vendor and product.
    #[must_use]
    pub fn id(&self) -> String {
        self.serial_number.clone().unwrap_or_else(|| self.usb_id())
    }

    fn usb_id(&self) -> String {
        format!("{:04x}:{:04x}", self.vendor_id, self.product_id)
    }

    fn is(&self, id: &str) -> bool {
        [self.id(), self.usb_id()].iter().any(|known| known.eq_ignore_ascii_case(id))
    }
}

impl std::fmt::Display for DebugProbe {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{} (ID {})", self.name, self.id())
    }
}

/// The only probe, or the one that `id` names: a serial number, or vendor and product as `0483:374e`.
pub fn choose<'a>(probes: &'a [DebugProbe], id: Option<&str>) -> Result<&'a DebugProbe, ChoiceError> {
    let fitting: Vec<_> = probes.iter().filter(|probe| id.is_none_or(|id| probe.is(id))).collect();
    match (&fitting[..], id) {
        ([probe], _) if probe.accessible => Ok(probe),
        ([probe], _) => Err(ChoiceError::Permission { probe: (*probe).clone() }),
        ([], Some(id)) if !probes.is_empty() => {
            Err(ChoiceError::Unknown { id: id.to_owned(), probes: probes.to_vec() })
        }
        ([], _) => Err(ChoiceError::None),
        _ => Err(ChoiceError::Several { probes: fitting.into_iter().cloned().collect() }),
    }
}

/// The probes with their IDs, one a line.
#[must_use]
pub fn table(probes: &[DebugProbe]) -> String {
    let mut lines = String::new();
    for probe in probes {
        // Writing to a string does not fail.
        let _ = writeln!(lines, "  {}  {}", probe.id(), probe.name);
    }
    lines.trim_end().to_owned()
}

/// What a chip says of itself, read over the debug port (RM0440).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ChipIdentity {
    /// `DBGMCU_IDCODE`; its lower twelve bits are the kind of chip.
    pub idcode: u32,
    /// `FLASH_SIZE`, KiB.
    pub flash_kib: u16,
    /// `FLASH_OPTR`, the option bytes in use.
    pub options: u32,
}

/// The chip behind the probe is not one that the firmware runs on.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum ChipError {
    /// Another kind of chip.
    #[error(
        "the chip at the probe is of kind {found:#05x}, the board's STM32G474 of kind {:#05x}: is this a \
         NUCLEO-G474RE? Nothing was erased",
        ChipIdentity::STM32G47
    )]
    Kind {
        /// The kind found.
        found: u32,
    },
    /// Too little flash.
    #[error(
        "the chip at the probe has {kib} KiB of flash, firmware and patches need {} KiB (STM32G474RE). \
         Nothing was erased",
        ChipIdentity::FLASH_KIB
    )]
    Flash {
        /// What it has.
        kib: u16,
    },
    /// One bank of flash, in which the firmware cannot run while it writes patches.
    #[error(
        "the chip's flash is set up as one bank, the firmware needs two: set the option DBANK, e.g. with \
         STM32CubeProgrammer. Nothing was erased"
    )]
    SingleBank,
}

impl ChipIdentity {
    /// `DEV_ID` of STM32G473, G474, G483 and G484.
    const STM32G47: u32 = 0x469;
    /// Flash of the STM32G474RE.
    const FLASH_KIB: u16 = 512;
    /// `FLASH_OPTR.DBANK`.
    const DBANK: u32 = 1 << 22;

    /// Whether the firmware can run on the chip.
    pub fn check(self) -> Result<(), ChipError> {
        let found = self.idcode & 0xFFF;
        if found != Self::STM32G47 {
            return Err(ChipError::Kind { found });
        }
        if self.flash_kib < Self::FLASH_KIB {
            return Err(ChipError::Flash { kib: self.flash_kib });
        }
        if self.options & Self::DBANK == 0 {
            return Err(ChipError::SingleBank);
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn probe(serial_number: Option<&str>) -> DebugProbe {
        DebugProbe {
            name: "STLink V3".to_owned(),
            vendor_id: 0x0483,
            product_id: 0x374E,
            serial_number: serial_number.map(str::to_owned),
            accessible: true,
        }
    }

    #[test]
    fn the_only_probe_needs_no_name() {
        let probes = [probe(Some("0042"))];
        assert_eq!(choose(&probes, None), Ok(&probes[0]));
        assert_eq!(choose(&probes, Some("0042")), Ok(&probes[0]));
        assert_eq!(choose(&probes, Some("0483:374E")), Ok(&probes[0]));
    }

    #[test]
    fn without_a_probe_the_cable_is_the_advice() {
        for id in [None, Some("0042")] {
            let error = choose(&[], id).unwrap_err();
            assert_eq!(error, ChoiceError::None);
            assert!(error.to_string().contains("connect the board's ST-LINK"), "{error}");
        }
    }

    #[test]
    fn of_several_probes_one_must_be_chosen_and_all_are_named() {
        let probes = [probe(Some("0042")), probe(Some("00AB")), probe(None)];
        let words = choose(&probes, None).unwrap_err().to_string();
        assert_eq!(
            words,
            "3 debug probes fit: choose one; there are\n  0042  STLink V3\n  \
             00AB  STLink V3\n  0483:374e  STLink V3"
        );
        assert_eq!(choose(&probes, Some("00ab")), Ok(&probes[1]));
        let both = [probe(None), probe(None)];
        assert!(
            matches!(choose(&both, Some("0483:374e")), Err(ChoiceError::Several { probes }) if probes == both)
        );
    }

    #[test]
    fn an_unknown_id_is_answered_with_those_there_are() {
        let words = choose(&[probe(Some("0042"))], Some("0043")).unwrap_err().to_string();
        assert_eq!(words, "no debug probe has the ID `0043`; there are\n  0042  STLink V3");
    }

    #[test]
    fn a_forbidden_probe_hints_at_the_rules() {
        let probes = [DebugProbe { accessible: false, ..probe(Some("0042")) }];
        let words = choose(&probes, None).unwrap_err().to_string();
        assert!(words.contains("STLink V3 (ID 0042)") && words.contains("udev"), "{words}");
    }

    #[test]
    fn only_the_boards_chip_passes() {
        let chip = ChipIdentity { idcode: 0x2003_6469, flash_kib: 512, options: 0xFFEF_F8AA };
        assert_eq!(chip.check(), Ok(()));
        let other = ChipIdentity { idcode: 0x1007_6413, ..chip }.check();
        assert_eq!(other, Err(ChipError::Kind { found: 0x413 }));
        let small = ChipIdentity { flash_kib: 256, ..chip }.check();
        assert_eq!(small, Err(ChipError::Flash { kib: 256 }));
        let single = ChipIdentity { options: 0xFFAF_F8AA, ..chip }.check();
        assert_eq!(single, Err(ChipError::SingleBank));
        let words = other.unwrap_err().to_string();
        assert!(words.contains("0x413") && words.contains("0x469") && words.contains("Nothing was erased"));
    }
}
