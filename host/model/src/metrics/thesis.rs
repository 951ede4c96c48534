//! The thesis' figures (section 3.6), from the region of interest: the pixels above a quarter of the
//! image's largest value (section 3.5.1).
//!
//! The thesis counts elements where we add areas, which is the same on pixels of one size, and it
//! defines neither a shape deformation nor an amplitude response; what it reads off as pressure is
//! the region's mean, [`Figures::strength`].

use super::{Target, area, centre, peak, resolution, ringing};
use crate::pixels::Pixels;
use nalgebra::Point3;

/// Figures of an image of one target.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Figures {
    /// Centre of the region, weighted by conductivity change, m.
    pub centre: Point3<f64>,
    /// PE, equation 3.4: radial position of the target less that of the centre, m. Negative away
    /// from the skin's centre; errors around it do not show.
    pub position_error: f64,
    /// RES, equation 3.3: root of the region's share of the image, 0 to 1.
    pub resolution: f64,
    /// RNG, equation 3.5: magnitude of all opposite changes over the region's sum. EIDORS'
    /// `eval_GREIT_fig_merit` computes this as well.
    pub ringing: f64,
    /// Mean relative conductivity change over the region (section 3.5.1).
    pub strength: f64,
}

/// Figures of `image`, `[pixel]`; `None` where nothing in it is above zero.
#[must_use]
pub fn figures(image: &[f64], pixels: &Pixels, target: &Target) -> Option<Figures> {
    let region = region(image)?;
    let weight = |pixel: usize| if region[pixel] { pixels.areas[pixel] * image[pixel] } else { 0.0 };
    let centre = centre(pixels, weight);
    Some(Figures {
        centre,
        position_error: target.radial_error(centre),
        resolution: resolution(&region, &pixels.areas),
        ringing: ringing(image, &region, &pixels.areas)?,
        strength: (0..region.len()).map(weight).sum::<f64>() / area(&region, &pixels.areas),
    })
}

/// The region of interest: `[pixel]`; `None` where nothing is above zero.
pub(super) fn region(image: &[f64]) -> Option<Vec<bool>> {
    let level = peak(image)? / 4.0;
    Some(image.iter().map(|&value| value > level).collect())
}

/// Relative voltage change dV/V, equation 3.2: mean of the changes, each over its reference; both
/// `[step]` or `[measurement]`. Where the reference is zero there is no ratio, and it is left out.
#[must_use]
pub fn relative_voltage_change(voltages: &[f64], reference: &[f64]) -> f64 {
    let live = voltages.iter().zip(reference).filter(|(_, reference)| **reference != 0.0);
    let ratios = live.map(|(voltage, reference)| (voltage - reference) / reference);
    let (sum, count) = ratios.fold((0.0, 0.0), |(sum, count), ratio| (sum + ratio, count + 1.0));
    if count > 0.0 { sum / count } else { 0.0 }
}
