//! The first reason why a mesh cannot be used.

use super::Soundness;
use nalgebra::Point3;
use std::fmt;

/// A triangle as a message names it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Triangle {
    /// Its number, from 0.
    pub number: usize,
    /// Its corners, in the mesh's unit.
    pub corners: [Point3<f64>; 3],
}

/// Why a mesh cannot be used. Numbers count from 0.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum MeshFault {
    /// No triangles.
    #[error("the mesh has no triangle")]
    Empty,
    /// A triangle names a node that is not there.
    #[error("triangle {element} names node {node}; the mesh has {nodes} nodes, counted from 0")]
    UnknownNode {
        /// The triangle.
        element: usize,
        /// What it names.
        node: usize,
        /// How many nodes there are.
        nodes: usize,
    },
    /// A coordinate is not a number, infinite, or too large to be squared.
    #[error("node {node} lies at {}; all coordinates must be finite", Shown(*.at))]
    NotFinite {
        /// The node.
        node: usize,
        /// Where it lies.
        at: Point3<f64>,
    },
    /// A triangle without area.
    #[error("{triangle} is degenerate: it has no area, or an angle below {} degrees; {}",
        super::SMALLEST_ANGLE_DEGREES, Others(*.others))]
    Degenerate {
        /// The first such triangle.
        triangle: Triangle,
        /// How many more there are.
        others: usize,
    },
    /// Two triangles on the same nodes.
    #[error("{triangle} has the same corners as triangle {first}; {}", Others(*.others))]
    Duplicate {
        /// The second of the two.
        triangle: Triangle,
        /// The first of the two.
        first: usize,
        /// How many more there are.
        others: usize,
    },
    /// An edge with more than two triangles.
    #[error(
        "{count} triangles share the edge between nodes {} and {}, at most 2 may; one is {triangle}; {}",
        .nodes[0], .nodes[1], Others(*.others)
    )]
    NonManifold {
        /// Nodes of the edge.
        nodes: [usize; 2],
        /// How many triangles it has.
        count: usize,
        /// The last of them.
        triangle: Triangle,
        /// How many more such edges there are.
        others: usize,
    },
    /// A node of no triangle.
    #[error("node {node} at {} is the corner of no triangle; {}", Shown(*.at), Others(*.others))]
    LooseNode {
        /// The node.
        node: usize,
        /// Where it lies.
        at: Point3<f64>,
        /// How many more there are.
        others: usize,
    },
    /// More than one part.
    #[error(
        "the mesh falls into {parts} parts that share no node; welding may join them. The largest has \
         {largest} triangles, the next {next}, among them {triangle}"
    )]
    Disconnected {
        /// Number of parts.
        parts: usize,
        /// Triangles of the largest.
        largest: usize,
        /// Triangles of the second largest.
        next: usize,
        /// The first triangle of that one.
        triangle: Triangle,
    },
    /// A node that is all that holds two fans of triangles together.
    #[error(
        "the triangles at node {node}, {}, meet only in that node and not along edges; one is {triangle}; {}",
        Shown(*.at), Others(*.others)
    )]
    BowTie {
        /// The node.
        node: usize,
        /// Where it lies.
        at: Point3<f64>,
        /// One of its triangles.
        triangle: Triangle,
        /// How many more such nodes there are.
        others: usize,
    },
    /// A hole so small that it is no hole.
    #[error(
        "a crack: the hole of {edges} edges at node {node}, {}, is only {} around; {}",
        Shown(*.at), six_digits(*.length), Others(*.others)
    )]
    Crack {
        /// Edges around it.
        edges: usize,
        /// Length around it, in the mesh's unit.
        length: f64,
        /// Its lowest node.
        node: usize,
        /// Where that lies.
        at: Point3<f64>,
        /// How many more there are.
        others: usize,
    },
    /// Two nodes of the boundary at one place.
    #[error(
        "an open seam: nodes {} and {} of the boundary both lie at {}; welding joins them; {}",
        .nodes[0], .nodes[1], Shown(*.at), Others(*.others)
    )]
    Seam {
        /// The nodes.
        nodes: [usize; 2],
        /// Where they lie.
        at: Point3<f64>,
        /// How many more there are.
        others: usize,
    },
}

