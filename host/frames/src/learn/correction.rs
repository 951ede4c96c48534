//! The correction of the model's matrix by presses.
//!
//! Measurements are divided by their usual response s (the median size over the training presses), and
//! each press y by its own size a (root mean square), so that every press and measurement counts alike.
//! With the model's matrix W0, the presses Y, their desired images D (GREIT's round spots,
//! [`greit::desired`]) and the sign and scale g that bring W0 Y closest to D, the learnt matrix W
//! minimises
//!
//! ```text
//! mean |W y - d|^2 + t m |W - g W0|^2        m: mean square of the entries of Y
//! W = g W0 + (D - g W0 Y) Y'/n (Y Y'/n + t m I)^-1
//! ```
//!
//! a ridge regression that shrinks towards the model instead of zero. Trust t without end gives the
//! model; directions that the presses do not excite keep it. W is scaled so that
//! presses look as strong as in the model's images (median of the peaks); conductivity rises in it
//! where the skin is pressed.

use super::{LearnError, Strength, presses::Presses};
use crate::recorded::statistics::median;
use dermatome_model::{
    inverse::{greit, targets::half_side},
    jacobian::step_counts,
    model::Model,
};
use faer::{
    Conj, Mat, Scale, Side,
    linalg::solvers::{Llt, SolveCore},
};
use nalgebra::Point3;
use serde::Serialize;

/// A measurement whose usual response is below this share of the median one counts as if it were this.
const SMALLEST_RESPONSE: f64 = 1e-3;

/// What cross-validation chooses.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Settings {
    /// How far the model is trusted against the presses: t.
    pub trust: f64,
    /// Radius of the desired spots, as a share of half the skin's larger side.
    pub radius: f64,
}

/// A learnt matrix.
#[derive(Clone, Debug)]
pub struct Correction {
    /// Relative conductivity, up where pressed, from difference data: `[pixel][measurement]`.
    pub matrix: Mat<f64>,
    /// The model's, with the sign that makes presses positive.
    pub prior: Mat<f64>,
    /// Scale of the model's matrix in the fit over that of `prior`.
    gain: f64,
    /// What the fit was multiplied with.
    scale: f64,
    /// Whether the model says that presses lower the conductivity.
    pub falls: bool,
}

/// Presses made ready to learn from.
pub struct Training<'a> {
    model: &'a Model,
    /// 1 / s: `[measurement]`.
    inverse_responses: Vec<f64>,
    /// Standard deviation of difference data for equal noise on every step: `[measurement]`.
    pub noise: Vec<f64>,
    /// Y': `[press][measurement]`.
    presses: Mat<f64>,
    /// Sizes a of the presses: `[press]`.
    sizes: Vec<f64>,
    places: Vec<Point3<f64>>,
    /// Heights of the desired spots: `[press]`.
    heights: Vec<f64>,
    /// W0 for Y: `[pixel][measurement]`.
    prior: Mat<f64>,
    /// Y Y'/n.
    gram: Mat<f64>,
}

impl<'a> Training<'a> {
    /// Takes some of the presses.
    pub fn new(
        model: &'a Model,
        presses: &Presses,
        which: &[usize],
        strength: Strength,
    ) -> Result<Self, LearnError> {
        let measurements = presses.measurements();
        let responses = usual_responses(presses, which)?;
        let inverse_responses: Vec<f64> = responses.iter().map(|response| 1.0 / response).collect();
        let mut rows =
            Mat::from_fn(which.len(), measurements, |i, m| presses.data[which[i]][m] * inverse_responses[m]);
        let mut sizes = Vec::with_capacity(which.len());
        for (i, &press) in which.iter().enumerate() {
            let size = rows.row(i).norm_l2() / (measurements as f64).sqrt();
            if size == 0.0 {
                return Err(LearnError::NoChange(press));
            }
            rows.row_mut(i).iter_mut().for_each(|value| *value /= size);
            sizes.push(size);
        }
        let matrix = &model.conductivity_from_difference;
        let counts = step_counts(&model.combination);
        let noise =
            presses.mean_divisors.iter().zip(&counts).map(|(v, count)| inverse_or_zero(v * count.sqrt()));
        Ok(Self {
            model,
            prior: Mat::from_fn(matrix.nrows(), measurements, |p, m| matrix[(p, m)] * responses[m]),
            gram: rows.transpose() * &rows * Scale(1.0 / which.len() as f64),
            heights: heights(presses, which, &sizes, strength),
            places: which.iter().map(|&press| presses.places[press]).collect(),
            presses: rows,
            sizes,
            inverse_responses,
            noise: noise.collect(),
        })
    }

