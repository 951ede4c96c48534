//! NVIC: which exception is taken when (ARMv7-M Architecture Reference Manual, B1.5 and B3.4).
//!
//! Interrupt lines are levels: a line that is still up when its handler returns makes the interrupt
//! pending again.

use super::map::priority_bits;

/// Exceptions that the core itself has.
pub const SYSTEM_EXCEPTIONS: usize = 16;
/// Number of NMI.
pub const NMI: usize = 2;
/// Number of HardFault.
pub const HARD_FAULT: usize = 3;
/// Number of SVCall.
pub const SV_CALL: usize = 11;
/// Number of PendSV.
pub const PEND_SV: usize = 14;
/// Number of SysTick.
pub const SYS_TICK: usize = 15;
const EXCEPTIONS: usize = SYSTEM_EXCEPTIONS + 102;
/// Priority of code outside all handlers.
const THREAD: i16 = 256;

/// What masks exceptions, from the core's special registers.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Masks {
    /// PRIMASK: all but NMI and HardFault.
    pub primask: bool,
    /// FAULTMASK: all but NMI.
    pub faultmask: bool,
    /// BASEPRI: this priority and below; 0 masks none.
    pub basepri: u8,
}

/// Model of the NVIC: a bit of each word, and a priority, for each exception.
#[derive(Clone, Debug)]
pub struct Nvic {
    lines: u128,
    pending: u128,
    enabled: u128,
    active: u128,
    priorities: [u8; EXCEPTIONS],
    /// Something changed that may decide which exception is taken.
    has_news: bool,
}

impl Default for Nvic {
    fn default() -> Self {
        let enabled = (1 << SYSTEM_EXCEPTIONS) - 1;
        Self { lines: 0, pending: 0, enabled, active: 0, priorities: [0; EXCEPTIONS], has_news: true }
    }
}

/// Numbers of the exceptions whose bits are set, in order.
fn numbers(mut bits: u128) -> impl Iterator<Item = usize> {
    std::iter::from_fn(move || {
        let number = bits.trailing_zeros() as usize;
        bits &= bits.wrapping_sub(1);
        (number < EXCEPTIONS).then_some(number)
    })
}

impl Nvic {
    /// Number of the exception of an interrupt.
    #[must_use]
    pub fn exception_of(interrupt: u32) -> usize {
        SYSTEM_EXCEPTIONS + interrupt as usize
    }

    /// Sets the level of an interrupt line.
    pub fn set_line(&mut self, exception: usize, level: bool) {
        let bit = 1 << exception;
        if !level {
            self.lines &= !bit;
        } else if self.lines & bit == 0 {
            self.lines |= bit;
            self.pend(exception);
        }
    }

    /// Makes an exception pending.
    pub fn pend(&mut self, exception: usize) {
        self.pending |= 1 << exception;
        self.has_news |= self.enabled >> exception & 1 == 1;
    }

    /// Makes an exception not pending, unless its line is up.
    pub fn unpend(&mut self, exception: usize) {
        let bit = 1 << exception;
        self.pending = self.pending & !bit | self.lines & bit;
    }

    /// Whether an exception is pending.
    #[must_use]
    pub fn is_pending(&self, exception: usize) -> bool {
        self.pending >> exception & 1 == 1
    }

    /// The exception being handled, the most urgent first.
    #[must_use]
    pub fn active(&self) -> Option<usize> {
        numbers(self.active).min_by_key(|&n| (self.priority(n), n))
    }

    /// Whether the core can be woken: something enabled is pending, masked or not.
    #[must_use]
    pub fn any_pending(&self) -> bool {
        self.pending & self.enabled != 0
    }

    /// Whether anything changed since [`Nvic::forget_news`] that may take an exception or wake the core.
    #[must_use]
    pub fn has_news(&self) -> bool {
        self.has_news
    }

    /// The core has looked.
    pub fn forget_news(&mut self) {
        self.has_news = false;
    }

    /// The exception to take now, if any.
    #[must_use]
    pub fn next(&self, masks: Masks) -> Option<usize> {
        let candidates = numbers(self.pending & self.enabled & !1);
        let next = candidates.min_by_key(|&n| (self.priority(n), n))?;
        (self.priority(next) < self.execution_priority(masks)).then_some(next)
    }

    /// An exception is entered.
    pub fn enter(&mut self, exception: usize) {
        self.pending &= !(1 << exception);
        self.active |= 1 << exception;
    }

    /// The handler being run returns.
    pub fn leave(&mut self) -> Option<usize> {
        let exception = self.active()?;
        self.active &= !(1 << exception);
        self.pending |= self.lines & 1 << exception;
        self.has_news = true;
        Some(exception)
    }

    fn execution_priority(&self, masks: Masks) -> i16 {
        let active = self.active().map_or(THREAD, |n| self.priority(n));
        let masked = match masks {
            Masks { faultmask: true, .. } => -1,
            Masks { primask: true, .. } => 0,
            Masks { basepri: 0, .. } => THREAD,
            Masks { basepri, .. } => i16::from(basepri),
        };
        active.min(masked)
    }

