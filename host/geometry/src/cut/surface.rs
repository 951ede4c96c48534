//! Triangles that can be split, collapsed and flipped while they stay a surface.

use super::closest::Closest;
use crate::mesh::triangle;
use nalgebra::{Point3, Vector3};
use std::collections::HashMap;

/// A face that is no more.
const GONE: [usize; 3] = [usize::MAX; 3];
/// Faces that turn by more than this (cosine) fold over.
const FOLDED: f64 = 0.2;
/// A triangle with less than this share of the area of the one beside it is too flat to have a side.
const FLAT: f64 = 0.1;
/// Area over the sum of squared edges below which a triangle must not fall; 0.144 is equilateral.
const LEAST_SHAPE: f64 = 0.02;

/// An orientable surface whose edges have one face (the boundary) or two.
#[derive(Clone, Debug)]
pub(super) struct Surface {
    /// Where nodes lie: `[node]`; some belong to no face any more.
    pub(super) points: Vec<Point3<f64>>,
    faces: Vec<[usize; 3]>,
    /// Faces at each node.
    around: Vec<Vec<usize>>,
    /// Whether a node lies on the boundary: `[node]`.
    pub(super) boundary: Vec<bool>,
    /// Whether a node must stay: `[node]`.
    pub(super) fixed: Vec<bool>,
}

impl Surface {
    /// Faces all of which are oriented alike.
    pub(super) fn new(points: Vec<Point3<f64>>, faces: Vec<[usize; 3]>) -> Self {
        let mut around = vec![Vec::new(); points.len()];
        for (face, corners) in faces.iter().enumerate() {
            corners.iter().for_each(|&node| around[node].push(face));
        }
        let fixed = vec![false; points.len()];
        let mut surface = Self { boundary: fixed.clone(), fixed, points, faces, around };
        for [a, b] in surface.boundary_edges() {
            (surface.boundary[a], surface.boundary[b]) = (true, true);
        }
        surface
    }

