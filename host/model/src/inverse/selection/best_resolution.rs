//! Best resolution ("BestRes", Graham and Adler 2006): the hyperparameter whose image of a small
//! target is the sharpest. Weaker ones blur it with noise, stronger ones by smoothing.
//!
//! The blur radius (Adler and Guardo 1996) is the root of the share of the area that is above half
//! the largest pixel. It is taken of the root mean square of the images of many noisy frames: that
//! is the target's image where noise is small, and as wide as the skin where noise covers the
//! target. The half-amplitude set of a single frame shrinks again in noise, to its peaks.

use super::{CurvePoint, Selection, SelectionError, Spectrum, scan};
use crate::{
    inverse::{DataSpace, figures::area_above},
    skin::Criterion,
};
use faer::Mat;
use rayon::prelude::*;

/// Pixels above this share of the largest one make up the blur.
const HALF: f64 = 0.5;

/// The hyperparameter with the least blur radius over some noisy whitened `frames` of one small
/// target, `[measurement][frame]`; the strongest one of several that are alike.
pub fn best_resolution(
    space: &DataSpace,
    spectrum: &Spectrum,
    frames: &Mat<f64>,
    areas: &[f64],
) -> Result<Selection, SelectionError> {
    let components = spectrum.modes.transpose() * frames;
    let total: f64 = areas.iter().sum();
    let blur = |hyperparameter: f64| {
        let factors = spectrum.factors(hyperparameter);
        let weighted =
            Mat::from_fn(components.nrows(), components.ncols(), |i, j| factors[i] * components[(i, j)]);
        let images = space.images(&(&spectrum.modes * weighted), frames);
        let amplitude =
            |pixel: usize| images.row(pixel).iter().map(|value| value * value).sum::<f64>().sqrt();
        let amplitudes: Vec<f64> = (0..images.nrows()).into_par_iter().map(amplitude).collect();
        (area_above(&amplitudes, areas, HALF) / total).sqrt()
    };
    let points = scan(spectrum, |hyperparameter| CurvePoint::at(hyperparameter, blur(hyperparameter)));
    let lowest = (0..points.len()).rev().min_by(|&a, &b| points[a].ordinate.total_cmp(&points[b].ordinate));
    let Some(lowest) = lowest.filter(|&i| i > 0 && i + 1 < points.len()) else {
        let (weakest, strongest) = (points[0].hyperparameter, points[points.len() - 1].hyperparameter);
        return Err(SelectionError::NoMinimum { criterion: "best-resolution", weakest, strongest });
    };
    Ok(Selection { criterion: Criterion::BestResolution, chosen: points[lowest], curve: points })
}
