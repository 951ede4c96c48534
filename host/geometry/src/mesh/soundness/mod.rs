//! Whether triangles are a surface that a forward model can stand on.
//!
//! Faults are things that no skin can have; each makes [`require_sound`] refuse the mesh by name.
//! Notes are things that a skin may have but that often are mistakes: holes, no rim at all, triangles
//! of both orientations.

mod fault;

use super::{
    boundary::{self, DisjointSets},
    neighbours::{self, Edge},
    triangle, weld,
};
pub use fault::{MeshFault, Triangle};
use nalgebra::Point3;
use rayon::prelude::*;
use serde::Serialize;

/// Triangles with a smaller angle are degenerate, degrees.
pub const SMALLEST_ANGLE_DEGREES: f64 = 0.01;
/// Most edges around a hole that may be a crack: a few triangles are missing, or nodes are not welded.
pub const MOST_CRACK_EDGES: usize = 10;
/// Such cracks are shorter than this share of the longest boundary loop or of the bounding box's
/// diagonal, whichever is longer. A hole of three edges is a crack of any length: one missing triangle.
pub const LONGEST_CRACK: f64 = 0.02;
/// Nodes of the boundary closer than this share of its bounding box's diagonal are one place.
const SEAM_TOLERANCE: f64 = 1e-6;

/// What is wrong or strange with a mesh. All numbers count from 0.
///
/// With an unknown node or one that is not finite, nothing further is looked at.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Soundness {
    /// Fault: triangles that name a node that is not there.
    pub unknown_nodes: Vec<usize>,
    /// Fault: nodes with a coordinate that is not a number, infinite, or too large to be squared.
    pub not_finite: Vec<usize>,
    /// Fault: triangles with a repeated node or an angle below [`SMALLEST_ANGLE_DEGREES`].
    pub degenerate: Vec<usize>,
    /// Fault: triangles on the same three nodes: the first, and another.
    pub duplicates: Vec<[usize; 2]>,
    /// Fault: edges with more than two triangles.
    pub non_manifold: Vec<NonManifoldEdge>,
    /// Fault: nodes of no triangle.
    pub loose_nodes: Vec<usize>,
    /// Parts that share no node, the largest first. Fault: more than one.
    pub parts: Vec<Part>,
    /// Fault: nodes that are all that holds two fans of triangles together.
    pub bow_ties: Vec<usize>,
    /// Edges with one triangle: nodes along each loop in order, the longest loop first.
    #[serde(skip)]
    pub boundary_loops: Vec<Vec<usize>>,
    /// Number of edges and length of each of `boundary_loops`. Those behind the first are holes.
    pub boundaries: Vec<Boundary>,
    /// Fault unless allowed: which of `boundary_loops` are cracks, see [`MOST_CRACK_EDGES`] and
    /// [`LONGEST_CRACK`].
    pub cracks: Vec<usize>,
    /// Fault unless allowed: nodes of the boundary at one place, which leave the mesh open along a seam.
    pub seams: Vec<[usize; 2]>,
    /// Note: how many triangles would have to be turned over for all to have the same orientation.
    pub flipped: usize,
    /// Note: no turning over helps, as on a Moebius strip. `flipped` then means little.
    pub one_sided: bool,
}

/// An edge with more than two triangles.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct NonManifoldEdge {
    /// Its nodes.
    pub nodes: [usize; 2],
    /// Its triangles.
    pub elements: Vec<usize>,
}

/// Triangles that hang together.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub struct Part {
    /// Number of triangles.
    pub elements: usize,
    /// The first of them.
    pub first: usize,
}

/// A loop of edges with one triangle.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Boundary {
    /// Number of edges.
    pub edges: usize,
    /// Length, in the mesh's unit.
    pub length: f64,
}

/// Looks for everything that may be wrong.
#[must_use]
pub fn inspect(nodes: &[Point3<f64>], elements: &[[usize; 3]]) -> Soundness {
    let unknown = |corners: &[usize; 3]| corners.iter().any(|&node| node >= nodes.len());
    let mut found = Soundness {
        unknown_nodes: places(elements, unknown),
        not_finite: places(nodes, |node| !node.coords.norm_squared().is_finite()),
        ..Soundness::default()
    };
    if found.unknown_nodes.is_empty() && found.not_finite.is_empty() {
        found.inspect_triangles(nodes, elements);
        found.inspect_edges(nodes, elements);
    }
    found
}

