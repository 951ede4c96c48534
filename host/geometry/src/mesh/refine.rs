//! Refining a mesh that was made elsewhere.

use super::{ElectrodeContact, Mesh};
use std::collections::HashMap;

/// Splits every triangle in four by the middles of its edges. Electrodes cover what they covered.
#[must_use]
pub fn refine(mesh: &Mesh) -> Mesh {
    let mut middles = Middles { nodes: mesh.nodes.clone(), of_edge: HashMap::new() };
    let elements = mesh.elements.iter().flat_map(|&element| middles.quarters(element)).collect();
    let electrodes = mesh.electrodes.iter().map(|contact| middles.contact(contact)).collect();
    Mesh { nodes: middles.nodes, elements, electrodes }
}

/// All nodes, and which of them is the middle of an edge.
struct Middles {
    nodes: Vec<nalgebra::Point3<f64>>,
    of_edge: HashMap<[usize; 2], usize>,
}

impl Middles {
    fn of(&mut self, a: usize, b: usize) -> usize {
        *self.of_edge.entry([a.min(b), a.max(b)]).or_insert_with(|| {
            self.nodes.push(nalgebra::center(&self.nodes[a], &self.nodes[b]));
            self.nodes.len() - 1
        })
    }

    fn quarters(&mut self, [a, b, c]: [usize; 3]) -> [[usize; 3]; 4] {
        let (ab, bc, ca) = (self.of(a, b), self.of(b, c), self.of(c, a));
        [[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]
    }

    fn contact(&mut self, contact: &ElectrodeContact) -> ElectrodeContact {
        match contact {
            ElectrodeContact::Node(node) => ElectrodeContact::Node(*node),
            ElectrodeContact::Edges(edges) => {
                let halves = |&[a, b]: &[usize; 2]| {
                    let middle = self.of(a, b);
                    [[a, middle], [middle, b]]
                };
                ElectrodeContact::Edges(edges.iter().flat_map(halves).collect())
            }
            ElectrodeContact::Faces(faces) => {
                ElectrodeContact::Faces(faces.iter().flat_map(|&face| self.quarters(face)).collect())
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::{neighbours::neighbours, triangle};
    use nalgebra::Point3;

    /// Two triangles on a bent sheet.
    fn bent(electrodes: Vec<ElectrodeContact>) -> Mesh {
        let nodes = [[0.0, 0.0, 0.0], [2.0, 0.0, 0.0], [2.0, 2.0, 0.0], [0.0, 2.0, 2.0]];
        Mesh { nodes: nodes.map(Point3::from).to_vec(), elements: vec![[0, 1, 2], [0, 2, 3]], electrodes }
    }

    fn area(mesh: &Mesh, elements: &[[usize; 3]]) -> f64 {
        elements.iter().map(|&element| triangle::area(mesh.points(element))).sum()
    }

    #[test]
    fn four_triangles_of_a_quarter_each_share_their_new_nodes() {
        let mesh = bent(vec![]);
        let fine = refine(&mesh);
        assert_eq!((fine.nodes.len(), fine.elements.len()), (4 + 5, 8));
        assert_eq!(neighbours(&fine.elements).len(), 3 + 3 + 2);
        for (element, &coarse) in mesh.elements.iter().enumerate() {
            for part in &fine.elements[4 * element..4 * element + 4] {
                assert!((4.0 * area(&fine, &[*part]) / area(&mesh, &[coarse]) - 1.0).abs() < 1e-12);
            }
        }
    }

    #[test]
    fn electrodes_cover_what_they_covered() {
        let contacts = vec![
            ElectrodeContact::Node(3),
            ElectrodeContact::Edges(vec![[0, 1], [1, 2]]),
            ElectrodeContact::Faces(vec![[0, 2, 3]]),
        ];
        let mesh = bent(contacts);
        let fine = refine(&mesh);
        assert_eq!(fine.electrodes[0], ElectrodeContact::Node(3));
        let ElectrodeContact::Edges(edges) = &fine.electrodes[1] else { panic!("{:?}", fine.electrodes) };
        assert_eq!(edges.iter().map(|&[a, b]| (fine.nodes[a] - fine.nodes[b]).norm()).sum::<f64>(), 4.0);
        let ElectrodeContact::Faces(faces) = &fine.electrodes[2] else { panic!("{:?}", fine.electrodes) };
        assert_eq!(faces.len(), 4);
        assert!((area(&fine, faces) - area(&mesh, &[[0, 2, 3]])).abs() < 1e-12);
    }
}
