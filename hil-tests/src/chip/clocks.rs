//! Clocks: how fast the oscillators and the buses run (RM0440 7.2).

use super::time::Time;

/// Frequency of the HSI16, Hz.
pub const HSI: u64 = 16_000_000;
/// Frequency of the HSI48, Hz.
pub const HSI48: u64 = 48_000_000;
/// Frequency of the crystal on the NUCLEO-G474RE, Hz.
pub const HSE: u64 = 24_000_000;
/// Frequency of the LSI, Hz.
pub const LSI: u64 = 32_000;

/// What runs how fast, Hz.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Clocks {
    /// System clock before the AHB prescaler.
    pub system: u64,
    /// Core, buses and DMA.
    pub core: u64,
    /// APB1.
    pub apb1: u64,
    /// APB2.
    pub apb2: u64,
}

impl Clocks {
    /// After reset: everything on the HSI16.
    pub const RESET: Self = Self { system: HSI, core: HSI, apb1: HSI, apb2: HSI };

    /// Clock of timers on a bus: twice the bus when that is divided (RM0440 7.2.15).
    #[must_use]
    pub fn timer(self, bus: u64) -> u64 {
        if bus == self.core { bus } else { 2 * bus }
    }

    /// One cycle of the core.
    #[must_use]
    pub fn cycle(self) -> Time {
        Time::period(self.core)
    }
}
