//! Shape: a body with electrodes on it, a sheet yet to be meshed or a mesh that was made elsewhere, and how it looks
//! from above, along z.

use crate::{
    embedding::Embedding,
    mesh::{
        Mesh,
        soundness::{Soundness, inspect},
    },
    outline::Outline,
    sheet::{Place, Sheet},
};
use nalgebra::{Point2, Point3, Vector3};
use std::borrow::Cow;

/// Points of a rim that is not a polygon, from which its shadow is drawn.
const RIM_POINTS: u32 = 240;
/// An electrode closer to the rim's shadow than this share of the skin's diameter lies on it.
const ON_RIM: f64 = 0.02;
/// Coordinates that differ by less than this share of the diagonal are the same.
const FLAT: f64 = 1e-9;

/// Shape of a skin.
#[derive(Clone, Debug, PartialEq)]
pub enum Shape {
    /// A sheet, to be meshed.
    Sheet(Sheet),
    /// A mesh that was made elsewhere.
    Mesh {
        /// Nodes, elements, and the electrodes on them.
        mesh: Box<Mesh>,
        /// Rim of the mesh if all of it lies in the plane z = 0.
        outline: Option<Outline>,
    },
}

/// A skin that is not flat where only a flat one will do.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error(
    "`shape` is curved, or its rim as seen from above crosses itself: pixel grids (`image.columns`) need a flat \
     skin, simulated fingers and `--flatten` one that lies open from above"
)]
pub struct NotFlat;

impl Shape {
    /// Shape of a mesh whose boundary is known from its soundness.
    #[must_use]
    pub fn imported(mesh: Mesh, soundness: &Soundness) -> Self {
        let outline = flat_outline(&mesh.nodes, soundness);
        Self::Mesh { mesh: Box::new(mesh), outline }
    }

    /// Rim of a flat skin.
    pub fn flat(&self) -> Result<&Outline, NotFlat> {
        match self {
            Self::Sheet(Sheet { outline, embedding: Embedding::Flat, .. })
            | Self::Mesh { outline: Some(outline), .. } => Ok(outline),
            _ => Err(NotFlat),
        }
    }

    /// Centre of each electrode, m: `[electrode]`.
    #[must_use]
    pub fn electrode_centres(&self) -> Vec<Point3<f64>> {
        match self {
            Self::Sheet(sheet) => sheet.places.iter().map(|place| sheet.centre(place)).collect(),
            Self::Mesh { mesh, .. } => mesh.electrodes.iter().map(|contact| mesh.centre(contact)).collect(),
        }
    }

    /// Rim of the skin as seen from above: of a flat skin its own. A skin whose rim crosses itself there,
    /// or that has none, is refused.
    pub fn from_above(&self) -> Result<Cow<'_, Outline>, NotFlat> {
        match self {
            // The rim of half a sphere is that of its development.
            Self::Sheet(Sheet {
                outline, embedding: Embedding::Flat | Embedding::Hemisphere { .. }, ..
            })
            | Self::Mesh { outline: Some(outline), .. } => Ok(Cow::Borrowed(outline)),
            Self::Sheet(sheet) => shadow(&laid_rim(sheet)),
            Self::Mesh { mesh, .. } => shadow(&longest_boundary(mesh)),
        }
    }

    /// The flat skin of the same rim and electrodes, seen from above: z is dropped.
    pub fn flattened(&self) -> Result<Self, NotFlat> {
        let outline = self.from_above()?.into_owned();
        let centres = self.electrode_centres();
        let place = |electrode: usize| match self {
            Self::Sheet(Sheet {
                places, embedding: Embedding::Flat | Embedding::Hemisphere { .. }, ..
            }) if matches!(places[electrode], Place::Rim(_)) => places[electrode],
            _ => place_on(&outline, centres[electrode].xy()),
        };
        let places = (0..centres.len()).map(place).collect();
        Ok(Self::Sheet(Sheet { outline, embedding: Embedding::Flat, places }))
    }
}

/// Centre of each electrode as seen from above, m: `[electrode]`.
#[must_use]
pub fn electrodes_in_plane(shape: &Shape) -> Vec<[f64; 2]> {
    shape.electrode_centres().iter().map(|centre| [centre.x, centre.y]).collect()
}

/// Diagonal of the box round some points, m.
#[must_use]
pub fn diagonal(nodes: &[Point3<f64>]) -> f64 {
    let first = nodes.first().map_or(Vector3::zeros(), |node| node.coords);
    let (low, high) = nodes
        .iter()
        .fold((first, first), |(low, high), node| (low.inf(&node.coords), high.sup(&node.coords)));
    (high - low).norm()
}

/// Rim and holes of a mesh in the plane z = 0; none of a mesh in space, or of one whose boundary is
/// too long to be an outline.
fn flat_outline(nodes: &[Point3<f64>], soundness: &Soundness) -> Option<Outline> {
    let diagonal = diagonal(nodes);
    if nodes.iter().any(|node| node.z.abs() > FLAT * diagonal) {
        return None;
    }
    let corners =
        |order: &Vec<usize>| corners(&order.iter().map(|&node| nodes[node].xy()).collect::<Vec<_>>());
    let loops: Vec<Vec<Point2<f64>>> = soundness.boundary_loops.iter().map(corners).collect();
    let (rim, holes) = loops.split_first()?;
    Outline::polygon(rim, holes).ok()
}

/// The points of a closed line at which it bends.
fn corners(points: &[Point2<f64>]) -> Vec<Point2<f64>> {
    let count = points.len();
    let bends = |&i: &usize| {
        let (before, after) =
            (points[i] - points[(i + count - 1) % count], points[(i + 1) % count] - points[i]);
        before.perp(&after).abs() > 1e-9 * before.norm() * after.norm()
    };
    (0..count).filter(bends).map(|i| points[i]).collect()
}

fn laid_rim(sheet: &Sheet) -> Vec<Point2<f64>> {
    let step = sheet.outline.perimeter() / f64::from(RIM_POINTS);
    let at = |i: u32| sheet.embedding.lay(sheet.outline.rim_point(f64::from(i) * step)).xy();
    (0..RIM_POINTS).map(at).collect()
}

fn longest_boundary(mesh: &Mesh) -> Vec<Point2<f64>> {
    let loops = inspect(&mesh.nodes, &mesh.elements).boundary_loops;
    loops.first().map_or(Vec::new(), |order| order.iter().map(|&node| mesh.nodes[node].xy()).collect())
}

fn shadow(rim: &[Point2<f64>]) -> Result<Cow<'static, Outline>, NotFlat> {
    Outline::polygon(rim, &[]).map(Cow::Owned).map_err(|_| NotFlat)
}

/// On the rim if it is close to it, at the nearest of many arc lengths; else inside.
fn place_on(outline: &Outline, point: Point2<f64>) -> Place {
    let steps = 40 * RIM_POINTS;
    let at = |i: u32| f64::from(i) * outline.perimeter() / f64::from(steps);
    let distance = |i: u32| (outline.rim_point(at(i)) - point).norm();
    let nearest = (0..steps).min_by(|&a, &b| distance(a).total_cmp(&distance(b))).unwrap_or(0);
    if distance(nearest) < ON_RIM * outline.diameter() {
        Place::Rim(at(nearest))
    } else {
        Place::Inside(point)
    }
}
