//! Demodulation: samples over whole carrier periods -> in-phase and quadrature, a lock-in.
//!
//! The converter takes an even number of samples in each carrier period, from the same clock that
//! makes the current, so the reference is a table and the product sums are exact integers. Over
//! whole periods a constant and every harmonic below the sampling rate sum to zero.

#[cfg(all(target_arch = "arm", feature = "dsp"))]
mod kernel;

use super::{
    scan::Timing,
    trigonometry::{cosine, sine},
};
use crate::limits::MAX_PERIOD;
use micromath::F32Ext;

/// What a reference of 1 reads in the table.
const ONE: f32 = 16_384.0;
/// Code of the converter at rest, half of its range.
pub const MIDDLE: u16 = 2048;
/// A sample this far from the middle is taken for clipped. The range ends at 2047, but an amplifier stays 0.1 V
/// away from both rails, which leaves 1923.
pub const CLIPPED: u16 = 1900;

/// The lock-in's reference: as many whole periods as there is room for.
#[derive(Clone, Debug)]
pub struct LockInReference {
    waves: Waves,
    /// Samples in a period.
    period: usize,
    /// Samples in all periods.
    length: usize,
}

/// Cosine and negative sine, in steps of 2^-14.
#[derive(Clone, Debug)]
#[repr(C)]
struct Waves {
    cosine: [i16; MAX_PERIOD],
    sine: [i16; MAX_PERIOD],
}

impl LockInReference {
    /// A reference of `period` samples that lags the current by `phase` degrees; sample 0 of the scan
    /// lies `lead` samples after the current's crest.
    #[must_use]
    pub fn new(period: u16, phase: f32, lead: f32) -> Self {
        let period = usize::from(period).clamp(2, MAX_PERIOD);
        let length = MAX_PERIOD - MAX_PERIOD % period;
        let mut waves = Waves { cosine: [0; MAX_PERIOD], sine: [0; MAX_PERIOD] };
        for sample in 0..length {
            let n = sample % period;
            // The second half is the first one's opposite, so that a constant sums to exactly nothing.
            let (place, sign) = if n < period / 2 { (n, 1.0) } else { (n - period / 2, -1.0) };
            let turns = (place as f32 + lead) / period as f32 - phase / 360.0;
            waves.cosine[sample] = F32Ext::round(sign * cosine(turns) * ONE) as i16;
            waves.sine[sample] = F32Ext::round(-sign * sine(turns) * ONE) as i16;
        }
        Self { waves, period, length }
    }
}

/// What the lock-in found in one slot.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(C)]
pub struct Reading {
    /// Sum of sample * cosine, in steps of 2^-14.
    pub in_phase: i64,
    /// Sum of sample * negative sine, in steps of 2^-14.
    pub quadrature: i64,
    /// Largest sample, or the middle; the second place is the kernel's.
    highest: [u16; 2],
    /// Smallest sample, or the middle; the second place is the kernel's.
    lowest: [u16; 2],
}

impl Default for Reading {
    fn default() -> Self {
        Self { in_phase: 0, quadrature: 0, highest: [MIDDLE; 2], lowest: [MIDDLE; 2] }
    }
}

impl Reading {
    /// Largest way of a sample from the middle.
    #[must_use]
    pub fn peak(&self) -> u16 {
        (self.highest[0] - MIDDLE).max(MIDDLE - self.lowest[0])
    }

    /// Adds the products of samples and a reference from a place on, which ends no earlier.
    #[inline(always)]
    fn add(&mut self, samples: &[u16], waves: &Waves, place: usize) {
        #[cfg(all(target_arch = "arm", feature = "dsp"))]
        let done = kernel::add_pairs(self, samples, waves, place);
        #[cfg(not(all(target_arch = "arm", feature = "dsp")))]
        let done = 0;
        if done < samples.len() {
            self.add_each(&samples[done..], waves, place + done);
        }
    }

    /// As [`Self::add`], not in line: most slots do without.
    #[inline(never)]
    fn add_run(&mut self, samples: &[u16], waves: &Waves, place: usize) {
        self.add(samples, waves, place);
    }

