//! Responses: what the measurements make of a press anywhere, from presses at some places.
//!
//! Measurements are divided by their usual response s (the median size over the presses), and each press y by its own
//! size a (root mean square), so that every press and measurement counts alike. With the model's responses m, of the same
//! sizes, the response at a place p is a Gaussian process with the model for mean (Rasmussen and Williams 2006, chapter 2):
//!
//! ```text
//! r(p) = g m(p) + k(p)' (K + n I)^-1 (Y - g M)        k: Matérn 3/2 of the distance over a reach
//! ```
//!
//! Reach, noise n, and whether the model counts (g by least squares, or 0) are those with which presses are told best from
//! those at other places. What is missing then has the covariance C, shrunk towards its diagonal as Schäfer and Strimmer
//! (2005) do: noise, presses that differ, and responses that are not known well.

use super::{LearnError, presses::Presses};
use crate::recorded::statistics::median;
use dermatome_model::{inverse::targets::half_side, model::Model};
use faer::{
    Mat, Scale, Side,
    linalg::solvers::{DenseSolveCore, Llt},
};
use nalgebra::Point3;
use serde::Serialize;
use std::ops::RangeInclusive;

/// A measurement whose usual response is below this share of the median one counts as if it were this.
const SMALLEST_RESPONSE: f64 = 1e-3;
/// Reaches of the process, as shares of half the skin's larger side.
const REACHES: [f64; 4] = [0.3, 0.6, 1.2, 2.4];
/// Variances of what differs from press to press, as shares of the process' own.
const NOISES: [f64; 4] = [0.01, 0.03, 0.1, 0.3];
/// Radius of the model's press, as a share of the skin's larger side.
const RADIUS: f64 = 0.045;
/// By how much a press's size is corrected once its response is told from the others.
const SIZE_CORRECTIONS: RangeInclusive<f64> = 0.5..=2.0;
/// Smallest variance of what is missing, as a share of the mean one.
const LEAST_MISSING: f64 = 1e-3;

/// The process that tells presses best.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Process {
    /// How far a press says something of others, as a share of half the skin's larger side.
    pub reach: f64,
    /// Variance of what differs from press to press, as a share of the process' own.
    pub noise: f64,
    /// Whether the model says what presses say nothing of.
    pub from_model: bool,
}

/// Responses learnt from presses.
#[derive(Clone, Debug)]
pub struct Responses<'a> {
    model: &'a Model,
    places: Vec<Point3<f64>>,
    /// s: `[measurement]`.
    pub usual: Vec<f64>,
    /// a: `[press]`.
    pub sizes: Vec<f64>,
    /// Y': `[press][measurement]`.
    pub presses: Mat<f64>,
    process: Process,
    gain: f64,
    /// (K + n I)^-1: `[press][press]`.
    inverse: Mat<f64>,
    /// The same times Y' - g M': `[press][measurement]`.
    weights: Mat<f64>,
    /// Of each press, what presses at other places do not tell: `[press][measurement]`.
    missing: Mat<f64>,
}

impl<'a> Responses<'a> {
    /// Learns from some of the presses; `numbers` are those of their places.
    pub fn learn(
        model: &'a Model,
        presses: &Presses,
        which: &[usize],
        numbers: &[usize],
    ) -> Result<Self, LearnError> {
        let usual = usual_responses(presses, which)?;
        let mut rows = Mat::from_fn(which.len(), usual.len(), |i, m| presses.data[which[i]][m] / usual[m]);
        let sizes = normalise(&mut rows);
        if let Some(i) = sizes.iter().position(|&size| size == 0.0) {
            return Err(LearnError::NoChange(which[i]));
        }
        let places: Vec<_> = which.iter().map(|&press| presses.places[press]).collect();
        let prior = of_model(model, &places, &usual);
        let groups = groups(which, numbers);
        let mut best: Option<Self> = None;
        for reach in REACHES {
            for noise in NOISES {
                let inverse = inverse(&kernel(model, reach, &places, &places), noise)?;
                for from_model in [true, false] {
                    let mut next = Self {
                        model,
                        places: places.clone(),
                        usual: usual.clone(),
                        sizes: sizes.clone(),
                        presses: rows.clone(),
                        process: Process { reach, noise, from_model },
                        gain: 0.0,
                        inverse: inverse.clone(),
                        weights: Mat::new(),
                        missing: Mat::new(),
                    };
                    next.fit(&prior, &groups)?;
                    next.correct_sizes();
                    next.fit(&prior, &groups)?;
                    if best.as_ref().is_none_or(|best| next.missing_share() < best.missing_share()) {
                        best = Some(next);
                    }
                }
            }
        }
        best.ok_or(LearnError::Singular)
    }

