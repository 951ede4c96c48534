//! Cuts a surface along the line where a value is zero.

use super::{error::Wrapped, surface::Surface};
use crate::mesh::{boundary::DisjointSets, triangle};
use nalgebra::Point3;
use std::collections::HashMap;

/// Values smaller than this, as a share of the longest difference along an edge, are zero.
const ON_THE_LINE: f64 = 1e-6;

/// The part of a surface in which `field` (`[node]`, linear on each face) is negative and that holds
/// the face closest to `seed`.
pub(super) fn clip(surface: &Surface, field: &[f64], seed: Point3<f64>) -> Surface {
    let step = surface.edges().iter().map(|&[a, b]| (field[a] - field[b]).abs()).fold(0.0, f64::max);
    let snapped = |value: f64| if value.abs() < ON_THE_LINE * step { 0.0 } else { value };
    let field: Vec<f64> = field.iter().map(|&value| snapped(value)).collect();
    let mut cut = Cut { surface, field: &field, points: surface.points.clone(), on_edges: HashMap::new() };
    let mut faces = Vec::new();
    for face in surface.faces() {
        let kept = cut.kept(face);
        faces.extend(kept.windows(2).skip(1).map(|pair| [kept[0], pair[0], pair[1]]));
    }
    with_seed(&cut.points, &faces, seed)
}

struct Cut<'a> {
    surface: &'a Surface,
    field: &'a [f64],
    points: Vec<Point3<f64>>,
    /// The node where an edge is cut.
    on_edges: HashMap<[usize; 2], usize>,
}

impl Cut<'_> {
    /// Corners of what is left of a face; none if nothing is.
    fn kept(&mut self, face: [usize; 3]) -> Vec<usize> {
        let values = face.map(|node| self.field[node]);
        let mut kept = Vec::with_capacity(4);
        if values.iter().all(|&value| value >= 0.0) {
            return kept;
        }
        for i in 0..3 {
            let j = (i + 1) % 3;
            if values[i] <= 0.0 {
                kept.push(face[i]);
            }
            if values[i] * values[j] < 0.0 {
                kept.push(self.on_edge(face[i], face[j]));
            }
        }
        kept
    }

    fn on_edge(&mut self, a: usize, b: usize) -> usize {
        let (a, b) = (a.min(b), a.max(b));
        *self.on_edges.entry([a, b]).or_insert_with(|| {
            let share = self.field[a] / (self.field[a] - self.field[b]);
            let (from, to) = (self.surface.points[a], self.surface.points[b]);
            self.points.push(from + (to - from) * share);
            self.points.len() - 1
        })
    }
}

/// The faces that hang together over edges with the one closest to `seed`.
fn with_seed(points: &[Point3<f64>], faces: &[[usize; 3]], seed: Point3<f64>) -> Surface {
    let whole = Surface::new(points.to_vec(), faces.to_vec());
    let Some(start) = closest_face(&whole, seed) else { return whole };
    let numbers: HashMap<[usize; 3], usize> = faces.iter().enumerate().map(|(i, &face)| (face, i)).collect();
    let mut sets = DisjointSets::new(faces.len());
    let mut on_edge = HashMap::new();
    for (number, &[a, b, c]) in faces.iter().enumerate() {
        for [from, to] in [[a, b], [b, c], [c, a]] {
            if let Some(other) = on_edge.insert([from.min(to), from.max(to)], number) {
                sets.join(number, other);
            }
        }
    }
    let own = numbers.get(&start).map(|&number| sets.find(number));
    let kept = (0..faces.len()).filter(|&face| Some(sets.find(face)) == own).map(|face| faces[face]);
    let (points, faces, _) = Surface::new(points.to_vec(), kept.collect()).compact();
    Surface::new(points, faces)
}

/// The face closest to a point.
pub(super) fn closest_face(surface: &Surface, point: Point3<f64>) -> Option<[usize; 3]> {
    let distance = |face: &[usize; 3]| (triangle::nearest(surface.corners(*face), point) - point).norm();
    surface.faces().min_by(|a, b| distance(a).total_cmp(&distance(b)))
}

