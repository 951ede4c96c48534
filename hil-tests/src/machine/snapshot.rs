//! Snapshot: how a start stood just before the firmware read a part of the flash, to go on from there again and
//! again with other bytes in that part.
//!
//! Up to its first read of them, what the firmware does cannot depend on these bytes. So a machine runs up to there
//! once, and each flash is judged by the firmware's own code from there on. A flash that differs elsewhere is refused.
//! The world goes on from there as well, but for what a case does to it through its handle.

use super::{Halt, Machine, cycles::CounterSnapshot};
use crate::chip::{
    Chip, RAM_BYTES, RAM_START,
    flash::{self, Flash},
    time::Time,
};
use std::{cell::Cell, ops::Range, rc::Rc};
use unicorn_engine::{Context, uc_error};

/// Between two looks at whether the firmware has read there.
const SLICE: Time = Time::from_micros(100);
/// A start that takes longer does not read there at all.
const LONGEST: Time = Time::from_millis(1000);

/// A machine at one moment.
struct Snapshot {
    context: Context,
    ram: Vec<u8>,
    chip: Chip,
    counter: CounterSnapshot,
    now: Time,
    event: bool,
    last_poll: (u32, u32),
    spins: u32,
    is_conditional: bool,
    sleeps: bool,
    is_locked_up: bool,
    slept: Time,
}

/// A machine just before it first reads these addresses.
pub(super) struct BeforeRead {
    range: Range<u32>,
    snapshot: Snapshot,
}

/// Why a machine does not go on from a snapshot.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum SnapshotError {
    /// The machine cannot go on.
    #[error(transparent)]
    Halt(#[from] Halt),
    /// The flash is not the one that the snapshot was taken with.
    #[error("the flash differs outside of {:#010x} to {:#010x}, the part that was not read yet", range.start, range.end)]
    Elsewhere {
        /// Addresses that may differ.
        range: Range<u32>,
    },
    /// Nothing depends on that part of the flash.
    #[error("the firmware does not read {:#010x} to {:#010x} within {LONGEST} of its start", range.start, range.end)]
    NotRead {
        /// Addresses that were to be read.
        range: Range<u32>,
    },
    /// Nobody has run up to a first read.
    #[error("there is no snapshot to go on from")]
    Missing,
}

impl Machine {
    /// Runs on until just before the firmware first reads these addresses of the flash; says when that is.
    /// [`Machine::go_on_with`] goes on from there.
    pub fn run_before_read(&mut self, range: Range<u32>) -> Result<Time, SnapshotError> {
        let has_read = Rc::new(Cell::new(false));
        let seen = has_read.clone();
        let hook = self.watch_reads(range.clone(), move |_, _, _| seen.set(true));
        let end = self.now() + LONGEST;
        let mut snapshot = self.snapshot()?;
        while self.now() < end {
            self.run_until(self.now() + SLICE)?;
            if has_read.get() {
                break;
            }
            snapshot = self.snapshot()?;
        }
        self.unicorn.remove_hook(hook).map_err(|error| self.failed(error))?;
        if !has_read.get() {
            return Err(SnapshotError::NotRead { range });
        }
        let time = snapshot.now;
        self.before_read = Some(BeforeRead { range, snapshot });
        Ok(time)
    }

    /// Goes on, from just before the first read, as a machine that was switched on with this flash.
    pub fn go_on_with(&mut self, flash: Flash) -> Result<(), SnapshotError> {
        let before = self.before_read.take().ok_or(SnapshotError::Missing)?;
        let result = self.go_on_from(&before, flash);
        self.before_read = Some(before);
        result
    }

    fn go_on_from(&mut self, before: &BeforeRead, flash: Flash) -> Result<(), SnapshotError> {
        let BeforeRead { range, snapshot } = before;
        let differs = |flash: &Flash| !snapshot.chip.flash.is_same_outside(range, flash);
        if differs(&flash) {
            return Err(SnapshotError::Elsewhere { range: range.clone() });
        }
        let has_written_elsewhere = self.chip(|chip| differs(&chip.flash));
        self.restore(snapshot)?;
        let changed =
            if has_written_elsewhere { flash::START..flash::START + flash::BYTES } else { range.clone() };
        self.chip(|chip| chip.flash.take_content(flash, changed));
        self.watch_damage();
        Ok(())
    }

    fn snapshot(&mut self) -> Result<Snapshot, SnapshotError> {
        // What the CPU is still to be shown of the flash is not part of it.
        self.sync_flash();
        let state = &self.state;
        Ok(Snapshot {
            context: self.unicorn.context_init().map_err(|error| self.failed(error))?,
            ram: self.peek(RAM_START, RAM_BYTES as usize),
            chip: state.chip.borrow().clone(),
            counter: state.counter.borrow().snapshot(),
            now: state.now.get(),
            event: state.event.get(),
            last_poll: state.last_poll.get(),
            spins: state.spins.get(),
            is_conditional: state.is_conditional.get(),
            sleeps: self.sleeps,
            is_locked_up: self.is_locked_up,
            slept: self.slept,
        })
    }

    /// All but the flash is as it was.
    fn restore(&mut self, from: &Snapshot) -> Result<(), Halt> {
        self.unicorn.context_restore(&from.context).map_err(|error| self.failed(error))?;
        self.poke(RAM_START, &from.ram);
        let state = &self.state;
        *state.chip.borrow_mut() = from.chip.clone();
        state.counter.borrow_mut().restore(&from.counter);
        state.now.set(from.now);
        state.event.set(from.event);
        state.last_poll.set(from.last_poll);
        state.spins.set(from.spins);
        state.is_conditional.set(from.is_conditional);
        state.misuse.borrow_mut().take();
        (self.sleeps, self.is_locked_up, self.slept) = (from.sleeps, from.is_locked_up, from.slept);
        Ok(())
    }

    fn failed(&self, error: uc_error) -> Halt {
        self.gave_up(format!("a snapshot fails: {error:?}"))
    }
}
