//! Atlas: how the measurements respond to one finger anywhere on the skin.
//!
//! At the nodes of the mesh the response is summed over the elements under the finger. Between them it is a
//! polynomial of second degree in the tangent plane of the nearest node, fitted to the responses at the nodes round it.

use crate::indenter::Press;
use crate::pixels::{Pixels, samples, tangents};
use dermatome_geometry::mesh::{Mesh, neighbours::orientation, triangle};
use nalgebra::{DVector, Matrix5, Point3, Vector3, Vector5};
use rayon::prelude::*;

/// Nodes that a polynomial is fitted to; it has five unknowns.
const ROUND: usize = 14;

/// Responses at all nodes.
#[derive(Clone, Debug)]
pub(super) struct Atlas {
    pub(super) sites: Vec<Site>,
}

/// A node and the responses round it.
#[derive(Clone, Debug)]
pub(super) struct Site {
    pub(super) place: Point3<f64>,
    axes: [Vector3<f64>; 2],
    /// How far the polynomial is good for, m.
    reach: f64,
    /// To a finger of strength 1 here.
    pub(super) response: DVector<f64>,
    /// Coefficients of x, y, x²/2, xy, y²/2.
    polynomial: [DVector<f64>; 5],
}

/// A place on the skin: a node, and how far along its axes, m.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Place {
    pub(super) site: usize,
    offset: [f64; 2],
}

/// The response to a finger of strength 1, and how it changes along two axes, for each metre.
pub(super) struct Response {
    pub(super) value: DVector<f64>,
    pub(super) slopes: [DVector<f64>; 2],
}

/// A finger of this radius at each node.
pub(super) fn fingers(mesh: &Mesh, radius: f64) -> Pixels {
    fingers_at(mesh, &mesh.nodes, radius)
}

/// Fingers of this radius, each as a pixel of which only the Jacobian is wanted.
pub(super) fn fingers_at(mesh: &Mesh, centres: &[Point3<f64>], radius: f64) -> Pixels {
    let press = Press::finger([0.0, 0.0], radius, 1.0);
    let share = |element: usize, centre: &Point3<f64>| {
        let corners = mesh.corners(element);
        let reach = corners.iter().map(|corner| (corner - centre).norm()).fold(f64::INFINITY, f64::min);
        if reach > radius + (corners[1] - corners[0]).norm().max((corners[2] - corners[0]).norm()) {
            return 0.0;
        }
        let (sum, count) = samples(corners).fold((0.0, 0.0), |(sum, count), point| {
            (sum + press.change_at([(point - centre).norm(), 0.0]), count + 1.0)
        });
        sum / count
    };
    let under = |centre: &Point3<f64>| {
        let shares = (0..mesh.elements.len()).map(|element| (element, share(element, centre)));
        shares.filter(|(_, share)| *share > 0.0).collect()
    };
    Pixels {
        elements: centres.par_iter().map(under).collect(),
        neighbours: Vec::new(),
        centres: Vec::new(),
        normals: Vec::new(),
        areas: Vec::new(),
        grid: None,
    }
}

impl Atlas {
    /// From the response at each node.
    pub(super) fn new(mesh: &Mesh, response: impl Fn(usize) -> DVector<f64>) -> Self {
        let responses: Vec<_> = (0..mesh.nodes.len()).map(response).collect();
        let normals = normals(mesh);
        let site = |node: usize| Site::new(node, &mesh.nodes, &normals[node], &responses);
        Self { sites: (0..mesh.nodes.len()).into_par_iter().map(site).collect() }
    }

    /// A node itself.
    pub(super) fn at_node(site: usize) -> Place {
        Place { site, offset: [0.0; 2] }
    }

    /// Where a place lies, m.
    pub(super) fn point(&self, at: Place) -> Point3<f64> {
        let Site { place, axes: [u, v], .. } = &self.sites[at.site];
        place + u * at.offset[0] + v * at.offset[1]
    }

