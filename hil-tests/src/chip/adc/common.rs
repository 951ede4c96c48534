//! Common registers of a group of converters: the clock, and what is measured inside the chip (ADC_CCR).

use crate::chip::{
    bank::Bank,
    map::Register,
    misuse::Misuse,
    peripheral::{Moment, Peripheral, has_bank},
};

/// Divisors of CCR.PRESC.
const PRESCALERS: [u64; 12] = [1, 2, 4, 6, 8, 10, 12, 16, 32, 64, 128, 256];

/// Model of one group's common registers.
#[derive(Clone, Debug)]
pub struct AdcCommon {
    bank: Bank,
}

impl AdcCommon {
    /// The registers of that name: `ADC12_COMMON` or `ADC345_COMMON`.
    #[must_use]
    pub fn new(name: &str) -> Self {
        Self { bank: Bank::new(name, &[]) }
    }

    /// Whether a field of CCR switches something on.
    #[must_use]
    pub fn switches_on(&self, field: &str) -> bool {
        self.bank.is_set("CCR", field)
    }

    /// Clock of the converters, Hz, from the AHB's (CKMODE 1 to 3) or the kernel clock (0).
    #[must_use]
    pub fn clock(&self, ahb: u64, kernel: u64) -> u64 {
        match self.bank.get("CCR", "CKMODE") {
            0 => kernel / PRESCALERS[self.bank.get("CCR", "PRESC").min(11) as usize],
            mode => ahb >> (mode - 1),
        }
    }
}

impl Peripheral for AdcCommon {
    has_bank!();

    fn models(&self, register: &Register) -> bool {
        register.name == "CCR"
    }

    fn write(&mut self, register: &Register, value: u32, _: Moment) -> Result<(), Misuse> {
        if register.get(value, "DUAL") != 0 {
            return Err(Misuse::rule("ADC", "dual mode (CCR.DUAL) is not modelled"));
        }
        self.bank.store(register, value);
        Ok(())
    }
}
