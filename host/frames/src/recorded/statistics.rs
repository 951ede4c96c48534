//! A few statistics of measurements.

use num_complex::Complex64;

/// Median, the upper one of two; 0 for nothing.
#[must_use]
pub fn median(values: impl Iterator<Item = f64>) -> f64 {
    let mut values: Vec<_> = values.collect();
    let middle = values.len() / 2;
    if values.is_empty() { 0.0 } else { *values.select_nth_unstable_by(middle, f64::total_cmp).1 }
}

/// Root of the mean square; 0 for nothing.
pub(super) fn root_mean_square(values: impl ExactSizeIterator<Item = f64>) -> f64 {
    let count = values.len().max(1) as f64;
    (values.map(|value| value * value).sum::<f64>() / count).sqrt()
}

/// Correlation of pairs; 0 where one of the two does not vary.
#[must_use]
pub fn pearson(points: &[(f64, f64)]) -> f64 {
    let count = points.len().max(1) as f64;
    let (sum_x, sum_y) = points.iter().fold((0.0, 0.0), |(x, y), point| (x + point.0, y + point.1));
    let (mut xx, mut yy, mut xy) = (0.0, 0.0, 0.0);
    for point in points {
        let (x, y) = (point.0 - sum_x / count, point.1 - sum_y / count);
        (xx, yy, xy) = (xx + x * x, yy + y * y, xy + x * y);
    }
    let scale = (xx * yy).sqrt();
    if scale > 0.0 { (xy / scale).clamp(-1.0, 1.0) } else { 0.0 }
}

/// Magnitudes with the sign that values have along their common phase, half the angle of the sum of squares.
pub(super) fn along_common_phase(values: &[Complex64]) -> Vec<f64> {
    let squares: Complex64 = values.iter().map(|value| value * value).sum();
    let back = Complex64::from_polar(1.0, -squares.arg() / 2.0);
    let back = if back.is_finite() { back } else { Complex64::ONE };
    values.iter().map(|value| value.norm().copysign((value * back).re)).collect()
}