    /// The place so far along the axes of another, m.
    pub(super) fn moved(&self, from: Place, [x, y]: [f64; 2]) -> Place {
        let [u, v] = self.sites[from.site].axes;
        self.nearest(self.point(from) + u * x + v * y)
    }

    /// The place that is closest to a point.
    pub(super) fn nearest(&self, point: Point3<f64>) -> Place {
        let away = |site: &usize| (self.sites[*site].place - point).norm_squared();
        let site = (0..self.sites.len()).min_by(|a, b| away(a).total_cmp(&away(b))).unwrap_or(0);
        let Site { place, axes, reach, .. } = &self.sites[site];
        let offset = axes.map(|axis| axis.dot(&(point - place)));
        // Beside the rim the skin ends.
        let shrink = (reach / offset[0].hypot(offset[1])).min(1.0);
        Place { site, offset: offset.map(|part| part * shrink) }
    }

    pub(super) fn response(&self, at: Place) -> Response {
        let Site { response, polynomial: [x1, y1, xx, xy, yy], .. } = &self.sites[at.site];
        let [x, y] = at.offset;
        Response {
            value: response + x1 * x + y1 * y + xx * (x * x / 2.0) + xy * (x * y) + yy * (y * y / 2.0),
            slopes: [x1 + xx * x + xy * y, y1 + xy * x + yy * y],
        }
    }
}

impl Site {
    fn new(node: usize, nodes: &[Point3<f64>], normal: &Vector3<f64>, responses: &[DVector<f64>]) -> Self {
        let place = nodes[node];
        let axes = tangents(normal);
        let round = round(node, nodes);
        let reach = round.iter().map(|&other| (nodes[other] - place).norm()).fold(0.0, f64::max) / 2.0;
        let terms = round.iter().map(|&other| {
            let away = nodes[other] - place;
            let [x, y] = axes.map(|axis| axis.dot(&away) / reach);
            let weight = (reach / away.norm()).powi(4);
            (other, weight, Vector5::new(x, y, x * x / 2.0, x * y, y * y / 2.0))
        });
        let terms: Vec<_> = terms.collect();
        let normal_matrix: Matrix5<f64> =
            terms.iter().map(|(_, weight, row)| row * row.transpose() * *weight).sum();
        let inverse = normal_matrix.try_inverse().unwrap_or_else(Matrix5::zeros);
        let units = [1, 1, 2, 2, 2].map(|power| reach.powi(power));
        let polynomial = std::array::from_fn(|coefficient| {
            let mut sum = DVector::zeros(responses[node].len());
            for (other, weight, row) in &terms {
                let share = (inverse * row)[coefficient] * weight / units[coefficient];
                sum += (&responses[*other] - &responses[node]) * share;
            }
            sum
        });
        Self { place, axes, reach, response: responses[node].clone(), polynomial }
    }
}

/// The nodes closest to one.
fn round(node: usize, nodes: &[Point3<f64>]) -> Vec<usize> {
    let away = |other: &usize| (nodes[*other] - nodes[node]).norm_squared();
    let mut others: Vec<usize> = (0..nodes.len()).filter(|&other| other != node).collect();
    let count = ROUND.min(others.len());
    if count < others.len() {
        others.select_nth_unstable_by(count, |a, b| away(a).total_cmp(&away(b)));
    }
    others.truncate(count);
    others
}

/// Unit normal at each node: the mean of its elements'.
fn normals(mesh: &Mesh) -> Vec<Vector3<f64>> {
    let signs = orientation(&mesh.elements);
    let mut normals = vec![Vector3::zeros(); mesh.nodes.len()];
    for (element, nodes) in mesh.elements.iter().enumerate() {
        let corners = mesh.corners(element);
        let normal = triangle::normal(corners) * (signs[element] * triangle::area(corners));
        nodes.iter().for_each(|&node| normals[node] += normal);
    }
    normals.into_iter().map(|normal| normal.try_normalize(0.0).unwrap_or_else(Vector3::z)).collect()
}
