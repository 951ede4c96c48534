//! Distances over a surface from one point of it.
//!
//! Fast marching with circular waves: two nodes of a triangle and their distances say where a source
//! would lie if everything were unfolded into the triangle's plane, and that gives the third. On
//! flat and developable surfaces this is exact where no triangle is obtuse; else the error falls with the
//! length of the edges (Novotni and Klein, "Computing geodesic distances on triangular meshes",
//! 2002). Unlike theirs, a node's distance may shrink again later, so that no order is presumed.

use super::surface::Surface;
use nalgebra::Point3;
use std::{
    cmp::{Ordering, Reverse},
    collections::BinaryHeap,
};

/// A node by its distance.
#[derive(PartialEq)]
struct Reached(f64, usize);

impl Eq for Reached {}

impl PartialOrd for Reached {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for Reached {
    fn cmp(&self, other: &Self) -> Ordering {
        self.0.total_cmp(&other.0).then(self.1.cmp(&other.1))
    }
}

/// Distance of every node from `source`, a point of `face`; infinite where there is no way, and
/// beyond `farthest` only a bound: `[node]`.
pub(super) fn distances(surface: &Surface, face: [usize; 3], source: Point3<f64>, farthest: f64) -> Vec<f64> {
    let mut distances = vec![f64::INFINITY; surface.points.len()];
    let mut queue = BinaryHeap::new();
    for node in face {
        distances[node] = (surface.points[node] - source).norm();
        queue.push(Reverse(Reached(distances[node], node)));
    }
    while let Some(Reverse(Reached(distance, node))) = queue.pop() {
        if distance > distances[node] || distance > farthest {
            continue;
        }
        for face in surface.faces_at(node) {
            for (third, found) in third_nodes(surface, &distances, face, node) {
                // No way is shorter than the straight one. Tiny gains are not worth a new round.
                let found = found.max((surface.points[third] - source).norm());
                if found < distances[third] * (1.0 - 1e-9) {
                    distances[third] = found;
                    queue.push(Reverse(Reached(found, third)));
                }
            }
        }
    }
    distances
}

/// What `node` and each other node of a face say about the face's third node.
fn third_nodes(surface: &Surface, distances: &[f64], face: [usize; 3], node: usize) -> [(usize, f64); 2] {
    let at = face.iter().position(|&corner| corner == node).unwrap_or_default();
    let (next, last) = (face[(at + 1) % 3], face[(at + 2) % 3]);
    [(next, last), (last, next)].map(|(third, second)| {
        let corners = [node, second, third].map(|corner| surface.points[corner]);
        (third, across(corners, [distances[node], distances[second]]))
    })
}

/// Distance of the third corner from that of the first two.
fn across([a, b, c]: [Point3<f64>; 3], [from_a, from_b]: [f64; 2]) -> f64 {
    let along = (from_a + (c - a).norm()).min(from_b + (c - b).norm());
    let edge = (b - a).norm();
    let source_x = (edge * edge + from_a * from_a - from_b * from_b) / (2.0 * edge);
    let below = from_a * from_a - source_x * source_x;
    if !below.is_finite() || below < 0.0 {
        return along;
    }
    let x = (c - a).dot(&(b - a)) / edge;
    let y = ((c - a).norm_squared() - x * x).max(0.0).sqrt();
    let source_y = -below.sqrt();
    let crossing = source_x + (x - source_x) * (-source_y) / (y - source_y);
    let direct = (x - source_x).hypot(y - source_y);
    if (0.0..=edge).contains(&crossing) { direct.min(along) } else { along }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use std::f64::consts::PI;

    const SIDE: usize = 30;

    /// A sheet of 1 x 1 in uneven triangles, laid into space.
    fn sheet(uneven: f64, lay: impl Fn(f64, f64) -> Point3<f64>) -> (Surface, Vec<[f64; 2]>) {
        let step = 1.0 / SIDE as f64;
        let mut flat = Vec::new();
        for i in 0..=SIDE {
            for j in 0..=SIDE {
                let wobble = |k: usize| uneven * step * ((k * k) as f64 * 12.9898).sin();
                flat.push([i as f64 * step + wobble(31 * i + j), j as f64 * step + wobble(i + 57 * j)]);
            }
        }
        let node = |i: usize, j: usize| i * (SIDE + 1) + j;
        let quads = (0..SIDE * SIDE).map(|k| (k / SIDE, k % SIDE));
        let faces = quads.flat_map(|(i, j)| {
            let [a, b, c, d] = [node(i, j), node(i + 1, j), node(i + 1, j + 1), node(i, j + 1)];
            if (i + j) % 2 == 0 { [[a, b, c], [a, c, d]] } else { [[a, b, d], [b, c, d]] }
        });
        let faces = faces.collect();
        (Surface::new(flat.iter().map(|&[x, y]| lay(x, y)).collect(), faces), flat)
    }

    fn largest_error(surface: &Surface, face: [usize; 3], truth: impl Fn(Point3<f64>, usize) -> f64) -> f64 {
        let corners = surface.corners(face);
        let source = crate::mesh::triangle::centroid(corners);
        let found = distances(surface, face, source, f64::INFINITY);
        let error = |node: usize| (found[node] - truth(source, node)).abs();
        (0..found.len()).map(error).fold(0.0, f64::max)
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(16))]
        #[test]
        fn on_a_plane_and_rolled_up_it_is_the_straight_distance(
            uneven in 0.0..0.3_f64, start in 0..2 * SIDE * SIDE, radius in 0.3..2.0_f64,
        ) {
            let (plane, flat) = sheet(uneven, |x, y| Point3::new(x, y, 0.0));
            let face = plane.faces().nth(start).unwrap();
            let centre = face.iter().fold([0.0; 2], |sum, &node| [sum[0] + flat[node][0] / 3.0, sum[1] + flat[node][1] / 3.0]);
            let truth = |node: usize| (flat[node][0] - centre[0]).hypot(flat[node][1] - centre[1]);
            let error = largest_error(&plane, face, |_, node| truth(node));
            prop_assert!(error < 8e-3, "flat: {error}");
            let (rolled, _) = sheet(uneven, |x, y| Point3::new(radius * (x / radius).sin(), y, radius * (x / radius).cos()));
            let error = largest_error(&rolled, face, |_, node| truth(node));
            prop_assert!(error < 1e-2, "rolled: {error}");
        }
    }

    #[test]
    fn on_a_sphere_it_is_the_great_circle() {
        let ball = |x: f64, y: f64| {
            let (longitude, latitude) = ((x - 0.5) * PI / 2.0, (y - 0.5) * PI / 2.0);
            Point3::new(latitude.cos() * longitude.sin(), latitude.sin(), latitude.cos() * longitude.cos())
        };
        let (surface, _) = sheet(0.2, ball);
        let face = surface.faces().nth(SIDE * SIDE).unwrap();
        let truth = |source: Point3<f64>, node: usize| surface.points[node].coords.angle(&source.coords);
        let error = largest_error(&surface, face, truth);
        assert!(error < 0.02 * PI / 2.0, "{error}");
    }
}
