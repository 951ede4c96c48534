//! Regularisation priors R, and their inverses as the data-space solution needs them.

use crate::{pixels::Pixels, skin};
use faer::{
    Mat, Side,
    linalg::solvers::SolveCore,
    sparse::{SparseColMat, Triplet, linalg::solvers as sparse},
};

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
}

impl Prior {
    /// The prior of a skin; `jacobian` is `[measurement][pixel]`, `weights` `[measurement]`.
    #[must_use]
    pub fn new(kind: skin::Prior, pixels: &Pixels, jacobian: &Mat<f64>, weights: &[f64]) -> Self {
        match kind {
            skin::Prior::Laplace => {
                Self::Laplace { pixels: pixels.elements.len(), neighbours: pixels.neighbours.clone() }
            }
            skin::Prior::Tikhonov => Self::Diagonal(vec![1.0; jacobian.ncols()]),
            skin::Prior::Noser => Self::Diagonal(noser(jacobian, weights)),
        }
    }

    /// Entries of R: row, column, value; entries of one place are to be added.
    #[must_use]
    pub fn entries(&self) -> Vec<(usize, usize, f64)> {
        match self {
            Self::Diagonal(diagonal) => {
                diagonal.iter().enumerate().map(|(i, &value)| (i, i, value)).collect()
            }
            Self::Laplace { neighbours, .. } => {
                let pair = |&[a, b]: &[usize; 2]| [(a, a, 2.0), (b, b, 2.0), (a, b, -2.0), (b, a, -2.0)];
                neighbours.iter().flat_map(pair).collect()
            }
        }
    }

    /// Parts of the image on which R is blind to a constant: the part of each pixel, and how many
    /// parts there are (0 if R is regular).
    #[must_use]
    pub fn blind_parts(&self) -> (Vec<usize>, usize) {
        match self {
            Self::Diagonal(_) => (Vec::new(), 0),
            Self::Laplace { pixels, neighbours } => connected_parts(*pixels, neighbours),
        }
    }

    /// Solves R x = b for every column of `rhs`, `[pixel][column]`; where R is blind to a
    /// constant, one pixel of the part is held at zero.
    pub fn solve(&self, rhs: &Mat<f64>) -> Result<Mat<f64>, PriorError> {
        match self {
            Self::Diagonal(diagonal) => {
                if let Some(pixel) = diagonal.iter().position(|&value| !(value > 0.0 && value.is_finite())) {
                    return Err(PriorError::Singular { pixel });
                }
                Ok(Mat::from_fn(rhs.nrows(), rhs.ncols(), |i, j| rhs[(i, j)] / diagonal[i]))
            }
            Self::Laplace { .. } => self.solve_laplace(rhs),
        }
    }

    fn solve_laplace(&self, rhs: &Mat<f64>) -> Result<Mat<f64>, PriorError> {
        let (parts, count) = self.blind_parts();
        let held: Vec<usize> = (0..count).filter_map(|part| parts.iter().position(|&p| p == part)).collect();
        let is_held = |pixel: usize| held[parts[pixel]] == pixel;
        let lower =
            self.entries().into_iter().filter(|&(row, col, _)| row >= col && !is_held(row) && !is_held(col));
        let unit = held.iter().map(|&pixel| (pixel, pixel, 1.0));
        let triplets: Vec<_> = lower.chain(unit).map(|(row, col, val)| Triplet { row, col, val }).collect();
        let solver = |error: String| PriorError::Solver(error);
        let matrix = SparseColMat::<usize, f64>::try_new_from_triplets(parts.len(), parts.len(), &triplets)
            .map_err(|error| solver(format!("{error:?}")))?;
        let factor = matrix.sp_cholesky(Side::Lower).map_err(|error| solver(format!("{error:?}")))?;
        let mut solution =
            Mat::from_fn(rhs.nrows(), rhs.ncols(), |i, j| if is_held(i) { 0.0 } else { rhs[(i, j)] });
        sparse::Llt::solve_in_place_with_conj(&factor, faer::Conj::No, solution.as_mut());
        Ok(solution)
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
    /// The sparse solver failed.
    #[error("the prior cannot be factored: {0}")]
    Solver(String),
}

/// diag(J'WJ)^0.5 (Cheney et al. 1990; EIDORS `prior_noser` with exponent 0.5).
fn noser(jacobian: &Mat<f64>, weights: &[f64]) -> Vec<f64> {
    let column = |pixel: usize| -> f64 {
        jacobian.col(pixel).iter().zip(weights).map(|(j, w)| w * j * j).sum::<f64>().sqrt()
    };
    (0..jacobian.ncols()).map(column).collect()
}

fn connected_parts(pixels: usize, neighbours: &[[usize; 2]]) -> (Vec<usize>, usize) {
    let mut adjacent = vec![Vec::new(); pixels];
    for &[a, b] in neighbours {
        adjacent[a].push(b);
        adjacent[b].push(a);
    }
    let mut part = vec![usize::MAX; pixels];
    let mut count = 0;
    for start in 0..pixels {
        let mut waiting = if part[start] == usize::MAX { vec![start] } else { continue };
        while let Some(pixel) = waiting.pop() {
            if part[pixel] == usize::MAX {
                part[pixel] = count;
                waiting.extend(&adjacent[pixel]);
            }
        }
        count += 1;
    }
    (part, count)
}
