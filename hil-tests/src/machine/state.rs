//! State: what the hooks of unicorn share with the machine.

use super::{
    calls::Calls,
    cycles::{Access, Counter, Timing},
};
use crate::chip::{Chip, misuse::Misuse, time::Time};
use std::cell::{Cell, RefCell};

/// What the hooks share with the machine.
pub(super) struct State {
    pub(super) chip: RefCell<Chip>,
    pub(super) now: Cell<Time>,
    pub(super) counter: RefCell<Counter>,
    /// Time of a cycle of the core.
    pub(super) cycle: Cell<Time>,
    /// An event is due then; zero where the core is to stop whatever happens.
    pub(super) stop_at: Cell<Time>,
    /// The core is to stop then.
    pub(super) deadline: Cell<Time>,
    /// Stop as soon as PRIMASK or BASEPRI are no longer these.
    pub(super) masks: Cell<Option<(u64, u64)>>,
    /// Code in this range stands still until then.
    pub(super) stall: Cell<Option<(u32, u32, Time)>>,
    /// SEV was executed, or an exception entered or left, since the last WFE.
    pub(super) event: Cell<bool>,
    pub(super) why: Cell<Why>,
    pub(super) misuse: RefCell<Option<Misuse>>,
    pub(super) last_poll: Cell<(u32, u32)>,
    pub(super) spins: Cell<u32>,
    /// Instructions of the block that runs may depend on an IT.
    pub(super) is_conditional: Cell<bool>,
    /// Where the last access went that nothing responds to.
    pub(super) bad_address: Cell<u32>,
    pub(super) calls: RefCell<Option<Calls>>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Why {
    Nothing,
    Due,
    Interrupt(u32),
    Misuse,
}

impl State {
    pub(super) fn new(chip: Chip, timing: Timing) -> Self {
        Self {
            chip: RefCell::new(chip),
            now: Cell::new(Time::ZERO),
            counter: RefCell::new(Counter::new(timing)),
            cycle: Cell::new(Time::ZERO),
            stop_at: Cell::new(Time::ZERO),
            deadline: Cell::new(Time::ZERO),
            masks: Cell::new(None),
            stall: Cell::new(None),
            event: Cell::new(false),
            why: Cell::new(Why::Nothing),
            misuse: RefCell::new(None),
            last_poll: Cell::new((0, 0)),
            spins: Cell::new(0),
            is_conditional: Cell::new(false),
            bad_address: Cell::new(0),
            calls: RefCell::new(None),
        }
    }

    /// What the hooks must know of the chip.
    pub(super) fn follow(&self, chip: &mut Chip) {
        self.cycle.set(chip.clocks().cycle());
        self.stall.set(chip.flash.stalled_code());
        self.spend(|counter| {
            counter.set_up(Access::of(&chip.flash));
            counter.give_way(chip.take_transfers())
        });
    }

    /// Cycles pass.
    pub(super) fn spend(&self, cycles: impl FnOnce(&mut Counter) -> u64) {
        let cycles = cycles(&mut self.counter.borrow_mut());
        self.now.set(self.now.get() + self.cycle.get() * cycles);
    }
}
