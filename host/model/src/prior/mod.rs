//! Prior: the regularisation matrix R of x = (J'WJ + lambda^2 R)^-1 J'W y, and its inverse as the
//! data-space solution needs it.

mod gaussian;
mod laplace;
#[cfg(test)]
mod tests;

use crate::{pixels::Pixels, skin};
use faer::Mat;
pub use gaussian::{HighPass, MOST_PIXELS};
use laplace::Laplacian;
use std::sync::Arc;

/// The matrix R in x = (J'WJ + lambda^2 R)^-1 J'W y.
#[derive(Clone, Debug, PartialEq)]
pub enum Prior {
    /// A diagonal: `[pixel]`.
    Diagonal(Vec<f64>),
    /// Twice the graph Laplacian of neighbouring pixels, which is what EIDORS' `prior_laplace`
    /// comes to when it is used as R'R: images that are constant on a connected part cost nothing.
    Laplace {
        /// Pixels.
        pixels: usize,
        /// Pairs of neighbours.
        neighbours: Vec<[usize; 2]>,
    },
    /// L'L with L the graph Laplacian: the thesis' reading, in which equation 3.1 is the R of R'R in
    /// equation 2.11. At the rim, where a pixel has fewer neighbours, the diagonal is their number,
    /// as in EIDORS.
    SquaredLaplace {
        /// Pixels.
        pixels: usize,
        /// Pairs of neighbours.
        neighbours: Vec<[usize; 2]>,
    },
    /// F'F with F a Gaussian high-pass filter (Adler and Guardo 1996).
    HighPass(HighPass),
}

impl Prior {
    /// The prior of a skin; `jacobian` is `[measurement][pixel]`, `weights` `[measurement]`.
    #[must_use]
    pub fn new(kind: skin::Prior, pixels: &Pixels, jacobian: &Mat<f64>, weights: &[f64]) -> Self {
        let count = pixels.count();
        match kind {
            skin::Prior::Laplace => Self::Laplace { pixels: count, neighbours: pixels.neighbours.clone() },
            skin::Prior::SquaredLaplace => {
                Self::SquaredLaplace { pixels: count, neighbours: pixels.neighbours.clone() }
            }
            skin::Prior::Tikhonov => Self::Diagonal(vec![1.0; count]),
            skin::Prior::Noser { exponent } => Self::Diagonal(noser(jacobian, weights, exponent)),
            skin::Prior::Gaussian { diameter } => Self::HighPass(HighPass::new(pixels, diameter)),
        }
    }

    /// Entries of R: row, column, value; entries of one place are to be added.
    pub fn entries(&self) -> Result<Vec<(usize, usize, f64)>, PriorError> {
        Ok(match self {
            Self::Diagonal(diagonal) => {
                diagonal.iter().enumerate().map(|(i, &value)| (i, i, value)).collect()
            }
            Self::Laplace { neighbours, .. } => laplace::entries(neighbours, LAPLACE),
            Self::SquaredLaplace { pixels, neighbours } => laplace::squared_entries(*pixels, neighbours),
            Self::HighPass(filter) => filter.entries()?,
        })
    }

    /// Parts of the image on which R is blind to a constant: the part of each pixel, and how many
    /// parts there are (0 if R is regular).
    #[must_use]
    pub fn blind_parts(&self) -> (Vec<usize>, usize) {
        match self {
            Self::Diagonal(_) | Self::HighPass(_) => (Vec::new(), 0),
            Self::Laplace { pixels, neighbours } | Self::SquaredLaplace { pixels, neighbours } => {
                laplace::connected_parts(*pixels, neighbours)
            }
        }
    }

    /// G `rhs` for a generalised inverse G of R, `[pixel][column]`: it solves R x = b for every
    /// column b that is orthogonal to what R is blind to.
    pub fn solve(&self, rhs: Mat<f64>) -> Result<Mat<f64>, PriorError> {
        self.solve_with(None, rhs)
    }

