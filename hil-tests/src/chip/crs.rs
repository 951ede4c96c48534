//! CRS: trims the HSI48 by a signal from outside (RM0440, "Clock recovery system").
//!
//! Modelled is whether it does, not the error that it measures: the HSI48 is exact where it does.

use super::{
    bank::Bank,
    map::Register,
    misuse::Misuse,
    peripheral::{Moment, Peripheral, has_bank},
};

/// CFGR.SYNCSRC: starts of frames of the USB.
const USB: u32 = 2;

/// Model of the CRS.
#[derive(Clone, Debug)]
pub struct Crs {
    bank: Bank,
}

impl Default for Crs {
    fn default() -> Self {
        Self { bank: Bank::new("CRS", &[("CR", 0x4000), ("CFGR", 0x2022_BB7F)]) }
    }
}

impl Crs {
    /// Whether it keeps the HSI48 at the pace of the host's frames.
    #[must_use]
    pub fn follows_frames(&self) -> bool {
        self.bank.is_set("CR", "CEN")
            && self.bank.is_set("CR", "AUTOTRIMEN")
            && self.bank.get("CFGR", "SYNCSRC") == USB
    }
}

impl Peripheral for Crs {
    has_bank!();

    fn models(&self, register: &Register) -> bool {
        matches!(register.name.as_str(), "CR" | "CFGR")
    }

    fn write(&mut self, register: &Register, value: u32, _: Moment) -> Result<(), Misuse> {
        let refused = |rule| Err(Misuse::rule("CRS", rule));
        match register.name.as_str() {
            "CFGR" if self.bank.is_set("CR", "CEN") => return refused("CFGR changes while CR.CEN is 1"),
            "CR" if register.get(value, "SWSYNC") != 0 => {
                return refused("a signal by software (SWSYNC) is not modelled");
            }
            "CR" if ["SYNCOKIE", "SYNCWARNIE", "ERRIE", "ESYNCIE"]
                .iter()
                .any(|field| register.get(value, field) != 0) =>
            {
                return refused("its interrupts are not modelled");
            }
            _ => self.bank.store(register, value),
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::chip::tests::bus::Bus;

    #[test]
    fn it_trims_by_frames_once_all_three_are_set_and_is_then_left_alone() {
        let mut bus = Bus::new(Crs::default());
        // After reset it would follow the USB, if it were on.
        assert_eq!(bus.get("CFGR", "SYNCSRC"), USB);
        assert!(!bus.model.follows_frames());
        bus.fields("CR", &[("AUTOTRIMEN", 1)]);
        assert!(!bus.model.follows_frames());
        bus.fields("CR", &[("AUTOTRIMEN", 1), ("CEN", 1)]);
        assert!(bus.model.follows_frames());
        assert!(bus.refused("CFGR", 0).contains("while CR.CEN is 1"));
        assert!(bus.refused("CR", 1 << 7).contains("SWSYNC"));
        bus.fields("CR", &[]);
        bus.fields("CFGR", &[("SYNCSRC", 1)]);
        bus.fields("CR", &[("AUTOTRIMEN", 1), ("CEN", 1)]);
        assert!(!bus.model.follows_frames(), "a crystal's pace is not the host's");
    }
}