    /// The faces there are.
    pub(super) fn faces(&self) -> impl Iterator<Item = [usize; 3]> + '_ {
        self.faces.iter().copied().filter(|&face| face != GONE)
    }

    /// The faces at a node.
    pub(super) fn faces_at(&self, node: usize) -> impl Iterator<Item = [usize; 3]> + '_ {
        self.around[node].iter().map(|&face| self.faces[face])
    }

    /// Where the corners of a face lie.
    pub(super) fn corners(&self, face: [usize; 3]) -> [Point3<f64>; 3] {
        face.map(|node| self.points[node])
    }

    /// Distance of two nodes.
    pub(super) fn length(&self, a: usize, b: usize) -> f64 {
        (self.points[a] - self.points[b]).norm()
    }

    /// Area of all faces.
    pub(super) fn area(&self) -> f64 {
        self.faces().map(|face| triangle::area(self.corners(face))).sum()
    }

    /// Length of the longest edge.
    pub(super) fn longest_edge(&self) -> f64 {
        self.edges().into_iter().map(|[a, b]| self.length(a, b)).fold(0.0, f64::max)
    }

    /// Every edge once, the lower node first.
    pub(super) fn edges(&self) -> Vec<[usize; 2]> {
        let of_face = |[a, b, c]: [usize; 3]| [[a, b], [b, c], [c, a]];
        let on_boundary =
            |a: usize, b: usize| self.boundary[a] && self.boundary[b] && self.sides(a, b).1.is_none();
        let once = |&[a, b]: &[usize; 2]| a < b || on_boundary(a, b);
        let sorted = |[a, b]: [usize; 2]| [a.min(b), a.max(b)];
        self.faces().flat_map(of_face).filter(once).map(sorted).collect()
    }

    /// Edges of one face, as it passes them.
    pub(super) fn boundary_edges(&self) -> Vec<[usize; 2]> {
        let of_face = |[a, b, c]: [usize; 3]| [[a, b], [b, c], [c, a]];
        self.faces().flat_map(of_face).filter(|&[a, b]| self.sides(a, b).1.is_none()).collect()
    }

    /// The boundaries, each walked with the surface on its left.
    pub(super) fn loops(&self) -> Vec<Vec<usize>> {
        let mut next: HashMap<usize, usize> =
            self.boundary_edges().into_iter().map(|[a, b]| (a, b)).collect();
        let mut starts: Vec<usize> = next.keys().copied().collect();
        starts.sort_unstable();
        let mut loops = Vec::new();
        for start in starts {
            let mut around = Vec::new();
            let mut node = start;
            while let Some(follower) = next.remove(&node) {
                around.push(node);
                node = follower;
            }
            if !around.is_empty() {
                loops.push(around);
            }
        }
        loops
    }

    /// Faces on an edge.
    fn sides(&self, a: usize, b: usize) -> (Option<usize>, Option<usize>) {
        let mut sides = self.around[a].iter().copied().filter(|&face| self.faces[face].contains(&b));
        (sides.next(), sides.next())
    }

    /// Whether two nodes are the ends of an edge.
    pub(super) fn is_edge(&self, a: usize, b: usize) -> bool {
        self.sides(a, b).0.is_some()
    }

    /// Whether this edge is a piece of the boundary.
    pub(super) fn is_boundary_edge(&self, a: usize, b: usize) -> bool {
        matches!(self.sides(a, b), (Some(_), None))
    }

    /// Nodes that share an edge with a node.
    pub(super) fn neighbours(&self, node: usize) -> Vec<usize> {
        let mut others: Vec<usize> = self.faces_at(node).flatten().filter(|&other| other != node).collect();
        others.sort_unstable();
        others.dedup();
        others
    }

    /// Puts a new node on an edge.
    pub(super) fn split(&mut self, a: usize, b: usize, at: Point3<f64>) -> usize {
        let middle = self.points.len();
        let (first, second) = self.sides(a, b);
        self.points.push(at);
        self.around.push(Vec::new());
        self.boundary.push(second.is_none());
        self.fixed.push(false);
        for face in [first, second].into_iter().flatten() {
            self.split_face(face, a, b, middle);
        }
        middle
    }

    fn split_face(&mut self, face: usize, a: usize, b: usize, middle: usize) {
        let other = self.faces.len();
        let old = self.faces[face];
        self.faces[face] = old.map(|node| if node == b { middle } else { node });
        self.faces.push(old.map(|node| if node == a { middle } else { node }));
        self.around[b].retain(|&it| it != face);
        self.around[middle].extend([face, other]);
        for node in old.into_iter().filter(|&node| node != a) {
            self.around[node].push(other);
        }
    }

    /// Lets `gone` become `kept`, its neighbour, unless the surface would tear, fold, get an edge
    /// longer than `longest`, or a boundary would change other than along itself.
    pub(super) fn collapse(&mut self, gone: usize, kept: usize, longest: f64) -> bool {
        let possible = self.may_vanish(gone, kept) && self.stays_unfolded(gone, kept, longest);
        if possible {
            self.merge(gone, kept);
        }
        possible
    }

    fn may_vanish(&self, gone: usize, kept: usize) -> bool {
        if self.fixed[gone] || self.boundary[gone] && !self.is_boundary_edge(gone, kept) {
            return false;
        }
        let dying: Vec<[usize; 3]> = self.faces_at(gone).filter(|face| face.contains(&kept)).collect();
        let opposite = |face: &[usize; 3]| face.iter().copied().find(|&node| node != gone && node != kept);
        let others: Vec<usize> = dying.iter().filter_map(opposite).collect();
        let lasting = |&node: &usize| self.around[node].len() > if self.boundary[node] { 1 } else { 3 };
        let of_kept = self.neighbours(kept);
        let common = self.neighbours(gone).iter().filter(|node| of_kept.binary_search(node).is_ok()).count();
        common == dying.len() && self.around[gone].len() > dying.len() && others.iter().all(lasting)
    }

    fn stays_unfolded(&self, gone: usize, kept: usize, longest: f64) -> bool {
        let side = self.side(gone);
        // Without a longest edge a node has to go, and flips repair what that leaves.
        let least = if longest.is_finite() { LEAST_SHAPE } else { 0.01 * LEAST_SHAPE };
        self.faces_at(gone).filter(|face| !face.contains(&kept)).all(|face| {
            let moved = face.map(|node| if node == gone { kept } else { node });
            let short = face.iter().all(|&node| node == gone || self.length(node, kept) <= longest);
            short && keeps_side(self.corners(face), self.corners(moved), side, least)
        })
    }

    /// Sum of the vector areas of the faces at a node: slivers hardly count.
    fn side(&self, node: usize) -> Vector3<f64> {
        self.faces_at(node).map(|face| vector_area(self.corners(face))).sum()
    }

    fn merge(&mut self, gone: usize, kept: usize) {
        for face in std::mem::take(&mut self.around[gone]) {
            if self.faces[face].contains(&kept) {
                for node in std::mem::replace(&mut self.faces[face], GONE) {
                    self.around[node].retain(|&it| it != face);
                }
            } else {
                self.faces[face] = self.faces[face].map(|node| if node == gone { kept } else { node });
                self.around[kept].push(face);
            }
        }
    }

    /// Turns the edge in its quadrilateral if that makes the pair Delaunay.
    pub(super) fn flip(&mut self, a: usize, b: usize) -> bool {
        let (Some(left), Some(right)) = self.sides(a, b) else { return false };
        // `left` passes the edge from a to b.
        let passes =
            |face: usize| (0..3).any(|i| [self.faces[face][i], self.faces[face][(i + 1) % 3]] == [a, b]);
        let (left, right) = if passes(left) { (left, right) } else { (right, left) };
        let opposite = |face: usize| self.faces[face].into_iter().find(|&node| node != a && node != b);
        let (Some(c), Some(d)) = (opposite(left), opposite(right)) else { return false };
        if c == d || self.is_edge(c, d) || !self.is_better_flipped([a, b, c, d]) {
            return false;
        }
        self.faces[left] = [a, d, c];
        self.faces[right] = [d, b, c];
        self.around[a].retain(|&face| face != right);
        self.around[b].retain(|&face| face != left);
        self.around[c].push(right);
        self.around[d].push(left);
        true
    }

    fn is_better_flipped(&self, [a, b, c, d]: [usize; 4]) -> bool {
        let few = |node: usize| self.around[node].len() <= if self.boundary[node] { 1 } else { 3 };
        if few(a) || few(b) || self.angle(c, a, b) + self.angle(d, a, b) <= std::f64::consts::PI + 1e-6 {
            return false;
        }
        let normal = |face: [usize; 3]| vector_area(self.corners(face));
        let (left, right) = (normal([a, b, c]), normal([b, a, d]));
        // A sharp bend along the edge stays where it is, unless a triangle is too flat to have a side.
        let bent = left.dot(&right) < 0.5 * left.norm() * right.norm();
        let degenerate = left.norm().min(right.norm()) < FLAT * left.norm().max(right.norm());
        let side = left + right;
        let fits = |new: Vector3<f64>| new.dot(&side) > FOLDED * new.norm() * side.norm();
        (!bent || degenerate) && fits(normal([a, d, c])) && fits(normal([d, b, c]))
    }

    fn angle(&self, at: usize, a: usize, b: usize) -> f64 {
        let (u, v) = (self.points[a] - self.points[at], self.points[b] - self.points[at]);
        u.cross(&v).norm().atan2(u.dot(&v))
    }

    /// Moves a node into the middle of its faces, along the surface, unless one would fold.
    pub(super) fn relax(&mut self, node: usize, onto: &Closest) {
        let (mut sum, mut weight, mut normal) = (Vector3::zeros(), 0.0, Vector3::zeros());
        for face in self.faces_at(node) {
            let corners = self.corners(face);
            let (area, side) = (triangle::area(corners), vector_area(corners));
            sum += triangle::centroid(corners).coords * area;
            weight += area;
            normal += side;
        }
        let Some(normal) = normal.try_normalize(0.0).filter(|_| weight > 0.0) else { return };
        let step = Point3::from(sum / weight) - self.points[node];
        let moved = onto.point(self.points[node] + (step - normal * normal.dot(&step)));
        let stays = |face: [usize; 3]| {
            let there = face.map(|it| if it == node { moved } else { self.points[it] });
            keeps_side(self.corners(face), there, normal, LEAST_SHAPE)
        };
        if self.faces_at(node).all(stays) {
            self.points[node] = moved;
        }
    }

    /// Nodes and faces that there are, nodes numbered anew.
    pub(super) fn compact(&self) -> Compacted {
        let mut numbers = HashMap::new();
        let mut points = Vec::new();
        let mut number = |node: usize| {
            *numbers.entry(node).or_insert_with(|| {
                points.push(self.points[node]);
                points.len() - 1
            })
        };
        let faces = self.faces().map(|face| face.map(&mut number)).collect();
        (points, faces, numbers)
    }
}