/// [`inspect`], and refuses a mesh with a fault. `allow_cracks` lets tiny holes and open seams pass.
pub fn require_sound(
    nodes: &[Point3<f64>],
    elements: &[[usize; 3]],
    allow_cracks: bool,
) -> Result<Soundness, MeshFault> {
    let found = inspect(nodes, elements);
    match MeshFault::first(&found, nodes, elements, allow_cracks) {
        Some(fault) => Err(fault),
        None => Ok(found),
    }
}

impl Soundness {
    /// Loops of the boundary behind the longest.
    #[must_use]
    pub fn holes(&self) -> &[Boundary] {
        self.boundaries.get(1..).unwrap_or_default()
    }

    /// What is strange in words, one line each; lengths are in the mesh's unit, which is metres but
    /// for meshes straight from a file. Of the faults it holds those that do not keep a mesh from
    /// being generated: degenerate triangles and edges with more than two.
    #[must_use]
    pub fn notes(&self) -> Vec<String> {
        let mut notes = Vec::new();
        for (count, what) in [
            (self.degenerate.len(), "degenerate triangles"),
            (self.non_manifold.len(), "edges with more than two triangles"),
        ] {
            if count > 0 {
                notes.push(format!("number of {what}: {count}"));
            }
        }
        if self.boundaries.is_empty() {
            notes.push("the surface is closed: it has no rim".to_owned());
        }
        for Boundary { edges, length } in self.holes() {
            notes.push(format!("a hole of {edges} edges, {} m around", fault::six_digits(*length)));
        }
        if self.one_sided {
            notes.push("the surface has only one side, like a Moebius strip".to_owned());
        } else if self.flipped > 0 {
            notes.push(format!(
                "number of triangles flipped against the others: {}; it does not matter",
                self.flipped
            ));
        }
        if !self.seams.is_empty() {
            notes.push(format!(
                "number of places with two nodes of the rim, open seams: {}",
                self.seams.len()
            ));
        }
        notes
    }

    fn inspect_triangles(&mut self, nodes: &[Point3<f64>], elements: &[[usize; 3]]) {
        let least = SMALLEST_ANGLE_DEGREES.to_radians();
        let is_degenerate = |&[a, b, c]: &[usize; 3]| {
            a == b || b == c || c == a || triangle::smallest_angle([nodes[a], nodes[b], nodes[c]]) < least
        };
        self.degenerate = places(elements, is_degenerate);
        self.duplicates = duplicates(elements);
        let mut loose = vec![true; nodes.len()];
        elements.iter().flatten().for_each(|&node| loose[node] = false);
        self.loose_nodes = places(&loose, |&loose| loose);
        self.parts = parts(nodes.len(), elements);
    }

    fn inspect_edges(&mut self, nodes: &[Point3<f64>], elements: &[[usize; 3]]) {
        let mut edges = neighbours::edges(elements);
        let signs = neighbours::orientation_over(&edges, elements.len());
        // What a triangle that repeats a node has instead of an edge is left out.
        edges.retain(|edge| edge.nodes()[0] != edge.nodes()[1]);
        self.non_manifold = non_manifold(&edges);
        self.flipped = signs.iter().filter(|&&sign| sign < 0.0).count();
        self.one_sided = is_one_sided(&edges, &signs);
        let mut fans = boundary::fans(&edges, elements);
        self.bow_ties = bow_ties(nodes.len(), elements, &mut fans);
        self.measure_boundary(nodes, boundary::boundary_loops(&edges, elements, &mut fans));
    }

    fn measure_boundary(&mut self, nodes: &[Point3<f64>], loops: Vec<Vec<usize>>) {
        let length = |around: &[usize]| -> f64 {
            let next = around.iter().cycle().skip(1);
            around.iter().zip(next).map(|(&a, &b)| (nodes[a] - nodes[b]).norm()).sum()
        };
        let mut measured: Vec<_> = loops.into_iter().map(|around| (length(&around), around)).collect();
        // Stable: equally long ones stay in the order of their lowest node.
        measured.sort_by(|a, b| b.0.total_cmp(&a.0));
        self.seams = seams(nodes, measured.iter().flat_map(|(_, around)| around));
        for (length, around) in measured {
            self.boundaries.push(Boundary { edges: around.len(), length });
            self.boundary_loops.push(around);
        }
        let longest = self.boundaries.first().map_or(0.0, |first| first.length).max(diagonal(nodes));
        let tiny = |it: &Boundary| it.edges <= MOST_CRACK_EDGES && it.length < LONGEST_CRACK * longest;
        let all = self.boundaries.iter().enumerate();
        let cracks = all.filter(|(place, it)| tiny(it) || *place > 0 && it.edges == 3);
        self.cracks = cracks.map(|(place, _)| place).collect();
    }
}