    /// As [`Self::add`], in plain Rust.
    #[inline(never)]
    fn add_each(&mut self, samples: &[u16], waves: &Waves, place: usize) {
        let references = waves.cosine.iter().zip(&waves.sine).skip(place);
        for (&sample, (&cosine, &sine)) in samples.iter().zip(references) {
            self.in_phase += i64::from(i32::from(sample) * i32::from(cosine));
            self.quadrature += i64::from(i32::from(sample) * i32::from(sine));
            self.highest[0] = self.highest[0].max(sample);
            self.lowest[0] = self.lowest[0].min(sample);
        }
    }
}

/// Takes the samples of a scan as they come, in pieces of any length, and gives a reading per slot.
#[derive(Clone, Debug)]
pub struct Demodulator {
    reference: LockInReference,
    timing: Timing,
    /// Samples of the slot so far.
    position: usize,
    /// Place of the slot's first measured sample in the carrier's period.
    first: usize,
    reading: Reading,
}

impl Demodulator {
    /// Ready for the first sample of a scan.
    #[must_use]
    pub fn new(reference: LockInReference, timing: Timing) -> Self {
        let mut demodulator = Self { reference, timing, position: 0, first: 0, reading: Reading::default() };
        demodulator.restart();
        demodulator
    }

    /// Ready for the first sample of a scan again.
    pub fn restart(&mut self) {
        let first = usize::from(self.timing.settling) % self.reference.period;
        (self.position, self.first, self.reading) = (0, first, Reading::default());
    }

    /// Takes the next samples; `done` gets the reading of each slot that they complete.
    pub fn push(&mut self, mut samples: &[u16], mut done: impl FnMut(&Reading)) {
        let (settling, slot) = (usize::from(self.timing.settling), self.timing.slot_samples());
        let turn = slot % self.reference.period;
        while !samples.is_empty() {
            let (of_slot, rest) = samples.split_at(samples.len().min(slot - self.position));
            let settles = settling.saturating_sub(self.position);
            if let Some(measured) = of_slot.get(settles..) {
                self.accumulate(measured, self.first + self.position + settles - settling);
            }
            self.position += of_slot.len();
            samples = rest;
            if self.position == slot {
                done(&self.reading);
                (self.position, self.reading) = (0, Reading::default());
                self.first += turn;
                if self.first >= self.reference.period {
                    self.first -= self.reference.period;
                }
            }
        }
    }

