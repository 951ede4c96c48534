//! Difference: what difference data divide a change of voltage by; see [`dermatome_shared::reference`].

use dermatome_shared::patch::Difference;

/// What a kind of difference data divides by: `[measurement]`.
#[must_use]
pub fn divisors(kind: Difference, reference: &[f64]) -> Vec<f64> {
    match kind {
        Difference::Plain => vec![mean_magnitude(reference); reference.len()],
        Difference::Normalised => reference.to_vec(),
    }
}

/// Mean of the magnitudes.
#[must_use]
pub fn mean_magnitude(values: &[f64]) -> f64 {
    values.iter().map(|value| value.abs()).sum::<f64>() / values.len() as f64
}
