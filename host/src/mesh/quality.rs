//! Quality of a mesh in a few numbers.

use super::{Mesh, triangle};
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
    /// Area of all triangles, m^2.
    pub area: f64,
}

/// Looks at every triangle.
#[must_use]
pub fn quality(mesh: &Mesh) -> Quality {
    let corners = (0..mesh.elements.len()).map(|element| mesh.corners(element));
    let smallest = corners.clone().map(triangle::smallest_angle).fold(f64::INFINITY, f64::min);
    Quality {
        nodes: mesh.nodes.len(),
        elements: mesh.elements.len(),
        smallest_angle_degrees: smallest.to_degrees(),
        area: corners.map(triangle::area).sum(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::{ElectrodeContact, Lattice, generate};
    use crate::skin::{
        electrodes::{ElectrodeModel, Electrodes},
        outline::Outline,
    };
    use proptest::prelude::*;

    fn electrodes(outline: &Outline, count: u8, cover: f64) -> Electrodes {
        let spacing = outline.perimeter() / f64::from(count);
        let model = match cover {
            0.0 => ElectrodeModel::Point,
            _ => ElectrodeModel::Complete {
                width: cover * spacing,
                contact_impedance: vec![0.01; count.into()],
            },
        };
        Electrodes { centres: (0..count).map(|i| f64::from(i) * spacing).collect(), model, ground: 0 }
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
            let outline = if disc { Outline::Disc { radius: 0.5 } } else { Outline::Rectangle { width: 1.0, height: aspect } };
            let electrodes = electrodes(&outline, 16, cover);
            let mesh = generate(&outline, &electrodes, 1.0 / fineness, Lattice { angle, shift: 0.3 }).unwrap();
            let quality = quality(&mesh);
            // An electrode's end close to a corner forces a short edge, and a sharp angle beside it.
            let edges = mesh.elements.iter().flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]]);
            let lengths = edges.map(|[a, b]| (mesh.nodes[a] - mesh.nodes[b]).norm());
            let shortest: f64 = lengths.fold(f64::INFINITY, f64::min) * fineness;
            prop_assert!(quality.smallest_angle_degrees > (18.0 * shortest).min(14.0), "{shortest} {quality:?}");
            for contact in &mesh.electrodes {
                let ElectrodeContact::Edges(edges) = contact else { continue };
                let length: f64 = edges.iter().map(|&[a, b]| (mesh.nodes[a] - mesh.nodes[b]).norm()).sum();
                prop_assert!((length / electrodes.width() - 1.0).abs() < 0.15, "{length}");
            }
        }
    }
}
