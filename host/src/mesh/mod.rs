//! Mesh: a skin as triangles, with its electrodes on the rim.

mod generate;
pub mod quality;
pub mod triangle;

pub use generate::{Lattice, MeshError, generate};
use nalgebra::Point3;

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
    /// Complete model: edges of the rim.
    Edges(Vec<[usize; 2]>),
}

impl Mesh {
    /// Corners of one element.
    #[must_use]
    pub fn corners(&self, element: usize) -> [Point3<f64>; 3] {
        self.elements[element].map(|node| self.nodes[node])
    }
}
