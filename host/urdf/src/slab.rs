//! Slab: a skin's mesh as a closed body of its thickness, whose underside lies on the link.
//!
//! A surface without thickness flickers in the link's own where programs draw both, is seen from one side only, and has
//! no volume, which MuJoCo refuses.

use dermatome_geometry::mesh::{
    Mesh,
    neighbours::{boundary_edges, orientation},
    triangle,
};
use nalgebra::{Point3, Vector3};

/// Points between which a hull is tried: with more the time grows and the finding hardly changes.
const HULL_POINTS: usize = 40;
/// A point lies beside the skin, and not above or under it, where it is no further from its plane than this share of
/// its distance.
const BESIDE: f64 = 0.1;

/// Points that are spread evenly over a skin.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Spread {
    /// Where they are, m, in the skin's frame.
    pub points: Vec<Point3<f64>>,
    /// No place of the skin is farther from the nearest one, m.
    pub radius: f64,
}

/// A skin's mesh whose triangles all face outward, in its own frame.
#[derive(Clone, Debug)]
pub struct Surface {
    nodes: Vec<Point3<f64>>,
    elements: Vec<[usize; 3]>,
    /// Outward, `[node]`.
    normals: Vec<Vector3<f64>>,
}

impl Surface {
    /// Outward is where z points on the whole.
    #[must_use]
    pub fn of(mesh: &Mesh) -> Self {
        let mut elements = mesh.elements.clone();
        for (element, sign) in elements.iter_mut().zip(orientation(&mesh.elements)) {
            if sign < 0.0 {
                element.swap(1, 2);
            }
        }
        let mut normals = normals(mesh, &elements);
        if normals.iter().sum::<Vector3<f64>>().z < 0.0 {
            elements.iter_mut().for_each(|element| element.swap(1, 2));
            normals.iter_mut().for_each(|normal| *normal = -*normal);
        }
        let normals =
            normals.into_iter().map(|normal| normal.try_normalize(0.0).unwrap_or_default()).collect();
        Self { nodes: mesh.nodes.clone(), elements, normals }
    }

    /// The skin as a body that is so thick, m.
    #[must_use]
    pub fn slab(&self, thickness: f64) -> Mesh {
        let count = self.nodes.len();
        let above = self.nodes.iter().zip(&self.normals).map(|(node, normal)| node + normal * thickness);
        let nodes = self.nodes.iter().copied().chain(above).collect();
        let top = self.elements.iter().map(|element| element.map(|node| node + count));
        let under = self.elements.iter().map(|&[a, b, c]| [a, c, b]);
        let walls = self.rim().flat_map(|[a, b]| [[a, b, b + count], [a, b + count, a + count]]);
        Mesh { nodes, elements: top.chain(under).chain(walls).collect(), electrodes: Vec::new() }
    }

    /// How far the skin's convex hull reaches out above or beyond it, m, about: of a simulator that collides hulls, by how
    /// much it touches too early.
    #[must_use]
    pub fn bulge(&self) -> f64 {
        let step = self.elements.len().div_ceil(HULL_POINTS).max(1);
        let rim: Vec<_> = self.rim().map(|[a, _]| a).collect();
        let rim = rim.iter().copied().step_by(rim.len().div_ceil(HULL_POINTS).max(1));
        let inside = self.elements.iter().step_by(step).map(|element| element[0]);
        let some: Vec<_> = rim.chain(inside).map(|node| &self.nodes[node]).collect();
        let pairs = some.iter().enumerate().flat_map(|(at, a)| some[..at].iter().map(move |b| (a, b)));
        pairs.map(|(a, b)| self.above(nalgebra::center(a, b))).fold(0.0, f64::max)
    }

    /// So many points, each new one as far from those before as any: the first is in the middle.
    #[must_use]
    pub fn spread(&self, count: usize) -> Spread {
        let middle =
            self.nodes.iter().map(|node| node.coords).sum::<Vector3<f64>>() / self.nodes.len().max(1) as f64;
        let from_middle = |node: &&Point3<f64>| (node.coords - middle).norm();
        let first = self.nodes.iter().min_by(|a, b| from_middle(a).total_cmp(&from_middle(b)));
        let Some(mut next) = first.copied().filter(|_| count > 0) else { return Spread::default() };
        let mut points = Vec::new();
        let mut away = vec![f64::INFINITY; self.nodes.len()];
        loop {
            points.push(next);
            self.nodes.iter().zip(&mut away).for_each(|(node, away)| *away = away.min((node - next).norm()));
            let farthest = (0..away.len()).max_by(|&a, &b| away[a].total_cmp(&away[b])).unwrap_or(0);
            if points.len() == count.min(away.len()) {
                return Spread { points, radius: away[farthest] };
            }
            next = self.nodes[farthest];
        }
    }

