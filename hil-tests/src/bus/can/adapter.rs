//! Adapter: the host's node on a CAN bus, with a queue of frames that is never full.

use super::{Frame, Rates};
use crate::chip::time::Time;
use std::collections::VecDeque;

/// The host's node.
#[derive(Debug)]
pub struct Adapter {
    /// Whether it takes part in the bus: it acknowledges and sends.
    pub is_on: bool,
    /// Its bit rates.
    pub rates: Rates,
    /// Whether what it hears is kept in a record as well.
    pub keeps_record: bool,
    queue: VecDeque<(Time, Frame)>,
    heard: Vec<(Time, Frame)>,
    record: Vec<(Time, Frame)>,
    sent: Vec<Frame>,
}

impl Default for Adapter {
    fn default() -> Self {
        let rates = Rates { nominal: 1_000_000, data: 2_000_000 };
        Self {
            is_on: true,
            rates,
            keeps_record: false,
            queue: VecDeque::new(),
            heard: Vec::new(),
            record: Vec::new(),
            sent: Vec::new(),
        }
    }
}

impl Adapter {
    /// Sends a frame after those that it still has to send.
    pub fn send(&mut self, frame: Frame, now: Time) {
        self.queue.push_back((now, frame));
    }

    /// Frames that it has still to send.
    #[must_use]
    pub fn waiting(&self) -> usize {
        self.queue.len()
    }

    /// Forgets them.
    pub fn forget(&mut self) {
        self.queue.clear();
    }

    /// What it has heard since it was asked last, with the time each frame ended.
    pub fn take_heard(&mut self) -> Vec<(Time, Frame)> {
        std::mem::take(&mut self.heard)
    }

    /// What it has sent since it was asked last.
    pub fn take_sent(&mut self) -> Vec<Frame> {
        std::mem::take(&mut self.sent)
    }

    /// What the record holds.
    pub fn take_record(&mut self) -> Vec<(Time, Frame)> {
        std::mem::take(&mut self.record)
    }

    pub(super) fn request(&self) -> Option<(Time, Frame)> {
        self.queue.front().filter(|_| self.is_on).cloned()
    }

    pub(super) fn note_sent(&mut self) {
        self.sent.extend(self.queue.pop_front().map(|(_, frame)| frame));
    }

    pub(super) fn hear(&mut self, at: Time, frame: Frame) {
        if self.keeps_record {
            self.record.push((at, frame.clone()));
        }
        self.heard.push((at, frame));
    }
}