    /// The learnt matrix.
    pub fn correct(&self, settings: Settings) -> Result<Correction, LearnError> {
        let model_images = &self.prior * self.presses.transpose();
        let desired = self.desired(settings.radius);
        let gain = inner(&model_images, &desired) / inner(&model_images, &model_images);
        if !gain.is_finite() || gain == 0.0 {
            return Err(LearnError::Singular);
        }
        let left = desired - model_images.clone() * Scale(gain);
        let products = left * &self.presses * Scale(1.0 / self.presses.nrows() as f64);
        let fitted = self.prior.clone() * Scale(gain) + self.solve(&products, settings.trust)?;
        let strongest = |images: &Mat<f64>, sign: f64| {
            let peak = |press: usize| images.col(press).iter().fold(0.0, |max: f64, v| max.max(v * sign));
            median((0..images.ncols()).map(|press| peak(press) * self.sizes[press]))
        };
        let fitted_peak = strongest(&(&fitted * self.presses.transpose()), 1.0);
        let scale = strongest(&model_images, gain.signum()) / fitted_peak;
        if !scale.is_finite() || scale == 0.0 {
            return Err(LearnError::Singular);
        }
        let matrix = Mat::from_fn(fitted.nrows(), fitted.ncols(), |p, m| {
            fitted[(p, m)] * scale * self.inverse_responses[m]
        });
        let prior = self.model.conductivity_from_difference.clone() * Scale(gain.signum());
        Ok(Correction { matrix, prior, gain: gain.abs(), scale, falls: gain < 0.0 })
    }

    /// |W - g W0| / |g W0|, for measurements divided by their usual responses.
    #[must_use]
    pub fn departure(&self, correction: &Correction) -> f64 {
        let factor = correction.gain * correction.scale;
        let (mut apart, mut size) = (0.0, 0.0);
        for m in 0..correction.matrix.ncols() {
            let response = 1.0 / self.inverse_responses[m];
            for (learnt, prior) in correction.matrix.col(m).iter().zip(correction.prior.col(m).iter()) {
                let prior = prior * factor * response;
                apart += (learnt * response - prior).powi(2);
                size += prior * prior;
            }
        }
        (apart / size).sqrt()
    }

    /// D: `[pixel][press]`.
    fn desired(&self, radius: f64) -> Mat<f64> {
        let radius = radius * half_side(&self.model.mesh);
        let centres = &self.model.pixels.centres;
        Mat::from_fn(centres.len(), self.places.len(), |pixel, press| {
            let distance = (centres[pixel] - self.places[press]).norm();
            greit::desired(distance, radius) * self.heights[press]
        })
    }

    /// A (Y Y'/n + t m I)^-1 for A `[pixel][measurement]`.
    fn solve(&self, products: &Mat<f64>, trust: f64) -> Result<Mat<f64>, LearnError> {
        let size = self.gram.nrows();
        let mean_square = (0..size).map(|m| self.gram[(m, m)]).sum::<f64>() / size as f64;
        let mut system = self.gram.clone();
        (0..size).for_each(|m| system[(m, m)] += trust * mean_square);
        let factor = Llt::new(system.as_ref(), Side::Lower).map_err(|_| LearnError::Singular)?;
        let mut solution = products.transpose().to_owned();
        factor.solve_in_place_with_conj(Conj::No, solution.as_mut());
        Ok(solution.transpose().to_owned())
    }
}

/// s: median size of each measurement over some presses, none of them zero.
fn usual_responses(presses: &Presses, which: &[usize]) -> Result<Vec<f64>, LearnError> {
    let usual = |m: usize| median(which.iter().map(|&press| presses.data[press][m].abs()));
    let responses: Vec<f64> = (0..presses.measurements()).map(usual).collect();
    let alive = responses.iter().copied().filter(|&response| response > 0.0);
    let least = SMALLEST_RESPONSE * median(alive);
    if least > 0.0 { Ok(responses.iter().map(|s| s.max(least)).collect()) } else { Err(LearnError::Silent) }
}

/// Heights of the spots for presses divided by their sizes, with a median of about 1.
fn heights(presses: &Presses, which: &[usize], sizes: &[f64], strength: Strength) -> Vec<f64> {
    let (Strength::Force, Some(forces)) = (strength, &presses.forces) else {
        return vec![1.0; which.len()];
    };
    let ratios: Vec<f64> = which.iter().zip(sizes).map(|(&press, size)| forces[press] / size).collect();
    let median = median(ratios.iter().copied());
    ratios.iter().map(|ratio| ratio / median).collect()
}

/// Sum of the products of all entries.
fn inner(a: &Mat<f64>, b: &Mat<f64>) -> f64 {
    let column = |i: usize| a.col(i).iter().zip(b.col(i).iter()).map(|(a, b)| a * b).sum::<f64>();
    (0..a.ncols()).map(column).sum()
}

fn inverse_or_zero(value: f64) -> f64 {
    if value == 0.0 { 0.0 } else { 1.0 / value.abs() }
}
