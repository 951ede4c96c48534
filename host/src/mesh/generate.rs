//! Generates the mesh of a flat convex skin: rim points that honour electrodes and corners, a
//! triangular lattice inside, and a Delaunay triangulation (crate spade) of both.

use super::{ElectrodeContact, Mesh};
use crate::skin::{
    electrodes::{ElectrodeModel, Electrodes},
    outline::Outline,
};
use nalgebra::{Point2, Point3, Rotation2};
use spade::{DelaunayTriangulation, Triangulation};

/// How the inner points lie: turned and shifted against the axes, so that two meshes of one skin
/// need not share a node.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Lattice {
    /// Turn against the x axis, rad.
    pub angle: f64,
    /// Shift along both lattice directions, in edge lengths.
    pub shift: f64,
}

/// Why no mesh could be made.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum MeshError {
    /// The triangulation refused a point.
    #[error("the mesh generator cannot place a point: {0}")]
    Point(String),
    /// The triangles do not cover the skin.
    #[error(
        "the mesh covers {covered:.9} of the skin's area where 1 is expected; try another mesh.edge_length"
    )]
    Coverage {
        /// Share of the area covered.
        covered: f64,
    },
}

/// Rounds of moving each inner node to the mean of its neighbours.
const SMOOTHING_ROUNDS: usize = 4;
/// Inner points keep this distance from the rim, in edge lengths.
const RIM_CLEARANCE: f64 = 0.6;

/// Mesh of a skin with triangles of about `edge_length` (m).
pub fn generate(
    outline: &Outline,
    electrodes: &Electrodes,
    edge_length: f64,
    lattice: Lattice,
) -> Result<Mesh, MeshError> {
    let rim = Rim::new(outline, electrodes, edge_length);
    let mut points: Vec<Point2<f64>> = rim.positions.iter().map(|&s| outline.rim_point(s)).collect();
    points.extend(inner_points(outline, edge_length, lattice));
    let mut elements = triangulate(&points)?;
    for _ in 0..SMOOTHING_ROUNDS {
        smooth(&mut points, &elements, rim.positions.len());
        elements = triangulate(&points)?;
    }
    let nodes: Vec<_> = points.iter().map(|p| Point3::new(p.x, p.y, 0.0)).collect();
    let mesh = Mesh { nodes, elements, electrodes: rim.contacts };
    check_coverage(&mesh, &rim.positions, outline)?;
    Ok(mesh)
}

/// Points on the rim, in counter-clockwise order; their numbers are node numbers.
struct Rim {
    positions: Vec<f64>,
    contacts: Vec<ElectrodeContact>,
}

impl Rim {
    fn new(outline: &Outline, electrodes: &Electrodes, edge_length: f64) -> Self {
        let perimeter = outline.perimeter();
        let breaks = breaks(outline, electrodes);
        let mut positions = Vec::new();
        let mut edges = vec![Vec::new(); electrodes.centres.len()];
        for (i, &from) in breaks.iter().enumerate() {
            let length = match breaks.get(i + 1) {
                Some(to) => to - from,
                None => breaks[0] + perimeter - from,
            };
            let electrode = covering(electrodes, from + length / 2.0, perimeter);
            let pieces =
                ((length / edge_length).ceil() as usize).max(if electrode.is_some() { 2 } else { 1 });
            for piece in 0..pieces {
                if let Some(electrode) = electrode {
                    edges[electrode].push([positions.len(), positions.len() + 1]);
                }
                positions.push(from + length * piece as f64 / pieces as f64);
            }
        }
        let count = positions.len();
        edges.iter_mut().flatten().for_each(|edge| edge[1] %= count);
        let contacts = contacts(electrodes, &positions, edges, perimeter);
        Self { positions, contacts }
    }
}

fn contacts(
    electrodes: &Electrodes,
    positions: &[f64],
    edges: Vec<Vec<[usize; 2]>>,
    perimeter: f64,
) -> Vec<ElectrodeContact> {
    let nearest = |centre: &f64| {
        let distance = |s: f64| circular_distance(s, *centre, perimeter);
        let node =
            (0..positions.len()).min_by(|&a, &b| distance(positions[a]).total_cmp(&distance(positions[b])));
        ElectrodeContact::Node(node.unwrap_or(0))
    };
    match electrodes.model {
        ElectrodeModel::Point => electrodes.centres.iter().map(nearest).collect(),
        ElectrodeModel::Complete { .. } => edges.into_iter().map(ElectrodeContact::Edges).collect(),
    }
}

