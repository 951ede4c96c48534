//! Figures of merit of one image, in the thesis' variants (section 3.6).

use dermatome_shared::{contact::region_level, units::RelativeConductivity};

/// What an image of one press is worth.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ImageFigures {
    /// Resolution, equation 3.3: root of the region of interest's share of the image, 0 to 1.
    pub resolution: f64,
    /// Ringing, equation 3.5: magnitude of all opposite changes outside the region, over the
    /// region's sum.
    pub ringing: f64,
}

/// Figures of an image `[pixel]` whose press is positive; `None` where nothing rises above
/// `threshold`.
#[must_use]
pub fn image_figures(
    image: &[RelativeConductivity],
    threshold: RelativeConductivity,
) -> Option<ImageFigures> {
    let level = region_level(image, threshold)?;
    let inside = || image.iter().filter(move |value| value.0 > level);
    let opposite: f64 = image.iter().filter(|value| value.0 < 0).map(|value| -value.to_f64()).sum();
    Some(ImageFigures {
        resolution: (inside().count() as f64 / image.len() as f64).sqrt(),
        ringing: opposite / inside().map(|value| value.to_f64()).sum::<f64>(),
    })
}

/// Distance between where a contact is reported and where the press is, m.
#[must_use]
pub fn position_error(reported: [f32; 2], true_position: [f64; 2]) -> f64 {
    (f64::from(reported[0]) - true_position[0]).hypot(f64::from(reported[1]) - true_position[1])
}

/// Mean and largest of some numbers that are not negative; `None` where there are none.
#[must_use]
pub fn mean_and_max(values: impl Iterator<Item = f64> + Clone) -> Option<(f64, f64)> {
    let count = values.clone().count();
    (count > 0).then(|| (values.clone().sum::<f64>() / count as f64, values.fold(0.0, f64::max)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn figures_of_a_hand_made_image() {
        let image: Vec<_> = [8, 4, 2, 1, -1, 0, 0, 0].map(|v| RelativeConductivity(v << 10)).to_vec();
        let figures = image_figures(&image, RelativeConductivity(1)).unwrap();
        assert!((figures.resolution - (2.0_f64 / 8.0).sqrt()).abs() < 1e-12);
        assert!((figures.ringing - 1.0 / 12.0).abs() < 1e-12);
        assert_eq!(image_figures(&image, RelativeConductivity(9 << 10)), None);
    }
}
