//! Core: the private peripherals of the Cortex-M4 (ARMv7-M Architecture Reference Manual, B3): NVIC,
//! system control block, SysTick, DWT's cycle counter.
//!
//! CYCCNT counts where both DEMCR.TRCENA and DWT_CTRL.CYCCNTENA say so (C1.6.5, C1.8.3). It stands still while the core's
//! clock is off: in sleep, unless DBGMCU keeps it on.

use super::{
    misuse::Misuse,
    nvic::{Bits, HARD_FAULT, NMI, Nvic, PEND_SV, SYS_TICK, SYSTEM_EXCEPTIONS},
    time::Time,
};
use std::collections::BTreeMap;

/// Where the private peripherals lie.
pub const START: u32 = 0xE000_0000;
/// Bytes there, debug components included.
pub const BYTES: u32 = 0x0010_0000;

/// Control register of the DWT, and the debug monitor's, whose TRCENA switches the DWT on.
const DWT_CTRL: u32 = 0xE000_1000;
const DEMCR: u32 = 0xE000_EDFC;

const CPUID_OF_R0P1: u32 = 0x410F_C241;

/// Model of the core's private peripherals.
#[derive(Clone, Debug, Default)]
pub struct Core {
    /// The interrupt controller.
    pub nvic: Nvic,
    /// Registers that keep what is written.
    plain: BTreeMap<u32, u32>,
    tick: SysTick,
    /// What CYCCNT held at a cycle.
    counted: (u32, u64),
    wants_reset: bool,
}

#[derive(Clone, Copy, Debug, Default)]
struct SysTick {
    control: u32,
    reload: u32,
    /// The counter was reloaded at that time.
    since: Time,
    wrapped: bool,
}

impl Core {
    /// Where the vector table is.
    #[must_use]
    pub fn vectors(&self) -> u32 {
        self.plain.get(&0xE000_ED08).copied().unwrap_or(0x0800_0000)
    }

    /// Whether the firmware has asked for a reset since this was asked last.
    pub fn take_reset(&mut self) -> bool {
        std::mem::take(&mut self.wants_reset)
    }

    /// A fault without a handler of its own becomes a HardFault (B1.5.14): notes why.
    pub fn escalate(&mut self, cause: FaultCause) {
        let (status, address) = match cause {
            FaultCause::Bus(address) => (1 << 15 | 1 << 9, Some(address)),
            FaultCause::Fetch(_) => (1 << 8, None),
            FaultCause::Undefined => (1 << 16, None),
            FaultCause::Stacking => (1 << 12, None),
        };
        *self.plain.entry(0xE000_ED28).or_insert(0) |= status;
        *self.plain.entry(0xE000_ED2C).or_insert(0) |= 1 << 30;
        if let Some(address) = address {
            self.plain.insert(0xE000_ED38, address);
        }
        self.nvic.pend(HARD_FAULT);
    }

    /// Reads a word.
    pub fn read(&mut self, address: u32, at: CoreMoment) -> Result<u32, Misuse> {
        let plain = self.plain.get(&address).copied();
        let value = match address {
            DWT_CTRL => plain.unwrap_or(0x4000_0000),
            0xE000_1004 => self.cycle_count(at),
            0xE000_E010 => self.tick.control | u32::from(std::mem::take(&mut self.tick.wrapped)) << 16,
            0xE000_E014 => self.tick.reload,
            0xE000_E018 => self.tick.count(at),
            0xE000_E01C => 0,
            0xE000_E100..=0xE000_E10C | 0xE000_E180..=0xE000_E18C => {
                self.nvic.bits(word(address), Bits::Enabled)
            }
            0xE000_E200..=0xE000_E20C | 0xE000_E280..=0xE000_E28C => {
                self.nvic.bits(word(address), Bits::Pending)
            }
            0xE000_E300..=0xE000_E30C => self.nvic.bits(word(address), Bits::Active),
            0xE000_E400..=0xE000_E464 => {
                self.nvic.priorities(SYSTEM_EXCEPTIONS + (address - 0xE000_E400) as usize)
            }
            0xE000_ED00 => CPUID_OF_R0P1,
            0xE000_ED04 => self.interrupt_state(),
            0xE000_ED0C => 0xFA05_0000,
            0xE000_ED14 => plain.unwrap_or(0x200),
            0xE000_ED18..=0xE000_ED20 => self.nvic.priorities((address - 0xE000_ED14) as usize),
            0xE000_EF34 => plain.unwrap_or(0xC000_0000),
            _ if is_plain(address) => plain.unwrap_or(0),
            _ => return Err(no_register(address)),
        };
        Ok(value)
    }