/// Where in a list something holds.
fn places<T>(list: &[T], holds: impl Fn(&T) -> bool) -> Vec<usize> {
    list.iter().enumerate().filter(|(_, item)| holds(item)).map(|(place, _)| place).collect()
}

fn duplicates(elements: &[[usize; 3]]) -> Vec<[usize; 2]> {
    let sorted = |(element, &corners): (usize, &[usize; 3])| {
        let mut corners = corners;
        corners.sort_unstable();
        (corners, element)
    };
    let mut by_corners: Vec<_> = elements.iter().enumerate().map(sorted).collect();
    by_corners.par_sort_unstable();
    let same = by_corners.chunk_by(|a, b| a.0 == b.0);
    let mut pairs: Vec<_> =
        same.flat_map(|same| same[1..].iter().map(|other| [same[0].1, other.1])).collect();
    pairs.sort_unstable();
    pairs
}

fn parts(nodes: usize, elements: &[[usize; 3]]) -> Vec<Part> {
    let mut sets = DisjointSets::new(nodes);
    for &[a, b, c] in elements {
        sets.join(a, b);
        sets.join(b, c);
    }
    let mut by_set = vec![Part { elements: 0, first: 0 }; nodes];
    for (element, corners) in elements.iter().enumerate() {
        let part = &mut by_set[sets.find(corners[0])];
        if part.elements == 0 {
            part.first = element;
        }
        part.elements += 1;
    }
    by_set.retain(|part| part.elements > 0);
    by_set.sort_by_key(|part| (std::cmp::Reverse(part.elements), part.first));
    by_set
}

fn non_manifold(edges: &[Edge]) -> Vec<NonManifoldEdge> {
    let crowded = edges.chunk_by(|a, b| a.nodes() == b.nodes()).filter(|edges| edges.len() > 2);
    let edge = |edges: &[Edge]| NonManifoldEdge {
        nodes: edges[0].nodes(),
        elements: edges.iter().map(Edge::element).collect(),
    };
    crowded.map(edge).collect()
}

/// Whether neighbours lie differently although all that could was turned over, see
/// [`neighbours::orientation`].
fn is_one_sided(edges: &[Edge], signs: &[f64]) -> bool {
    let mut pairs = edges.chunk_by(|a, b| a.nodes() == b.nodes()).filter(|edges| edges.len() == 2);
    pairs.any(|pair| {
        // Neighbours alike pass their edge in opposite directions.
        let alike = pair[0].ascending != pair[1].ascending;
        alike != (signs[pair[0].element()] == signs[pair[1].element()])
    })
}

/// Nodes with more than one fan.
fn bow_ties(nodes: usize, elements: &[[usize; 3]], fans: &mut DisjointSets) -> Vec<usize> {
    let mut count = vec![0; nodes];
    for (corner, &node) in elements.iter().flatten().enumerate() {
        count[node] += usize::from(fans.find(corner) == corner);
    }
    places(&count, |&count| count > 1)
}

/// Pairs of different nodes on the boundary that lie at one place.
fn seams<'a>(nodes: &[Point3<f64>], boundary: impl Iterator<Item = &'a usize>) -> Vec<[usize; 2]> {
    let mut boundary: Vec<_> = boundary.copied().collect();
    boundary.sort_unstable();
    boundary.dedup();
    let points: Vec<_> = boundary.iter().map(|&node| nodes[node]).collect();
    let places = weld::weld(&points, SEAM_TOLERANCE).numbers;
    let mut first_at = Vec::new();
    let mut pairs = Vec::new();
    for (&node, place) in boundary.iter().zip(places) {
        if place == first_at.len() { first_at.push(node) } else { pairs.push([first_at[place], node]) }
    }
    pairs
}

fn diagonal(nodes: &[Point3<f64>]) -> f64 {
    let Some(&start) = nodes.first() else { return 0.0 };
    let low = nodes.iter().fold(start, |low, node| low.inf(node));
    let high = nodes.iter().fold(start, |high, node| high.sup(node));
    (high - low).norm()
}

#[cfg(test)]
mod tests;
