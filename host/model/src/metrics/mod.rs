//! Figures of merit: what an image is worth where the truth is known.
//!
//! The same names stand for different definitions in the thesis and in GREIT, so each family has a
//! module of its own: [`thesis`] and [`greit`]. Images are `[pixel]` over any [`Pixels`]: sums are
//! weighted by area, which makes no difference where all pixels are alike, and positions are points
//! in space. The change looked for is positive; turn the sign of an image of a falling conductivity.

pub mod detectability;
pub mod greit;
pub mod parts;
pub mod thesis;

use crate::pixels::Pixels;
use dermatome_shared::{contact::region_level, units::RelativeConductivity};
use nalgebra::{Point3, Vector3};

/// What truly changed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Target {
    /// Centre of the change, m.
    pub position: Point3<f64>,
    /// The change summed over the skin: area times relative conductivity change, m^2.
    pub amount: f64,
    /// Centre of the skin, from which radial positions count, m.
    pub skin_centre: Point3<f64>,
}

impl Target {
    /// Radial position of the target less that of what was found, m: positive where the image shows
    /// it too close to the centre.
    #[must_use]
    pub fn radial_error(&self, found: Point3<f64>) -> f64 {
        (self.position - self.skin_centre).norm() - (found - self.skin_centre).norm()
    }
}

/// Resolution and ringing of a board's image.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ImageFigures {
    /// [`thesis::Figures::resolution`].
    pub resolution: f64,
    /// [`thesis::Figures::ringing`].
    pub ringing: f64,
}

/// Figures of a board's image `[pixel]` whose press is positive; `None` where nothing rises above
/// `threshold`.
#[must_use]
pub fn image_figures(
    image: &[RelativeConductivity],
    threshold: RelativeConductivity,
) -> Option<ImageFigures> {
    region_level(image, threshold)?;
    let image: Vec<f64> = image.iter().map(|value| value.to_f64()).collect();
    let region = thesis::region(&image)?;
    let areas = vec![1.0; image.len()];
    Some(ImageFigures { resolution: resolution(&region, &areas), ringing: ringing(&image, &region, &areas)? })
}

/// Distance between where a contact is reported and where the press is, seen from above, m.
#[must_use]
pub fn position_error(reported: [f32; 3], true_position: [f64; 2]) -> f64 {
    (f64::from(reported[0]) - true_position[0]).hypot(f64::from(reported[1]) - true_position[1])
}

/// Mean and largest of some numbers that are not negative; `None` where there are none.
#[must_use]
pub fn mean_and_max(values: impl Iterator<Item = f64> + Clone) -> Option<(f64, f64)> {
    let count = values.clone().count();
    (count > 0).then(|| (values.clone().sum::<f64>() / count as f64, values.fold(0.0, f64::max)))
}

/// The image's largest value, if it is above zero.
fn peak(image: &[f64]) -> Option<f64> {
    let finite = image.iter().all(|value| value.is_finite());
    Some(image.iter().copied().fold(0.0, f64::max)).filter(|&peak| finite && peak > 0.0)
}

/// Root of a set's share of all area: RES in both families.
fn resolution(set: &[bool], areas: &[f64]) -> f64 {
    (area(set, areas) / areas.iter().sum::<f64>()).sqrt()
}

fn area(set: &[bool], areas: &[f64]) -> f64 {
    set.iter().zip(areas).filter(|(inside, _)| **inside).map(|(_, area)| area).sum()
}

/// Magnitude of the opposite changes outside a set over the sum of the changes inside it; `None`
/// where that is not positive. RNG in both families, of different sets.
fn ringing(image: &[f64], set: &[bool], areas: &[f64]) -> Option<f64> {
    let (mut inside, mut opposite) = (0.0, 0.0);
    for ((&value, &is_inside), &area) in image.iter().zip(set).zip(areas) {
        if is_inside {
            inside += area * value;
        } else {
            opposite -= area * value.min(0.0);
        }
    }
    (inside > 0.0).then(|| opposite / inside)
}

/// Mean of pixel centres, each with its weight, on the surface; weights must not all be zero.
fn centre(pixels: &Pixels, weight: impl Fn(usize) -> f64) -> Point3<f64> {
    let weights = (0..pixels.count()).map(|pixel| (pixel, weight(pixel)));
    let (sum, total) = weights.fold((Vector3::zeros(), 0.0), |(sum, total), (pixel, weight)| {
        (sum + pixels.centres[pixel].coords * weight, total + weight)
    });
    on_surface(pixels, Point3::from(sum / total))
}

/// Lays a point onto the plane of the nearest pixel: means of points on a curved surface lie beneath it.
fn on_surface(pixels: &Pixels, point: Point3<f64>) -> Point3<f64> {
    let distance = |centre: &Point3<f64>| (centre - point).norm_squared();
    let pairs = pixels.centres.iter().zip(&pixels.normals);
    let nearest = pairs.min_by(|a, b| distance(a.0).total_cmp(&distance(b.0)));
    nearest.map_or(point, |(centre, normal)| point - normal * (point - centre).dot(normal))
}

#[cfg(test)]
mod tests;