    /// Writes a word, or the bytes of one that `size` says.
    pub fn write(&mut self, address: u32, size: u32, value: u32, at: CoreMoment) -> Result<(), Misuse> {
        match address {
            0xE000_1004 => self.counted = (value, at.cycles),
            DWT_CTRL | DEMCR => {
                self.counted = (self.cycle_count(at), at.cycles);
                self.plain.insert(address, value);
            }
            0xE000_E010 => {
                self.tick.control = value & 7;
                self.tick.since = at.now;
            }
            0xE000_E014 => self.tick.reload = value & 0x00FF_FFFF,
            0xE000_E018 => self.tick.since = at.now,
            0xE000_E100..=0xE000_E10C => self.nvic.change(word(address), value, Bits::Enabled, true),
            0xE000_E180..=0xE000_E18C => self.nvic.change(word(address), value, Bits::Enabled, false),
            0xE000_E200..=0xE000_E20C => self.nvic.change(word(address), value, Bits::Pending, true),
            0xE000_E280..=0xE000_E28C => self.nvic.change(word(address), value, Bits::Pending, false),
            0xE000_E400..=0xE000_E467 => {
                let first = SYSTEM_EXCEPTIONS + (address - 0xE000_E400) as usize;
                self.nvic.set_priorities(first, &value.to_le_bytes()[..size as usize]);
            }
            0xE000_ED04 => self.set_interrupt_state(value),
            0xE000_ED0C => return self.reset_control(value),
            0xE000_ED18..=0xE000_ED23 => {
                let first = (address - 0xE000_ED14) as usize;
                self.nvic.set_priorities(first, &value.to_le_bytes()[..size as usize]);
            }
            // Fault status bits are cleared by writing 1 (B3.2.15).
            0xE000_ED28 | 0xE000_ED2C => *self.plain.entry(address).or_insert(0) &= !value,
            0xE000_EF00 => self.nvic.pend(SYSTEM_EXCEPTIONS + (value & 0x1FF) as usize),
            _ if is_plain(address) || address == 0xE000_ED14 || address == 0xE000_EF34 => {
                self.plain.insert(address, value);
            }
            _ => return Err(no_register(address)),
        }
        Ok(())
    }

    /// When SysTick wraps next, where that raises its exception.
    #[must_use]
    pub fn next_event(&self, cycle: Time) -> Time {
        if self.tick.control & 3 == 3 && self.tick.reload > 0 {
            self.tick.since + self.tick.round(cycle)
        } else {
            Time::NEVER
        }
    }

    /// Does what is due by now.
    pub fn advance(&mut self, now: Time, cycle: Time) {
        if now >= self.next_event(cycle) {
            self.tick.since += self.tick.round(cycle);
            self.tick.wrapped = true;
            self.nvic.pend(SYS_TICK);
        }
    }

    /// CYCCNT.
    fn cycle_count(&self, at: CoreMoment) -> u32 {
        let bit = |register, bit: u32| self.plain.get(&register).copied().unwrap_or(0) >> bit & 1 == 1;
        let (value, since) = self.counted;
        let counts = bit(DWT_CTRL, 0) && bit(DEMCR, 24);
        if counts { value.wrapping_add(at.cycles.wrapping_sub(since) as u32) } else { value }
    }

    /// ICSR (B3.2.4).
    fn interrupt_state(&self) -> u32 {
        let active = self.nvic.active().unwrap_or(0) as u32;
        let bit = |exception, place| u32::from(self.nvic.is_pending(exception)) << place;
        active | bit(SYS_TICK, 26) | bit(PEND_SV, 28) | bit(NMI, 31)
    }

