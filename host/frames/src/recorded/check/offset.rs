//! A constant that every value holds, as raw counts of a converter do.

use super::{
    super::{
        diagnose::CLEARLY_BETTER,
        order::{Arrangement, OrderError},
        statistics::median,
    },
    Expected, Readings, Reference,
    numbering::{Wiring, correlations},
};
use num_complex::Complex64;
use serde::Serialize;

/// Offsets that are tried, from zero to the smallest magnitude.
const TRIALS: usize = 200;
/// Smallest offset that is worth a word, as a share of the median magnitude.
const SMALLEST_SHARE: f64 = 0.3;

/// A constant that every value seems to hold.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Offset {
    /// The constant, in the file's unit.
    pub value: f64,
    /// Its share of the median magnitude, %.
    pub share_percent: f64,
    /// Correlation of log magnitudes with the model, with it.
    pub correlation_before: f64,
    /// The same once it is subtracted.
    pub correlation: f64,
}

impl Offset {
    /// Subtracts it.
    #[must_use]
    pub fn without(&self, values: &[Complex64]) -> Vec<Complex64> {
        values.iter().map(|value| value - self.value).collect()
    }
}

/// Looks for the offset with which real values of one sign resemble the model best, in the order that
/// fits best without it.
pub(super) fn find(
    expected: &Expected,
    reference: &Reference,
    used: Arrangement,
) -> Result<Option<Offset>, OrderError> {
    let all = correlations(expected, reference, used)?;
    let (arrangement, _) = super::super::diagnose::best(&all, used);
    let wiring = Wiring::new(arrangement, expected.electrodes);
    let readings = Readings::of(expected, reference, &wiring)?;
    Ok(find_in(readings))
}

fn find_in(mut readings: Readings) -> Option<Offset> {
    let original = readings.measured.clone();
    let values: Vec<f64> = original.iter().map(|value| value.re).collect();
    let one_sign = values.iter().all(|&v| v > 0.0) || values.iter().all(|&v| v < 0.0);
    if !one_sign || original.iter().any(|value| value.im != 0.0) {
        return None;
    }
    let smallest = values.iter().copied().min_by(|a, b| a.abs().total_cmp(&b.abs()))?;
    let before = readings.correlation();
    let trial = |trial: usize| smallest * trial as f64 / TRIALS as f64;
    let (value, correlation) = (1..TRIALS)
        .map(|t| {
            readings.measured = original.iter().map(|value| value - trial(t)).collect();
            (trial(t), readings.correlation())
        })
        .max_by(|a, b| a.1.total_cmp(&b.1))?;
    let median = median(values.iter().map(|value| value.abs()));
    let share = value.abs() / median;
    let clear = correlation > before + CLEARLY_BETTER && share > SMALLEST_SHARE;
    clear.then_some(Offset { value, share_percent: share * 100.0, correlation_before: before, correlation })
}
