//! Deform: a sheet that is stretched, and electrodes that slip along its rim.

use dermatome_geometry::mesh::{Mesh, soundness};
use nalgebra::{Point3, Vector3};
use rand::Rng;

/// Nodes inside follow those of the rim up to so many times the distance of two electrodes.
const REACH: f64 = 1.0;

/// Nothing of the kind can happen to a skin.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{0}")]
pub struct DeformError(pub(crate) &'static str);

/// Nodes of a sheet longer by this share in the direction `along`, rad from x; a conductivity per square stays what it was.
pub(crate) fn stretch(nodes: &[Point3<f64>], by: f64, along: f64) -> Vec<Point3<f64>> {
    let direction = Vector3::new(along.cos(), along.sin(), 0.0);
    nodes.iter().map(|node| node + direction * (by * direction.dot(&node.coords))).collect()
}

/// Nodes of a sheet whose electrodes have slipped along the rim by this length, m, each one way or the other.
///
/// The sheet stays where it is: nodes of the rim move along it, wholly under an electrode and not at all halfway to the
/// next, and those inside follow, so that the mesh stays sound and nothing else of it changes.
pub(crate) fn slip(mesh: &Mesh, by: f64, random: &mut impl Rng) -> Result<Vec<Point3<f64>>, DeformError> {
    let rim = Rim::of(mesh)?;
    let signs: Vec<f64> = rim.electrodes.iter().map(|_| if random.random() { by } else { -by }).collect();
    let moves: Vec<(Point3<f64>, Vector3<f64>)> = (0..rim.nodes.len())
        .map(|place| {
            let point = mesh.nodes[rim.nodes[place]];
            (point, rim.point(mesh, rim.lengths[place] + rim.slip(rim.lengths[place], &signs)) - point)
        })
        .collect();
    let reach = REACH * rim.perimeter / rim.electrodes.len() as f64;
    let mut nodes: Vec<_> = mesh.nodes.iter().map(|node| node + follow(node, &moves, reach)).collect();
    for (&node, (point, by)) in rim.nodes.iter().zip(&moves) {
        nodes[node] = point + by;
    }
    Ok(nodes)
}

/// Mean of the moves weighted by distance^-4 (Shepard), fading to none at `reach`, m.
///
/// Numbers rather than vectors: all nodes times all of the rim are what the experiments take longest for.
fn follow(node: &Point3<f64>, moves: &[(Point3<f64>, Vector3<f64>)], reach: f64) -> Vector3<f64> {
    let [x, y, z] = [node.x, node.y, node.z];
    let ([mut along_x, mut along_y, mut along_z], mut weights, mut nearest) = ([0.0; 3], 0.0, f64::INFINITY);
    for (point, by) in moves {
        let (dx, dy, dz) = (x - point.x, y - point.y, z - point.z);
        let square = (dx * dx + dy * dy + dz * dz).max(f64::MIN_POSITIVE);
        let weight = 1.0 / (square * square);
        along_x += by.x * weight;
        along_y += by.y * weight;
        along_z += by.z * weight;
        weights += weight;
        nearest = nearest.min(square);
    }
    if weights.is_finite() {
        let sum = Vector3::new(along_x, along_y, along_z);
        sum / weights * (1.0 - nearest.sqrt() / reach).max(0.0)
    } else {
        Vector3::zeros()
    }
}

/// The longest boundary of a mesh, with the electrodes that lie on it.
struct Rim {
    /// In order: `[place]`.
    nodes: Vec<usize>,
    /// Length from the first node on, m: `[place]`.
    lengths: Vec<f64>,
    perimeter: f64,
    /// Where electrodes begin and end, m, from the first node on; one may begin below zero. By their middles.
    electrodes: Vec<[f64; 2]>,
}

impl Rim {
    fn of(mesh: &Mesh) -> Result<Self, DeformError> {
        let nodes = soundness::inspect(&mesh.nodes, &mesh.elements).boundary_loops.into_iter().next();
        let nodes = nodes.ok_or(DeformError("the skin has no rim along which electrodes may slip"))?;
        let (mut lengths, mut perimeter) = (Vec::new(), 0.0);
        for (place, &node) in nodes.iter().enumerate() {
            lengths.push(perimeter);
            perimeter += (mesh.nodes[nodes[(place + 1) % nodes.len()]] - mesh.nodes[node]).norm();
        }
        let mut rim = Self { nodes, lengths, perimeter, electrodes: Vec::new() };
        for contact in &mesh.electrodes {
            let places = contact.nodes().map(|node| rim.nodes.iter().position(|&other| other == node));
            let ends = places.map(|place| Some(rim.lengths[place?])).collect::<Option<Vec<_>>>();
            let ends = ends.ok_or(DeformError("an electrode is not on the rim, along which they slip"))?;
            rim.electrodes.push(rim.extent(&ends));
        }
        rim.electrodes.sort_by(|a, b| (a[0] + a[1]).total_cmp(&(b[0] + b[1])));
        Ok(rim)
    }

    /// From where to where these lengths lie, once round if they lie on both sides of the first node.
    fn extent(&self, lengths: &[f64]) -> [f64; 2] {
        let first = lengths.first().copied().unwrap_or(0.0);
        let near = lengths.iter().map(|length| first + self.wrapped(length - first));
        near.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], at| [low.min(at), high.max(at)])
    }

    /// A length between minus and plus half of the perimeter.
    fn wrapped(&self, length: f64) -> f64 {
        length - (length / self.perimeter).round() * self.perimeter
    }

    /// By how much the rim slips at a length.
    fn slip(&self, length: f64, signs: &[f64]) -> f64 {
        let count = self.electrodes.len();
        let away = |electrode: usize| {
            let [low, high] = self.electrodes[electrode];
            let off = self.wrapped(length - (low + high) / 2.0).abs() - (high - low) / 2.0;
            off.max(0.0)
        };
        let Some(nearest) = (0..count).min_by(|&a, &b| away(a).total_cmp(&away(b))) else { return 0.0 };
        let middle = |electrode: usize| (self.electrodes[electrode][0] + self.electrodes[electrode][1]) / 2.0;
        let width = self.electrodes[nearest][1] - self.electrodes[nearest][0];
        let gap = [1, count - 1]
            .map(|on| self.wrapped(middle((nearest + on) % count) - middle(nearest)).abs())
            .into_iter()
            .fold(self.perimeter, f64::min);
        let half_gap = ((gap - width) / 2.0).max(f64::MIN_POSITIVE);
        signs[nearest] * (1.0 - away(nearest) / half_gap).max(0.0)
    }

    /// The point of the rim at a length.
    fn point(&self, mesh: &Mesh, length: f64) -> Point3<f64> {
        let length = length.rem_euclid(self.perimeter);
        let place = self.lengths.partition_point(|&other| other <= length).saturating_sub(1);
        let [from, to] = [place, (place + 1) % self.nodes.len()].map(|place| mesh.nodes[self.nodes[place]]);
        let edge = (to - from).norm();
        from + (to - from) * ((length - self.lengths[place]) / edge).min(1.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::evaluate::tests::coarse_disc;
    use dermatome_geometry::mesh::triangle;
    use dermatome_simulate::TrueSkin;
    use rand::SeedableRng;
    use rand_pcg::Pcg64Mcg;

    fn middle(nodes: &[Point3<f64>], mesh: &Mesh, electrode: usize) -> Vector3<f64> {
        let points: Vec<_> = mesh.electrodes[electrode].nodes().map(|node| nodes[node].coords).collect();
        points.iter().sum::<Vector3<f64>>() / points.len() as f64
    }

    #[test]
    fn electrodes_slip_along_the_rim_and_the_sheet_stays() {
        let truth = TrueSkin::new(&coarse_disc()).unwrap();
        let mesh = truth.mesh();
        let nodes = slip(mesh, 1e-3, &mut Pcg64Mcg::seed_from_u64(3)).unwrap();
        let mut ways = [0; 2];
        for electrode in 0..mesh.electrodes.len() {
            let [before, after] = [&mesh.nodes, &nodes].map(|nodes| middle(nodes, mesh, electrode));
            assert!(
                ((after - before).norm() - 1e-3).abs() < 3e-5,
                "{electrode}: {}",
                (after - before).norm()
            );
            assert!((after.norm() - before.norm()).abs() < 1e-4);
            ways[usize::from(before.cross(&after).z > 0.0)] += 1;
        }
        assert!(ways[0] > 0 && ways[1] > 0);
        let area = |nodes: &[Point3<f64>]| {
            mesh.elements
                .iter()
                .map(|element| triangle::area(element.map(|node| nodes[node])))
                .collect::<Vec<_>>()
        };
        let [before, after] = [&mesh.nodes, &nodes].map(|nodes| area(nodes));
        assert!((after.iter().sum::<f64>() / before.iter().sum::<f64>() - 1.0).abs() < 1e-3);
        assert!(before.iter().zip(&after).all(|(before, after)| (0.4..2.5).contains(&(after / before))));
    }

    #[test]
    fn a_stretched_sheet_is_longer_in_one_direction_only() {
        let nodes = [Point3::new(0.1, 0.0, 0.0), Point3::new(0.0, 0.1, 0.02), Point3::new(0.03, 0.03, 0.0)];
        let along_x = stretch(&nodes, 0.01, 0.0);
        assert!((along_x[0] - Point3::new(0.101, 0.0, 0.0)).norm() < 1e-15);
        assert!((along_x[1] - nodes[1]).norm() < 1e-15);
        let along_both = stretch(&nodes, 0.01, std::f64::consts::FRAC_PI_4);
        assert!((along_both[2] - Point3::new(0.0303, 0.0303, 0.0)).norm() < 1e-15);
    }

    #[test]
    fn electrodes_that_do_not_slip_leave_everything_as_it_was() {
        let truth = TrueSkin::new(&coarse_disc()).unwrap();
        let nodes = slip(truth.mesh(), 0.0, &mut Pcg64Mcg::seed_from_u64(3)).unwrap();
        let most = nodes.iter().zip(&truth.mesh().nodes).map(|(a, b)| (a - b).norm()).fold(0.0, f64::max);
        assert!(most < 1e-12, "{most}");
    }
}
