//! Noise of the amplifiers and of the converter, seeded.

use super::{modes, parameters::Analogue};
use crate::chip::time::Time;
use rand::SeedableRng;
use rand_distr::{Distribution, StandardNormal};
use rand_pcg::Pcg64Mcg;
use std::f64::consts::TAU;

/// Noise at the converter. That of the amplifiers is coloured by the slowest of their poles, that of the
/// converter is white.
#[derive(Clone, Debug)]
pub(super) struct Noise {
    random: Pcg64Mcg,
    /// Standard deviations, V.
    amplifiers: f64,
    converter: f64,
    /// Slowest pole, 1/s.
    rate: f64,
    /// Noise of the amplifiers now, in standard deviations.
    now: f64,
    last: Time,
    /// Correlation over the last step, and that step.
    step: (Time, f64),
}

impl Noise {
    pub(super) fn new(analogue: &Analogue, seed: u64) -> Self {
        let mut noise = Self {
            random: Pcg64Mcg::seed_from_u64(seed),
            amplifiers: 0.0,
            converter: analogue.adc.noise,
            rate: 0.0,
            now: 0.0,
            last: Time::ZERO,
            step: (Time::NEVER, 0.0),
        };
        noise.set_gain(analogue, 1.0);
        noise
    }

    pub(super) fn set_gain(&mut self, analogue: &Analogue, gain: f64) {
        let poles = modes::poles(analogue, gain);
        let density = (analogue.amplifier.gain * analogue.amplifier.noise).hypot(analogue.pga.noise);
        self.amplifiers = gain * density * modes::bandwidth(poles).sqrt();
        self.rate = TAU * poles.into_iter().fold(f64::INFINITY, f64::min);
        self.step = (Time::NEVER, 0.0);
    }

    /// Of the amplifiers, and of the converter, V.
    pub(super) fn sample(&mut self, at: Time) -> (f64, f64) {
        let step = at.since(self.last);
        self.last = at;
        if self.step.0 != step {
            self.step = (step, (-self.rate * step.seconds()).exp());
        }
        let correlation = self.step.1;
        let fresh: f64 = StandardNormal.sample(&mut self.random);
        let white: f64 = StandardNormal.sample(&mut self.random);
        self.now = correlation * self.now + (1.0 - correlation * correlation).sqrt() * fresh;
        (self.amplifiers * self.now, self.converter * white)
    }
}
