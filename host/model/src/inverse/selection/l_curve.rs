//! L-curve: the corner where a smaller image starts to cost residual (Hansen and O'Leary 1993).

use super::{CurvePoint, Selection, SelectionError, Spectrum, minimum, scan};
use crate::skin::Criterion;

/// A corner turns at least this sharply; a rounded right angle between the axes of the logarithmic
/// plot has a curvature of about 1 or more.
const LEAST_CURVATURE: f64 = 0.3;

/// The hyperparameter of largest curvature of log |x|_R over log |y - J x|, for whitened `data`.
pub fn l_curve(spectrum: &Spectrum, data: &[f64]) -> Result<Selection, SelectionError> {
    let curve = Curve { spectrum, components: spectrum.components(data) };
    let points = scan(spectrum, |hyperparameter| curve.point(hyperparameter));
    let curvature: Vec<f64> = points.iter().map(|point| curve.curvature(point.hyperparameter)).collect();
    let inner = 1..points.len() - 1;
    let sharpest = inner.max_by(|&a, &b| curvature[a].total_cmp(&curvature[b])).unwrap_or(0);
    let (weakest, strongest) = (points[0].hyperparameter, points[points.len() - 1].hyperparameter);
    let is_peak = curvature[sharpest] >= curvature[sharpest - 1].max(curvature[sharpest + 1]);
    if !(is_peak && curvature[sharpest] > LEAST_CURVATURE) {
        return Err(SelectionError::NoCorner { weakest, strongest });
    }
    let (low, high) = (points[sharpest - 1].hyperparameter, points[sharpest + 1].hyperparameter);
    let chosen = curve.point(minimum(|hyperparameter| -curve.curvature(hyperparameter), low, high));
    Ok(Selection { criterion: Criterion::LCurve, chosen, curve: points })
}

struct Curve<'a> {
    spectrum: &'a Spectrum,
    components: Vec<f64>,
}

impl Curve<'_> {
    /// Sum over modes of s^a u^2 / (s + lambda^2)^b.
    fn sum(&self, hyperparameter: f64, a: i32, b: i32) -> f64 {
        let factors = self.spectrum.factors(hyperparameter);
        let terms = self.spectrum.values.iter().zip(&self.components).zip(factors);
        terms.map(|((s, u), factor)| s.powi(a) * u * u * factor.powi(b)).sum()
    }

    fn square(&self, hyperparameter: f64) -> f64 {
        (hyperparameter * self.spectrum.unit).powi(2)
    }

    /// |y - J x|^2 = lambda^4 sum u^2 / (s + lambda^2)^2.
    fn residual_squared(&self, hyperparameter: f64) -> f64 {
        self.square(hyperparameter).powi(2) * self.sum(hyperparameter, 0, 2)
    }

    fn point(&self, hyperparameter: f64) -> CurvePoint {
        let abscissa = self.residual_squared(hyperparameter).sqrt();
        CurvePoint { hyperparameter, abscissa, ordinate: self.sum(hyperparameter, 1, 2).sqrt() }
    }

    /// Curvature, positive at the corner of an L. With m = lambda^2, size e = x'Rx and residual
    /// r = |y - J x|^2: r' = -m e' (Hansen 1998, section 4.5).
    fn curvature(&self, hyperparameter: f64) -> f64 {
        let m = self.square(hyperparameter);
        let (size, residual) = (self.sum(hyperparameter, 1, 2), self.residual_squared(hyperparameter));
        let size_1 = -2.0 * self.sum(hyperparameter, 1, 3);
        let size_2 = 6.0 * self.sum(hyperparameter, 1, 4);
        let (residual_1, residual_2) = (-m * size_1, -size_1 - m * size_2);
        // Logarithms, halved because both are squares.
        let (x_1, y_1) = (residual_1 / residual / 2.0, size_1 / size / 2.0);
        let x_2 = residual_2 / residual / 2.0 - 2.0 * x_1 * x_1;
        let y_2 = size_2 / size / 2.0 - 2.0 * y_1 * y_1;
        (x_1 * y_2 - x_2 * y_1) / (x_1 * x_1 + y_1 * y_1).powf(1.5)
    }
}
