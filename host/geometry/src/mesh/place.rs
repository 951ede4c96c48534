//! Places electrodes on a mesh that was made elsewhere: along its boundary, at given points, or where its
//! named groups are. The mesh stays as it is, so an electrode covers whole edges or triangles.

use super::{ElectrodeContact, triangle};
use nalgebra::{Point3, Vector3};
use std::collections::HashMap;

/// A boundary loop of a mesh, walked counter-clockwise as seen from above.
#[derive(Clone, Debug)]
pub struct BoundaryLoop<'a> {
    nodes: &'a [Point3<f64>],
    order: Vec<usize>,
    /// Arc length at which each edge starts, and that of the whole loop: `[edge]`, one more.
    starts: Vec<f64>,
}

impl<'a> BoundaryLoop<'a> {
    /// A loop of nodes in either direction.
    #[must_use]
    pub fn new(nodes: &'a [Point3<f64>], mut order: Vec<usize>) -> Self {
        let next = |i: usize| nodes[order[(i + 1) % order.len()]];
        let turn: f64 =
            (0..order.len()).map(|i| nodes[order[i]].xy().coords.perp(&next(i).xy().coords)).sum();
        if turn < 0.0 {
            order.reverse();
        }
        let mut starts = vec![0.0];
        for i in 0..order.len() {
            let edge = nodes[order[(i + 1) % order.len()]] - nodes[order[i]];
            starts.push(starts[i] + edge.norm());
        }
        Self { nodes, order, starts }
    }

    /// Length of the loop, m.
    #[must_use]
    pub fn length(&self) -> f64 {
        self.starts[self.order.len()]
    }

    /// Arc length of the node that lies most nearly in direction `angle` (rad, from x towards y) from
    /// the middle of the loop.
    #[must_use]
    pub fn position(&self, angle: f64) -> f64 {
        let sum: Vector3<f64> = self.order.iter().map(|&node| self.nodes[node].coords).sum();
        let middle = sum / self.order.len() as f64;
        let along = |i: usize| {
            let direction = (self.nodes[self.order[i]].coords - middle).xy();
            (direction.x * angle.cos() + direction.y * angle.sin()) / direction.norm()
        };
        let best = (0..self.order.len()).max_by(|&a, &b| along(a).total_cmp(&along(b)));
        best.map_or(0.0, |i| self.starts[i])
    }

    /// Arc length of the node closest to `point`, and how far away it is, m.
    #[must_use]
    pub fn nearest(&self, point: Point3<f64>) -> (f64, f64) {
        let distance = |i: usize| (self.nodes[self.order[i]] - point).norm();
        let best = (0..self.order.len()).min_by(|&a, &b| distance(a).total_cmp(&distance(b)));
        best.map_or((0.0, f64::INFINITY), |i| (self.starts[i], distance(i)))
    }

    /// The node closest to an arc length.
    #[must_use]
    pub fn node(&self, s: f64) -> ElectrodeContact {
        let distance = |i: usize| self.distance(self.starts[i], s);
        let best = (0..self.order.len()).min_by(|&a, &b| distance(a).total_cmp(&distance(b)));
        ElectrodeContact::Node(best.map_or(0, |i| self.order[i]))
    }

    /// The edges whose middles lie within half a `width` of an arc length; at least the closest one.
    #[must_use]
    pub fn edges(&self, s: f64, width: f64) -> ElectrodeContact {
        let distance = |i: usize| self.distance((self.starts[i] + self.starts[i + 1]) / 2.0, s);
        let edge = |i: usize| [self.order[i], self.order[(i + 1) % self.order.len()]];
        let closest = (0..self.order.len()).min_by(|&a, &b| distance(a).total_cmp(&distance(b)));
        let covered = (0..self.order.len()).filter(|&i| distance(i) <= width / 2.0 || Some(i) == closest);
        ElectrodeContact::Edges(covered.map(edge).collect())
    }

