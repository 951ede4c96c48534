//! Isotropic remeshing: edges are split, collapsed, flipped and relaxed until all are about as long as
//! wanted (Botsch and Kobbelt, "A remeshing approach to multiresolution modeling", 2004, with
//! Delaunay flips instead of valences). Nodes stay on the original surface, boundaries where they are.
//!
//! The crate `remesh` (0.0.5) calls itself experimental and knows no boundary that has to stay.

use super::{closest::Closest, surface::Surface};
use nalgebra::center;
use std::{cmp::Ordering, collections::BinaryHeap};

/// Edges longer than this many wanted lengths are split, shorter ones collapse.
const TOO_LONG: f64 = 4.0 / 3.0;
const TOO_SHORT: f64 = 4.0 / 5.0;
/// Splitting begins with edges so many times as long: slivers are flipped before they become many.
const FIRST_SPLIT: f64 = 4.0;
/// Delaunay flips end by themselves in the plane; on a bumpy surface a few may go round in circles.
const MOST_FLIP_PASSES: usize = 12;

/// How often what is done.
#[derive(Clone, Copy)]
pub(super) struct Effort {
    /// Rounds of splitting, collapsing, flipping and relaxing.
    rounds: i32,
    /// Rounds of flipping and relaxing after them.
    polish: usize,
}

impl Effort {
    /// For triangles to cut.
    pub(super) const EVEN: Self = Self { rounds: 5, polish: 0 };
    /// For triangles to compute with.
    pub(super) const FINAL: Self = Self { rounds: 6, polish: 6 };
}

/// An edge by its length.
struct ByLength(f64, [usize; 2]);

impl PartialEq for ByLength {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl Eq for ByLength {}

impl PartialOrd for ByLength {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for ByLength {
    fn cmp(&self, other: &Self) -> Ordering {
        self.0.total_cmp(&other.0).then(other.1.cmp(&self.1))
    }
}

/// Makes all edges about `edge` long. Of the boundary only nodes that are not fixed vanish, and none moves.
pub(super) fn remesh(surface: &mut Surface, edge: f64, onto: &Closest, effort: Effort) {
    for round in 0..effort.rounds {
        let project = |point| onto.point(point);
        let longest = TOO_LONG * edge * (FIRST_SPLIT * 0.5_f64.powi(round)).max(1.0);
        split_long(surface, longest, project);
        collapse_short(surface, edge, TOO_LONG * edge);
        flip(surface);
        relax(surface, onto);
    }
    polish(surface, onto, effort);
}

/// Splits edges above `longest` where the surface has slivers. Halved alone, a sliver becomes ever more slivers of its
/// own shape, with the square of its length; so nodes closer than `edge` are joined before it is halved again.
pub(super) fn shorten(surface: &mut Surface, longest: f64, edge: f64, onto: &Closest) {
    split_long(surface, TOO_LONG * longest, |point| onto.point(point));
    surface.fixed.clone_from(&surface.boundary);
    collapse_short(surface, edge, TOO_LONG * longest);
    flip(surface);
}

/// Flips and relaxes.
pub(super) fn polish(surface: &mut Surface, onto: &Closest, effort: Effort) {
    for _ in 0..effort.polish {
        flip(surface);
        relax(surface, onto);
    }
    flip(surface);
}

/// Halves edges above `longest`, the longest first; the new nodes lie where `place` puts the middles.
fn split_long(
    surface: &mut Surface,
    longest: f64,
    place: impl Fn(nalgebra::Point3<f64>) -> nalgebra::Point3<f64>,
) {
    let measured = |surface: &Surface, edge: [usize; 2]| ByLength(surface.length(edge[0], edge[1]), edge);
    let edges = surface.edges();
    let mut long: BinaryHeap<ByLength> =
        edges.into_iter().map(|edge| measured(surface, edge)).filter(|it| it.0 > longest).collect();
    while let Some(ByLength(length, [a, b])) = long.pop() {
        let middle = center(&surface.points[a], &surface.points[b]);
        let at = if surface.is_boundary_edge(a, b) { middle } else { place(middle) };
        let new = surface.split(a, b, at);
        for other in surface.neighbours(new) {
            let edge = measured(surface, [new, other]);
            // Not longer than the old one, or a projection could go on for ever.
            if edge.0 > longest && edge.0 < 0.99 * length {
                long.push(edge);
            }
        }
    }
}

/// Collapses short edges, the shortest first, and all nodes of the boundary that are not fixed. Inside no edge becomes longer
/// than `longest`.
fn collapse_short(surface: &mut Surface, edge: f64, longest: f64) {
    let mut short: Vec<ByLength> = Vec::new();
    for [a, b] in surface.edges() {
        let length = surface.length(a, b);
        let loose = |node: usize| surface.boundary[node] && !surface.fixed[node];
        if length < TOO_SHORT * edge || (loose(a) || loose(b)) && surface.is_boundary_edge(a, b) {
            short.push(ByLength(length, [a, b]));
        }
    }
    short.sort_unstable();
    for ByLength(_, [a, b]) in short {
        if surface.is_edge(a, b) {
            collapse_either(surface, [a, b], edge, longest);
        }
    }
}

fn collapse_either(surface: &mut Surface, [a, b]: [usize; 2], edge: f64, longest: f64) {
    let along_boundary = surface.is_boundary_edge(a, b);
    if !along_boundary && surface.length(a, b) >= TOO_SHORT * edge {
        return;
    }
    let longest = if along_boundary { f64::INFINITY } else { longest };
    let _ = surface.collapse(a, b, longest) || surface.collapse(b, a, longest);
}

fn flip(surface: &mut Surface) {
    for _ in 0..MOST_FLIP_PASSES {
        let flips = surface.edges().into_iter().filter(|&[a, b]| surface.flip(a, b)).count();
        if flips == 0 {
            return;
        }
    }
}

fn relax(surface: &mut Surface, onto: &Closest) {
    for node in 0..surface.points.len() {
        if !surface.boundary[node] && !surface.fixed[node] {
            surface.relax(node, onto);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::triangle;
    use nalgebra::Point3;

    #[test]
    fn strips_a_hundred_times_as_long_as_wide_become_even_triangles_on_the_cylinder() {
        let (around, radius) = (64, 0.05);
        let at = |i: usize, z: f64| {
            let angle = std::f64::consts::PI * i as f64 / around as f64;
            Point3::new(radius * angle.cos(), radius * angle.sin(), z)
        };
        let points: Vec<_> = (0..=around).flat_map(|i| [at(i, 0.0), at(i, 0.25)]).collect();
        let faces: Vec<_> = (0..around)
            .flat_map(|i| [[2 * i, 2 * i + 2, 2 * i + 1], [2 * i + 1, 2 * i + 2, 2 * i + 3]])
            .collect();
        let mut surface = Surface::new(points, faces);
        surface.fixed = surface.boundary.clone();
        let before = surface.area();
        let onto = Closest::new(surface.faces().map(|face| surface.corners(face)), 0.004);
        remesh(&mut surface, 0.004, &onto, Effort::FINAL);
        let angles = surface.faces().map(|face| triangle::smallest_angle(surface.corners(face)).to_degrees());
        let mut angles: Vec<f64> = angles.collect();
        angles.sort_by(f64::total_cmp);
        assert!(angles[0] > 12.0 && angles[angles.len() / 20] > 30.0, "{:?}", &angles[..20]);
        assert!((surface.area() / before - 1.0).abs() < 2e-3);
        let farthest = surface.points.iter().map(|p| (onto.point(*p) - p).norm()).fold(0.0, f64::max);
        assert!(farthest < 1e-12, "{farthest}");
    }
}