/// Nodes, faces, and the new number of each old node that is left.
type Compacted = (Vec<Point3<f64>>, Vec<[usize; 3]>, HashMap<usize, usize>);

/// Normal of a triangle, as long as its area.
pub(super) fn vector_area([a, b, c]: [Point3<f64>; 3]) -> Vector3<f64> {
    (b - a).cross(&(c - a)) / 2.0
}

/// Whether a triangle that moves keeps its own side, or lies on that of its surroundings, and has some shape.
fn keeps_side(before: [Point3<f64>; 3], after: [Point3<f64>; 3], side: Vector3<f64>, least: f64) -> bool {
    let (old, new) = (vector_area(before), vector_area(after));
    let shape = |corners: [Point3<f64>; 3], area: f64| {
        let [a, b, c] = corners;
        area / ((a - b).norm_squared() + (b - c).norm_squared() + (c - a).norm_squared())
            .max(f64::MIN_POSITIVE)
    };
    let (was, is) = (shape(before, old.norm()), shape(after, new.norm()));
    let faces = |side: Vector3<f64>| new.dot(&side) > FOLDED * new.norm() * side.norm();
    (faces(old) || faces(side)) && (is > least || is >= 0.9 * was)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A square of four triangles round a middle node.
    fn square() -> Surface {
        let points = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0], [0.5, 0.5]];
        let points = points.map(|[x, y]| Point3::new(x, y, 0.0)).to_vec();
        Surface::new(points, vec![[0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4]])
    }

    #[test]
    fn a_split_keeps_the_area_and_the_boundary_closed() {
        let mut surface = square();
        surface.split(0, 1, Point3::new(0.4, 0.0, 0.0));
        surface.split(1, 4, Point3::new(0.7, 0.3, 0.0));
        assert!((surface.area() - 1.0).abs() < 1e-12);
        assert_eq!(surface.faces().count(), 7);
        assert_eq!(surface.loops().iter().map(Vec::len).collect::<Vec<_>>(), [5]);
        assert_eq!(surface.boundary, [true, true, true, true, false, true, false]);
    }

    #[test]
    fn a_boundary_node_vanishes_along_the_boundary_only() {
        let mut surface = square();
        let middle = surface.split(0, 1, Point3::new(0.4, 0.0, 0.0));
        assert!(!surface.collapse(middle, 4, f64::INFINITY), "that would dent the boundary");
        assert!(surface.collapse(middle, 0, f64::INFINITY));
        assert!((surface.area() - 1.0).abs() < 1e-12);
        assert!(!surface.collapse(4, 0, 1.2), "an edge would be 1.41 long");
        assert!(surface.collapse(4, 0, 1.5));
        assert_eq!((surface.faces().count(), surface.compact().0.len()), (2, 4));
    }

    #[test]
    fn a_flip_makes_a_kite_delaunay_and_is_not_undone() {
        let points = [[0.0, 0.0], [4.0, 0.0], [2.0, 1.0], [2.0, -1.0]];
        let points = points.map(|[x, y]| Point3::new(x, y, 0.0)).to_vec();
        let mut surface = Surface::new(points, vec![[0, 1, 2], [1, 0, 3]]);
        assert!(surface.flip(0, 1));
        assert!(surface.is_edge(2, 3) && !surface.is_edge(0, 1) && !surface.flip(2, 3));
        assert!((surface.area() - 4.0).abs() < 1e-12);
    }
}
