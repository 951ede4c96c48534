//! Data space: the reconstruction matrices of all hyperparameters, and their spectrum.
//!
//! Measurements are whitened here (see [`super::Whitening`]). With A = J', the image of data y is
//! G A a, where a solves (M + lambda^2 I) a = y and M = A'G A. A prior that is blind to constants N
//! (Laplace) has only a generalised inverse G; the constants then become unknowns c of their own:
//!
//! ```text
//! [ M + lambda^2 I   B ] [a]   [y]        B = A'N,  image = G A a + N c
//! [ B'               0 ] [c] = [0]
//! ```
//!
//! The second line makes A a orthogonal to N, so that R G A a = A a. With Q an orthonormal basis of
//! what is orthogonal to B, a = Q (Q'M Q + lambda^2 I)^-1 Q'y and c = B^+ (y - M a). The residual
//! y - J x is lambda^2 a, and x'R x = a'M a.

use super::InverseError;
use crate::prior::{Factored, Prior};
use faer::{
    Col, ColRef, Mat, Side,
    linalg::solvers::{Llt, SolveCore},
};
use rayon::prelude::*;

/// What turns whitened data into images for every hyperparameter.
#[derive(Clone, Debug)]
pub struct DataSpace {
    /// (G A - N B^+ M): `[pixel][measurement]`.
    images: Mat<f64>,
    blind: Option<Blind>,
    /// Q'M Q.
    gram: Mat<f64>,
    /// What a hyperparameter is multiplied with to give lambda.
    unit: f64,
}

/// The constants that the prior is blind to.
#[derive(Clone, Debug)]
struct Blind {
    part_of_pixel: Vec<usize>,
    /// B^+: `[part][measurement]`.
    levels: Mat<f64>,
    /// Q: `[measurement][mode]`.
    free: Mat<f64>,
}

impl DataSpace {
    /// One Gauss-Newton step: `transposed` is A = J', `[pixel][measurement]`. `movement` is what the
    /// unknown movement of electrodes adds to M: `[measurement][measurement]`.
    pub fn one_step(
        transposed: Mat<f64>,
        prior: &Prior,
        movement: Option<&Mat<f64>>,
    ) -> Result<Self, InverseError> {
        Self::one_step_with(transposed, prior, None, movement)
    }

    /// The same with what of the prior was factored before.
    pub fn one_step_with(
        transposed: Mat<f64>,
        prior: &Prior,
        factored: Option<&Factored>,
        movement: Option<&Mat<f64>>,
    ) -> Result<Self, InverseError> {
        let (part_of_pixel, parts) = prior.blind_parts();
        let smoothed = prior.solve_with(factored, transposed.clone())?;
        let mut gram = transposed.transpose() * &smoothed;
        if let Some(movement) = movement {
            gram += movement;
        }
        if parts == 0 {
            return Ok(Self { images: smoothed, blind: None, gram, unit: 1.0 });
        }
        let answer = sums_over_parts(&transposed, &part_of_pixel, parts);
        drop(transposed);
        Self::with_blind_parts(smoothed, gram, part_of_pixel, &answer)
    }

    /// GREIT: `images` is D Y', `[pixel][measurement]`, `gram` is Y Y', and what movement adds.
    #[must_use]
    pub fn trained(images: Mat<f64>, gram: Mat<f64>, unit: f64) -> Self {
        Self { images, blind: None, gram, unit }
    }

    fn with_blind_parts(
        mut images: Mat<f64>,
        gram: Mat<f64>,
        part_of_pixel: Vec<usize>,
        answer: &Mat<f64>,
    ) -> Result<Self, InverseError> {
        let (levels, free) = split(answer).map_err(|part| InverseError::Blind {
            pixel: part_of_pixel.iter().position(|&other| other == part).unwrap_or(0),
        })?;
        let level_of_dual = &levels * &gram;
        add_levels(&mut images, &level_of_dual, &part_of_pixel, -1.0);
        let gram = free.transpose() * (gram * &free);
        Ok(Self { images, blind: Some(Blind { part_of_pixel, levels, free }), gram, unit: 1.0 })
    }

    /// Reconstruction matrix for whitened data: `[pixel][measurement]`.
    pub fn matrix(&self, hyperparameter: f64) -> Result<Mat<f64>, InverseError> {
        let dual = self.dual(hyperparameter)?;
        let mut matrix = &self.images * dual;
        if let Some(blind) = &self.blind {
            add_levels(&mut matrix, &blind.levels, &blind.part_of_pixel, 1.0);
        }
        Ok(matrix)
    }

