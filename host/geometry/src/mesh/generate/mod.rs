//! Generates the mesh of a sheet in its flat development.
//!
//! Nodes that must be there come first: on the rims, so that corners and electrodes are honoured, and
//! at electrodes inside ([`skeleton`]). They say how long edges may be anywhere ([`size_field`]). A
//! triangular lattice, finer where edges are to be shorter, fills the rest ([`lattice`]). A
//! constrained Delaunay triangulation (crate spade) joins both, and inner nodes are smoothed
//! ([`triangulate`]). Where the development stretches in space it does so alike in all directions,
//! so good triangles stay good ones.

mod lattice;
mod paths;
mod polish;
mod size_field;
mod skeleton;
mod sources;
mod triangulate;

use super::{ElectrodeContact, Mesh};
use crate::{
    outline::Curve,
    sheet::{EdgeLengths, ElectrodeModel, Sheet},
};
use nalgebra::Point2;
use size_field::{SizeField, flattened};
use skeleton::{Skeleton, Touch};
use sources::MOST_ACROSS;

/// How the inner points lie: turned and shifted against the axes, so that two meshes of one skin
/// need not share a node.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Lattice {
    /// Turn against the x axis, rad.
    pub angle: f64,
    /// Shift along both lattice directions, in edge lengths.
    pub shift: f64,
}

/// Why no mesh could be made.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum MeshError {
    /// The triangulation refused a point.
    #[error("the mesh generator cannot place a point: {0}")]
    Point(String),
    /// More nodes than the rest could work with.
    #[error(
        "the mesh would have more than {MOST_NODES} nodes; allowed: a longer `mesh.electrode_edge_length`, \
         `mesh.edge_length`, or electrodes further apart"
    )]
    TooManyNodes,
    /// More narrow places than the rest could work with.
    #[error(
        "the skin is narrow in more than {MOST_ACROSS} places; allowed: a shorter `mesh.edge_length`, or fewer corners, \
         spikes and notches in `shape.points` and `shape.holes`"
    )]
    TooNarrow,
    /// The triangles do not cover the skin.
    #[error(
        "the mesh covers {covered:.9} of the skin's area where 1 is expected; try another mesh.edge_length"
    )]
    Coverage {
        /// Share of the area covered.
        covered: f64,
    },
    /// An edge of a rim or of an electrode is not there.
    #[error("the mesh lacks the edge of a rim at x = {x:.6} m, y = {y:.6} m; try another mesh.edge_length")]
    Rim {
        /// Where its first end lies in the flat sheet.
        x: f64,
        /// Where its first end lies in the flat sheet.
        y: f64,
    },
}

/// Nodes that a mesh may have: about three million elements.
const MOST_NODES: usize = 1_500_000;

/// Mesh of a sheet, with the electrodes of `model` on it.
pub fn generate(
    sheet: &Sheet,
    model: &ElectrodeModel,
    edges: EdgeLengths,
    lattice: Lattice,
) -> Result<Mesh, MeshError> {
    let skeleton = Skeleton::new(sheet, model, edges)?;
    let size_field = SizeField::new(flattened(edges.skin, sheet), skeleton.sources());
    let mut points = skeleton.points.clone();
    points.extend(lattice::inner_points(&skeleton, &size_field, lattice)?);
    let elements = triangulate::triangulate(&skeleton, &mut points)?;
    let electrodes = skeleton.touches.iter().map(|touch| contact(touch, &points, &elements)).collect();
    let nodes = points.iter().map(|&point| sheet.embedding.lay(point)).collect();
    Ok(Mesh { nodes, elements, electrodes })
}

fn contact(touch: &Touch, points: &[Point2<f64>], elements: &[[usize; 3]]) -> ElectrodeContact {
    match touch {
        Touch::Node(node) => ElectrodeContact::Node(*node),
        Touch::Edges(edges) => ElectrodeContact::Edges(edges.clone()),
        Touch::Disc(nodes) => {
            let rim = Curve::polygon(&points[nodes.clone()]);
            let covered = elements.iter().filter(|element| rim.encloses(middle(points, element)));
            ElectrodeContact::Faces(covered.copied().collect())
        }
    }
}

fn middle(points: &[Point2<f64>], element: &[usize; 3]) -> Point2<f64> {
    let [a, b, c] = element.map(|node| points[node].coords);
    Point2::from((a + b + c) / 3.0)
}

#[cfg(test)]
mod tests;
