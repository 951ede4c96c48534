//! Whitening: brings measurements to uncorrelated noise of size 1, so that nothing after it needs
//! weights.

use super::InverseError;
use faer::{Mat, Side, linalg::solvers::Llt, linalg::triangular_solve::solve_lower_triangular_in_place};
use rayon::prelude::*;

/// A matrix T with T'T = W, the inverse of the noise covariance: `[measurement][measurement]`.
#[derive(Clone, Debug)]
pub enum Whitening {
    /// Independent noise: the diagonal of T.
    Diagonal(Vec<f64>),
    /// Correlated noise: L with L L' the covariance, T = L^-1.
    Correlated(Mat<f64>),
}

impl Whitening {
    /// From the diagonal of W; a measurement of weight 0 is left out.
    pub fn from_weights(weights: &[f64]) -> Result<Self, InverseError> {
        check(weights)?;
        Ok(Self::Diagonal(weights.iter().map(|weight| weight.sqrt()).collect()))
    }

    /// From the covariance of the noise: `[measurement][measurement]`.
    pub fn from_covariance(covariance: &Mat<f64>) -> Result<Self, InverseError> {
        let factor = Llt::new(covariance.as_ref(), Side::Lower).map_err(|_| InverseError::Covariance)?;
        Ok(Self::Correlated(factor.L().to_owned()))
    }

    /// (T A)': from A, `[measurement][column]`, to `[column][measurement]`.
    #[must_use]
    pub fn transposed(&self, rows: &Mat<f64>) -> Mat<f64> {
        match self {
            Self::Diagonal(factors) => {
                let mut transposed = Mat::zeros(rows.ncols(), rows.nrows());
                transposed.par_row_chunks_mut(BLOCK).enumerate().for_each(|(block, chunk)| {
                    for (i, (column, factor)) in chunk.col_iter_mut().zip(factors).enumerate() {
                        let from = rows.row(i).subcols(block * BLOCK, column.nrows());
                        column.iter_mut().zip(from.iter()).for_each(|(to, from)| *to = factor * from);
                    }
                });
                transposed
            }
            Self::Correlated(lower) => {
                let mut whitened = rows.clone();
                solve_lower_triangular_in_place(
                    lower.as_ref(),
                    whitened.as_mut(),
                    faer::get_global_parallelism(),
                );
                whitened.transpose().to_owned()
            }
        }
    }

    /// T y: `[measurement]`.
    #[must_use]
    pub fn data(&self, data: &[f64]) -> Vec<f64> {
        let column = Mat::from_fn(data.len(), 1, |i, _| data[i]);
        self.transposed(&column).row(0).iter().copied().collect()
    }

    /// A T, in the place of A, `[row][measurement]`.
    pub fn columns(&self, matrix: &mut Mat<f64>) {
        match self {
            Self::Diagonal(factors) => scale_columns(matrix, factors),
            Self::Correlated(lower) => {
                // (A T)' = L'^-1 A'
                let transposed = matrix.as_mut().transpose_mut();
                faer::linalg::triangular_solve::solve_upper_triangular_in_place(
                    lower.transpose(),
                    transposed,
                    faer::get_global_parallelism(),
                );
            }
        }
    }
}

/// Weights are finite, none below zero and not all of them zero.
pub(super) fn check(weights: &[f64]) -> Result<(), InverseError> {
    let wrong = weights.iter().position(|&weight| !(weight >= 0.0 && weight.is_finite()));
    let nothing = || weights.iter().all(|&weight| weight == 0.0).then_some(0);
    match wrong.or_else(nothing) {
        Some(measurement) => {
            let value = weights.get(measurement).copied().unwrap_or(0.0);
            Err(InverseError::Weight { measurement, value })
        }
        None => Ok(()),
    }
}

/// Columns transposed together, so that both sides stay in the cache.
const BLOCK: usize = 64;

/// Multiplies each column by its factor.
pub(super) fn scale_columns(matrix: &mut Mat<f64>, factors: &[f64]) {
    matrix.par_col_iter_mut().zip(factors).for_each(|(column, factor)| {
        column.iter_mut().for_each(|value| *value *= factor);
    });
}
