//! Generalised cross-validation (Golub, Heath and Wahba 1979): the hyperparameter that would predict
//! a measurement best that was left out.

use super::{CurvePoint, Selection, SelectionError, Spectrum, minimum, scan};
use crate::skin::Criterion;

/// The hyperparameter that minimises |y - J x|^2 / trace(I - J K)^2 for whitened `data`, K being the
/// reconstruction matrix.
pub fn cross_validation(spectrum: &Spectrum, data: &[f64]) -> Result<Selection, SelectionError> {
    let components = spectrum.components(data);
    let value = |hyperparameter: f64| {
        let factors = spectrum.factors(hyperparameter);
        // lambda^2 cancels.
        let residual: f64 = components.iter().zip(&factors).map(|(u, factor)| (u * factor).powi(2)).sum();
        residual / factors.iter().sum::<f64>().powi(2)
    };
    let points = scan(spectrum, |hyperparameter| CurvePoint::at(hyperparameter, value(hyperparameter)));
    let lowest = (0..points.len()).min_by(|&a, &b| points[a].ordinate.total_cmp(&points[b].ordinate));
    let Some(lowest) = lowest.filter(|&i| i > 0 && i + 1 < points.len()) else {
        let (weakest, strongest) = (points[0].hyperparameter, points[points.len() - 1].hyperparameter);
        return Err(SelectionError::NoMinimum { criterion: "gcv", weakest, strongest });
    };
    let (low, high) = (points[lowest - 1].hyperparameter, points[lowest + 1].hyperparameter);
    let hyperparameter = minimum(value, low, high);
    let chosen = CurvePoint::at(hyperparameter, value(hyperparameter));
    Ok(Selection { criterion: Criterion::CrossValidation, chosen, curve: points })
}