    fn priority(&self, exception: usize) -> i16 {
        match exception {
            1 => -3,
            NMI => -2,
            HARD_FAULT => -1,
            _ => i16::from(self.priorities[exception]),
        }
    }

    /// Bits of 32 interrupts, from the first on.
    pub(super) fn bits(&self, first: usize, of: Bits) -> u32 {
        let bits = match of {
            Bits::Enabled => self.enabled,
            Bits::Pending => self.pending,
            Bits::Active => self.active,
        };
        bits.checked_shr((SYSTEM_EXCEPTIONS + first) as u32).unwrap_or(0) as u32
    }

    /// Sets or clears what the bits name.
    pub(super) fn change(&mut self, first: usize, bits: u32, of: Bits, on: bool) {
        for exception in
            numbers(u128::from(bits).checked_shl((SYSTEM_EXCEPTIONS + first) as u32).unwrap_or(0))
        {
            match (of, on) {
                (Bits::Enabled, true) => self.enabled |= 1 << exception,
                (Bits::Enabled, false) => self.enabled &= !(1 << exception),
                (_, true) => self.pend(exception),
                (_, false) => self.unpend(exception),
            }
        }
        self.has_news = true;
    }

    /// Four priorities, a byte each.
    pub(super) fn priorities(&self, first: usize) -> u32 {
        let bytes = self.priorities.iter().skip(first).take(4);
        bytes.enumerate().map(|(place, &priority)| u32::from(priority) << (8 * place)).sum()
    }

    /// Sets priorities; bits that the chip does not have read zero.
    pub(super) fn set_priorities(&mut self, first: usize, bytes: &[u8]) {
        let implemented = !(0xFF_u16 >> priority_bits()) as u8;
        for (priority, byte) in self.priorities.iter_mut().skip(first).zip(bytes) {
            *priority = byte & implemented;
        }
        self.has_news = true;
    }
}

/// Which bits of the interrupts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Bits {
    Enabled,
    Pending,
    Active,
}

#[cfg(test)]
mod tests {
    use super::*;

    fn with(pending: &[(usize, u8)]) -> Nvic {
        let mut nvic = Nvic::default();
        for &(interrupt, priority) in pending {
            let exception = SYSTEM_EXCEPTIONS + interrupt;
            nvic.change(interrupt, 1, Bits::Enabled, true);
            nvic.set_priorities(exception, &[priority]);
            nvic.set_line(exception, true);
        }
        nvic
    }

    #[test]
    fn the_most_urgent_pending_interrupt_is_taken_and_equal_ones_in_order_of_number() {
        let mut nvic = with(&[(5, 0x40), (9, 0x20), (3, 0x40)]);
        assert_eq!(nvic.next(Masks::default()), Some(16 + 9));
        nvic.enter(16 + 9);
        assert_eq!(nvic.next(Masks::default()), None, "less urgent ones wait");
        nvic.set_line(16 + 9, false);
        assert_eq!(nvic.leave(), Some(16 + 9));
        assert_eq!(nvic.next(Masks::default()), Some(16 + 3));
    }

    #[test]
    fn a_more_urgent_interrupt_preempts_a_handler() {
        let mut nvic = with(&[(5, 0x40)]);
        nvic.enter(16 + 5);
        nvic.change(6, 1, Bits::Enabled, true);
        nvic.set_line(16 + 6, true);
        assert_eq!(nvic.next(Masks::default()), Some(16 + 6));
    }

    #[test]
    fn primask_basepri_and_faultmask_hold_back_what_they_name() {
        let nvic = with(&[(5, 0x40)]);
        assert_eq!(nvic.next(Masks { primask: true, ..Masks::default() }), None);
        assert_eq!(nvic.next(Masks { basepri: 0x40, ..Masks::default() }), None);
        assert_eq!(nvic.next(Masks { basepri: 0x50, ..Masks::default() }), Some(16 + 5));
        let mut nvic = nvic;
        nvic.pend(HARD_FAULT);
        assert_eq!(nvic.next(Masks { primask: true, ..Masks::default() }), Some(HARD_FAULT));
        assert_eq!(nvic.next(Masks { faultmask: true, ..Masks::default() }), None);
        nvic.pend(NMI);
        assert_eq!(nvic.next(Masks { faultmask: true, ..Masks::default() }), Some(NMI));
    }

    #[test]
    fn a_line_that_stays_up_makes_its_interrupt_pending_again_on_return() {
        let mut nvic = with(&[(5, 0)]);
        nvic.enter(16 + 5);
        nvic.leave();
        assert_eq!(nvic.next(Masks::default()), Some(16 + 5));
        nvic.enter(16 + 5);
        nvic.set_line(16 + 5, false);
        nvic.leave();
        assert_eq!(nvic.next(Masks::default()), None);
    }

    #[test]
    fn priorities_have_the_four_bits_that_the_chip_has() {
        let mut nvic = Nvic::default();
        nvic.set_priorities(20, &[0xFF, 0x12]);
        assert_eq!(nvic.priorities(20), 0x10F0);
    }
}
