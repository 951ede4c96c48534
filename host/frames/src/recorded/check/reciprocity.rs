//! Steps that must agree on any linear body: how well they do.

use super::{
    super::statistics::{median, root_mean_square},
    Readings,
};
use dermatome_model::stimulation::{Repetition, pairs_alike, repetition};
use dermatome_shared::stimulation::Step;
use serde::Serialize;

/// How well steps agree that measure the same.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Agreement {
    /// Median error, %.
    pub median_percent: f64,
    /// Root of the mean square, %.
    pub rms_percent: f64,
    /// Each pair of steps.
    pub pairs: Vec<PairError>,
}

/// Two steps that must agree.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct PairError {
    /// The first step.
    pub step: usize,
    /// The other one.
    pub other: usize,
    /// Difference of magnitudes over their mean, 0 to 200 %, of small ones over what the model does not know of them. Signs
    /// are left to the polarity.
    pub error_percent: f64,
}

impl Agreement {
    /// Of steps that differ in one of these ways, dead ones left out; `None` if there are no such steps.
    pub(super) fn of(steps: &[Step], readings: &Readings, kinds: &[Repetition]) -> Option<Self> {
        let pairs: Vec<_> = pairs_alike(steps)
            .filter(|&(step, other, _)| kinds.contains(&repetition(steps[step], steps[other])))
            .filter(|&(step, other, _)| !readings.is_dead(step) && !readings.is_dead(other))
            .map(|(step, other, _)| PairError { step, other, error_percent: error(readings, step, other) })
            .collect();
        let errors = || pairs.iter().map(|pair| pair.error_percent);
        let (median_percent, rms_percent) = (median(errors()), root_mean_square(errors()));
        (!pairs.is_empty()).then_some(Self { median_percent, rms_percent, pairs })
    }

    /// The worst pairs, those over `limit` %.
    pub(super) fn worst(&self, limit: f64) -> Vec<PairError> {
        let mut worst: Vec<_> =
            self.pairs.iter().filter(|pair| pair.error_percent > limit).copied().collect();
        worst.sort_by(|a, b| b.error_percent.total_cmp(&a.error_percent));
        worst
    }
}

fn error(readings: &Readings, step: usize, other: usize) -> f64 {
    let should = (readings.model[step] / readings.model[other]).abs();
    // A model's agree; good frames' need not.
    let should = if should > 0.0 && should.is_finite() { should } else { 1.0 };
    let (a, b) = (readings.measured[step], readings.measured[other] * should);
    let difference = (a - b).norm().min((a + b).norm());
    let blur = readings.blur[step].min(readings.blur[other]);
    let mean = ((a.norm() + b.norm()) / 2.0).hypot(blur);
    if mean > 0.0 { 100.0 * difference / mean } else { 0.0 }
}
