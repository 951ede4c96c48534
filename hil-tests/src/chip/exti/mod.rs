//! EXTI: edges of pins raise interrupts (RM0440 chapter 15). Lines 0 to 15; the lines of
//! peripherals, and events for the core, are not modelled.

use super::{
    bank::Bank,
    map::Register,
    misuse::Misuse,
    peripheral::{Moment, Peripheral, has_bank},
};

/// Lines that belong to pins.
const PINS: u32 = 0xFFFF;

/// Model of the EXTI.
#[derive(Clone, Debug)]
pub struct Exti {
    bank: Bank,
    levels: u16,
}

impl Default for Exti {
    fn default() -> Self {
        Self { bank: Bank::new("EXTI", &[("IMR", 0x1F84_0000)]), levels: 0 }
    }
}

impl Exti {
    /// The pins that SYSCFG.EXTICR selects have these levels now: chosen edges set their pending bits.
    pub fn see(&mut self, levels: u16) {
        let rising = u32::from(levels & !self.levels) & self.bank.word("RTSR", 0);
        let falling = u32::from(self.levels & !levels) & self.bank.word("FTSR", 0);
        self.levels = levels;
        self.pend(rising | falling);
    }

    fn pend(&mut self, lines: u32) {
        let pending = self.bank.word("PR", 0);
        self.bank.set_word("PR", 0, pending | lines);
    }

    /// PR: a 1 clears the bit, and the software trigger with it.
    fn clear(&mut self, lines: u32) {
        for register in ["PR", "SWIER"] {
            let value = self.bank.word(register, 0);
            self.bank.set_word(register, 0, value & !lines);
        }
    }
}

impl Peripheral for Exti {
    has_bank!();

    fn models(&self, register: &Register) -> bool {
        register.index == 0
    }

    fn clears_flags(&self, register: &Register) -> bool {
        register.name == "PR"
    }

    fn write(&mut self, register: &Register, value: u32, _: Moment) -> Result<(), Misuse> {
        let old = self.bank.value(register);
        match register.name.as_str() {
            "PR" => self.clear(value),
            name if (value ^ old) & !PINS != 0 => {
                return Err(Misuse::rule("EXTI", format!("{name} of lines above 15 is not modelled")));
            }
            "EMR" if value != 0 => return Err(Misuse::rule("EXTI", "events (EMR) are not modelled")),
            "SWIER" => {
                self.bank.store(register, old | value);
                self.pend(value & !old);
            }
            _ => self.bank.store(register, value),
        }
        Ok(())
    }

    fn interrupts(&self, signal: &str) -> bool {
        let line = signal.strip_prefix("EXTI").and_then(|line| line.parse::<u32>().ok());
        let raised = self.bank.word("PR", 0) & self.bank.word("IMR", 0);
        line.is_some_and(|line| raised >> line & 1 == 1)
    }

    fn reset(&mut self) {
        *self = Self { levels: self.levels, ..Self::default() };
    }
}

#[cfg(test)]
mod tests;