    /// Samples of one slot, as many at a time as the reference goes on; `place` counts from its start, and
    /// may lie behind its end.
    #[inline(always)]
    fn accumulate(&mut self, mut samples: &[u16], mut place: usize) {
        let length = self.reference.length;
        // Most often the reference holds all of them.
        while place + samples.len() > length {
            place = if place < length { place } else { place % self.reference.period };
            let (run, rest) = samples.split_at(samples.len().min(length - place));
            self.reading.add_run(run, &self.reference.waves, place);
            (samples, place) = (rest, place + run.len());
        }
        self.reading.add(samples, &self.reference.waves, place);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use std::vec::Vec;

    const TIMING: Timing = Timing { period: 20, settling: 7, integration: 40 };

    fn wave(amplitude: f64, degrees: f64, offset: f64, samples: usize) -> Vec<u16> {
        let at = |n: usize| (n as f64 / 20.0 + degrees / 360.0) * core::f64::consts::TAU;
        (0..samples).map(|n| (2048.0 + offset + amplitude * at(n).cos()).round() as u16).collect()
    }

    fn readings(samples: &[u16], pieces: usize) -> Vec<Reading> {
        let mut demodulator = Demodulator::new(LockInReference::new(20, 0.0, 0.0), TIMING);
        let mut found = Vec::new();
        samples.chunks(pieces).for_each(|piece| demodulator.push(piece, |reading| found.push(*reading)));
        found
    }

    /// Amplitude in codes.
    fn amplitude(sum: i64) -> f64 {
        sum as f64 * 2.0 / 40.0 / f64::from(ONE)
    }

    #[test]
    #[cfg_attr(miri, ignore = "a lock-in over whole frames takes Miri minutes")]
    fn a_wave_reads_its_amplitude_and_phase_in_every_slot_whatever_its_offset() {
        // Slots of 47 samples start at another phase each.
        for reading in readings(&wave(900.0, 30.0, 150.0, 470), 470) {
            assert!((amplitude(reading.in_phase) - 900.0 * 0.75_f64.sqrt()).abs() < 0.5, "{reading:?}");
            assert!((amplitude(reading.quadrature) - 450.0).abs() < 0.5, "{reading:?}");
            assert!((1035..=1051).contains(&reading.peak()));
            assert!(reading.peak() < CLIPPED);
        }
    }

    #[test]
    #[cfg_attr(miri, ignore = "a lock-in over whole frames takes Miri minutes")]
    fn phase_and_lead_turn_the_reference() {
        let samples = wave(900.0, 0.0, 0.0, 470);
        for (phase, lead) in [(90.0, 0.0), (0.0, -5.0)] {
            let mut demodulator = Demodulator::new(LockInReference::new(20, phase, lead), TIMING);
            demodulator.push(&samples, |reading| {
                assert!(amplitude(reading.in_phase).abs() < 0.5, "{reading:?}");
                assert!((amplitude(reading.quadrature) - 900.0).abs() < 0.5, "{reading:?}");
            });
        }
    }

    #[test]
    #[cfg_attr(miri, ignore = "a lock-in over whole frames takes Miri minutes")]
    fn harmonics_sum_to_nothing() {
        for harmonic in 2..10 {
            let at = |n: usize| (n * harmonic) as f64 / 20.0 * core::f64::consts::TAU;
            let samples: Vec<u16> = (0..47).map(|n| (2048.0 + 1500.0 * at(n).cos()).round() as u16).collect();
            let reading = readings(&samples, 47)[0];
            assert!(amplitude(reading.in_phase).hypot(amplitude(reading.quadrature)) < 0.3, "{harmonic}");
        }
    }

    #[test]
    fn a_slot_longer_than_the_reference_reads_the_same_in_pieces_of_any_length() {
        let timing = Timing { period: 20, settling: 7, integration: 60 * 20 };
        let samples = wave(900.0, 30.0, 150.0, 2 * timing.slot_samples());
        for piece in [1, 7, 150, 333, samples.len()] {
            let mut demodulator = Demodulator::new(LockInReference::new(20, 0.0, 0.0), timing);
            let mut found = Vec::new();
            samples.chunks(piece).for_each(|piece| demodulator.push(piece, |reading| found.push(*reading)));
            assert_eq!(found.len(), 2);
            for reading in found {
                let [real, imaginary] =
                    [reading.in_phase, reading.quadrature].map(|sum| amplitude(sum) / 30.0);
                assert!((real - 900.0 * 0.75_f64.sqrt()).abs() < 0.5, "{piece}: {real}");
                assert!((imaginary - 450.0).abs() < 0.5, "{piece}: {imaginary}");
            }
        }
    }

    #[test]
    fn the_end_of_the_range_reads_clipped() {
        assert!(readings(&wave(2046.0, 0.0, 0.0, 47), 47)[0].peak() >= CLIPPED);
        // An amplifier stays 0.1 V away from both rails: 124 codes.
        let limited: Vec<u16> =
            wave(2046.0, 0.0, 0.0, 47).into_iter().map(|code| code.clamp(124, 3971)).collect();
        assert!(readings(&limited, 47)[0].peak() >= CLIPPED);
        assert_eq!(readings(&[0; 47], 47)[0].peak(), MIDDLE);
    }

    proptest! {
        #[test]
        fn pieces_of_any_length_give_the_same_readings(
            samples in prop::collection::vec(0_u16..4096, 0..500),
            pieces in 1_usize..100,
        ) {
            prop_assert_eq!(readings(&samples, pieces), readings(&samples, 1000));
            prop_assert_eq!(readings(&samples, pieces).len(), samples.len() / 47);
        }
    }
}
