//! Embedding: how a sheet that was cut out flat lies in space.
//!
//! The flat sheet is the surface's development. Its origin lies uppermost (at the hemisphere's top,
//! in the middle of a patch), its x axis points to the right and its y axis upwards as seen from
//! above, so that what `first` and pictures mean does not depend on the embedding. The axis of a
//! cylinder or cone is the y axis, the middle of a hemisphere is the origin.

use crate::outline::Outline;
use nalgebra::{Point2, Point3, Vector2};

/// A surface onto which a flat sheet is laid.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Embedding {
    /// The plane z = 0.
    Flat,
    /// Half a sphere round the origin, z >= 0. Its development is the disc of the same rim, by
    /// stereographic projection: angles stay, lengths grow from the rim (1) to the top (2).
    Hemisphere {
        /// Radius, m.
        radius: f64,
    },
    /// A cylinder round the y axis; lengths stay.
    Cylinder {
        /// Radius, m.
        radius: f64,
    },
    /// A cone round the y axis that narrows upwards; lengths stay.
    Cone {
        /// From the axis to the surface, rad: above 0, below a right angle.
        half_angle: f64,
        /// From the development's origin up the surface to the apex, m.
        to_apex: f64,
    },
}

impl Embedding {
    /// Point in space of a point of the flat sheet.
    #[must_use]
    pub fn lay(&self, point: Point2<f64>) -> Point3<f64> {
        match *self {
            Self::Flat => Point3::new(point.x, point.y, 0.0),
            Self::Hemisphere { radius } => {
                let scale = self.scale(point);
                Point3::new(scale * point.x, scale * point.y, radius * (scale - 1.0))
            }
            Self::Cylinder { radius } => {
                let (sin, cos) = (point.x / radius).sin_cos();
                Point3::new(radius * sin, point.y, radius * cos)
            }
            Self::Cone { half_angle, to_apex } => {
                let from_apex = Vector2::new(point.x, to_apex - point.y);
                let (slope, shrink) = half_angle.sin_cos();
                let along = from_apex.norm();
                let (sin, cos) = (from_apex.x.atan2(from_apex.y) / slope).sin_cos();
                Point3::new(along * slope * sin, (to_apex - along) * shrink, along * slope * cos)
            }
        }
    }

    /// The point of the flat sheet whose place in space is nearest to `point`. On the axis, where
    /// all directions are as near, it is one of them.
    #[must_use]
    pub fn flatten(&self, point: Point3<f64>) -> Point2<f64> {
        match *self {
            Self::Flat => point.xy(),
            Self::Hemisphere { radius } => {
                let distance = point.coords.norm();
                let up = if distance > 0.0 { point.coords / distance } else { nalgebra::Vector3::z() };
                // The lowest point has no place; it is as far off as the top.
                Point2::from(up.xy() * (radius / (1.0 + up.z).max(1e-12)))
            }
            Self::Cylinder { radius } => Point2::new(radius * point.x.atan2(point.z), point.y),
            Self::Cone { half_angle, to_apex } => {
                let (slope, shrink) = half_angle.sin_cos();
                let along = point.x.hypot(point.z) * slope + (to_apex * shrink - point.y) * shrink;
                let (sin, cos) = (point.x.atan2(point.z) * slope).sin_cos();
                Point2::new(along * sin, to_apex - along * cos)
            }
        }
    }

    /// Metres in space per metre of the flat sheet, the same in all directions, and at least 1.
    #[must_use]
    pub fn scale(&self, point: Point2<f64>) -> f64 {
        match *self {
            Self::Flat | Self::Cylinder { .. } | Self::Cone { .. } => 1.0,
            Self::Hemisphere { radius } => 2.0 / (1.0 + (point.coords / radius).norm_squared()),
        }
    }

    /// Area in space of a sheet, m^2.
    #[must_use]
    pub fn area(&self, outline: &Outline) -> f64 {
        match self {
            // A hemisphere's outline is all of its development.
            Self::Hemisphere { .. } => 2.0 * outline.area(),
            Self::Flat | Self::Cylinder { .. } | Self::Cone { .. } => outline.area(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn embeddings() -> impl Strategy<Value = Embedding> {
        prop_oneof![
            Just(Embedding::Flat),
            Just(Embedding::Hemisphere { radius: 1.0 }),
            (0.5..3.0).prop_map(|radius| Embedding::Cylinder { radius }),
            (0.3..1.4, 1.5..4.0).prop_map(|(half_angle, to_apex)| Embedding::Cone { half_angle, to_apex }),
        ]
    }

    fn on_sheet() -> impl Strategy<Value = Point2<f64>> {
        (-0.7..0.7, -0.7..0.7).prop_map(|(x, y)| Point2::new(x, y))
    }

    proptest! {
        #[test]
        fn the_nearest_point_of_a_laid_point_is_itself(embedding in embeddings(), point in on_sheet()) {
            let back = embedding.flatten(embedding.lay(point));
            prop_assert!((back - point).norm() < 1e-12, "{back}");
        }

        #[test]
        fn no_point_nearby_is_nearer_than_the_nearest(
            embedding in embeddings(),
            point in on_sheet(),
            off in -0.2..0.2_f64,
            step in on_sheet(),
        ) {
            let laid = embedding.lay(point);
            let away = laid + nalgebra::Vector3::new(off, -off, 0.7 * off);
            let flat = embedding.flatten(away);
            let nearest = (embedding.lay(flat) - away).norm();
            let other = (embedding.lay(flat + step.coords * 0.1) - away).norm();
            prop_assert!(nearest <= other + 1e-12);
        }

        #[test]
        fn lengths_in_space_are_those_of_the_sheet_times_the_scale(
            embedding in embeddings(),
            point in on_sheet(),
            angle in 0.0..7.0_f64,
        ) {
            let step = Vector2::new(angle.cos(), angle.sin()) * 1e-6;
            let walked = (embedding.lay(point + step) - embedding.lay(point - step)).norm() / 2e-6;
            prop_assert!((walked / embedding.scale(point) - 1.0).abs() < 1e-8);
        }
    }

    #[test]
    fn every_surface_lies_face_up_round_its_axis() {
        let close = |a: Point3<f64>, b: [f64; 3]| assert!((a - Point3::from(b)).norm() < 1e-12, "{a} {b:?}");
        let hemisphere = Embedding::Hemisphere { radius: 2.0 };
        close(hemisphere.lay(Point2::origin()), [0.0, 0.0, 2.0]);
        close(hemisphere.lay(Point2::new(0.0, 2.0)), [0.0, 2.0, 0.0]);
        let cylinder = Embedding::Cylinder { radius: 2.0 };
        close(cylinder.lay(Point2::new(std::f64::consts::PI, 1.0)), [2.0, 1.0, 0.0]);
        // Half way up a cone of radii 3 and 1 and height 2: radius 2.
        let half_angle = 1.0_f64.atan();
        let cone = Embedding::Cone { half_angle, to_apex: 2.0 / half_angle.sin() };
        close(cone.lay(Point2::origin()), [0.0, 0.0, 2.0]);
        close(cone.lay(Point2::new(0.0, 2.0_f64.sqrt())), [0.0, 1.0, 1.0]);
    }
}
