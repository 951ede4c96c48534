//! Noise figure: how much worse the image's signal-to-noise ratio is than the data's (Adler and
//! Guardo 1996; Graham and Adler 2006; EIDORS `calc_noise_figure`).
//!
//! NF = SNR of the data / SNR of the image. The signal is the mean magnitude over measurements, or
//! over pixels times their area; the noise is the root of the mean variance over the same. A noise
//! figure below 1 means that the image averages noise away.

use super::{CurvePoint, Selection, SelectionError, Spectrum, scan};
use crate::{
    inverse::{DataSpace, figures::weighted_magnitude},
    skin::Criterion,
};
use faer::Mat;

/// What a noise figure is about.
#[derive(Clone, Debug)]
pub struct NoiseFigure<'a> {
    /// Whitened answer to a small target: `[measurement]`.
    pub signal: &'a [f64],
    /// Standard deviation of the whitened measurements: `[measurement]`.
    pub noise: &'a [f64],
    /// Signal-to-noise ratio of the difference data: mean magnitude over root mean variance.
    pub data_snr: f64,
    /// Area of each pixel: `[pixel]`.
    pub areas: &'a [f64],
}

/// The hyperparameter at which the noise figure is `asked`.
pub fn noise_figure(
    space: &DataSpace,
    spectrum: &Spectrum,
    of: &NoiseFigure<'_>,
    asked: f64,
) -> Result<Selection, SelectionError> {
    let figure = Figure::new(space, spectrum, of);
    let points = scan(spectrum, |hyperparameter| CurvePoint::at(hyperparameter, figure.at(hyperparameter)));
    // The weakest crossing from above: further on the figure may rise again, where images are flat.
    let crossing = points.windows(2).find(|pair| pair[0].ordinate >= asked && pair[1].ordinate < asked);
    let Some(&[above, below]) = crossing else {
        let values = || points.iter().map(|point| point.ordinate);
        let (least, most) = (values().fold(f64::INFINITY, f64::min), values().fold(0.0, f64::max));
        return Err(SelectionError::NoiseFigure { asked, least, most });
    };
    let hyperparameter = bisect(above.hyperparameter, below.hyperparameter, |h| figure.at(h) >= asked);
    let chosen = CurvePoint::at(hyperparameter, figure.at(hyperparameter));
    Ok(Selection { criterion: Criterion::NoiseFigure(asked), chosen, curve: points })
}

/// Where `is_low` ends, by equal ratios.
fn bisect(mut low: f64, mut high: f64, is_low: impl Fn(f64) -> bool) -> f64 {
    while high / low > 1.0 + 1e-6 {
        let middle = (low * high).sqrt();
        if is_low(middle) { low = middle } else { high = middle }
    }
    (low * high).sqrt()
}

/// The noise figure of every hyperparameter.
struct Figure<'a> {
    space: &'a DataSpace,
    spectrum: &'a Spectrum,
    of: &'a NoiseFigure<'a>,
    components: Vec<f64>,
    signal: Mat<f64>,
    variance: Variance,
}

impl<'a> Figure<'a> {
    fn new(space: &'a DataSpace, spectrum: &'a Spectrum, of: &'a NoiseFigure<'a>) -> Self {
        Self {
            space,
            spectrum,
            of,
            components: spectrum.components(of.signal),
            signal: Mat::from_fn(of.signal.len(), 1, |i, _| of.signal[i]),
            variance: Variance::new(space, spectrum, of),
        }
    }

    fn at(&self, hyperparameter: f64) -> f64 {
        let dual = self.spectrum.dual(&self.components, hyperparameter);
        let image = self.space.images(&dual.as_mat().to_owned(), &self.signal);
        let signal = weighted_magnitude(image.col(0).iter().copied(), self.of.areas);
        let pixels = self.of.areas.len() as f64;
        let noise = (self.variance.sum(&self.spectrum.factors(hyperparameter)) / pixels).sqrt();
        self.of.data_snr / (signal / noise)
    }
}

/// Sum over pixels of the variance of area times image, as a function of the spectrum's factors f:
/// f'Q f + 2 l'f + c.
struct Variance {
    quadratic: Mat<f64>,
    linear: Vec<f64>,
    constant: f64,
}

impl Variance {
    /// With images = P U diag(f) U' y + C y, areas A and noise covariance V: the variance is the
    /// trace of A (P U F U' + C) V (P U F U' + C)' A.
    fn new(space: &DataSpace, spectrum: &Spectrum, of: &NoiseFigure<'_>) -> Self {
        let (weights, modes) = (of.areas, &spectrum.modes);
        let noisy = Mat::from_fn(modes.nrows(), modes.ncols(), |i, j| of.noise[i].powi(2) * modes[(i, j)]);
        let data = modes.transpose() * &noisy;
        let products = space.weighted_products(weights);
        let image = modes.transpose() * &products.dual_dual * modes;
        let cross = modes.transpose() * &products.dual_data * &noisy;
        let constant = (0..of.noise.len()).map(|j| products.data_data[j] * of.noise[j].powi(2)).sum();
        Self {
            quadratic: Mat::from_fn(data.nrows(), data.ncols(), |i, j| data[(i, j)] * image[(i, j)]),
            linear: (0..cross.nrows()).map(|i| cross[(i, i)]).collect(),
            constant,
        }
    }

    fn sum(&self, factors: &[f64]) -> f64 {
        let row = |i: usize| -> f64 {
            let column = self.quadratic.col(i).iter().zip(factors).map(|(q, f)| q * f).sum::<f64>();
            factors[i] * (column + 2.0 * self.linear[i])
        };
        (0..factors.len()).map(row).sum::<f64>() + self.constant
    }
}
