//! Reconstruction: from a skin's Jacobian and settings to its one matrix.

use super::{
    DataSpace, InverseError, Whitening,
    difference::{divisors, mean_magnitude},
    figures, greit, movement,
    selection::{self, NoiseFigure, Selection},
    targets::Responses,
    whitening::{self, scale_columns},
};
use crate::{
    pixels::Pixels,
    prior::{Factored, Prior},
    skin::{Criterion, Hyperparameter, Inverse, Method, Weights},
};
use dermatome_shared::patch::Difference;
use faer::Mat;
use rand::SeedableRng;
use rand_distr::{Distribution, StandardNormal};
use rand_pcg::Pcg64Mcg;

/// What is known of the measurements of a skin. Voltages are in model volts.
pub struct Measurements<'a> {
    /// d voltage / d relative conductivity: `[measurement][pixel]`.
    pub jacobian: &'a Mat<f64>,
    /// Voltages of the untouched skin: `[measurement]`.
    pub voltages: &'a [f64],
    /// Steps that each measurement averages: `[measurement]`.
    pub step_counts: &'a [f64],
    /// Root mean square of the untouched voltages over all steps.
    pub step_size: f64,
    /// Responses to simulated targets.
    pub responses: &'a Responses,
}

/// A skin's matrix and how its hyperparameter was found.
#[derive(Clone, Debug)]
pub struct Reconstruction {
    /// Relative conductivity from difference data: `[pixel][measurement]`.
    pub matrix: Mat<f64>,
    /// The prior, unless the method has none.
    pub prior: Option<Prior>,
    /// W for model volts: `[measurement]`.
    pub weights: Vec<f64>,
    /// The hyperparameter used.
    pub hyperparameter: f64,
    /// The criterion it was chosen by, unless it was given.
    pub selection: Option<Selection>,
}

/// Computes the reconstruction matrix that `inverse` asks for; `factored` is what of its prior was
/// factored before.
pub fn reconstruct(
    inverse: &Inverse,
    pixels: &Pixels,
    factored: Option<&Factored>,
    of: &Measurements<'_>,
) -> Result<Reconstruction, InverseError> {
    let weights = weights(inverse, of)?;
    let whitening = Whitening::from_weights(&weights)?;
    let (space, prior) = data_space(inverse, pixels, factored, of, &weights, &whitening)?;
    let (hyperparameter, selection) = match inverse.hyperparameter {
        Hyperparameter::Fixed(given) => (given, None),
        Hyperparameter::Chosen(criterion) => {
            let selection = select(criterion, inverse, &pixels.areas, of, &space, &whitening)?;
            (selection.chosen.hyperparameter, Some(selection))
        }
    };
    let mut matrix = space.matrix(hyperparameter)?;
    whitening.columns(&mut matrix);
    scale_columns(&mut matrix, &divisors(inverse.difference, of.voltages));
    Ok(Reconstruction { matrix, prior, weights, hyperparameter, selection })
}

/// Smallest untouched voltage that may be normalised by, over the mean: below it, noise at 60 dB is as
/// large as the voltage.
const SMALLEST_SHARE: f64 = 1e-3;

/// W for model volts: `[measurement]`.
///
/// The hyperparameter keeps EIDORS' meaning: plain differences are weighed in model volts (unit
/// current and conductivity), normalised ones as ratios, so that their weight in volts is divided by
/// the voltage squared.
fn weights(inverse: &Inverse, of: &Measurements<'_>) -> Result<Vec<f64>, InverseError> {
    let measurements = of.voltages.len();
    let squares = || of.voltages.iter().map(|v| v * v);
    let weights: Vec<f64> = match &inverse.weights {
        Weights::Steps => of.step_counts.to_vec(),
        Weights::ReferenceSquared => {
            of.step_counts.iter().zip(squares()).map(|(n, square)| n * square).collect()
        }
        Weights::Each(list) if list.len() == measurements => list.clone(),
        Weights::Each(list) => return Err(InverseError::WeightCount { given: list.len(), measurements }),
    };
    whitening::check(&weights)?;
    match inverse.difference {
        Difference::Plain => Ok(weights),
        Difference::Normalised => {
            check_smallest(of.voltages)?;
            Ok(weights.iter().zip(squares()).map(|(weight, square)| weight / square).collect())
        }
    }
}

