//! Targets: discs of changed conductivity on the true skin's mesh.

use super::surface::Surface;
use dermatome_model::pixels::samples;
use nalgebra::{Point3, Vector3};

/// Discs of one size and contrast.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Discs {
    /// Radius, m; on a curved skin along straight lines in space.
    pub(super) radius: f64,
    /// Relative conductivity change inside.
    pub(super) contrast: f64,
}

/// What discs on a skin amount to.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Change {
    /// Relative conductivity of each element: `[element]`.
    pub(super) conductivity: Vec<f64>,
    /// Sum of magnitudes: area times relative change, m^2.
    pub(super) amount: f64,
    /// Centre of gravity, m: the disc's middle, unless the rim cuts it.
    pub(super) centre: Point3<f64>,
}

impl Discs {
    /// Discs round these middles; what reaches beyond the rim is lost.
    #[must_use]
    pub(super) fn at(&self, surface: &Surface<'_>, middles: &[Point3<f64>]) -> Change {
        let mut conductivity = vec![1.0; surface.centroids.len()];
        let (mut area, mut moment) = (0.0, Vector3::zeros());
        for (element, sigma) in conductivity.iter_mut().enumerate() {
            for middle in middles {
                if let Some((covered, centre)) = self.cover(surface, element, middle) {
                    *sigma += self.contrast * covered / surface.areas[element];
                    area += covered;
                    moment += centre.coords * covered;
                }
            }
            // Discs that overlap may not make the sheet vanish.
            *sigma = sigma.max(0.01);
        }
        let centre = if area > 0.0 { Point3::from(moment / area) } else { middles[0] };
        Change { conductivity, amount: area * self.contrast.abs(), centre: surface.onto(centre) }
    }

    /// Area of an element inside a disc, m^2, and its centre of gravity.
    fn cover(
        &self,
        surface: &Surface<'_>,
        element: usize,
        middle: &Point3<f64>,
    ) -> Option<(f64, Point3<f64>)> {
        let (centroid, area) = (surface.centroids[element], surface.areas[element]);
        let corners = surface.mesh.corners(element);
        let size = corners.iter().map(|corner| (corner - centroid).norm()).fold(0.0, f64::max);
        let distance = (centroid - middle).norm();
        if distance > self.radius + size {
            return None;
        }
        if distance + size < self.radius {
            return Some((area, centroid));
        }
        let is_inside = |point: &Point3<f64>| (point - middle).norm_squared() < self.radius * self.radius;
        let (mut inside, mut all, mut sum) = (0.0, 0.0, Vector3::zeros());
        for point in samples(corners) {
            all += 1.0;
            if is_inside(&point) {
                inside += 1.0;
                sum += point.coords;
            }
        }
        (inside > 0.0).then(|| (area * inside / all, Point3::from(sum / inside)))
    }
}

#[cfg(test)]
mod tests {
    use super::super::surface::tests::{disc_surface, hemisphere};
    use super::*;
    use dermatome_model::skin::Shape;
    use std::f64::consts::PI;

    #[test]
    fn a_disc_on_the_skin_has_its_area_and_its_middle() {
        let (shape, mesh) = disc_surface();
        let surface = Surface::new(&shape, &mesh);
        let middle = Point3::new(0.03, -0.02, 0.0);
        let change = Discs { radius: 0.02, contrast: -0.5 }.at(&surface, &[middle]);
        assert!((change.amount / (0.5 * PI * 0.0004) - 1.0).abs() < 5e-3, "{}", change.amount);
        assert!((change.centre - middle).norm() < 1e-4, "{}", change.centre);
        assert!(change.conductivity.iter().all(|sigma| (0.5..=1.0).contains(sigma)));
        let changed: f64 =
            change.conductivity.iter().zip(&surface.areas).map(|(sigma, area)| (1.0 - sigma) * area).sum();
        assert!((changed - change.amount).abs() < 1e-12);
    }

    #[test]
    fn the_rim_cuts_a_disc_and_its_centre_moves_inwards() {
        let (shape, mesh) = disc_surface();
        let surface = Surface::new(&shape, &mesh);
        let change = Discs { radius: 0.02, contrast: 1.0 }.at(&surface, &[Point3::new(0.1, 0.0, 0.0)]);
        assert!(change.amount < 0.5 * PI * 0.0004, "{}", change.amount);
        // Centre of gravity of half a disc: 4 r / 3 pi.
        assert!((0.1 - change.centre.x - 0.02 * 4.0 / (3.0 * PI)).abs() < 1.5e-3, "{}", change.centre);
    }

    #[test]
    fn two_discs_that_overlap_never_make_the_sheet_vanish() {
        let (shape, mesh) = disc_surface();
        let surface = Surface::new(&shape, &mesh);
        let change = Discs { radius: 0.02, contrast: -0.9 }.at(&surface, &[Point3::origin(); 2]);
        assert_eq!(change.conductivity.iter().copied().fold(f64::INFINITY, f64::min), 0.01);
    }

    #[test]
    fn a_disc_on_a_curved_skin_is_centred_on_its_surface() {
        let mesh = hemisphere();
        let shape = Shape::Mesh { mesh: Box::new(mesh.clone()), outline: None };
        let surface = Surface::new(&shape, &mesh);
        let pole = surface.onto(Point3::new(0.0, 0.0, 0.1));
        let change = Discs { radius: 0.03, contrast: 1.0 }.at(&surface, &[pole]);
        assert!((change.centre - pole).norm() < 1e-3, "{} {pole}", change.centre);
        // A cap of a sphere has the area of a disc whose radius is the cap's chord.
        assert!((change.amount / (PI * 0.0009) - 1.0).abs() < 0.03, "{}", change.amount);
    }
}