    /// Q (Q'M Q + lambda^2 I)^-1 Q': `[measurement][measurement]`.
    fn dual(&self, hyperparameter: f64) -> Result<Mat<f64>, InverseError> {
        let size = self.gram.nrows();
        let square = (hyperparameter * self.unit).powi(2);
        let mut system = self.gram.clone();
        (0..size).for_each(|i| system[(i, i)] += square);
        let factor = Llt::new(system.as_ref(), Side::Lower).map_err(|_| {
            let largest = (0..size).map(|i| self.gram[(i, i)]).fold(0.0, f64::max);
            let least = (largest * size as f64 * f64::EPSILON).sqrt() / self.unit;
            InverseError::Rounding { hyperparameter, least }
        })?;
        let mut solution = match &self.blind {
            Some(blind) => blind.free.transpose().to_owned(),
            None => Mat::identity(size, size),
        };
        factor.solve_in_place_with_conj(faer::Conj::No, solution.as_mut());
        Ok(match &self.blind {
            Some(blind) => &blind.free * solution,
            None => solution,
        })
    }

    /// Eigenvalues and eigenvectors of M where the data are free of constants.
    pub fn spectrum(&self) -> Result<Spectrum, InverseError> {
        let eigen = self
            .gram
            .self_adjoint_eigen(Side::Lower)
            .map_err(|error| InverseError::Eigenvalues(format!("{error:?}")))?;
        let values: Vec<f64> = eigen.S().column_vector().iter().copied().collect();
        let rounding = values.iter().fold(0.0, |max: f64, value| max.max(*value)) * ROUNDING;
        let values = values.into_iter().map(|value| if value > rounding { value } else { 0.0 }).collect();
        let modes = match &self.blind {
            Some(blind) => &blind.free * eigen.U(),
            None => eigen.U().to_owned(),
        };
        Ok(Spectrum { values, modes, unit: self.unit })
    }

    /// Images of whitened data: `duals` holds a = Q (Q'M Q + lambda^2 I)^-1 Q'y for each `data` y,
    /// both `[measurement][image]`; the images are `[pixel][image]`.
    #[must_use]
    pub fn images(&self, duals: &Mat<f64>, data: &Mat<f64>) -> Mat<f64> {
        let mut images = &self.images * duals;
        if let Some(blind) = &self.blind {
            add_levels(&mut images, &(&blind.levels * data), &blind.part_of_pixel, 1.0);
        }
        images
    }

    /// Products of what makes images of a and y, P = G A - N B^+ M and C = N B^+, each pixel
    /// weighted by its area squared.
    pub(super) fn weighted_products(&self, areas: &[f64]) -> WeightedProducts {
        let mut weighted = self.images.clone();
        weighted.par_col_iter_mut().for_each(|column| {
            column.iter_mut().zip(areas).for_each(|(value, area)| *value *= area);
        });
        let dual_dual = weighted.transpose() * &weighted;
        let measurements = dual_dual.nrows();
        let Some(blind) = &self.blind else {
            let dual_data = Mat::zeros(measurements, measurements);
            return WeightedProducts { dual_dual, dual_data, data_data: vec![0.0; measurements] };
        };
        let mut sums = Mat::<f64>::zeros(measurements, blind.levels.nrows());
        let mut squares = vec![0.0; blind.levels.nrows()];
        for (pixel, &part) in blind.part_of_pixel.iter().enumerate() {
            squares[part] += areas[pixel].powi(2);
            (0..measurements).for_each(|m| sums[(m, part)] += areas[pixel] * weighted[(pixel, m)]);
        }
        let square =
            |level: ColRef<'_, f64>| level.iter().zip(&squares).map(|(v, square)| v * v * square).sum();
        let data_data = blind.levels.col_iter().map(square).collect();
        WeightedProducts { dual_dual, dual_data: sums * &blind.levels, data_data }
    }
}

/// See [`DataSpace::weighted_products`].
pub(super) struct WeightedProducts {
    /// P'A^2 P: `[measurement][measurement]`.
    pub(super) dual_dual: Mat<f64>,
    /// P'A^2 C: `[measurement][measurement]`.
    pub(super) dual_data: Mat<f64>,
    /// Diagonal of C'A^2 C: `[measurement]`.
    pub(super) data_data: Vec<f64>,
}