impl MeshFault {
    /// The gravest fault that was found.
    pub(super) fn first(
        found: &Soundness,
        nodes: &[Point3<f64>],
        elements: &[[usize; 3]],
        allow_cracks: bool,
    ) -> Option<Self> {
        let triangle = |number: usize| Triangle { number, corners: elements[number].map(|node| nodes[node]) };
        Self::of_nodes(found, nodes, elements)
            .or_else(|| Self::of_triangles(found, triangle))
            .or_else(|| Self::of_connection(found, nodes, elements, triangle))
            .or_else(|| if allow_cracks { None } else { Self::of_boundary(found, nodes) })
    }

    fn of_nodes(found: &Soundness, nodes: &[Point3<f64>], elements: &[[usize; 3]]) -> Option<Self> {
        if elements.is_empty() {
            return Some(Self::Empty);
        }
        if let Some(&element) = found.unknown_nodes.first() {
            let node = elements[element].into_iter().max().unwrap_or_default();
            return Some(Self::UnknownNode { element, node, nodes: nodes.len() });
        }
        found.not_finite.first().map(|&node| Self::NotFinite { node, at: nodes[node] })
    }

    fn of_triangles(found: &Soundness, triangle: impl Fn(usize) -> Triangle) -> Option<Self> {
        if let [first, others @ ..] = &*found.degenerate {
            return Some(Self::Degenerate { triangle: triangle(*first), others: others.len() });
        }
        if let [[first, copy], others @ ..] = &*found.duplicates {
            return Some(Self::Duplicate { triangle: triangle(*copy), first: *first, others: others.len() });
        }
        let [edge, others @ ..] = &*found.non_manifold else { return None };
        let last = *edge.elements.last()?;
        Some(Self::NonManifold {
            nodes: edge.nodes,
            count: edge.elements.len(),
            triangle: triangle(last),
            others: others.len(),
        })
    }

    fn of_connection(
        found: &Soundness,
        nodes: &[Point3<f64>],
        elements: &[[usize; 3]],
        triangle: impl Fn(usize) -> Triangle,
    ) -> Option<Self> {
        if let [node, ref others @ ..] = *found.loose_nodes {
            return Some(Self::LooseNode { node, at: nodes[node], others: others.len() });
        }
        if let [largest, next, ..] = *found.parts {
            return Some(Self::Disconnected {
                parts: found.parts.len(),
                largest: largest.elements,
                next: next.elements,
                triangle: triangle(next.first),
            });
        }
        let [node, ref others @ ..] = *found.bow_ties else { return None };
        let touching = elements.iter().position(|corners| corners.contains(&node))?;
        Some(Self::BowTie { node, at: nodes[node], triangle: triangle(touching), others: others.len() })
    }

    fn of_boundary(found: &Soundness, nodes: &[Point3<f64>]) -> Option<Self> {
        if let [crack, others @ ..] = &*found.cracks {
            let (boundary, node) = (found.boundaries[*crack], found.boundary_loops[*crack][0]);
            let super::Boundary { edges, length } = boundary;
            return Some(Self::Crack { edges, length, node, at: nodes[node], others: others.len() });
        }
        let [pair, others @ ..] = &*found.seams else { return None };
        Some(Self::Seam { nodes: *pair, at: nodes[pair[0]], others: others.len() })
    }
}

impl fmt::Display for Triangle {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [a, b, c] = self.corners.map(Shown);
        write!(f, "triangle {} (counted from 0) with the corners {a}, {b} and {c}", self.number)
    }
}

/// A point to six digits.
struct Shown(Point3<f64>);

impl fmt::Display for Shown {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [x, y, z] = self.0.coords.map(six_digits).into();
        write!(f, "({x}, {y}, {z})")
    }
}

/// `x` to six digits.
pub(super) fn six_digits(x: f64) -> f64 {
    format!("{x:.5e}").parse().unwrap_or(x)
}

/// How many more faults of one kind there are.
struct Others(usize);

impl fmt::Display for Others {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.0 {
            0 => write!(f, "there is no other"),
            1 => write!(f, "there is one more"),
            others => write!(f, "there are {others} more"),
        }
    }
}
