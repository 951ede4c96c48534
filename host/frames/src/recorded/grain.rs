//! The grain of a sheet as a fit sees it: the logarithm of its conductivity tensor, [c d; d -c].
//!
//! The tensor's determinant is 1, its eigenvalues e^r and e^-r with r^2 = c^2 + d^2, the larger one at half the angle
//! of (c, d). A sheet without grain is c = d = 0, through which a search passes as through any other point, while the
//! grain's angle jumps there.

use dermatome_model::skin::Material;
use nalgebra::{Matrix2, Vector2};
use serde::Serialize;
use std::f64::consts::{FRAC_PI_2, PI};

/// Grain of the sheet.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Grain {
    /// Conductivity across it over that along it, as the skin file says.
    pub across_before: f64,
    /// As fitted: below 1, or above if the skin file's is.
    pub across: f64,
    /// Standard deviation, %, from what is left over; none if the frames do not say.
    pub across_deviation_percent: Option<f64>,
    /// Direction as the skin file says: from x towards y, degrees.
    pub angle_before_degrees: f64,
    /// As fitted, within 90 degrees of the skin file's.
    pub angle_degrees: f64,
}

/// c and d of a material, if it has a grain.
pub(super) fn stretch(material: &Material) -> Option<Vector2<f64>> {
    let across = material.across?;
    let (sine, cosine) = (2.0 * material.grain).sin_cos();
    Some(Vector2::new(cosine, sine) * (-0.5 * across.ln()))
}

/// The material with another grain, and the conductivity along that over the mean, the root of the determinant.
pub(super) fn stretched(material: &Material, stretch: Vector2<f64>) -> (Material, f64) {
    let r = stretch.norm();
    let grain = stretch.y.atan2(stretch.x) / 2.0;
    (Material { across: Some((-2.0 * r).exp()), grain, ..material.clone() }, r.exp())
}

impl Grain {
    /// From what was fitted, and its covariance if that is known.
    pub(super) fn new(material: &Material, stretch: Vector2<f64>, covariance: Option<Matrix2<f64>>) -> Self {
        let across_before = material.across.unwrap_or(1.0);
        let is_turned = across_before > 1.0;
        let r = stretch.norm();
        let of_larger = stretch.y.atan2(stretch.x) / 2.0;
        let angle = if is_turned { of_larger + FRAC_PI_2 } else { of_larger };
        // A direction comes again after half a turn.
        let turns = ((angle - material.grain) / PI).round();
        // d ln across = 2 d r.
        let unit = stretch.try_normalize(0.0).unwrap_or(Vector2::x());
        let deviation = covariance.map(|covariance| 200.0 * unit.dot(&(covariance * unit)).sqrt());
        Self {
            across_before,
            across: if is_turned { (2.0 * r).exp() } else { (-2.0 * r).exp() },
            across_deviation_percent: deviation,
            angle_before_degrees: material.grain.to_degrees(),
            angle_degrees: (angle - turns * PI).to_degrees(),
        }
    }
}
