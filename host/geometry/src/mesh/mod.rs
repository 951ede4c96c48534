//! Mesh: a skin as triangles, with its electrodes on the rim.

pub(crate) mod boundary;
pub mod export;
mod generate;
pub mod import;
pub mod neighbours;
pub mod place;
pub mod quality;
mod refine;
pub mod soundness;
pub mod triangle;
pub mod weld;

pub use generate::{Lattice, MeshError, generate};
use nalgebra::{Point3, Vector3};
pub use refine::refine;

/// Triangles in space; a flat skin has z = 0.
#[derive(Clone, Debug, PartialEq)]
pub struct Mesh {
    /// Corners, m: `[node]`.
    pub nodes: Vec<Point3<f64>>,
    /// Node numbers of each triangle: `[element]`. Their orientation never matters.
    pub elements: Vec<[usize; 3]>,
    /// Where each electrode touches: `[electrode]`.
    pub electrodes: Vec<ElectrodeContact>,
}

/// Where one electrode touches the mesh.
#[derive(Clone, Debug, PartialEq)]
pub enum ElectrodeContact {
    /// Point model: one node.
    Node(usize),
    /// Complete model: edges, of the rim or inside.
    Edges(Vec<[usize; 2]>),
    /// Complete model of an electrode inside the skin: triangles.
    Faces(Vec<[usize; 3]>),
}

impl ElectrodeContact {
    /// Nodes it touches; some more than once.
    pub fn nodes(&self) -> impl Iterator<Item = usize> + '_ {
        let (node, edges, faces) = match self {
            Self::Node(node) => (Some(*node), [].as_slice(), [].as_slice()),
            Self::Edges(edges) => (None, edges.as_slice(), [].as_slice()),
            Self::Faces(faces) => (None, [].as_slice(), faces.as_slice()),
        };
        node.into_iter().chain(edges.iter().flatten().copied()).chain(faces.iter().flatten().copied())
    }
}

impl Mesh {
    /// Corners of one element.
    #[must_use]
    pub fn corners(&self, element: usize) -> [Point3<f64>; 3] {
        self.points(self.elements[element])
    }

    /// The point of the mesh that is nearest to a place; the place itself where there are no elements.
    #[must_use]
    pub fn nearest(&self, place: Point3<f64>) -> Point3<f64> {
        let of = |element: usize| triangle::nearest(self.corners(element), place);
        let away = |point: &Point3<f64>| (point - place).norm_squared();
        let points = (0..self.elements.len()).map(of);
        points.min_by(|a, b| away(a).total_cmp(&away(b))).unwrap_or(place)
    }

    /// Where three nodes lie.
    #[must_use]
    pub fn points(&self, nodes: [usize; 3]) -> [Point3<f64>; 3] {
        nodes.map(|node| self.nodes[node])
    }

    /// Length of the edges under an electrode, or the diameter of a disc as large as its triangles, m.
    #[must_use]
    pub fn width(&self, contact: &ElectrodeContact) -> f64 {
        match contact {
            ElectrodeContact::Node(_) => 0.0,
            ElectrodeContact::Edges(edges) => {
                edges.iter().map(|&[a, b]| (self.nodes[a] - self.nodes[b]).norm()).sum()
            }
            ElectrodeContact::Faces(faces) => {
                let area: f64 = faces.iter().map(|&face| triangle::area(self.points(face))).sum();
                2.0 * (area / std::f64::consts::PI).sqrt()
            }
        }
    }

    /// Middle of an electrode: the mean of the nodes it touches, m.
    #[must_use]
    pub fn centre(&self, contact: &ElectrodeContact) -> Point3<f64> {
        let sum: Vector3<f64> = contact.nodes().map(|node| self.nodes[node].coords).sum();
        Point3::from(sum / contact.nodes().count().max(1) as f64)
    }
}
