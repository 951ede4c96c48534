//! The instrument of recorded frames, as its untouched file tells it: offsets of its channels and what it keeps of the
//! value before.
//!
//! Wires, contacts and gains act before it, so that they are spoilt on the voltages, and the instrument is put back:
//! its offsets, the lowest value that it recorded, and what it keeps.

use dermatome_frames::recorded::{check::Check, read::Frames};
use num_complex::Complex64;
use std::collections::BTreeMap;

/// What it adds to voltages.
#[derive(Clone, Default)]
pub(super) struct Instrument {
    common: f64,
    /// Of sense pairs that have their own.
    of_pairs: BTreeMap<[u8; 2], f64>,
    /// Share of the value before.
    kept: f64,
    lowest: f64,
}

impl Instrument {
    /// As a check of the untouched frames tells it, if it adds anything.
    pub(super) fn of(good: &Check, frames: &Frames) -> Option<Self> {
        let instrument = Self {
            common: good.offset.map_or(0.0, |offset| offset.value),
            of_pairs: good.channel_offsets.iter().map(|it| (it.electrodes, it.value)).collect(),
            kept: good.kept_percent / 100.0,
            lowest: frames.values.iter().map(|value| value.re).fold(f64::INFINITY, f64::min),
        };
        let adds = instrument.common != 0.0 || !instrument.of_pairs.is_empty() || instrument.kept > 0.0;
        (adds && !frames.complex).then_some(instrument)
    }

    fn offset(&self, pair: [u8; 2]) -> f64 {
        self.of_pairs.get(&pair).copied().unwrap_or(self.common)
    }

    /// Voltages behind a frame's values, in the order of measurement.
    pub(super) fn voltages(&self, frame: &[Complex64], pair: impl Fn(usize) -> [u8; 2]) -> Vec<Complex64> {
        let before = |place: usize| frame[(place + frame.len() - 1) % frame.len()];
        let settled = |place: usize| (frame[place] - self.kept * before(place)) / (1.0 - self.kept);
        (0..frame.len()).map(|place| settled(place) - self.offset(pair(place))).collect()
    }

    /// What it records of these.
    pub(super) fn records(&self, voltages: &[Complex64], pair: impl Fn(usize) -> [u8; 2]) -> Vec<Complex64> {
        let real = |place: usize| (voltages[place].re + self.offset(pair(place))).max(self.lowest);
        let mut before = voltages.len().checked_sub(1).map_or(0.0, real);
        (0..voltages.len())
            .map(|place| {
                before = (1.0 - self.kept) * real(place) + self.kept * before;
                Complex64::from(before)
            })
            .collect()
    }
}