fn check_smallest(voltages: &[f64]) -> Result<(), InverseError> {
    let mean = mean_magnitude(voltages);
    let shares = voltages.iter().map(|v| v.abs() / mean).enumerate();
    match shares.min_by(|a, b| a.1.total_cmp(&b.1)) {
        Some((measurement, share)) if share < SMALLEST_SHARE => {
            Err(InverseError::SmallVoltage { measurement, share })
        }
        _ => Ok(()),
    }
}

fn data_space(
    inverse: &Inverse,
    pixels: &Pixels,
    factored: Option<&Factored>,
    of: &Measurements<'_>,
    weights: &[f64],
    whitening: &Whitening,
) -> Result<(DataSpace, Option<Prior>), InverseError> {
    let movement = match (inverse.electrode_movement, &of.responses.movement) {
        (None, _) => None,
        (Some(weight), Some(movement)) => Some(movement::covariance(movement, weight, whitening)),
        (Some(_), None) => return Err(InverseError::NotSimulated { what: "electrode movement" }),
    };
    match inverse.method {
        Method::OneStep(kind) => {
            let prior = Prior::new(kind, pixels, of.jacobian, weights);
            let space = DataSpace::one_step_with(
                whitening.transposed(of.jacobian),
                &prior,
                factored,
                movement.as_ref(),
            )?;
            Ok((space, Some(prior)))
        }
        Method::Greit { radius } => {
            let training = of.responses.training.as_ref();
            let training = training.ok_or(InverseError::NotSimulated { what: "training targets" })?;
            Ok((greit::data_space(training, whitening, pixels, radius, movement.as_ref()), None))
        }
    }
}

/// Noisy frames for best resolution.
const NOISY_FRAMES: usize = 32;
/// Seed of their noise.
const SEED: u64 = 1;

fn select(
    criterion: Criterion,
    inverse: &Inverse,
    areas: &[f64],
    of: &Measurements<'_>,
    space: &DataSpace,
    whitening: &Whitening,
) -> Result<Selection, InverseError> {
    let spectrum = space.spectrum()?;
    let noise = noise(of, inverse.noise_db);
    let frames = |count| {
        noisy_frames(of, &noise, count).map(|frames| whitening.transposed(&frames).transpose().to_owned())
    };
    let frame = || frames(1).map(|frame| frame.col(0).iter().copied().collect::<Vec<_>>());
    Ok(match criterion {
        Criterion::LCurve => selection::l_curve(&spectrum, &frame()?)?,
        Criterion::CrossValidation => selection::cross_validation(&spectrum, &frame()?)?,
        Criterion::BestResolution => {
            selection::best_resolution(space, &spectrum, &frames(NOISY_FRAMES)?, areas)?
        }
        Criterion::NoiseFigure(asked) => {
            let divisors = divisors(inverse.difference, of.voltages);
            let ratio = |values: &[f64]| {
                values.iter().zip(&divisors).map(|(v, divisor)| v / divisor).collect::<Vec<_>>()
            };
            let data_snr = figures::signal_to_noise(&ratio(&of.responses.target), &ratio(&noise));
            let (signal, noise) = (whitening.data(&of.responses.target), whitening.data(&noise));
            let figure = NoiseFigure { signal: &signal, noise: &noise, data_snr, areas };
            selection::noise_figure(space, &spectrum, &figure, asked)?
        }
    })
}

/// Standard deviation of each measurement, in model volts, for white noise on every step at this
/// signal-to-noise ratio (dB, against the root mean square of the untouched voltages).
#[must_use]
pub fn noise(of: &Measurements<'_>, snr_db: f64) -> Vec<f64> {
    let step = of.step_size * 10_f64.powf(-snr_db / 20.0);
    of.step_counts.iter().map(|count| step / count.sqrt()).collect()
}

/// Frames of the standard target, in model volts: `[measurement][frame]`.
fn noisy_frames(of: &Measurements<'_>, noise: &[f64], count: usize) -> Result<Mat<f64>, InverseError> {
    let frame = of
        .responses
        .frame
        .as_ref()
        .ok_or(InverseError::NotSimulated { what: "a frame of the standard target" })?;
    let mut random = Pcg64Mcg::seed_from_u64(SEED);
    Ok(Mat::from_fn(frame.len(), count, |i, _| {
        let unit: f64 = StandardNormal.sample(&mut random);
        frame[i] + noise[i] * unit
    }))
}