    fn distance(&self, a: f64, b: f64) -> f64 {
        let ahead = (a - b).rem_euclid(self.length());
        ahead.min(self.length() - ahead)
    }
}

/// The node closest to `point`, and how far away it is, m.
#[must_use]
pub fn nearest_node(nodes: &[Point3<f64>], point: Point3<f64>) -> (usize, f64) {
    let distance = |node: usize| (nodes[node] - point).norm();
    let best = (0..nodes.len()).min_by(|&a, &b| distance(a).total_cmp(&distance(b)));
    best.map_or((0, f64::INFINITY), |node| (node, distance(node)))
}

/// The triangles whose centres lie within half a `width` of `point`; those around its nearest node if
/// there are none.
#[must_use]
pub fn faces(
    nodes: &[Point3<f64>],
    elements: &[[usize; 3]],
    point: Point3<f64>,
    width: f64,
) -> ElectrodeContact {
    let centre = |element: &[usize; 3]| triangle::centroid(element.map(|node| nodes[node]));
    let within = |element: &&[usize; 3]| (centre(element) - point).norm() <= width / 2.0;
    let mut faces: Vec<[usize; 3]> = elements.iter().filter(within).copied().collect();
    if faces.is_empty() {
        let (nearest, _) = nearest_node(nodes, point);
        faces = elements.iter().filter(|element| element.contains(&nearest)).copied().collect();
    }
    ElectrodeContact::Faces(faces)
}

/// The first two electrodes that touch the same node, and that node.
#[must_use]
pub fn shared_node(electrodes: &[ElectrodeContact]) -> Option<([usize; 2], usize)> {
    let mut owner = HashMap::new();
    for (electrode, contact) in electrodes.iter().enumerate() {
        for node in contact.nodes() {
            match owner.insert(node, electrode) {
                Some(other) if other != electrode => return Some(([other, electrode], node)),
                _ => {}
            }
        }
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::{PI, TAU};

    /// A ring of 32 nodes on the unit circle, clockwise, from the x axis on.
    fn ring() -> Vec<Point3<f64>> {
        (0..32).map(|i| -TAU * f64::from(i) / 32.0).map(|a| Point3::new(a.cos(), a.sin(), 0.5)).collect()
    }

    #[test]
    fn a_boundary_is_walked_counter_clockwise_whichever_way_it_comes() {
        let nodes = ring();
        let boundary = BoundaryLoop::new(&nodes, (0..32).collect());
        assert!((boundary.length() - TAU).abs() < 0.02);
        let top = boundary.position(PI / 2.0);
        let ElectrodeContact::Node(at_top) = boundary.node(top) else { panic!() };
        let ElectrodeContact::Node(left) = boundary.node(top + boundary.length() / 4.0) else { panic!() };
        assert!((nodes[at_top] - Point3::new(0.0, 1.0, 0.5)).norm() < 1e-12);
        assert!((nodes[left] - Point3::new(-1.0, 0.0, 0.5)).norm() < 1e-9);
    }

    #[test]
    fn an_electrode_covers_the_edges_in_its_width_and_one_at_least() {
        let nodes = ring();
        let boundary = BoundaryLoop::new(&nodes, (0..32).collect());
        let covered = |width: f64| match boundary.edges(boundary.position(0.0), width) {
            ElectrodeContact::Edges(edges) => edges.len(),
            _ => 0,
        };
        assert_eq!([covered(0.01), covered(TAU / 16.0), covered(TAU / 8.0)], [1, 2, 4]);
    }

    #[test]
    fn electrodes_that_touch_the_same_node_are_found() {
        let electrodes = [
            ElectrodeContact::Node(3),
            ElectrodeContact::Edges(vec![[4, 5], [5, 6]]),
            ElectrodeContact::Node(6),
        ];
        assert_eq!(shared_node(&electrodes), Some(([1, 2], 6)));
        assert_eq!(shared_node(&electrodes[..2]), None);
    }
}
