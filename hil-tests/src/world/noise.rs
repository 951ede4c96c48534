//! Noise of the skin, of the amplifiers and of the converter, seeded.

use super::{modes::Chain, parameters::Analogue};
use crate::chip::time::Time;
use rand::SeedableRng;
use rand_distr::{Distribution, StandardNormal};
use rand_pcg::Pcg64Mcg;

/// Noise at the converter. That of skin and amplifiers is coloured by the slowest of their poles, that of the
/// converter is white.
#[derive(Clone, Debug)]
pub(super) struct Noise {
    random: Pcg64Mcg,
    /// Standard deviations, V.
    amplifiers: f64,
    converter: f64,
    /// Slowest pole, 1/s.
    rate: f64,
    /// Noise of skin and amplifiers now, in standard deviations.
    now: f64,
    last: Time,
    /// Correlation over the last step, and that step.
    step: (Time, f64),
}

impl Noise {
    pub(super) fn new(analogue: &Analogue, seed: u64) -> Self {
        Self {
            random: Pcg64Mcg::seed_from_u64(seed),
            amplifiers: 0.0,
            converter: analogue.adc.noise,
            rate: 0.0,
            now: 0.0,
            last: Time::ZERO,
            step: (Time::NEVER, 0.0),
        }
    }

    /// The noise is that of a chain from now on.
    pub(super) fn follow(&mut self, chain: &Chain) {
        (self.amplifiers, self.rate) = (chain.noise, chain.slowest_pole);
        self.step = (Time::NEVER, 0.0);
    }

    /// Of skin and amplifiers, and of the converter, V.
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