    /// The same with what was factored before, or is here if it was not.
    pub(crate) fn solve_with(
        &self,
        factored: Option<&Factored>,
        rhs: Mat<f64>,
    ) -> Result<Mat<f64>, PriorError> {
        let laplacian = |pixels: usize, neighbours: &[[usize; 2]], factor| match factored {
            Some(Factored(laplacian)) => Ok(laplacian.clone()),
            None => Laplacian::new(pixels, neighbours, factor).map(Arc::new),
        };
        match self {
            Self::Diagonal(diagonal) => divide_rows(rhs, diagonal),
            Self::Laplace { pixels, neighbours } => laplacian(*pixels, neighbours, LAPLACE)?.solve(rhs),
            Self::SquaredLaplace { pixels, neighbours } => {
                laplacian(*pixels, neighbours, SQUARED_LAPLACE)?.solve_twice(rhs)
            }
            Self::HighPass(filter) => filter.solve(rhs),
        }
    }
}

/// Factor of the graph Laplacian in [`Prior::Laplace`].
const LAPLACE: f64 = 2.0;
/// Factor of each of those in [`Prior::SquaredLaplace`].
const SQUARED_LAPLACE: f64 = 1.0;

/// What of a prior's solution the pixels alone determine, so that it need not wait for measurements.
pub struct Factored(Arc<Laplacian>);

impl Factored {
    /// Of a prior that has such a part, and can be factored.
    #[must_use]
    pub fn new(kind: skin::Prior, pixels: &Pixels) -> Option<Self> {
        let factor = match kind {
            skin::Prior::Laplace => LAPLACE,
            skin::Prior::SquaredLaplace => SQUARED_LAPLACE,
            skin::Prior::Tikhonov | skin::Prior::Noser { .. } | skin::Prior::Gaussian { .. } => return None,
        };
        Laplacian::new(pixels.count(), &pixels.neighbours, factor).ok().map(Arc::new).map(Self)
    }
}

/// Why a prior cannot be used.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum PriorError {
    /// No measurement answers to a pixel, so the prior is zero there.
    #[error("the prior is singular: its entry for pixel {pixel} is not above zero")]
    Singular {
        /// The pixel.
        pixel: usize,
    },
    /// A dense prior of too fine an image.
    #[error(
        "`inverse.prior` \"gaussian\" is a dense matrix and takes at most {MOST_PIXELS} pixels; the image has {pixels}"
    )]
    TooManyPixels {
        /// Pixels of the image.
        pixels: usize,
    },
    /// The filter has no inverse.
    #[error(
        "`inverse.prior` \"gaussian\" is singular on pixels that are larger than its filter; allowed here: a larger \
         `inverse.gaussian_diameter`, or more pixels"
    )]
    SingularFilter,
    /// The sparse solver failed.
    #[error("the prior cannot be factored: {0}")]
    Solver(String),
}

fn divide_rows(mut rhs: Mat<f64>, diagonal: &[f64]) -> Result<Mat<f64>, PriorError> {
    if let Some(pixel) = diagonal.iter().position(|&value| !(value > 0.0 && value.is_finite())) {
        return Err(PriorError::Singular { pixel });
    }
    for column in rhs.col_iter_mut() {
        column.iter_mut().zip(diagonal).for_each(|(value, divisor)| *value /= divisor);
    }
    Ok(rhs)
}

/// diag(J'WJ) to a power (Cheney et al. 1990, where it is 1; EIDORS' `prior_noser` takes 0.5).
fn noser(jacobian: &Mat<f64>, weights: &[f64], exponent: f64) -> Vec<f64> {
    let column = |pixel: usize| -> f64 {
        jacobian.col(pixel).iter().zip(weights).map(|(j, w)| w * j * j).sum::<f64>().powf(exponent)
    };
    (0..jacobian.ncols()).map(column).collect()
}