    fn set_interrupt_state(&mut self, value: u32) {
        for (place, exception, on) in [
            (31, NMI, true),
            (28, PEND_SV, true),
            (27, PEND_SV, false),
            (26, SYS_TICK, true),
            (25, SYS_TICK, false),
        ] {
            match (value >> place & 1, on) {
                (1, true) => self.nvic.pend(exception),
                (1, false) => self.nvic.unpend(exception),
                _ => {}
            }
        }
    }

    /// AIRCR (B3.2.6).
    fn reset_control(&mut self, value: u32) -> Result<(), Misuse> {
        if value >> 16 != 0x05FA {
            return Err(Misuse::rule("SCB", "AIRCR is written without its key"));
        }
        if value >> 8 & 7 != 0 {
            return Err(Misuse::rule("SCB", "sub-priorities (AIRCR.PRIGROUP) are not modelled"));
        }
        self.wants_reset |= value & 4 != 0;
        Ok(())
    }
}

/// What went wrong in the core.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FaultCause {
    /// Nothing is at this address.
    Bus(u32),
    /// No code is at this address.
    Fetch(u32),
    /// An instruction that is none.
    Undefined,
    /// Registers that an exception saves have no memory to go to.
    Stacking,
}

/// When the core is asked.
#[derive(Clone, Copy, Debug)]
pub struct CoreMoment {
    /// Virtual time.
    pub now: Time,
    /// One cycle.
    pub cycle: Time,
    /// Cycles of the core's clock so far.
    pub cycles: u64,
}

impl SysTick {
    fn round(&self, cycle: Time) -> Time {
        cycle * (u64::from(self.reload) + 1)
    }

    fn count(&self, at: CoreMoment) -> u32 {
        let gone = at.now.since(self.since).periods(at.cycle) % (u64::from(self.reload) + 1);
        self.reload - gone as u32
    }
}

/// Registers that only keep what is written: auxiliary control, vector table, sleep control, fault
/// status and control, coprocessor access, floating point, debug monitor.
fn is_plain(address: u32) -> bool {
    matches!(
        address,
        0xE000_E008 | 0xE000_ED08 | 0xE000_ED10 | 0xE000_ED24
            ..=0xE000_ED3C | 0xE000_ED88 | 0xE000_EDF0 | 0xE000_EDFC | 0xE000_EF38 | 0xE000_EF3C
    )
}

fn word(address: u32) -> usize {
    (address & 0x1C) as usize * 8
}

