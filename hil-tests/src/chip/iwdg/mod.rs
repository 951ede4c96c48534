//! IWDG: independent watchdog (RM0440 chapter 42), on the LSI: 32 kHz exactly.

use super::{
    bank::Bank,
    clocks::LSI,
    map::Register,
    misuse::Misuse,
    peripheral::{Moment, Peripheral, has_bank},
    time::Time,
};

/// Model of the watchdog.
#[derive(Clone, Debug)]
pub struct Iwdg {
    bank: Bank,
    unlocked: bool,
    bites_at: Time,
    bitten: bool,
}

impl Default for Iwdg {
    fn default() -> Self {
        let bank = Bank::new("IWDG", &[("RLR", 0xFFF), ("WINR", 0xFFF)]);
        Self { bank, unlocked: false, bites_at: Time::NEVER, bitten: false }
    }
}

impl Iwdg {
    /// Whether it has bitten since it was asked last.
    pub fn take_bite(&mut self) -> bool {
        std::mem::take(&mut self.bitten)
    }

    /// Whether it has bitten and nobody has taken it.
    #[must_use]
    pub fn has_bitten(&self) -> bool {
        self.bitten
    }

    /// Counts down from RLR at LSI / (4 << PR): 42.3.
    fn time_out(&self) -> Time {
        let prescaler = 4_u64 << self.bank.get("PR", "PR").min(6);
        Time::period(LSI) * (prescaler * (u64::from(self.bank.get("RLR", "RL")) + 1))
    }

    /// Whether it has been started.
    #[must_use]
    pub fn is_running(&self) -> bool {
        self.bites_at != Time::NEVER
    }
}

impl Peripheral for Iwdg {
    has_bank!();

    fn models(&self, _: &Register) -> bool {
        true
    }

    fn write(&mut self, register: &Register, value: u32, at: Moment) -> Result<(), Misuse> {
        if register.name == "KR" {
            // Any other key locks PR, RLR and WINR again (42.3.5).
            self.unlocked = value == 0x5555;
        }
        match (register.name.as_str(), value) {
            ("KR", 0xAAAA) if self.is_running() => self.bites_at = at.now + self.time_out(),
            ("KR", 0xCCCC) => self.bites_at = at.now + self.time_out(),
            ("KR", _) => {}
            (name, _) if !self.unlocked => {
                return Err(Misuse::rule("IWDG", format!("{name} is written while locked (42.3.5)")));
            }
            _ => self.bank.store(register, value),
        }
        Ok(())
    }

    fn next_event(&self) -> Time {
        self.bites_at
    }

    fn advance(&mut self, at: Moment) -> Result<(), Misuse> {
        if at.now >= self.bites_at {
            self.bites_at = Time::NEVER;
            self.bitten = true;
        }
        Ok(())
    }

    fn reset(&mut self) {
        *self = Self::default();
    }
}

#[cfg(test)]
mod tests;
