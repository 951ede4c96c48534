//! What a reconstruction matrix is worth: noise figure and blur.

use faer::{ColRef, Mat};
use rayon::prelude::*;

/// Noise figure of a reconstruction matrix, `[pixel][measurement]`: the signal-to-noise ratio of the
/// data over that of the image.
///
/// `signal` is the answer to a small target and `noise` the standard deviation, both
/// `[measurement]`, in the units of the data that the matrix takes; `areas` is `[pixel]`. The
/// definition is in [`super::selection::NoiseFigure`].
#[must_use]
pub fn noise_figure(matrix: &Mat<f64>, signal: &[f64], noise: &[f64], areas: &[f64]) -> f64 {
    let data = Mat::from_fn(signal.len(), 1, |i, _| signal[i]);
    let image = matrix * data;
    let image_signal = weighted_magnitude(image.col(0).iter().copied(), areas);
    let column = |(column, noise): (ColRef<'_, f64>, &f64)| -> f64 {
        column.iter().zip(areas).map(|(value, area)| (value * noise * area).powi(2)).sum()
    };
    // Added up in one order, so that the figure does not depend on how many cores there are.
    let variances: Vec<f64> = matrix.par_col_iter().zip(noise).map(column).collect();
    let variance: f64 = variances.iter().sum();
    let image_noise = (variance / areas.len() as f64).sqrt();
    signal_to_noise(signal, noise) / (image_signal / image_noise)
}

/// Mean magnitude of a signal over the root of the noise's mean variance.
#[must_use]
pub fn signal_to_noise(signal: &[f64], noise: &[f64]) -> f64 {
    let count = signal.len() as f64;
    let mean = signal.iter().map(|value| value.abs()).sum::<f64>() / count;
    mean / (noise.iter().map(|value| value * value).sum::<f64>() / count).sqrt()
}

/// Mean magnitude of an image times its areas.
pub(super) fn weighted_magnitude(image: impl Iterator<Item = f64>, areas: &[f64]) -> f64 {
    image.zip(areas).map(|(value, area)| (value * area).abs()).sum::<f64>() / areas.len() as f64
}

/// How widely the image spreads a point: the area above a quarter of the largest pixel, as of the
/// region of interest.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Blur {
    /// Mean over the skin of RES = root of that area over the skin's (Adler et al. 2009), 0 to 1.
    pub resolution: f64,
    /// Radius of a circle of that area, m: half of the points have less.
    pub median_radius: f64,
    /// The largest one, m.
    pub worst_radius: f64,
}

/// Points of the skin whose image is looked at, at most.
const POINTS: usize = 1000;
/// Level of the region of interest.
const QUARTER: f64 = 0.25;

/// Blur of a reconstruction matrix, `[pixel][measurement]`: of its point-spread functions, the images
/// of single pixels. `jacobian` is `[measurement][pixel]`, and `divisors`, `[measurement]`, turn it
/// into difference data.
///
/// Of more than 1,000 pixels, only every n-th is looked at.
#[must_use]
pub fn blur(matrix: &Mat<f64>, jacobian: &Mat<f64>, divisors: &[f64], areas: &[f64]) -> Blur {
    let total: f64 = areas.iter().sum();
    let chosen: Vec<usize> = (0..areas.len()).step_by(areas.len().div_ceil(POINTS)).collect();
    let mut shares: Vec<f64> = chosen
        .par_chunks(16)
        .flat_map_iter(|pixels| {
            let entry = |i: usize, j: usize| jacobian[(i, pixels[j])] / divisors[i];
            let data = Mat::from_fn(jacobian.nrows(), pixels.len(), entry);
            let images = matrix * data;
            let share = |point: usize| area_above(images.col_as_slice(point), areas, QUARTER) / total;
            (0..images.ncols()).map(share).collect::<Vec<_>>()
        })
        .collect();
    shares.sort_unstable_by(f64::total_cmp);
    let radius = |share: f64| (share * total / std::f64::consts::PI).sqrt();
    Blur {
        resolution: shares.iter().map(|share| share.sqrt()).sum::<f64>() / shares.len() as f64,
        median_radius: radius(shares[shares.len() / 2]),
        worst_radius: radius(shares[shares.len() - 1]),
    }
}

/// Area of the pixels above `level` times the largest one.
pub(super) fn area_above(image: &[f64], areas: &[f64], level: f64) -> f64 {
    let least = level * image.iter().fold(0.0, |most, &value| if value > most { value } else { most });
    image.iter().zip(areas).map(|(&value, &area)| if value > least { area } else { 0.0 }).sum()
}