fn no_register(address: u32) -> Misuse {
    Misuse::NoRegister { peripheral: "core".to_owned(), offset: address }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(cycles: u64) -> CoreMoment {
        CoreMoment { now: Time::from_micros(cycles), cycle: Time::from_micros(1), cycles }
    }

    #[test]
    fn interrupts_are_enabled_by_one_register_and_disabled_by_another() {
        let mut core = Core::default();
        core.write(0xE000_E108, 4, 1 << 27, at(0)).unwrap();
        assert_eq!(core.read(0xE000_E188, at(0)).unwrap(), 1 << 27);
        core.nvic.set_line(Nvic::exception_of(91), true);
        assert_eq!(core.nvic.next(Default::default()), Some(16 + 91));
        core.write(0xE000_E188, 4, 1 << 27, at(0)).unwrap();
        assert_eq!(core.nvic.next(Default::default()), None);
    }

    #[test]
    fn systick_counts_down_and_raises_its_exception_at_each_wrap() {
        let mut core = Core::default();
        core.write(0xE000_E014, 4, 99, at(0)).unwrap();
        core.write(0xE000_E018, 4, 0, at(0)).unwrap();
        core.write(0xE000_E010, 4, 7, at(0)).unwrap();
        assert_eq!(core.read(0xE000_E018, at(30)).unwrap(), 69);
        assert_eq!(core.next_event(Time::from_micros(1)), Time::from_micros(100));
        core.advance(Time::from_micros(100), Time::from_micros(1));
        assert!(core.nvic.is_pending(SYS_TICK));
        assert_eq!(core.read(0xE000_E010, at(100)).unwrap() >> 16 & 1, 1);
    }

    #[test]
    fn the_cycle_counter_counts_from_the_value_it_was_given() {
        let mut core = Core::default();
        core.write(DEMCR, 4, 1 << 24, at(0)).unwrap();
        core.write(DWT_CTRL, 4, 1, at(0)).unwrap();
        core.write(0xE000_1004, 4, 0, at(1000)).unwrap();
        assert_eq!(core.read(0xE000_1004, at(1234)).unwrap(), 234);
    }

    #[test]
    fn the_cycle_counter_stands_still_unless_trace_and_counter_are_on() {
        let mut core = Core::default();
        let mut count = |trace: u32, counter: u32, at_cycle| {
            core.write(DEMCR, 4, trace << 24, at(at_cycle)).unwrap();
            core.write(DWT_CTRL, 4, counter, at(at_cycle)).unwrap();
            core.read(0xE000_1004, at(at_cycle + 10)).unwrap()
        };
        assert_eq!([count(0, 1, 0), count(1, 0, 100), count(1, 1, 200), count(0, 0, 210)], [0, 0, 10, 10]);
    }

    #[test]
    fn a_reset_needs_its_key_and_unknown_registers_are_refused() {
        let mut core = Core::default();
        assert!(core.write(0xE000_ED0C, 4, 4, at(0)).is_err());
        core.write(0xE000_ED0C, 4, 0x05FA_0004, at(0)).unwrap();
        assert!(core.take_reset());
        assert!(core.read(0xE000_EEEC, at(0)).unwrap_err().to_string().contains("0xe000eeec"));
    }

    #[test]
    fn system_handlers_have_priorities_and_pendsv_yields_to_more_urgent_interrupts() {
        let mut core = Core::default();
        // SHPR3 (B3.2.12): PendSV in byte 2, SysTick in byte 3; then byte by byte.
        core.write(0xE000_ED20, 4, 0x40F0_0000, at(0)).unwrap();
        assert_eq!(core.read(0xE000_ED20, at(0)).unwrap(), 0x40F0_0000);
        core.write(0xE000_ED23, 1, 0xE0, at(0)).unwrap();
        assert_eq!(core.read(0xE000_ED20, at(0)).unwrap(), 0xE0F0_0000);
        core.write(0xE000_ED04, 4, 1 << 28 | 1 << 26, at(0)).unwrap();
        assert_eq!(core.nvic.next(Default::default()), Some(SYS_TICK));
        core.write(0xE000_ED04, 4, 1 << 25, at(0)).unwrap();
        assert_eq!(core.nvic.next(Default::default()), Some(PEND_SV));
        assert_eq!(core.read(0xE000_ED04, at(0)).unwrap() >> 28 & 1, 1);
    }

    #[test]
    fn stir_and_ispr_pend_an_interrupt_by_software_and_icpr_takes_it_back() {
        let mut core = Core::default();
        core.write(0xE000_EF00, 4, 91, at(0)).unwrap();
        assert_eq!(core.read(0xE000_E208, at(0)).unwrap(), 1 << 27);
        assert_eq!(core.nvic.next(Default::default()), None, "it is not enabled");
        core.write(0xE000_E108, 4, 1 << 27, at(0)).unwrap();
        assert_eq!(core.nvic.next(Default::default()), Some(16 + 91));
        core.write(0xE000_E288, 4, 1 << 27, at(0)).unwrap();
        assert_eq!(core.nvic.next(Default::default()), None);
        core.write(0xE000_E208, 4, 1 << 27, at(0)).unwrap();
        assert_eq!(core.nvic.next(Default::default()), Some(16 + 91));
    }

    #[test]
    fn an_interrupts_priority_is_a_byte_of_four_bits() {
        let mut core = Core::default();
        core.write(0xE000_E45B, 1, 0x7F, at(0)).unwrap();
        assert_eq!(core.read(0xE000_E458, at(0)).unwrap(), 0x7000_0000);
        core.write(0xE000_E108, 4, 1 << 27, at(0)).unwrap();
        core.write(0xE000_EF00, 4, 91, at(0)).unwrap();
        let masks = |basepri| super::super::nvic::Masks { basepri, ..Default::default() };
        assert_eq!(core.nvic.next(masks(0x70)), None, "BASEPRI masks its own priority");
        assert_eq!(core.nvic.next(masks(0x80)), Some(16 + 91));
    }
}
