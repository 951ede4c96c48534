//! Choice of the hyperparameter by a criterion.
//!
//! Everything here works on whitened data (see [`super::Whitening`]) and on the [`Spectrum`] of the
//! data space, so that one more lambda costs next to nothing.

mod best_resolution;
mod cross_validation;
mod l_curve;
mod noise_figure;
#[cfg(test)]
mod tests;

pub use best_resolution::best_resolution;
pub use cross_validation::cross_validation;
pub use l_curve::l_curve;
pub use noise_figure::{NoiseFigure, noise_figure};

use super::Spectrum;
use crate::skin::Criterion;

/// Hyperparameters at which a criterion is evaluated first.
const SCANNED: usize = 60;

/// A hyperparameter with the criterion that led to it.
#[derive(Clone, Debug, PartialEq)]
pub struct Selection {
    /// How it was chosen.
    pub criterion: Criterion,
    /// The chosen point.
    pub chosen: CurvePoint,
    /// The criterion over the range of hyperparameters, ascending.
    pub curve: Vec<CurvePoint>,
}

/// One point of a criterion's curve.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CurvePoint {
    /// The hyperparameter.
    pub hyperparameter: f64,
    /// What to draw to the right: the hyperparameter, or, of an L-curve, the size of the residual.
    pub abscissa: f64,
    /// The criterion, or, of an L-curve, the size of the image as the prior measures it.
    pub ordinate: f64,
}

impl CurvePoint {
    /// A value of a criterion over the hyperparameter.
    fn at(hyperparameter: f64, ordinate: f64) -> Self {
        Self { hyperparameter, abscissa: hyperparameter, ordinate }
    }
}

/// Why no hyperparameter could be chosen.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum SelectionError {
    /// The L-curve bends nowhere.
    #[error(
        "`inverse.hyperparameter` is \"l-curve\", but the curve has no corner between {weakest:.1e} and \
         {strongest:.1e}; allowed here: a number, or another criterion"
    )]
    NoCorner {
        /// Least hyperparameter tried.
        weakest: f64,
        /// Largest hyperparameter tried.
        strongest: f64,
    },
    /// A criterion falls or rises all the way.
    #[error(
        "`inverse.hyperparameter` is \"{criterion}\", but it has no minimum between {weakest:.1e} and \
         {strongest:.1e}; allowed here: a number, or another criterion"
    )]
    NoMinimum {
        /// The criterion, as the skin file calls it.
        criterion: &'static str,
        /// Least hyperparameter tried.
        weakest: f64,
        /// Largest hyperparameter tried.
        strongest: f64,
    },
    /// A noise figure out of reach.
    #[error(
        "`inverse.noise_figure` is {asked}; allowed here: {least:.3} to {most:.3}, which is what this skin reaches"
    )]
    NoiseFigure {
        /// The noise figure asked for.
        asked: f64,
        /// The least that can be reached.
        least: f64,
        /// The largest that can be reached.
        most: f64,
    },
}

/// Evaluates a criterion over the range of a spectrum.
fn scan(spectrum: &Spectrum, criterion: impl Fn(f64) -> CurvePoint) -> Vec<CurvePoint> {
    spectrum.range(SCANNED).into_iter().map(criterion).collect()
}

/// Minimum of `value` over the logarithm of the hyperparameter between two of its values, by golden
/// sections.
fn minimum(value: impl Fn(f64) -> f64, low: f64, high: f64) -> f64 {
    let golden = (5.0_f64.sqrt() - 1.0) / 2.0;
    let (mut low, mut high) = (low.ln(), high.ln());
    while high - low > 1e-6 {
        let (left, right) = (high - golden * (high - low), low + golden * (high - low));
        if value(left.exp()) < value(right.exp()) { high = right } else { low = left }
    }
    ((low + high) / 2.0).exp()
}
