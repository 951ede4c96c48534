//! Gaussian high-pass filter (Adler and Guardo 1996; EIDORS `prior_gaussian_HPF`).

use super::PriorError;
use crate::pixels::Pixels;
use faer::{
    Mat, Side,
    linalg::solvers::{Llt, SolveCore},
};
use nalgebra::Point3;
use std::f64::consts::PI;

/// Pixels that the dense filter takes: factoring 4,096 needs 134 MB and about a second.
pub const MOST_PIXELS: usize = 4096;

/// exp(-2.769 r^2) falls to a half at r = 0.5, so a filter's diameter is its width at half height.
const HALF_HEIGHT: f64 = 2.769;

/// The filter F: a pixel minus its surroundings, weighed by a Gaussian of integral 1.
///
/// EIDORS integrates the Gaussian over a pixel by counting sample points; here each pixel is a blob
/// with the pixel's area and second moment (that of a square), which widens the Gaussian a little.
/// EIDORS also drops entries below 0.003, which on fine meshes is all of them; none are dropped
/// here, and distances are in units of the skin's larger side in both directions. Where pixels are about
/// as large as the Gaussian (100 on a disc at EIDORS' diameter), the values at their centres may add up
/// to more than its integral, and F would be indefinite: shares are scaled back to it. What the Gaussian
/// loses beyond the rim then keeps its largest eigenvalue below 1; on pixels one and a half diameters wide
/// it loses nothing, and F is singular.
#[derive(Clone, Debug, PartialEq)]
pub struct HighPass {
    centres: Vec<Point3<f64>>,
    areas: Vec<f64>,
    /// Diameter of the Gaussian at half height, m.
    diameter: f64,
}

impl HighPass {
    /// `diameter` is that of the Gaussian at half height as a share of the image's larger side; 0.1
    /// is EIDORS' choice.
    #[must_use]
    pub fn new(pixels: &Pixels, diameter: f64) -> Self {
        let diameter = diameter * pixels.larger_side();
        Self { centres: pixels.centres.clone(), areas: pixels.areas.clone(), diameter }
    }

    /// F: `[pixel][pixel]`, symmetric.
    pub fn filter(&self) -> Result<Mat<f64>, PriorError> {
        let pixels = self.areas.len();
        if pixels > MOST_PIXELS {
            return Err(PriorError::TooManyPixels { pixels });
        }
        let share = |i: usize, j: usize| self.share(j, (self.centres[i] - self.centres[j]).norm_squared());
        let mut filter = Mat::from_fn(pixels, pixels, |i, j| (share(i, j) + share(j, i)) / 2.0);
        let scale: Vec<f64> = filter.row_iter().map(|row| row.iter().sum::<f64>().max(1.0).sqrt()).collect();
        for (j, column) in filter.col_iter_mut().enumerate() {
            for (i, entry) in column.iter_mut().enumerate() {
                *entry = f64::from(u8::from(i == j)) - *entry / (scale[i] * scale[j]);
            }
        }
        Ok(filter)
    }

    /// Integral of the Gaussian over a pixel at this squared distance from its centre.
    fn share(&self, pixel: usize, distance_squared: f64) -> f64 {
        let area = self.areas[pixel];
        let beta = 1.0 / (self.diameter.powi(2) / HALF_HEIGHT + area / 6.0);
        beta / PI * area * (-beta * distance_squared).exp()
    }

    /// Entries of F'F.
    pub(super) fn entries(&self) -> Result<Vec<(usize, usize, f64)>, PriorError> {
        let filter = self.filter()?;
        let square = filter.transpose() * &filter;
        let pixels = 0..square.nrows();
        Ok(pixels
            .clone()
            .flat_map(|i| pixels.clone().map(move |j| (i, j)))
            .map(|(i, j)| (i, j, square[(i, j)]))
            .collect())
    }

    /// Solves F'F x = b for every column.
    pub(super) fn solve(&self, mut rhs: Mat<f64>) -> Result<Mat<f64>, PriorError> {
        let factor =
            Llt::new(self.filter()?.as_ref(), Side::Lower).map_err(|_| PriorError::SingularFilter)?;
        factor.solve_in_place_with_conj(faer::Conj::No, rhs.as_mut());
        factor.solve_in_place_with_conj(faer::Conj::No, rhs.as_mut());
        Ok(rhs)
    }
}