    /// Which process it is.
    #[must_use]
    pub fn process(&self) -> Process {
        self.process
    }

    /// Share of the presses' squares that those at other places do not tell.
    #[must_use]
    pub fn missing_share(&self) -> f64 {
        (self.missing.squared_norm_l2() / self.presses.squared_norm_l2()).max(0.0)
    }

    /// Responses of presses of usual size: `[point][measurement]`, divided by s.
    #[must_use]
    pub fn at(&self, points: &[Point3<f64>]) -> Mat<f64> {
        let near = kernel(self.model, self.process.reach, points, &self.places);
        of_model(self.model, points, &self.usual) * Scale(self.gain) + near * &self.weights
    }

    /// A value of each press as a smooth field round its mean, at some points.
    #[must_use]
    pub fn field(&self, values: &[f64], points: &[Point3<f64>]) -> Vec<f64> {
        let mean = values.iter().sum::<f64>() / values.len() as f64;
        let weights = &self.inverse * Mat::from_fn(values.len(), 1, |press, _| values[press] - mean);
        let field = kernel(self.model, self.process.reach, points, &self.places) * weights;
        (0..points.len()).map(|point| mean + field[(point, 0)]).collect()
    }

    /// C: `[measurement][measurement]`.
    #[must_use]
    pub fn covariance(&self) -> Mat<f64> {
        let count = self.missing.nrows() as f64;
        let mut covariance = self.missing.transpose() * &self.missing * Scale(1.0 / count);
        let size = covariance.nrows();
        let squares = Mat::from_fn(self.missing.nrows(), size, |i, m| self.missing[(i, m)].powi(2));
        let fourth = squares.transpose() * &squares * Scale(1.0 / count);
        let (mut uncertain, mut all) = (0.0, 0.0);
        for (i, j) in (0..size).flat_map(|i| (0..i).map(move |j| (i, j))) {
            let square = covariance[(i, j)].powi(2);
            uncertain += (fourth[(i, j)] - square) / count;
            all += square;
        }
        let shrunk = if all > 0.0 { (uncertain / all).clamp(0.0, 1.0) } else { 1.0 };
        let mean = (0..size).map(|m| covariance[(m, m)]).sum::<f64>() / size as f64;
        for i in 0..size {
            (0..size).filter(|&j| j != i).for_each(|j| covariance[(i, j)] *= 1.0 - shrunk);
            covariance[(i, i)] += LEAST_MISSING * mean + f64::MIN_POSITIVE;
        }
        covariance
    }

    /// The process through the presses, and what each misses without those at its own place: with L = (K + n I)^-1 and
    /// the presses b there it is `L_bb^-1 (L Z)_b` (Rasmussen and Williams 2006, section 5.4.2, for several at once).
    fn fit(&mut self, prior: &Mat<f64>, groups: &[Vec<usize>]) -> Result<(), LearnError> {
        let of_prior = prior.squared_norm_l2();
        let is_used = self.process.from_model && of_prior > 0.0;
        self.gain = if is_used { inner(prior, &self.presses) / of_prior } else { 0.0 };
        self.weights = &self.inverse * (&self.presses - prior * Scale(self.gain));
        self.missing = self.weights.clone();
        for group in groups {
            let own = Mat::from_fn(group.len(), group.len(), |i, j| self.inverse[(group[i], group[j])]);
            let own = inverse(&own, 0.0)?;
            let told = own * Mat::from_fn(group.len(), prior.ncols(), |i, m| self.weights[(group[i], m)]);
            for (i, &press) in group.iter().enumerate() {
                self.missing.row_mut(press).copy_from(told.row(i));
            }
        }
        Ok(())
    }

