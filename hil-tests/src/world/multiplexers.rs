//! The four multiplexers: which switches are closed, and when that changes.
//!
//! Bits 0 to 3 of port B address I+, 4 to 7 I-, 8 to 11 V+, 12 to 15 V-; PC6 enables all four while high.

use super::parameters::Multiplexer;
use crate::chip::time::Time;
use std::time::Duration;

/// Bit of port C that enables the multiplexers.
const ENABLE: u16 = 1 << 6;

/// Closed switches, one or none of each multiplexer: I+, I-, V+, V-.
pub type Closed = [Option<u8>; 4];

/// All switches of a word.
#[must_use]
pub fn selected(word: u16) -> Closed {
    [0, 4, 8, 12].map(|shift| Some((word >> shift & 15) as u8))
}

/// The word that selects these electrodes: I+, I-, V+, V-.
#[must_use]
pub fn word(channels: [u8; 4]) -> u16 {
    channels.iter().rev().fold(0, |word, &channel| word << 4 | u16::from(channel & 15))
}

/// What is wanted, what is closed, and what closes when.
#[derive(Clone, Copy, Debug)]
pub(super) struct Multiplexers {
    address: u16,
    enabled: bool,
    transition: Time,
    break_before_make: bool,
    closed: Closed,
    closing: (Closed, Time),
}

impl Multiplexers {
    pub(super) fn new(parameters: &Multiplexer) -> Self {
        Self {
            address: 0,
            enabled: false,
            transition: Duration::from_secs_f64(parameters.transition_time).into(),
            break_before_make: parameters.break_before_make,
            closed: [None; 4],
            closing: ([None; 4], Time::NEVER),
        }
    }

    /// The chip's pins have these levels from now on; says whether that matters here.
    pub(super) fn pins(&mut self, port: char, levels: u16) -> bool {
        let (address, enabled) = match port {
            'B' => (levels, self.enabled),
            'C' => (self.address, levels & ENABLE != 0),
            _ => return false,
        };
        let changes = (address, enabled) != (self.address, self.enabled);
        (self.address, self.enabled) = (address, enabled);
        changes
    }

    /// Whether they are enabled.
    pub(super) fn is_enabled(&self) -> bool {
        self.enabled
    }

    /// Goes for the switches that address and enable ask for; `stuck` says what reaches the parts.
    pub(super) fn follow(&mut self, stuck: impl Fn(u16) -> u16, now: Time) {
        let wanted = if self.enabled { selected(stuck(self.address)) } else { [None; 4] };
        if wanted == self.closing.0 {
            return;
        }
        for (closed, wanted) in self.closed.iter_mut().zip(wanted) {
            // A part that closes before it opens keeps the old channel until the new one is there.
            if *closed != wanted && (wanted.is_none() || self.break_before_make) {
                *closed = None;
            }
        }
        self.closing = (wanted, now + self.transition);
    }

    /// When the next switches close.
    pub(super) fn next_change(&self) -> Time {
        if self.closed == self.closing.0 { Time::NEVER } else { self.closing.1 }
    }

    /// The switches that were to close do.
    pub(super) fn close(&mut self) {
        self.closed = self.closing.0;
    }

    pub(super) fn closed(&self) -> Closed {
        self.closed
    }
}
