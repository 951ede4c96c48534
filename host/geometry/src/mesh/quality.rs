//! Quality of a mesh in a few numbers.

use super::{Mesh, triangle};
use rayon::prelude::*;
use serde::Serialize;

/// How good a mesh is.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Quality {
    /// Number of nodes.
    pub nodes: usize,
    /// Number of triangles.
    pub elements: usize,
    /// Smallest angle of any triangle, degrees.
    pub smallest_angle_degrees: f64,
    /// The first triangle with that angle, from 0.
    pub sharpest_element: usize,
    /// Shortest edge, m.
    pub shortest_edge: f64,
    /// Longest edge, m.
    pub longest_edge: f64,
    /// Area of all triangles, m^2.
    pub area: f64,
}

/// Triangles that are worth a core of their own.
const MANY: usize = 4096;

/// Looks at every triangle.
#[must_use]
pub fn quality(mesh: &Mesh) -> Quality {
    let elements = || (0..mesh.elements.len()).into_par_iter().with_min_len(MANY);
    let angles = elements().map(|element| (triangle::smallest_angle(mesh.corners(element)), element));
    let (smallest, sharpest_element) =
        angles.reduce(|| (f64::INFINITY, 0), |least, it| if it < least { it } else { least });
    let lengths = elements().flat_map_iter(|element| {
        let [a, b, c] = mesh.corners(element);
        [a - b, b - c, c - a].map(|edge| (edge.norm(), edge.norm()))
    });
    let wider = |a: (f64, f64), b: (f64, f64)| (a.0.min(b.0), a.1.max(b.1));
    let (shortest_edge, longest_edge) = lengths.reduce(|| (f64::INFINITY, 0.0), wider);
    Quality {
        nodes: mesh.nodes.len(),
        elements: mesh.elements.len(),
        smallest_angle_degrees: smallest.to_degrees(),
        sharpest_element,
        shortest_edge,
        longest_edge,
        // In one order, so that the sum does not depend on how many cores there are.
        area: (0..mesh.elements.len()).map(|element| triangle::area(mesh.corners(element))).sum(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::{ElectrodeContact, Lattice, generate};
    use crate::{
        embedding::Embedding,
        outline::Outline,
        sheet::{EdgeLengths, ElectrodeModel, Place, Sheet},
    };
    use proptest::prelude::*;

    fn sheet(outline: Outline, electrodes: u8) -> Sheet {
        let spacing = outline.perimeter() / f64::from(electrodes);
        let places = (0..electrodes).map(|i| Place::Rim(f64::from(i) * spacing)).collect();
        Sheet { outline, embedding: Embedding::Flat, places }
    }

    fn model(sheet: &Sheet, cover: f64) -> ElectrodeModel {
        let count = sheet.places.len();
        let width = cover * sheet.outline.perimeter() / count as f64;
        match cover {
            0.0 => ElectrodeModel::Point,
            _ => ElectrodeModel::Complete { width: vec![width; count], contact_impedance: vec![0.01; count] },
        }
    }

    #[test]
    fn the_sharpest_triangle_and_the_extreme_edges_are_found() {
        let nodes = [[0.0, 0.0, 0.0], [4.0, 0.0, 0.0], [4.0, 3.0, 0.0], [0.0, 3.0, 0.0], [-1.0, 0.0, 0.0]];
        let mesh = Mesh {
            nodes: nodes.map(Into::into).to_vec(),
            elements: vec![[0, 1, 2], [0, 3, 4], [0, 2, 3]],
            electrodes: Vec::new(),
        };
        let found = quality(&mesh);
        assert_eq!((found.nodes, found.elements, found.sharpest_element), (5, 3, 1));
        assert!((found.smallest_angle_degrees.to_radians().tan() - 1.0 / 3.0).abs() < 1e-12);
        assert_eq!((found.shortest_edge, found.longest_edge, found.area), (1.0, 5.0, 13.5));
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(24))]
        #[test]
        fn every_mesh_is_sound_and_its_electrodes_are_as_long_as_asked(
            disc in any::<bool>(),
            aspect in 0.4..1.0,
            fineness in 20.0..40.0,
            cover in prop_oneof![Just(0.0), 0.4..0.8],
            angle in 0.0..1.0,
        ) {
            let outline = if disc { Outline::disc(0.5) } else { Outline::rectangle(1.0, aspect) };
            let sheet = sheet(outline, 16);
            let model = model(&sheet, cover);
            let edges = EdgeLengths { skin: 1.0 / fineness, electrodes: 1.0 / fineness };
            let mesh = generate(&sheet, &model, edges, Lattice { angle, shift: 0.3 }).unwrap();
            let quality = quality(&mesh);
            // An electrode's end close to a corner forces a short edge, and a sharp angle beside it.
            let shortest: f64 = quality.shortest_edge * fineness;
            prop_assert!(quality.smallest_angle_degrees > (18.0 * shortest).min(14.0), "{shortest} {quality:?}");
            for contact in &mesh.electrodes {
                let ElectrodeContact::Edges(edges) = contact else { continue };
                let length: f64 = edges.iter().map(|&[a, b]| (mesh.nodes[a] - mesh.nodes[b]).norm()).sum();
                prop_assert!((length / model.width(0) - 1.0).abs() < 0.15, "{length}");
            }
        }
    }
}
