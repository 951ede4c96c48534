//! Readings: what a board's own acquisition makes of a circuit that has settled, without the time that stepping takes.
//!
//! The circuit is solved by frequencies ([`super::expected`]); its phasors become samples, with noise and 12 bits,
//! and those go through the code that the firmware runs.

use super::{WorldHandle, expected::Response, multiplexers, parameters::Analogue};
use crate::world::Carrier;
use dermatome_shared::{
    acquire::{Acquisition, FrontEnd},
    demodulate::MIDDLE,
    drive::{Drive, GAINS},
    patch::PatchView,
    scan::Timing,
    trigonometry::cosine,
};
use num_complex::Complex64;
use rand::SeedableRng;
use rand_distr::{Distribution, Normal};
use rand_pcg::Pcg64;
use std::f64::consts::TAU;

/// Frames after which one has come, gains found and all.
const MOST_FRAMES: usize = 8;

/// Crest of the DAC's codes at 100 % of a range.
pub const FULL_DRIVE_CODES: f64 = 1738.0;
/// Clock of the converter, Hz.
const CONVERTER_CLOCK: f64 = 170e6 / 3.0;
/// When the DAC has its first value, after the first trigger, s: with the third sample.
const FIRST_VALUE: f64 = 2.0 / 2e6;

/// From the first value of the current to the first sample, s, where the converter samples so many clocks after a trigger.
#[must_use]
pub fn first_sample(clocks: f64) -> f64 {
    clocks / CONVERTER_CLOCK - FIRST_VALUE
}

/// A board as its firmware believes it to be, before a world.
pub struct Readings<'a> {
    /// The world.
    pub world: &'a WorldHandle,
    /// Its front end by design, with its trim.
    pub front_end: FrontEnd,
    /// Crest of the DAC's codes at 100 %.
    pub full_drive_codes: f64,
    /// From the first value of the current to the first sample, s.
    pub first_sample: f64,
}

impl Readings<'_> {
    /// The circuit at each slot of a patch, in the range that the drive's amplitude takes: what no gain changes.
    #[must_use]
    pub fn responses(&self, patch: &PatchView<'_>, drive: &Drive) -> Vec<Response> {
        self.world.set_small_range(self.front_end.uses_small_range(drive.amplitude));
        let carrier = self.carrier(drive, 1.0);
        let slots = dermatome_shared::scan::slots(patch);
        slots.iter().map(|step| self.world.response(multiplexers::word(step.to_bytes()), &carrier)).collect()
    }

    /// Voltages in phase and in quadrature, V: `[step]`; the mean of so many frames. None if the board cannot make the
    /// carrier.
    #[must_use]
    pub fn volts(
        &self,
        patch: &PatchView<'_>,
        drive: &Drive,
        responses: &[Response],
        frames: usize,
        seed: u64,
    ) -> Option<Vec<[f64; 2]>> {
        let frames = self.frames(patch, drive, responses, frames, seed)?;
        let mean = |step: usize, part: usize| {
            frames.iter().map(|frame| frame[step][part]).sum::<f64>() / frames.len() as f64
        };
        Some((0..frames.first()?.len()).map(|step| [0, 1].map(|part| mean(step, part))).collect())
    }

    /// The same of each frame, `[frame][step]`, once gains are found.
    #[must_use]
    pub fn frames(
        &self,
        patch: &PatchView<'_>,
        drive: &Drive,
        responses: &[Response],
        frames: usize,
        seed: u64,
    ) -> Option<Vec<Vec<[f64; 2]>>> {
        let timing = Timing::new(drive, self.front_end.sample_rate)?;
        let mut acquisition = Acquisition::new(patch, drive, &self.front_end)?;
        let mut circuit = Circuit::new(self, drive, timing, responses, seed);
        let volts = f64::from(self.front_end.volts_per_code);
        let mut found = Vec::new();
        for _ in 0..frames + MOST_FRAMES {
            let samples = circuit.frame(acquisition.gains());
            acquisition.push(&samples, |frame, _| {
                let both = frame.codes.iter().zip(&frame.quadrature);
                found.push(both.map(|(i, q)| [i, q].map(|code| f64::from(code.0) * volts)).collect());
            });
            if found.len() == frames {
                break;
            }
        }
        Some(found)
    }

    /// The values that the firmware's DAC plays, from the crest on.
    fn carrier(&self, drive: &Drive, share: f64) -> Carrier {
        let words = (f64::from(self.front_end.waveform_rate) / f64::from(drive.frequency)).round() as usize;
        let crest = (share * self.full_drive_codes) as f32;
        let code =
            |word: usize| (f32::from(MIDDLE) + crest * cosine(word as f32 / words as f32) + 0.5) as u16;
        Carrier {
            codes: (0..words).map(code).collect(),
            word_rate: self.front_end.waveform_rate.into(),
            samples_per_period: (self.front_end.sample_rate as f32 / drive.frequency).round() as usize,
            first_sample: self.first_sample,
        }
    }
}

/// Makes samples, frame after frame.
struct Circuit<'a> {
    analogue: &'a Analogue,
    responses: &'a [Response],
    carrier: Carrier,
    slot_samples: usize,
    sample_rate: f64,
    noise: f64,
    sample: usize,
    random: Pcg64,
}

impl<'a> Circuit<'a> {
    fn new(
        readings: &'a Readings<'_>,
        drive: &Drive,
        timing: Timing,
        responses: &'a [Response],
        seed: u64,
    ) -> Self {
        let share = f64::from(readings.front_end.share_of_range(drive.amplitude));
        Self {
            analogue: &readings.world.setup().analogue,
            responses,
            carrier: readings.carrier(drive, share),
            slot_samples: timing.slot_samples(),
            sample_rate: readings.front_end.sample_rate.into(),
            noise: readings.world.conditions().noise,
            sample: 0,
            random: Pcg64::seed_from_u64(seed),
        }
    }

    fn frame(&mut self, gains: &[u8]) -> Vec<u16> {
        let mut samples = Vec::new();
        for (response, &place) in self.responses.iter().zip(gains) {
            let gain = f64::from(GAINS[usize::from(place)]);
            let phasor = response.demodulated(self.analogue, gain, &self.carrier);
            let spread =
                self.noise * self.analogue.noise(gain, response.noise).hypot(self.analogue.adc.noise);
            let noise = Normal::new(0.0, spread).expect("a spread is no less than nothing");
            samples.extend((0..self.slot_samples).map(|_| self.next(phasor, gain, &noise)));
        }
        samples
    }

    fn next(&mut self, phasor: Complex64, gain: f64, noise: &Normal<f64>) -> u16 {
        let (pga, adc) = (self.analogue.pga, self.analogue.adc);
        let time = self.sample as f64 / self.sample_rate + self.carrier.first_sample;
        self.sample += 1;
        let wave = (phasor * Complex64::cis(TAU * self.carrier.frequency() * time)).re;
        let middle = adc.full_scale / 2.0 + pga.gain(gain) * pga.offset;
        let volts = (middle + wave).clamp(pga.headroom, adc.full_scale - pga.headroom);
        let read = volts + adc.offset + noise.sample(&mut self.random);
        (read / adc.full_scale * 4096.0).floor().clamp(0.0, 4095.0) as u16
    }
}
