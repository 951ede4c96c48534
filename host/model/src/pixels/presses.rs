//! Presses: which pixels lie under a round press, at places all over a surface.

use super::Pixels;
use dermatome_shared::MAX_PIXELS;
use faer::Mat;
use nalgebra::Point3;
use rayon::prelude::*;

/// Presses of one radius at places all over a skin.
#[derive(Clone, Debug)]
pub struct Presses {
    /// The pixel on whose centre each lies: `[place]`.
    pub places: Vec<usize>,
    /// The pixels under each, with the share of the press' strength that they have: `[place]`. Where the rim cuts a
    /// press, the rest has the strength of all of it.
    under: Vec<Vec<(usize, f64)>>,
}

impl Pixels {
    /// Presses on every pixel, or on every so many of them if no board takes so many pixels.
    #[must_use]
    pub fn presses(&self, radius: f64) -> Presses {
        let places: Vec<_> = (0..self.count()).step_by(self.count().div_ceil(MAX_PIXELS).max(1)).collect();
        let under = places.par_iter().map(|&place| self.under(self.centres[place], radius)).collect();
        Presses { places, under }
    }

    fn under(&self, middle: Point3<f64>, radius: f64) -> Vec<(usize, f64)> {
        let share = |pixel: usize| {
            let side = self.areas[pixel].sqrt();
            ((radius + side / 2.0 - (self.centres[pixel] - middle).norm()) / side).clamp(0.0, 1.0)
        };
        let shares = (0..self.count()).map(|pixel| (pixel, share(pixel))).filter(|(_, share)| *share > 0.0);
        let mut under: Vec<_> = shares.collect();
        let pressed: f64 = under.iter().map(|&(pixel, share)| share * self.areas[pixel]).sum();
        let scale = std::f64::consts::PI * radius * radius / pressed;
        under.iter_mut().for_each(|(_, share)| *share *= scale);
        under
    }
}

impl Presses {
    /// What presses of unit strength change the measurements by, `[measurement][place]`, of a Jacobian
    /// `[measurement][pixel]`.
    #[must_use]
    pub fn responses(&self, jacobian: &Mat<f64>) -> Mat<f64> {
        let mut responses = Mat::zeros(jacobian.nrows(), self.places.len());
        responses.par_col_iter_mut().zip(&self.under).for_each(|(response, under)| {
            let mut response = response;
            for &(pixel, share) in under {
                response += faer::Scale(share) * jacobian.col(pixel);
            }
        });
        responses
    }
}
