//! Candidates: points of a skin where an electrode might lie, and their fields.

use crate::{
    forward::{Fields, ForwardModel},
    metrics::detectability::Sought,
    model::ModelError,
    pixels::{Pixels, Presses, element_patches},
    skin::{Shape, Skin},
};
use dermatome_geometry::{
    mesh::{ElectrodeContact, Lattice, Mesh, generate, soundness::inspect, triangle},
    sheet::{EdgeLengths, ElectrodeModel, Sheet},
};
use nalgebra::Point3;

/// Triangles of a mesh that is made for the search, about.
const ELEMENTS: f64 = 1800.0;
/// Pixels of the search.
const PIXELS: usize = 400;
/// Candidates inside and on the rim, about.
const INSIDE: f64 = 200.0;
const ON_RIM: f64 = 64.0;
/// Distance of two electrodes' centres, and of one inside from a boundary, in widths.
const APART: f64 = 1.4;
/// Distance of point electrodes, in roots of the skin's area.
const POINTS_APART: f64 = 0.02;

/// Points where an electrode might lie.
pub(super) struct Candidates {
    /// The search's mesh; each candidate is one of its nodes.
    pub(super) mesh: Mesh,
    /// Fields of point electrodes: `[candidate]`.
    pub(super) fields: Fields,
    /// Where each lies, m: `[candidate]`.
    pub(super) positions: Vec<Point3<f64>>,
    /// How many of them, the first, lie on the rim, in their order along it.
    pub(super) on_rim: usize,
    /// Pixels that the Jacobian is computed of.
    pub(super) pixels: Pixels,
    /// The press, all over the skin.
    pub(super) presses: Presses,
    /// Area of the skin, m^2.
    pub(super) area: f64,
    /// Width of an electrode, m.
    pub(super) width: f64,
    /// Least distance of two electrodes, m.
    apart: f64,
}

impl Candidates {
    pub(super) fn new(skin: &Skin, sought: &Sought) -> Result<Self, ModelError> {
        let mut mesh = mesh(skin)?;
        let area: f64 = (0..mesh.elements.len()).map(|element| triangle::area(mesh.corners(element))).sum();
        let width = (0..usize::from(skin.electrodes.count))
            .map(|electrode| skin.electrodes.model.width(electrode))
            .fold(0.0, f64::max);
        let apart = (APART * width).max(POINTS_APART * area.sqrt());
        let (rim, inside) = nodes(&mesh, apart, area);
        let chosen: Vec<usize> = rim.iter().chain(&inside).copied().collect();
        mesh.electrodes = chosen.iter().map(|&node| ElectrodeContact::Node(node)).collect();
        let forward = ForwardModel::new(&mesh, &vec![0.0; chosen.len()])?;
        let fields = forward.solve(&vec![1.0; mesh.elements.len()])?;
        let pixels = element_patches(&mesh, PIXELS);
        Ok(Self {
            fields,
            positions: chosen.iter().map(|&node| mesh.nodes[node]).collect(),
            on_rim: rim.len(),
            presses: pixels.presses(sought.radius),
            pixels,
            mesh,
            area,
            width,
            apart,
        })
    }

    /// Whether electrodes at both have room beside each other.
    pub(super) fn are_apart(&self, a: usize, b: usize) -> bool {
        (self.positions[a] - self.positions[b]).norm() >= self.apart
    }
}

/// An even mesh; of an imported one itself.
fn mesh(skin: &Skin) -> Result<Mesh, ModelError> {
    match &skin.shape {
        Shape::Sheet(sheet) => {
            let edge = (sheet.embedding.area(&sheet.outline) / (0.433 * ELEMENTS)).sqrt();
            let edges = EdgeLengths { skin: edge, electrodes: edge };
            let bare = Sheet { places: Vec::new(), ..sheet.clone() };
            Ok(generate(&bare, &ElectrodeModel::Point, edges, Lattice::default())?)
        }
        Shape::Mesh { mesh, .. } => Ok((**mesh).clone()),
    }
}

/// Nodes on the rim, in their order along it, and inside, clear of all boundaries; evenly thinned out.
fn nodes(mesh: &Mesh, apart: f64, area: f64) -> (Vec<usize>, Vec<usize>) {
    let at = |node: usize| mesh.nodes[node];
    let loops = inspect(&mesh.nodes, &mesh.elements).boundary_loops;
    let boundary: Vec<usize> = loops.iter().flatten().copied().collect();
    let rim = loops.first().map_or_else(Vec::new, |rim| {
        let length: f64 =
            rim.iter().zip(rim.iter().cycle().skip(1)).map(|(&a, &b)| (at(a) - at(b)).norm()).sum();
        thinned(mesh, rim.iter().copied(), length / ON_RIM)
    });
    let is_clear = |&node: &usize| boundary.iter().all(|&other| (at(node) - at(other)).norm() >= apart);
    let inside = (0..mesh.nodes.len()).filter(is_clear);
    (rim, thinned(mesh, inside, (area / INSIDE).sqrt()))
}

/// The first node, and each that is not closer than this to one before.
fn thinned(mesh: &Mesh, nodes: impl Iterator<Item = usize>, least: f64) -> Vec<usize> {
    let mut kept: Vec<usize> = Vec::new();
    for node in nodes {
        if kept.iter().all(|&other| (mesh.nodes[node] - mesh.nodes[other]).norm() >= 0.9 * least) {
            kept.push(node);
        }
    }
    kept
}
