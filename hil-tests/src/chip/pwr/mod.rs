//! PWR: core voltage (RM0440 chapter 6). Everything it asks for is there at once.

use super::{
    bank::Bank,
    map::Register,
    misuse::Misuse,
    peripheral::{Moment, Peripheral, has_bank},
};

/// Model of the PWR.
#[derive(Clone, Debug)]
pub struct Pwr {
    bank: Bank,
}

impl Default for Pwr {
    fn default() -> Self {
        Self { bank: Bank::new("PWR", &[("CR1", 0x200), ("CR3", 0x8000), ("CR5", 1)]) }
    }
}

impl Pwr {
    /// Whether the pull-downs that UCPD1 has for a dead battery are off.
    #[must_use]
    pub fn ends_dead_battery(&self) -> bool {
        self.bank.is_set("CR3", "UCPD1_DBDIS")
    }

    /// Fastest core clock at the present voltage, Hz (6.1.5).
    #[must_use]
    pub fn fastest_core(&self) -> u64 {
        match (self.bank.get("CR1", "VOS"), self.bank.get("CR5", "R1MODE")) {
            (1, 0) => 170_000_000,
            (1, _) => 150_000_000,
            _ => 26_000_000,
        }
    }
}

impl Peripheral for Pwr {
    has_bank!();

    fn models(&self, register: &Register) -> bool {
        matches!(register.name.as_str(), "CR1" | "CR2" | "CR3" | "CR4" | "CR5" | "SR1" | "SR2" | "SCR")
            || register.name.starts_with("PUCR")
            || register.name.starts_with("PDCR")
    }

    fn write(&mut self, register: &Register, value: u32, _: Moment) -> Result<(), Misuse> {
        if register.name == "CR1" && !matches!(register.get(value, "VOS"), 1 | 2) {
            return Err(Misuse::rule("PWR", "CR1.VOS is neither range 1 nor range 2 (6.4.1)"));
        }
        if register.name != "SCR" {
            self.bank.store(register, value);
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests;