/// What a surface is, unless it is a disc.
pub(super) fn no_disc(surface: &Surface) -> Option<Wrapped> {
    let boundary = surface.boundary_edges();
    let mut starts: Vec<usize> = boundary.iter().map(|edge| edge[0]).collect();
    starts.sort_unstable();
    starts.dedup();
    let loops = surface.loops();
    let (points, faces, _) = surface.compact();
    let euler = points.len() + faces.len() == surface.edges().len() + 1;
    match loops.len() {
        0 => Some(Wrapped::Closed),
        1 if euler && starts.len() == boundary.len() => None,
        1 => Some(Wrapped::Handle),
        _ => {
            let mut lengths: Vec<f64> = loops.iter().map(|around| length(surface, around)).collect();
            lengths.sort_by(|a, b| b.total_cmp(a));
            Some(Wrapped::Boundaries(lengths))
        }
    }
}

/// Length of a closed line of nodes.
pub(super) fn length(surface: &Surface, around: &[usize]) -> f64 {
    (0..around.len()).map(|i| surface.length(around[i], around[(i + 1) % around.len()])).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A sheet of 2 x 1 in squares of `1 / side`.
    fn sheet(side: usize) -> Surface {
        let node = |i: usize, j: usize| i * (side + 1) + j;
        let step = 1.0 / side as f64;
        let points = (0..=2 * side).flat_map(|i| (0..=side).map(move |j| (i, j)));
        let points = points.map(|(i, j)| Point3::new(i as f64 * step, j as f64 * step, 0.0)).collect();
        let quads = (0..2 * side).flat_map(|i| (0..side).map(move |j| (i, j)));
        let faces = quads.flat_map(|(i, j)| {
            let [a, b, c, d] = [node(i, j), node(i + 1, j), node(i + 1, j + 1), node(i, j + 1)];
            [[a, b, c], [a, c, d]]
        });
        Surface::new(points, faces.collect())
    }

    #[test]
    fn triangles_are_cut_exactly_where_the_value_is_zero() {
        let surface = sheet(7);
        let field: Vec<f64> = surface.points.iter().map(|p| p.x + 0.3 * p.y - 0.8123).collect();
        let kept = clip(&surface, &field, Point3::origin());
        // From x = 0 to 0.8123 - 0.3 y.
        assert!((kept.area() - (0.8123 - 0.15)).abs() < 1e-12, "{}", kept.area());
        assert_eq!(no_disc(&kept), None);
    }

    #[test]
    fn of_two_parts_the_one_with_the_seed_is_kept() {
        let surface = sheet(8);
        let field: Vec<f64> = surface.points.iter().map(|p| 0.31 - (p.x - 1.0).abs()).collect();
        let kept = clip(&surface, &field, Point3::new(1.9, 0.5, 0.0));
        assert!((kept.area() - 0.69).abs() < 1e-12);
        assert!(kept.faces().flatten().all(|node| kept.points[node].x > 1.0));
    }

    #[test]
    fn a_line_through_nodes_leaves_no_slivers() {
        let surface = sheet(8);
        let field: Vec<f64> = surface.points.iter().map(|p| p.x - 0.5 + 1e-12 * p.y).collect();
        let kept = clip(&surface, &field, Point3::origin());
        assert_eq!(kept.faces().count(), 2 * 8 * 4);
    }

    #[test]
    fn rings_and_closed_surfaces_are_no_discs() {
        let surface = sheet(16);
        let field: Vec<f64> =
            surface.points.iter().map(|p| 0.2 - (p - Point3::new(0.5, 0.5, 0.0)).norm()).collect();
        let Some(Wrapped::Boundaries(lengths)) = no_disc(&clip(&surface, &field, Point3::origin())) else {
            panic!()
        };
        assert!(lengths.len() == 2 && (lengths[0] - 6.0).abs() < 1e-9 && (lengths[1] - 1.25).abs() < 0.02);
        let points = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]].map(Point3::from);
        let closed = Surface::new(points.to_vec(), vec![[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]]);
        assert_eq!(no_disc(&closed), Some(Wrapped::Closed));
    }
}
