//! Where a surface ends: fans of triangles around nodes, and loops of edges with one triangle.

use super::neighbours::{self, Edge};
use std::collections::HashMap;

/// Corners that hang together around one node, from triangle to triangle over their shared edges:
/// sets of 3 * element + corner.
pub(super) fn fans(edges: &[Edge], elements: &[[usize; 3]]) -> DisjointSets {
    let mut fans = DisjointSets::new(3 * elements.len());
    for pair in edges.windows(2).filter(|pair| pair[0].nodes() == pair[1].nodes()) {
        for node in pair[0].nodes() {
            fans.join(corner(pair[0].element(), node, elements), corner(pair[1].element(), node, elements));
        }
    }
    fans
}

/// Number of an element's corner at one of its nodes.
fn corner(element: usize, node: usize, elements: &[[usize; 3]]) -> usize {
    3 * element + elements[element].iter().position(|&other| other == node).unwrap_or_default()
}

/// Nodes along each loop of edges that have a triangle on one side only.
///
/// Each loop begins at its lowest node, and with the lower of that node's two neighbours. Where an
/// edge has more than two triangles, a loop may end without closing.
pub(super) fn boundary_loops(
    edges: &[Edge],
    elements: &[[usize; 3]],
    fans: &mut DisjointSets,
) -> Vec<Vec<usize>> {
    let boundary_edge = |edge: &Edge| BoundaryEdge {
        nodes: edge.nodes(),
        fans: edge.nodes().map(|node| fans.find(corner(edge.element(), node, elements))),
    };
    let boundary: Vec<_> = neighbours::alone(edges).map(boundary_edge).collect();
    // Each fan that is open has an edge of the boundary at either end.
    let mut ends: HashMap<usize, Vec<usize>> = HashMap::new();
    for (place, edge) in boundary.iter().enumerate() {
        edge.fans.iter().for_each(|&fan| ends.entry(fan).or_default().push(place));
    }
    let mut walked = vec![false; boundary.len()];
    let starts = 0..boundary.len();
    starts.filter_map(|start| walk(start, &boundary, &mut ends, &mut walked)).collect()
}

/// An edge of the boundary.
struct BoundaryEdge {
    nodes: [usize; 2],
    /// The fans at its nodes.
    fans: [usize; 2],
}

/// Follows the boundary from fan to fan; nothing if the first edge was walked before.
fn walk(
    start: usize,
    boundary: &[BoundaryEdge],
    ends: &mut HashMap<usize, Vec<usize>>,
    walked: &mut [bool],
) -> Option<Vec<usize>> {
    if walked[start] {
        return None;
    }
    let (mut at, mut fan) = (start, boundary[start].fans[0]);
    let mut nodes = Vec::new();
    loop {
        walked[at] = true;
        let from = usize::from(boundary[at].fans[0] != fan);
        nodes.push(boundary[at].nodes[from]);
        fan = boundary[at].fans[1 - from];
        let Some(ends) = ends.get_mut(&fan) else { return Some(nodes) };
        match std::iter::from_fn(|| ends.pop()).find(|&place| !walked[place]) {
            Some(next) => at = next,
            None => return Some(nodes),
        }
    }
}

/// Numbers 0..n in sets that only ever join.
#[derive(Clone, Debug)]
pub(crate) struct DisjointSets {
    /// Towards the set's lowest member, which is its own parent.
    parents: Vec<u32>,
}

impl DisjointSets {
    /// Each number in a set of its own.
    pub(crate) fn new(count: usize) -> Self {
        Self { parents: (0..count as u32).collect() }
    }

    /// The lowest member of the set that holds `member`.
    pub(crate) fn find(&mut self, mut member: usize) -> usize {
        loop {
            let parent = self.parents[member] as usize;
            if parent == member {
                return member;
            }
            self.parents[member] = self.parents[parent];
            member = self.parents[parent] as usize;
        }
    }

    pub(crate) fn join(&mut self, one: usize, other: usize) {
        let (one, other) = (self.find(one), self.find(other));
        self.parents[one.max(other)] = one.min(other) as u32;
    }
}
