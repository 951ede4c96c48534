//! Calls: cycles of each call of one function, without those of interrupts.

use unicorn_engine::{RegisterARM, Unicorn};

/// Calls of one function.
pub(super) struct Calls {
    function: u32,
    /// Where the call under way returns to.
    returns_to: u32,
    since: u64,
    /// Cycles when the core left thread mode.
    interrupted: u64,
    done: Vec<u64>,
}

impl Calls {
    /// Counts from the next call of the function at this address on.
    pub(super) fn of(function: u32, cycles: u64) -> Self {
        Self { function: function & !1, returns_to: 0, since: 0, interrupted: cycles, done: Vec::new() }
    }

    /// Cycles of each call that has returned.
    pub(super) fn done(&self) -> Vec<u64> {
        self.done.clone()
    }

    /// A block begins.
    pub(super) fn pass(&mut self, address: u32, cycles: u64, unicorn: &Unicorn<'_, ()>) {
        if address == self.function && self.returns_to == 0 {
            self.since = cycles;
            self.returns_to = unicorn.reg_read(RegisterARM::LR).unwrap_or(0) as u32 & !1;
        } else if self.returns_to != 0 && address == self.returns_to {
            self.done.push(cycles - self.since);
            self.returns_to = 0;
        }
    }

    /// An exception is taken, or its handler returns: what handlers take belongs to no call.
    pub(super) fn interrupt(&mut self, begins: bool, cycles: u64) {
        if begins {
            self.interrupted = cycles;
        } else {
            self.since += cycles - self.interrupted;
        }
    }
}
