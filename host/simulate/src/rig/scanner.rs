//! Scanner: an instrument whose frames are numbered and timed.

use crate::instrument::{Instrument, ScanTable};
use dermatome_shared::{frame::Frame, protocol::SlotSamples, scan::Timing};

/// An instrument with the board's clock. Frames are numbered from 0; the first one ends a period after the start.
#[derive(Debug)]
pub struct Scanner<I> {
    instrument: I,
    /// Number of the next frame.
    sequence: u32,
    /// Time scanned so far, s.
    time: f64,
}

impl<I> Scanner<I> {
    /// At its start.
    pub fn new(instrument: I) -> Self {
        Self { instrument, sequence: 0, time: 0.0 }
    }

    /// What measures.
    #[must_use]
    pub fn instrument(&self) -> &I {
        &self.instrument
    }

    /// What measures.
    pub fn instrument_mut(&mut self) -> &mut I {
        &mut self.instrument
    }

    /// Its clock alone, which goes on by itself.
    pub(super) fn clock(&self) -> Scanner<()> {
        Scanner { instrument: (), sequence: self.sequence, time: self.time }
    }

    /// Gives a frame its number and time: a period of this table has passed.
    pub fn stamp(&mut self, frame: Frame, table: &ScanTable) -> Frame {
        let sequence = self.sequence;
        self.sequence = sequence.wrapping_add(1);
        self.time += 1.0 / table.frame_rate();
        Frame { sequence, timestamp_us: (self.time * 1e6).round() as u64, ..frame }
    }
}

impl<I: Instrument> Scanner<I> {
    /// One scan, `script_time` seconds into the script, or of the untouched skin.
    pub fn scan(&mut self, table: &ScanTable, script_time: Option<f64>) -> Frame {
        let frame = self.instrument.scan(table, script_time);
        self.stamp(frame, table)
    }

    /// The first samples of one slot; none if the instrument has none to show.
    pub fn samples(&mut self, table: &ScanTable, slot: u16, script_time: Option<f64>) -> Option<SlotSamples> {
        let timing = Timing::new(&table.drive, self.instrument.front_end()?.sample_rate)?;
        self.instrument.samples(table, slot, timing, script_time)
    }
}
