//! Inverse: the one-step reconstruction matrix, computed in data space.
//!
//! The image that minimises |J x - y|_W^2 + lambda^2 x'R x (thesis equation 2.11 with weights)
//! is, with R^-1 = G, G J' (J G J' + lambda^2 W^-1)^-1 y: a system as large as the data, however
//! fine the image. A prior that is blind to constants (Laplace) has no inverse; the constants N
//! then become unknowns of their own, and the image is N c + G J' a with
//!
//! ```text
//! [ J G J' + lambda^2 W^-1   J N ] [a]   [y]
//! [ (J N)'                    0  ] [c] = [0]
//! ```
//!
//! where G is any generalised inverse of R: the second line makes J'a orthogonal to N.

use crate::prior::{Prior, PriorError};
use faer::{Mat, linalg::solvers::SolveCore};

/// Reconstruction matrix `conductivity_from_voltage`: `[pixel][measurement]`.
///
/// `jacobian` is `[measurement][pixel]`, `weights` is the diagonal of W: `[measurement]`.
pub fn reconstruction_matrix(
    jacobian: &Mat<f64>,
    prior: &Prior,
    weights: &[f64],
    hyperparameter: f64,
) -> Result<Mat<f64>, PriorError> {
    let measurements = jacobian.nrows();
    let smoothed = prior.solve(&jacobian.transpose().to_owned())?;
    let gram = jacobian * &smoothed;
    let blind = Blind::new(prior, jacobian);
    let size = measurements + blind.parts;
    let system = Mat::from_fn(size, size, |i, j| match (i < measurements, j < measurements) {
        (true, true) => gram[(i, j)] + if i == j { hyperparameter.powi(2) / weights[i] } else { 0.0 },
        (true, false) => blind.answer[(i, j - measurements)],
        (false, true) => blind.answer[(j, i - measurements)],
        (false, false) => 0.0,
    });
    let mut solution = Mat::from_fn(size, measurements, |i, j| if i == j { 1.0 } else { 0.0 });
    system.partial_piv_lu().solve_in_place_with_conj(faer::Conj::No, solution.as_mut());
    let mut matrix = &smoothed * solution.subrows(0, measurements);
    for (pixel, &part) in blind.part_of_pixel.iter().enumerate() {
        for measurement in 0..measurements {
            matrix[(pixel, measurement)] += solution[(measurements + part, measurement)];
        }
    }
    Ok(matrix)
}

/// The constants that the prior is blind to.
struct Blind {
    part_of_pixel: Vec<usize>,
    parts: usize,
    /// J N: answer of each measurement to a constant on each part, `[measurement][part]`.
    answer: Mat<f64>,
}

impl Blind {
    fn new(prior: &Prior, jacobian: &Mat<f64>) -> Self {
        let (part_of_pixel, parts) = prior.blind_parts();
        let mut answer = Mat::zeros(jacobian.nrows(), parts);
        for (pixel, &part) in part_of_pixel.iter().enumerate() {
            for measurement in 0..jacobian.nrows() {
                answer[(measurement, part)] += jacobian[(measurement, pixel)];
            }
        }
        Self { part_of_pixel, parts, answer }
    }
}
