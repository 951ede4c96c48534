//! What is cut out of a link, and how far each of its points lies from the cut.

use super::{error::CutError, geodesic, shell::bounds, surface::Surface};
use crate::{mesh::triangle, outline::Outline};
use nalgebra::{Isometry3, Point2, Point3, Rotation3, Translation3, UnitQuaternion, Vector3};

/// What is cut out of a link.
#[derive(Clone, Debug, PartialEq)]
pub enum Region {
    /// All points no further away than `radius` over the surface, m.
    Disc {
        /// Length of the shortest ways to the boundary, m.
        radius: f64,
    },
    /// What lies between two parallel planes, or several pairs.
    Slabs(Vec<Slab>),
    /// What a cutter of this outline cuts that is pressed down along the polygon's normal.
    Polygon(Cutter),
}

/// What lies between two parallel planes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Slab {
    normal: Vector3<f64>,
    from: f64,
    to: f64,
}

/// A polygon in space, in its own plane.
#[derive(Clone, Debug, PartialEq)]
pub struct Cutter {
    outline: Outline,
    to_plane: Isometry3<f64>,
}

/// Share of the region's size that the cut may be coarse.
const CUT_FINENESS: f64 = 0.0125;

impl Slab {
    /// Points p with `from` <= p . normal / |normal| <= `to`, m.
    pub fn new(normal: Vector3<f64>, from: f64, to: f64) -> Result<Self, CutError> {
        let refuse = |value: String, allowed: &str| {
            Err(CutError::Value { option: "between_planes", value, allowed: allowed.to_owned() })
        };
        match normal.try_normalize(1e-12) {
            Some(normal)
                if normal.iter().all(|it| it.is_finite()) && from < to && (to - from).is_finite() =>
            {
                Ok(Self { normal, from, to })
            }
            Some(_) => refuse(format!("from {from} m to {to} m"), "finite, the second above the first"),
            None => {
                let [x, y, z] = normal.into();
                refuse(format!("a normal of {x}, {y}, {z}"), "a normal with a length")
            }
        }
    }

    fn depth(&self, point: Point3<f64>) -> f64 {
        let along = self.normal.dot(&point.coords);
        (along - self.from).min(self.to - along)
    }
}

impl Cutter {
    /// A cutter through these corners; they need not lie in one plane exactly.
    pub fn new(corners: &[Point3<f64>]) -> Result<Self, CutError> {
        let centre =
            corners.iter().map(|corner| corner.coords).sum::<Vector3<f64>>() / corners.len().max(1) as f64;
        let normal: Vector3<f64> = (0..corners.len())
            .map(|i| (corners[i].coords - centre).cross(&(corners[(i + 1) % corners.len()].coords - centre)))
            .sum();
        // A polygon without area is turned anyhow, and refused as an outline.
        let rotation = Rotation3::rotation_between(&normal, &Vector3::z())
            .unwrap_or_else(|| Rotation3::from_axis_angle(&Vector3::x_axis(), std::f64::consts::PI));
        let to_plane = UnitQuaternion::from_rotation_matrix(&rotation) * Translation3::from(-centre);
        let flat: Vec<Point2<f64>> = corners.iter().map(|corner| (to_plane * corner).xy()).collect();
        let outline = Outline::polygon(&flat, &[]).map_err(CutError::Polygon)?;
        Ok(Self { outline, to_plane })
    }
}

