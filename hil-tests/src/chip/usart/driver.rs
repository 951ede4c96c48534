//! Driver: the output that switches a line's driver on while the UART sends (RM0440 37.5.20, CR3.DEM).

use crate::chip::time::Time;

/// What the driver-enable signal does.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
enum Phase {
    /// The line is left to others.
    #[default]
    Off,
    /// On, with the first start bit at this time (DEAT).
    Before(Time),
    /// On, while bytes leave.
    On,
    /// On until this time after the last stop bit (DEDT).
    After(Time),
}

/// The driver-enable signal, and its pin.
#[derive(Clone, Debug, Default)]
pub(super) struct Driver {
    phase: Phase,
    is_wired: bool,
    is_on: bool,
    /// Level of the pin since each time, as long as nobody has asked.
    edges: Vec<(Time, bool)>,
}

impl Driver {
    /// A driver that goes on from this one's pin after a reset.
    pub(super) fn after_reset(&mut self) -> Self {
        Self { phase: Phase::Off, ..std::mem::take(self) }
    }

    /// Whether the pin is high.
    pub(super) fn is_on(&self) -> bool {
        self.is_on
    }

    pub(super) fn next_event(&self) -> Time {
        match self.phase {
            Phase::Before(time) | Phase::After(time) => time,
            Phase::Off | Phase::On => Time::NEVER,
        }
    }

    /// Something is to be sent.
    pub(super) fn raise(&mut self, now: Time, assertion: Time) {
        // In between, its two times go by first.
        if self.phase == Phase::Off {
            self.phase = Phase::Before(now + assertion);
        }
        self.show(now);
    }

    /// Whether the first byte begins now.
    pub(super) fn begins(&mut self, now: Time) -> bool {
        let begins = matches!(self.phase, Phase::Before(time) if time <= now);
        if begins {
            self.phase = Phase::On;
        }
        begins
    }

    /// The last byte has left.
    pub(super) fn fall(&mut self, now: Time, deassertion: Time) {
        self.phase = Phase::After(now + deassertion);
    }

    /// Whether the line is left to others from now on.
    pub(super) fn ends(&mut self, now: Time) -> bool {
        let ends = matches!(self.phase, Phase::After(time) if time <= now);
        if ends {
            self.stop(now);
        }
        ends
    }

    /// The UART is off.
    pub(super) fn stop(&mut self, now: Time) {
        self.phase = Phase::Off;
        self.show(now);
    }

    /// Whether a pin carries the signal.
    pub(super) fn wire(&mut self, is_wired: bool, now: Time) {
        self.is_wired = is_wired;
        self.show(now);
    }

    pub(super) fn take_edges(&mut self) -> Vec<(Time, bool)> {
        std::mem::take(&mut self.edges)
    }

    fn show(&mut self, now: Time) {
        let is_on = self.is_wired && self.phase != Phase::Off;
        if std::mem::replace(&mut self.is_on, is_on) != is_on {
            self.edges.push((now, is_on));
        }
    }
}
