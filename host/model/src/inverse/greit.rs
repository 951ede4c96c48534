//! GREIT: a matrix trained on small targets to give round, equal images of them (Adler et al. 2009;
//! EIDORS `mk_GREIT_model`, `calc_GREIT_RM`, `GREIT_desired_img_sigmoid`).
//!
//! The matrix K = D Y' (Y Y' + lambda^2 W^-1)^-1 minimises |K y - d|^2 over the training targets
//! with responses y and desired images d, plus noise whose desired image is zero. EIDORS' weight is
//! lambda over the mean magnitude of Y; that is the hyperparameter here.
//!
//! Training targets are element patches of equal area, all over the skin, whatever its shape.
//! Their responses are linear in the change of conductivity, so a target is a column of a Jacobian and
//! costs no forward solution; EIDORS' targets are so weak that they come to the same. A desired
//! image is scaled so that, spread without a boundary, its integral is the target's: images stay relative
//! conductivities, where EIDORS' are 1 in the middle. Distances are straight, also on curved skins.

use super::{DataSpace, Whitening, targets::Training};
use crate::pixels::Pixels;
use faer::Mat;
use nalgebra::Point3;
use rayon::prelude::*;
use std::f64::consts::PI;

/// Steepness of the desired image's edge times its radius, as in EIDORS.
const STEEPNESS: f64 = 10.0;
/// Pixels worked on together.
const BLOCK: usize = 256;

/// The data space of a GREIT matrix. `radius` is that of the desired images, as a share of half the
/// skin's larger side; `movement` is what the unknown movement of electrodes, whose desired image is none either, adds to
/// Y Y': `[measurement][measurement]`.
#[must_use]
pub fn data_space(
    training: &Training,
    whitening: &Whitening,
    pixels: &Pixels,
    radius: f64,
    movement: Option<&Mat<f64>>,
) -> DataSpace {
    let responses = whitening.transposed(&training.responses);
    let mut images = Mat::zeros(pixels.count(), responses.ncols());
    images.par_row_chunks_mut(BLOCK).enumerate().for_each(|(block, mut rows)| {
        let centres = &pixels.centres[block * BLOCK..][..rows.nrows()];
        rows.copy_from(desired_images(training, centres, radius) * &responses);
    });
    let magnitude: f64 =
        responses.col_iter().map(|column| column.iter().map(|value| value.abs()).sum::<f64>()).sum();
    let unit = magnitude / (responses.nrows() * responses.ncols()) as f64;
    let mut gram = responses.transpose() * &responses;
    if let Some(movement) = movement {
        gram += movement;
    }
    DataSpace::trained(images, gram, unit)
}

/// Desired image of a target so far from its centre, both m: 1 in the middle, a half at the radius.
#[must_use]
pub fn desired(distance: f64, radius: f64) -> f64 {
    1.0 / (1.0 + (STEEPNESS * (distance / radius - 1.0)).exp())
}

/// Desired images of all training targets at some pixel centres: `[pixel][target]`.
#[must_use]
pub fn desired_images(training: &Training, centres: &[Point3<f64>], radius: f64) -> Mat<f64> {
    let radius = radius * training.half_side;
    let disc = PI * radius * radius * (1.0 + (PI / STEEPNESS).powi(2) / 3.0);
    let value = |pixel: usize, target: usize| {
        let distance = (centres[pixel] - training.centres[target]).norm();
        desired(distance, radius) * training.areas[target] / disc
    };
    Mat::from_fn(centres.len(), training.areas.len(), value)
}
