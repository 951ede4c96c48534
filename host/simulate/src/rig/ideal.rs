//! A rig without a converter, whose images are the model's own in f64.

use crate::{noise, truth::TrueSkin};
use dermatome_model::{metrics::thesis::relative_voltage_change, model::Model};
use dermatome_shared::reference::DEFAULT_TARE_FRAMES;
use rand::SeedableRng;
use rand_distr::{Distribution, Normal};
use rand_pcg::Pcg64Mcg;

/// A true skin, its measured reference, and the model that makes the images. Frames are numbered by whoever asks for
/// them, so that they can be measured in any order and on many threads.
#[derive(Debug)]
pub struct IdealRig<'a> {
    truth: &'a TrueSkin,
    model: &'a Model,
    /// Averaged frame of the untouched skin, with what noise is left in it: `[step]`.
    reference: Vec<f64>,
    noise: NumberedNoise,
}

/// Noise that follows from a frame's number.
#[derive(Clone, Copy, Debug)]
struct NumberedNoise {
    /// Standard deviation on each step of a frame.
    deviation: f64,
    seed: u64,
}

/// What one frame gives.
#[derive(Clone, Debug, PartialEq)]
pub struct Measured {
    /// Relative conductivity change: `[pixel]`.
    pub image: Vec<f64>,
    /// dV/V, thesis equation 3.2.
    pub relative_voltage_change: f64,
}

impl<'a> IdealRig<'a> {
    /// Measures the untouched skin as often as a board's tare does.
    ///
    /// `snr_db` is defined as in [`crate::Noise`]; `None` is without noise.
    #[must_use]
    pub fn new(truth: &'a TrueSkin, model: &'a Model, snr_db: Option<f64>, seed: u64) -> Self {
        let mut reference = truth.voltages(&vec![1.0; truth.mesh().elements.len()], &model.steps);
        let size = noise::root_mean_square(reference.iter().copied());
        let deviation = snr_db.map_or(0.0, |db| size * noise::share(db));
        let averaged = deviation / f64::from(DEFAULT_TARE_FRAMES).sqrt();
        NumberedNoise { deviation: averaged, seed }.add_to(&mut reference, 0);
        Self { truth, model, reference, noise: NumberedNoise { deviation, seed } }
    }

    /// Measures a sheet of this relative conductivity, `[element]`, once. The noise follows from `frame`, a number above
    /// zero, and the seed.
    #[must_use]
    pub fn measure(&self, conductivity: &[f64], frame: u64) -> Measured {
        self.read(self.truth.voltages(conductivity, &self.model.steps), frame)
    }

    /// The same of a sheet whose voltages without noise, `[step]`, are known.
    #[must_use]
    pub fn read(&self, mut voltages: Vec<f64>, frame: u64) -> Measured {
        self.noise.add_to(&mut voltages, frame);
        let difference: Vec<f64> = voltages.iter().zip(&self.reference).map(|(v, r)| v - r).collect();
        Measured {
            image: self.model.image(&difference, &self.reference),
            relative_voltage_change: relative_voltage_change(&voltages, &self.reference),
        }
    }
}

impl NumberedNoise {
    fn add_to(&self, voltages: &mut [f64], frame: u64) {
        let mut random = Pcg64Mcg::seed_from_u64(noise::seed_of(self.seed, frame));
        let noise = Normal::new(0.0, self.deviation).expect("a deviation is finite and not negative");
        voltages.iter_mut().for_each(|voltage| *voltage += noise.sample(&mut random));
    }
}