    /// Divides each press by how many times as large it is as what the others tell of it.
    fn correct_sizes(&mut self) {
        for press in 0..self.presses.nrows() {
            let told = self.presses.row(press) - self.missing.row(press);
            let product: f64 = told.iter().zip(self.presses.row(press).iter()).map(|(a, b)| a * b).sum();
            let ratio = product / told.squared_norm_l2();
            if ratio > 0.0 && ratio.is_finite() {
                let ratio = ratio.clamp(*SIZE_CORRECTIONS.start(), *SIZE_CORRECTIONS.end());
                self.presses.row_mut(press).iter_mut().for_each(|value| *value /= ratio);
                self.sizes[press] *= ratio;
            }
        }
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

/// Divides rows by their root mean squares, which it gives; rows of zeros stay.
fn normalise(rows: &mut Mat<f64>) -> Vec<f64> {
    let root = (rows.ncols() as f64).sqrt();
    let count = rows.nrows();
    let size = |row: usize| {
        let size = rows.row(row).norm_l2() / root;
        if size > 0.0 {
            rows.row_mut(row).iter_mut().for_each(|value| *value /= size);
        }
        size
    };
    (0..count).map(size).collect()
}

/// The model's responses to presses at some points, divided by s and of size 1: `[point][measurement]`.
fn of_model(model: &Model, points: &[Point3<f64>], usual: &[f64]) -> Mat<f64> {
    let (centres, areas, divisors) = (&model.pixels.centres, &model.pixels.areas, model.divisors());
    let radius = RADIUS * model.pixels.larger_side();
    let under = Mat::from_fn(centres.len(), points.len(), |pixel, point| {
        let side = areas[pixel].sqrt();
        let away = (centres[pixel] - points[point]).norm();
        ((radius + side / 2.0 - away) / side).clamp(0.0, 1.0)
    });
    let responses = &model.jacobian * under;
    let mut rows = Mat::from_fn(points.len(), usual.len(), |point, m| {
        let response = responses[(m, point)] / (divisors[m] * usual[m]);
        if response.is_finite() { response } else { 0.0 }
    });
    normalise(&mut rows);
    rows
}

/// Matérn 3/2: `[point][other]`.
fn kernel(model: &Model, reach: f64, points: &[Point3<f64>], others: &[Point3<f64>]) -> Mat<f64> {
    let reach = reach * half_side(&model.mesh);
    Mat::from_fn(points.len(), others.len(), |point, other| {
        let away = 3f64.sqrt() * (points[point] - others[other]).norm() / reach;
        (1.0 + away) * (-away).exp()
    })
}

/// (K + n I)^-1.
fn inverse(matrix: &Mat<f64>, noise: f64) -> Result<Mat<f64>, LearnError> {
    let mut system = matrix.clone();
    (0..system.nrows()).for_each(|i| system[(i, i)] += noise);
    let factor = Llt::new(system.as_ref(), Side::Lower).map_err(|_| LearnError::Singular)?;
    Ok(factor.inverse())
}

/// Which presses are at one place, of those learnt from.
fn groups(which: &[usize], numbers: &[usize]) -> Vec<Vec<usize>> {
    let mut groups = std::collections::BTreeMap::<usize, Vec<usize>>::new();
    for (i, &press) in which.iter().enumerate() {
        groups.entry(numbers[press]).or_default().push(i);
    }
    groups.into_values().collect()
}

/// Sum of the products of all entries.
fn inner(a: &Mat<f64>, b: &Mat<f64>) -> f64 {
    let column = |i: usize| a.col(i).iter().zip(b.col(i).iter()).map(|(a, b)| a * b).sum::<f64>();
    (0..a.ncols()).map(column).sum()
}
