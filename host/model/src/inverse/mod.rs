//! Inverse: the reconstruction matrix, computed in data space.
//!
//! The image that minimises |J x - y|_W^2 + lambda^2 x'R x (thesis equation 2.11 with weights)
//! is, with R^-1 = G, G J' (J G J' + lambda^2 W^-1)^-1 y: a system as large as the data, however
//! fine the image. GREIT's matrix D Y' (Y Y' + lambda^2 W^-1)^-1 has the same form, so both are a
//! [`DataSpace`]: it is set up once, and gives the matrix, or what the choice of a hyperparameter
//! asks, for every lambda.
//!
//! ```text
//! Jacobian, weights, prior  or  training targets
//!   -> Whitening: all measurements get noise of size 1
//!   -> DataSpace: J G J'  or  Y Y'
//!   -> selection: Spectrum of the data space -> hyperparameter
//!   -> DataSpace::matrix -> Whitening::columns -> reconstruction matrix
//! ```

pub mod data_space;
pub mod difference;
pub mod figures;
pub mod greit;
pub mod least_squares;
pub mod movement;
pub mod reconstruction;
pub mod selection;
pub mod targets;
#[cfg(test)]
mod tests;
pub mod whitening;

use crate::{
    forward::ForwardError,
    prior::{Prior, PriorError},
};
pub use data_space::{DataSpace, Spectrum};
use faer::Mat;
pub use whitening::Whitening;

/// Reconstruction matrix `conductivity_from_voltage` of a prior: `[pixel][measurement]`.
///
/// `jacobian` is `[measurement][pixel]`, `weights` is the diagonal of W: `[measurement]`.
pub fn reconstruction_matrix(
    jacobian: &Mat<f64>,
    prior: &Prior,
    weights: &[f64],
    hyperparameter: f64,
) -> Result<Mat<f64>, InverseError> {
    let whitening = Whitening::from_weights(weights)?;
    let space = DataSpace::one_step(whitening.transposed(jacobian), prior, None)?;
    let mut matrix = space.matrix(hyperparameter)?;
    whitening.columns(&mut matrix);
    Ok(matrix)
}

/// Why there is no reconstruction matrix.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum InverseError {
    /// A target cannot be simulated.
    #[error(transparent)]
    Forward(#[from] ForwardError),
    /// The prior cannot be used.
    #[error(transparent)]
    Prior(#[from] PriorError),
    /// Nothing is known of a part of the image.
    #[error(
        "the prior is singular: it leaves the level of the pixels around pixel {pixel} open, and so do the \
         measurements"
    )]
    Blind {
        /// First pixel of the part.
        pixel: usize,
    },
    /// A matrix that rounding makes indefinite.
    #[error(
        "`inverse.hyperparameter` = {hyperparameter:.3e} is lost in rounding; allowed here: more than {least:.1e}"
    )]
    Rounding {
        /// The hyperparameter.
        hyperparameter: f64,
        /// The least that may do.
        least: f64,
    },
    /// Weights must be one for each measurement.
    #[error("`inverse.weights` has {given} entries; allowed here: {measurements}, one for each measurement")]
    WeightCount {
        /// Weights given.
        given: usize,
        /// Measurements of the skin.
        measurements: usize,
    },
    /// A weight that is no weight.
    #[error(
        "`inverse.weights` has {value} for measurement {measurement}; allowed: zero or more, and one above zero"
    )]
    Weight {
        /// The measurement.
        measurement: usize,
        /// Its weight.
        value: f64,
    },
    /// A noise covariance that is none.
    #[error("the noise covariance is not positive definite")]
    Covariance,
    /// A normalised measurement would be divided by next to nothing.
    #[error(
        "measurement {measurement} of the untouched skin is too small to normalise by ({share:.0e} of the mean); \
         allowed here: `inverse.normalised` = false"
    )]
    SmallVoltage {
        /// Index of the measurement.
        measurement: usize,
        /// Its size over the mean.
        share: f64,
    },
    /// The responses to targets lack what the settings need.
    #[error("{what} must be simulated first")]
    NotSimulated {
        /// What is missing.
        what: &'static str,
    },
    /// The eigenvalues did not converge.
    #[error("the eigenvalues of the data space cannot be computed: {0}")]
    Eigenvalues(String),
    /// No hyperparameter could be chosen.
    #[error(transparent)]
    Selection(#[from] selection::SelectionError),
}