/// Arc lengths that must carry a node: electrode ends (or points) and corners, ascending.
fn breaks(outline: &Outline, electrodes: &Electrodes) -> Vec<f64> {
    let perimeter = outline.perimeter();
    let half = electrodes.width() / 2.0;
    let ends = electrodes.centres.iter().flat_map(|centre| [centre - half, centre + half]);
    let mut breaks: Vec<f64> = ends.chain(outline.corners()).map(|s| s.rem_euclid(perimeter)).collect();
    breaks.sort_by(f64::total_cmp);
    breaks.dedup_by(|a, b| (*a - *b).abs() < 1e-9 * perimeter);
    if breaks.len() > 1 && breaks[0] + perimeter - breaks[breaks.len() - 1] < 1e-9 * perimeter {
        breaks.pop();
    }
    breaks
}

/// The electrode that covers arc length `s`, if any.
fn covering(electrodes: &Electrodes, s: f64, perimeter: f64) -> Option<usize> {
    let half = electrodes.width() / 2.0;
    electrodes.centres.iter().position(|&centre| circular_distance(s, centre, perimeter) < half)
}

fn circular_distance(a: f64, b: f64, perimeter: f64) -> f64 {
    let ahead = (a - b).rem_euclid(perimeter);
    ahead.min(perimeter - ahead)
}

/// Points of a triangular lattice that lie well inside the outline.
fn inner_points(outline: &Outline, edge_length: f64, lattice: Lattice) -> Vec<Point2<f64>> {
    let turn = Rotation2::new(lattice.angle);
    let row_height = edge_length * 3_f64.sqrt() / 2.0;
    let [x, y] = outline.half_size();
    let (sin, cos) = lattice.angle.sin_cos();
    let rows = ((x * sin.abs() + y * cos.abs()) / row_height).ceil() as i64 + 2;
    let columns = ((x * cos.abs() + y * sin.abs()) / edge_length).ceil() as i64 + 2;
    let lattice_point = |row: i64, column: i64| {
        let along = column as f64 + 0.5 * row.rem_euclid(2) as f64 + lattice.shift;
        turn * Point2::new(along * edge_length, (row as f64 + lattice.shift) * row_height)
    };
    (-rows..=rows)
        .flat_map(|row| (-columns..=columns).map(move |column| lattice_point(row, column)))
        .filter(|&point| outline.depth(point) > RIM_CLEARANCE * edge_length)
        .collect()
}

fn triangulate(points: &[Point2<f64>]) -> Result<Vec<[usize; 3]>, MeshError> {
    let vertices = points.iter().map(|p| spade::Point2::new(p.x, p.y)).collect();
    let triangulation = DelaunayTriangulation::<spade::Point2<f64>>::bulk_load_stable(vertices)
        .map_err(|error| MeshError::Point(error.to_string()))?;
    let corners = triangulation.inner_faces().map(|face| face.vertices().map(|vertex| vertex.index()));
    // Rounding can leave flat triangles along a straight side; they hold no skin.
    Ok(corners.filter(|&corners| !is_flat(corners.map(|node| points[node]))).collect())
}

fn is_flat([p, q, r]: [Point2<f64>; 3]) -> bool {
    let doubled_area = (q - p).perp(&(r - p)).abs();
    let longest = (q - p).norm_squared().max((r - p).norm_squared()).max((r - q).norm_squared());
    doubled_area < 1e-6 * longest
}

/// Moves every node behind the first `fixed` to the mean of its neighbours.
fn smooth(points: &mut [Point2<f64>], elements: &[[usize; 3]], fixed: usize) {
    let mut sums = vec![(nalgebra::Vector2::zeros(), 0.0); points.len()];
    for element in elements {
        for corner in 0..3 {
            let [node, next, last] = [element[corner], element[(corner + 1) % 3], element[(corner + 2) % 3]];
            sums[node].0 += points[next].coords + points[last].coords;
            sums[node].1 += 2.0;
        }
    }
    for (point, (sum, count)) in points.iter_mut().zip(sums).skip(fixed) {
        *point = Point2::from(sum / count);
    }
}

/// The triangles must fill the polygon of rim points, no more and no less.
fn check_coverage(mesh: &Mesh, rim: &[f64], outline: &Outline) -> Result<(), MeshError> {
    let corner = |i: usize| outline.rim_point(rim[i % rim.len()]).coords;
    let polygon: f64 = (0..rim.len()).map(|i| corner(i).perp(&corner(i + 1)) / 2.0).sum();
    let triangles: f64 = (0..mesh.elements.len()).map(|e| super::triangle::area(mesh.corners(e))).sum();
    let covered = triangles / polygon;
    if (covered - 1.0).abs() < 1e-9 { Ok(()) } else { Err(MeshError::Coverage { covered }) }
}
