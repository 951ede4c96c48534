//! Board: one emulated board of several, with straps, and a time of its own that stands still without power.

use crate::{
    chip::{flash::Flash, time::Time},
    machine::{Halt, Machine, Options},
};

/// Pins of port C that are the straps of a board's address, lowest bit first.
const STRAPS: [usize; 4] = [9, 10, 11, 12];

/// One board of several.
pub(super) struct Board {
    pub(super) machine: Machine,
    /// How far its own time is behind the others': it stood still without power.
    pub(super) behind: Time,
    pub(super) has_power: bool,
    pub(super) stands_until: Time,
}

impl std::fmt::Debug for Board {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(formatter, "Board({})", self.machine.now())
    }
}

impl Board {
    pub(super) fn new((address, flash, options): (u8, Flash, Options)) -> Result<Self, Halt> {
        let mut machine = Machine::new(flash, options)?;
        machine.chip(|chip| {
            for (bit, pin) in STRAPS.into_iter().enumerate() {
                let is_bridged = address >> bit & 1 == 1;
                chip.drive('C', pin, is_bridged.then_some(false));
            }
        });
        Ok(Self { machine, behind: Time::ZERO, has_power: true, stands_until: Time::ZERO })
    }

    pub(super) fn run_until(&mut self, end: Time) -> Result<(), Halt> {
        if !self.has_power {
            self.behind = end - self.machine.now();
            return Ok(());
        }
        let stands_until = (self.stands_until.min(end)) - self.behind;
        if stands_until > self.machine.now() {
            self.machine.stand_until(stands_until)?;
        }
        self.machine.run_until(end - self.behind)
    }
}
