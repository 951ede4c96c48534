//! Meshes with as many nodes and elements as the thesis' Figs 5.2 and 5.6: rings of nodes round a middle one, and
//! electrodes that are nodes of the last ring.

use dermatome_geometry::mesh::{ElectrodeContact, Mesh};
use nalgebra::Point3;
use std::f64::consts::{FRAC_PI_2, TAU};

/// Electrodes.
const ELECTRODES: usize = 16;
/// Nodes of the rings of a mesh with 337 nodes and 624 elements. Euler's formula leaves 48 edges on the boundary, three
/// from electrode to electrode; the rings between are ours, as many nodes on each as keep edges about equal.
const OF_FIGURE_5_2: [usize; 10] = [8, 16, 23, 29, 35, 40, 43, 46, 48, 48];
/// Rings of EIDORS' common circular model with 1201 nodes and 2304 elements: four nodes more on each.
const RINGS_OF_FIGURE_5_6: usize = 24;

/// Fig. 5.2: a hemisphere with its pole up, its rings in equal steps of latitude; radius in m.
pub(super) fn hemisphere(radius: f64) -> Mesh {
    rings(&OF_FIGURE_5_2, |share, direction| {
        let (away, up) = (share * FRAC_PI_2).sin_cos();
        let (sine, cosine) = direction.sin_cos();
        Point3::new(away * cosine, away * sine, up) * radius
    })
}

/// Fig. 5.6: a disc; radius in m.
pub(super) fn disc(radius: f64) -> Mesh {
    let counts: Vec<usize> = (1..=RINGS_OF_FIGURE_5_6).map(|ring| 4 * ring).collect();
    rings(&counts, |share, direction| {
        let (sine, cosine) = direction.sin_cos();
        Point3::new(cosine, sine, 0.0) * (radius * share)
    })
}

/// Rings of so many nodes, evenly from the top clockwise, round a middle node. `lay` takes the ring's share of the way
/// to the last one and the direction, rad.
fn rings(counts: &[usize], lay: impl Fn(f64, f64) -> Point3<f64>) -> Mesh {
    let mut nodes = vec![lay(0.0, 0.0)];
    let mut elements = Vec::new();
    let mut inner = (0, 1);
    for (ring, &count) in (1..).zip(counts) {
        let outer = (nodes.len(), count);
        let share = f64::from(ring) / counts.len() as f64;
        nodes.extend((0..count).map(|k| lay(share, FRAC_PI_2 - TAU * k as f64 / count as f64)));
        elements.extend(between(inner, outer));
        inner = outer;
    }
    let (first, count) = inner;
    let electrode = |k: usize| ElectrodeContact::Node(first + k * count / ELECTRODES);
    Mesh { nodes, elements, electrodes: (0..ELECTRODES).map(electrode).collect() }
}

/// Triangles between two rings, each given by its first node and their number: the ring whose next node comes first in
/// the round goes on.
fn between((inner, few): (usize, usize), (outer, many): (usize, usize)) -> Vec<[usize; 3]> {
    let a = |i: usize| inner + i % few;
    let b = |j: usize| outer + j % many;
    if few == 1 {
        return (0..many).map(|j| [inner, b(j), b(j + 1)]).collect();
    }
    let (mut i, mut j) = (0, 0);
    let mut triangles = Vec::new();
    while i < few || j < many {
        if i == few || j < many && (j + 1) * few <= (i + 1) * many {
            triangles.push([a(i), b(j), b(j + 1)]);
            j += 1;
        } else {
            triangles.push([a(i), b(j), a(i + 1)]);
            i += 1;
        }
    }
    triangles
}

#[cfg(test)]
mod tests {
    use super::*;
    use dermatome_geometry::mesh::{soundness::inspect, triangle};
    use std::f64::consts::PI;

    fn area(mesh: &Mesh) -> f64 {
        (0..mesh.elements.len()).map(|element| triangle::area(mesh.corners(element))).sum()
    }

    #[test]
    fn the_meshes_have_the_numbers_of_the_thesis_and_cover_their_surface_once() {
        for (mesh, counts, boundary, surface) in
            [(hemisphere(0.1), [337, 624], 48, 0.02 * PI), (disc(0.1), [1201, 2304], 96, 0.01 * PI)]
        {
            assert_eq!([mesh.nodes.len(), mesh.elements.len()], counts);
            let found = inspect(&mesh.nodes, &mesh.elements);
            assert_eq!(found.boundary_loops.len(), 1);
            assert_eq!(found.boundary_loops[0].len(), boundary);
            // An inscribed polyhedron is a little smaller.
            let share = area(&mesh) / surface;
            assert!((0.97..1.0).contains(&share), "{share}");
        }
    }

    #[test]
    fn electrodes_are_nodes_of_the_boundary_at_equal_angles_clockwise_from_the_top() {
        for mesh in [hemisphere(1.0), disc(1.0)] {
            for (k, electrode) in mesh.electrodes.iter().enumerate() {
                let at = mesh.centre(electrode);
                let angle = FRAC_PI_2 - TAU * k as f64 / 16.0;
                assert!((at - Point3::new(angle.cos(), angle.sin(), 0.0)).norm() < 1e-12, "{k}: {at}");
            }
        }
    }
}