/// The data space in its own directions, in which every hyperparameter is a list of factors.
#[derive(Clone, Debug)]
pub struct Spectrum {
    /// Eigenvalues s of Q'M Q, ascending, none below zero: `[mode]`.
    pub values: Vec<f64>,
    /// Orthonormal directions: `[measurement][mode]`.
    pub modes: Mat<f64>,
    /// What a hyperparameter is multiplied with to give lambda.
    pub unit: f64,
}

impl Spectrum {
    /// Components of whitened data along the modes: `[mode]`.
    #[must_use]
    pub fn components(&self, data: &[f64]) -> Vec<f64> {
        let data = Col::from_fn(data.len(), |i| data[i]);
        (self.modes.transpose() * data).iter().copied().collect()
    }

    /// 1 / (s + lambda^2): `[mode]`.
    #[must_use]
    pub fn factors(&self, hyperparameter: f64) -> Vec<f64> {
        let square = (hyperparameter * self.unit).powi(2);
        self.values.iter().map(|value| 1.0 / (value + square)).collect()
    }

    /// a = U diag(factors) u for the `components` u of some data: `[measurement]`.
    #[must_use]
    pub fn dual(&self, components: &[f64], hyperparameter: f64) -> Col<f64> {
        let factors = self.factors(hyperparameter);
        &self.modes * Col::from_fn(components.len(), |i| factors[i] * components[i])
    }

    /// Hyperparameters from far too weak to far too strong, by equal ratios.
    #[must_use]
    pub fn range(&self, count: usize) -> Vec<f64> {
        let largest = self.values.last().copied().unwrap_or(1.0).sqrt() / self.unit;
        let (weak, strong) = (WEAKEST.ln(), STRONGEST.ln());
        let at = |i: usize| largest * (weak + (strong - weak) * i as f64 / (count - 1) as f64).exp();
        (0..count).map(at).collect()
    }
}

/// Eigenvalues below this share of the largest one are zero but for rounding.
const ROUNDING: f64 = 1e-13;

/// Ends of the range of hyperparameters, in units of the root of the largest eigenvalue. Below the
/// first, lambda^2 is lost in rounding.
const WEAKEST: f64 = 1e-7;
const STRONGEST: f64 = 10.0;

/// B = A'N: `[measurement][part]`.
fn sums_over_parts(transposed: &Mat<f64>, part_of_pixel: &[usize], parts: usize) -> Mat<f64> {
    let mut sums = Mat::zeros(transposed.ncols(), parts);
    for (measurement, column) in transposed.col_iter().enumerate() {
        for (value, &part) in column.iter().zip(part_of_pixel) {
            sums[(measurement, part)] += value;
        }
    }
    sums
}

/// B^+, `[part][measurement]`, and an orthonormal basis of what is orthogonal to B; or the first
/// part that the measurements cannot tell from those before it.
fn split(answer: &Mat<f64>) -> Result<(Mat<f64>, Mat<f64>), usize> {
    let (measurements, parts) = (answer.nrows(), answer.ncols());
    if parts > measurements {
        return Err(measurements);
    }
    let qr = answer.qr();
    let upper = qr.thin_R();
    let size = |part: usize| upper[(part, part)].abs();
    let largest = (0..parts).map(size).fold(0.0, f64::max);
    if let Some(part) = (0..parts).find(|&part| size(part) <= largest * 1e-12 || size(part).is_nan()) {
        return Err(part);
    }
    let basis = qr.compute_Q();
    let mut levels = basis.subcols(0, parts).transpose().to_owned();
    faer::linalg::triangular_solve::solve_upper_triangular_in_place(upper, levels.as_mut(), faer::Par::Seq);
    Ok((levels, basis.subcols(parts, measurements - parts).to_owned()))
}

/// Adds to each pixel `factor` times the row of its part.
fn add_levels(matrix: &mut Mat<f64>, levels: &Mat<f64>, part_of_pixel: &[usize], factor: f64) {
    matrix.par_col_iter_mut().enumerate().for_each(|(j, column)| {
        let level: Vec<f64> = levels.col(j).iter().map(|value| factor * value).collect();
        column.iter_mut().zip(part_of_pixel).for_each(|(value, &part)| *value += level[part]);
    });
}
