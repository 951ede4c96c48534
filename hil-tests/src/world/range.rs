//! The switch of the current source's range: PC8 low, as after a reset, for small currents.

use super::parameters::Ranges;
use crate::chip::time::Time;
use std::time::Duration;

/// Bit of port C that is high for the large range.
const LARGE: u16 = 1 << 8;

/// In which range the source is, and when that changes.
#[derive(Clone, Copy, Debug)]
pub(super) struct RangeSwitch {
    is_small: bool,
    wants_small: bool,
    switching: Time,
    at: Time,
}

impl RangeSwitch {
    pub(super) fn new(ranges: &Ranges, is_small: bool) -> Self {
        let switching = Duration::from_secs_f64(ranges.switching).into();
        Self { is_small, wants_small: is_small, switching, at: Time::NEVER }
    }

    /// The chip's pins have these levels from now on; says whether the switch begins to move.
    pub(super) fn pins(&mut self, port: char, levels: u16, now: Time) -> bool {
        let wants_small = levels & LARGE == 0;
        if port != 'C' || wants_small == self.wants_small {
            return false;
        }
        self.wants_small = wants_small;
        self.at = now + self.switching;
        true
    }

    /// When it will have moved.
    pub(super) fn next_change(&self) -> Time {
        if self.is_small == self.wants_small { Time::NEVER } else { self.at }
    }

    /// It has moved; says whether to the small range.
    pub(super) fn finish(&mut self) -> bool {
        self.is_small = self.wants_small;
        self.is_small
    }
}