    /// How far a point lies above the skin or beside it; 0 for one under it.
    fn above(&self, point: Point3<f64>) -> f64 {
        let corners = |element: &[usize; 3]| element.map(|node| self.nodes[node]);
        let from = |element: &[usize; 3]| {
            let corners = corners(element);
            (point - triangle::nearest(corners, point), triangle::normal(corners))
        };
        let all = self.elements.iter().map(from);
        let nearest = all.min_by(|(a, _), (b, _)| a.norm_squared().total_cmp(&b.norm_squared()));
        let (away, normal) = nearest.unwrap_or_default();
        let distance = away.norm();
        if away.dot(&normal) < -BESIDE * distance { 0.0 } else { distance }
    }

    /// Edges of the rim, in the order of their triangles.
    fn rim(&self) -> impl Iterator<Item = [usize; 2]> {
        let rim: std::collections::HashSet<_> = boundary_edges(&self.elements).into_iter().collect();
        let edges = self.elements.iter().flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]]);
        edges.filter(move |&[a, b]| rim.contains(&[a.min(b), a.max(b)]))
    }
}

/// Sums of the normals of a node's triangles, by their areas: `[node]`.
fn normals(mesh: &Mesh, elements: &[[usize; 3]]) -> Vec<Vector3<f64>> {
    let mut normals = vec![Vector3::zeros(); mesh.nodes.len()];
    for &element in elements {
        let [a, b, c] = mesh.points(element);
        let normal = (b - a).cross(&(c - a));
        element.iter().for_each(|&node| normals[node] += normal);
    }
    normals
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A net of `across` by `across` squares of 1 cm, at a height that follows from x and y; every second triangle lies
    /// the wrong way round.
    fn net(across: usize, height: impl Fn(f64, f64) -> f64) -> Mesh {
        let side = across + 1;
        let point = |at: usize| {
            let [x, y] = [at % side, at / side].map(|i| (i as f64 - across as f64 / 2.0) * 0.01);
            Point3::new(x, y, height(x, y))
        };
        let corners = (0..side * across).filter(|at| at % side < across);
        let elements = corners.flat_map(|at| [[at, at + 1, at + side], [at + 1, at + side, at + side + 1]]);
        Mesh {
            nodes: (0..side * side).map(point).collect(),
            elements: elements.collect(),
            electrodes: Vec::new(),
        }
    }

    /// Volume of a closed body by the divergence theorem; it is right only if every triangle faces outward.
    fn volume(mesh: &Mesh) -> f64 {
        let parts = (0..mesh.elements.len()).map(|element| {
            let [a, b, c] = mesh.corners(element).map(|corner| corner.coords);
            a.dot(&b.cross(&c)) / 6.0
        });
        parts.sum()
    }

    #[test]
    fn a_slab_is_closed_and_faces_outward_and_lies_on_the_skin() {
        for height in [(|_, _| 0.0) as fn(f64, f64) -> f64, |x, y| 0.05 - 2.0 * (x * x + y * y)] {
            let mesh = net(6, height);
            let slab = Surface::of(&mesh).slab(1e-3);
            assert!(boundary_edges(&slab.elements).is_empty());
            let area: f64 =
                (0..mesh.elements.len()).map(|element| triangle::area(mesh.corners(element))).sum();
            let found = volume(&slab);
            assert!((found / (area * 1e-3) - 1.0).abs() < 0.01, "{found} of {area}");
            let [low, high] = [f64::INFINITY, f64::NEG_INFINITY];
            let z = slab.nodes.iter().map(|node| node.z - height(node.x, node.y));
            let (low, high) = z.fold((low, high), |(low, high), z| (low.min(z), high.max(z)));
            assert!(low.abs() < 1e-12 && (0.99e-3..1.03e-3).contains(&high), "{low} {high}");
        }
    }

    #[test]
    fn spread_points_cover_the_skin() {
        let surface = Surface::of(&net(10, |_, _| 0.0));
        assert_eq!(surface.spread(0), Spread::default());
        let one = surface.spread(1);
        assert!(one.points[0].coords.norm() < 1e-12 && (one.radius - 0.05 * 2f64.sqrt()).abs() < 1e-9);
        let many = surface.spread(32);
        assert!(many.points.len() == 32 && many.radius < 0.015, "{many:?}");
        let all = surface.spread(1000);
        assert!(all.points.len() == 121 && all.radius == 0.0, "{}", all.points.len());
    }

    #[test]
    fn a_hull_fills_what_is_hollow_and_only_that() {
        assert!(Surface::of(&net(6, |_, _| 0.0)).bulge() < 1e-9);
        assert!(Surface::of(&net(6, |x, y| -2.0 * (x * x + y * y))).bulge() < 1e-9);
        // A saddle's hull lies 2 * 0.03^2 m above its middle.
        let saddle = Surface::of(&net(6, |x, y| 2.0 * (x * x - y * y))).bulge();
        assert!((1.2e-3..2e-3).contains(&saddle), "{saddle}");
        // An L's hull spans its inner corner, half a diagonal of 3 cm away.
        let mut hooked = net(6, |_, _| 0.0);
        hooked.elements.retain(|element| element.iter().any(|&node| node % 7 < 3 || node / 7 < 3));
        let hooked = Surface::of(&hooked).bulge();
        assert!((0.012..0.022).contains(&hooked), "{hooked}");
    }
}