impl Region {
    /// The option that says it.
    pub(super) fn option(&self) -> &'static str {
        match self {
            Self::Disc { .. } => "radius",
            Self::Slabs(_) => "between_planes",
            Self::Polygon(_) => "polygon",
        }
    }

    /// Refuses a radius that is none, and planes that do not meet the link.
    pub(super) fn check(&self, nodes: &[Point3<f64>]) -> Result<(), CutError> {
        match self {
            Self::Disc { radius } if !(*radius > 0.0 && radius.is_finite()) => Err(CutError::Value {
                option: "radius",
                value: format!("{radius} m"),
                allowed: "a length above zero".to_owned(),
            }),
            Self::Disc { .. } | Self::Polygon(_) => Ok(()),
            Self::Slabs(slabs) => slabs.iter().try_for_each(|slab| {
                let along = || nodes.iter().map(|node| slab.normal.dot(&node.coords));
                let spanned =
                    [along().fold(f64::INFINITY, f64::min), along().fold(f64::NEG_INFINITY, f64::max)];
                let meets = slab.from < spanned[1] && slab.to > spanned[0];
                let missed = CutError::PlanesMiss { asked: [slab.from, slab.to], spanned };
                if meets { Ok(()) } else { Err(missed) }
            }),
        }
    }

    /// Whether the region may reach a triangle; a cutout round `seed` has no part of others.
    pub(super) fn touches(&self, seed: Point3<f64>, corners: &[Point3<f64>; 3]) -> bool {
        match self {
            // A way over the surface is not shorter than the straight one.
            Self::Disc { radius } => {
                (triangle::nearest(*corners, seed) - seed).norm() <= radius * (1.0 + CUT_FINENESS)
            }
            Self::Slabs(slabs) => slabs.iter().all(|slab| {
                let along = corners.map(|corner| slab.normal.dot(&corner.coords));
                along.iter().any(|&it| it > slab.from) && along.iter().any(|&it| it < slab.to)
            }),
            Self::Polygon(cutter) => {
                let [low, high] = cutter.outline.bounds();
                let flat = corners.map(|corner| cutter.to_plane * corner);
                (0..2).all(|axis| {
                    flat.iter().any(|it| it[axis] > low[axis]) && flat.iter().any(|it| it[axis] < high[axis])
                })
            }
        }
    }

    /// Longest edge of the triangles on which the cut is made, m.
    pub(super) fn cut_edge(&self, crop: &Surface) -> f64 {
        match self {
            Self::Disc { radius } => 2.0 * CUT_FINENESS * radius,
            Self::Slabs(slabs) => {
                let [low, high] = bounds(&crop.points);
                let thinnest = slabs.iter().map(|slab| slab.to - slab.from).fold(f64::INFINITY, f64::min);
                (CUT_FINENESS * (high - low).norm()).min(5.0 * CUT_FINENESS * thinnest)
            }
            Self::Polygon(cutter) => CUT_FINENESS * cutter.outline.diameter(),
        }
    }

    /// How far each node lies outside the region, m; negative inside. `face` is one with the seed.
    pub(super) fn field(&self, surface: &Surface, face: [usize; 3], seed: Point3<f64>) -> Vec<f64> {
        match self {
            Self::Disc { radius } => {
                let distances = geodesic::distances(surface, face, seed, 1.1 * radius);
                // Infinite where nobody went; finite, for the cut divides by differences.
                distances.into_iter().map(|it| it.min(10.0 * radius) - radius).collect()
            }
            Self::Slabs(slabs) => {
                let depth = |&point: &Point3<f64>| {
                    slabs.iter().map(|slab| slab.depth(point)).fold(f64::INFINITY, f64::min)
                };
                surface.points.iter().map(|point| -depth(point)).collect()
            }
            Self::Polygon(cutter) => {
                let depth = |&point: &Point3<f64>| cutter.outline.depth((cutter.to_plane * point).xy());
                surface.points.iter().map(|point| -depth(point)).collect()
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_polygon_is_pressed_down_along_its_own_normal() {
        let corners = [[0.0, 0.0, 1.0], [0.0, 2.0, 1.0], [0.0, 2.0, 3.0], [0.0, 0.0, 3.0]];
        let cutter = Cutter::new(&corners.map(Point3::from)).unwrap();
        let region = Region::Polygon(cutter);
        let inside = [[5.0, 0.5, 2.0], [5.0, 0.6, 2.0], [5.0, 0.5, 2.2]].map(Point3::from);
        let outside = [[5.0, 2.5, 2.0], [5.0, 2.6, 2.0], [5.0, 2.5, 2.2]].map(Point3::from);
        assert!(region.touches(Point3::origin(), &inside) && !region.touches(Point3::origin(), &outside));
        let surface = Surface::new(inside.to_vec(), vec![[0, 1, 2]]);
        let field = region.field(&surface, [0, 1, 2], inside[0]);
        assert!((field[0] + 0.5).abs() < 1e-12 && (field[1] + 0.6).abs() < 1e-12, "{field:?}");
    }

    #[test]
    fn what_is_no_polygon_and_no_slab_is_refused() {
        let crossing = [[0.0, 0.0, 0.0], [2.0, 1.0, 0.0], [2.0, 0.0, 0.0], [0.0, 1.5, 0.0]].map(Point3::from);
        let error = Cutter::new(&crossing).unwrap_err().to_string();
        assert!(error.contains("`polygon`") && error.contains("cross"), "{error}");
        let line = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [2.0, 0.0, 0.0]].map(Point3::from);
        assert!(Cutter::new(&line).is_err() && Cutter::new(&[]).is_err());
        assert!(Slab::new(Vector3::z(), 1.0, 1.0).is_err() && Slab::new(Vector3::zeros(), 0.0, 1.0).is_err());
        assert!(Slab::new(Vector3::z(), f64::NAN, 1.0).is_err());
    }
}
