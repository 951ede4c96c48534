//! GREIT's figures: Adler et al., "GREIT: a unified approach to 2D linear EIT reconstruction of lung
//! images", Physiol. Meas. 30 (2009) S35, section 3.1, as EIDORS computes them in
//! `eval_GREIT_fig_merit`.
//!
//! The set they start from holds the pixels of at least a quarter of the image's largest value; its
//! centre counts every pixel alike. The circle has the set's area and centre.
//!
//! Differences: EIDORS' circle is a little small, because its pixels lie box / (n - 1) apart but count
//! box^2 / n^2 each; ours uses the pixels' areas. And EIDORS' code takes ringing outside the set,
//! where the paper says outside the circle; here are both.

use super::{Target, area, centre, peak, resolution, ringing};
use crate::pixels::Pixels;
use nalgebra::Point3;

/// Figures of an image of one target.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Figures {
    /// Centre of gravity of the set, m.
    pub centre: Point3<f64>,
    /// PE: radial position of the target less that of the centre, m; positive towards the skin's centre.
    pub position_error: f64,
    /// RES: root of the set's share of the image, 0 to 1.
    pub resolution: f64,
    /// SD: share of the set outside the circle, 0 to 1.
    pub shape_deformation: f64,
    /// RNG of the paper: magnitude of the opposite changes outside the circle over the sum of all
    /// changes inside it; none where that sum is not positive.
    pub ringing: Option<f64>,
    /// RNG of EIDORS' code: the same of the set instead of the circle.
    pub ringing_of_set: f64,
    /// Sum of the image, m^2: area times relative conductivity change. EIDORS' AR, but for its scale.
    pub amplitude: f64,
    /// AR: the amplitude over the target's; 1 is a faithful image.
    pub amplitude_response: f64,
}

/// Figures of `image`, `[pixel]`; `None` where nothing in it is above zero.
#[must_use]
pub fn figures(image: &[f64], pixels: &Pixels, target: &Target) -> Option<Figures> {
    let set = quarter_amplitude_set(image)?;
    let areas = &pixels.areas;
    let centre = centre(pixels, |pixel| if set[pixel] { areas[pixel] } else { 0.0 });
    let circle = circle(pixels, centre, area(&set, areas));
    let outside: Vec<bool> =
        set.iter().zip(&circle).map(|(in_set, in_circle)| *in_set && !in_circle).collect();
    let amplitude = image.iter().zip(areas).map(|(value, area)| value * area).sum();
    Some(Figures {
        centre,
        position_error: target.radial_error(centre),
        resolution: resolution(&set, areas),
        shape_deformation: area(&outside, areas) / area(&set, areas),
        ringing: ringing(image, &circle, areas),
        ringing_of_set: ringing(image, &set, areas)?,
        amplitude,
        amplitude_response: amplitude / target.amount,
    })
}

/// EIDORS' `calc_hm_set(image, 0.25)`: `[pixel]`; `None` where nothing is above zero.
fn quarter_amplitude_set(image: &[f64]) -> Option<Vec<bool>> {
    let level = peak(image)? * 0.25;
    Some(image.iter().map(|&value| value >= level).collect())
}

/// Pixels whose centre lies in the circle of this area: `[pixel]`.
fn circle(pixels: &Pixels, centre: Point3<f64>, area: f64) -> Vec<bool> {
    let radius_squared = area / std::f64::consts::PI;
    pixels.centres.iter().map(|pixel| (pixel - centre).norm_squared() < radius_squared).collect()
}
