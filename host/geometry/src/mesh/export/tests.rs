use super::*;
use crate::mesh::{
    ElectrodeContact, Mesh,
    import::{Format, Group, parse},
};
use nalgebra::Point3;
use proptest::{prelude::*, sample::Index};

/// A bumpy square of 5 by 5 cells, with electrodes of every kind in any order.
fn square() -> impl Strategy<Value = Mesh> {
    let bumps = prop::collection::vec(prop::array::uniform3(-0.3..0.3_f64), 36);
    let electrodes = prop::collection::vec((0..3, any::<Index>(), 1..4_usize), 0..6);
    (bumps, electrodes).prop_map(|(bumps, electrodes)| {
        let place = |(n, bump): (usize, &[f64; 3])| {
            Point3::new((n % 6) as f64 + bump[0], (n / 6) as f64 + bump[1], bump[2]) * 0.05
        };
        let corner = |cell: usize| cell / 5 * 6 + cell % 5;
        let halves = |n: usize| [[n, n + 1, n + 7], [n + 6, n, n + 7]];
        let elements: Vec<_> = (0..25).flat_map(|cell| halves(corner(cell))).collect();
        let contact = |(kind, at, count): (i32, Index, usize)| match kind {
            0 => ElectrodeContact::Node(at.index(36)),
            1 => {
                ElectrodeContact::Edges((0..count).map(|i| [at.index(2) + i, at.index(2) + i + 1]).collect())
            }
            // Triangles of different electrodes must not overlap: one electrode, in the first cells.
            _ => ElectrodeContact::Faces((0..count).map(|i| elements[i]).collect()),
        };
        let mut electrodes: Vec<_> = electrodes.into_iter().map(contact).collect();
        let mut faces = 0;
        electrodes
            .retain(|it| !matches!(it, ElectrodeContact::Faces(_)) || std::mem::replace(&mut faces, 1) == 0);
        Mesh { nodes: bumps.iter().enumerate().map(place).collect(), elements, electrodes }
    })
}

/// The contact that a group makes.
fn contact(group: &Group, triangles: &[[usize; 3]]) -> ElectrodeContact {
    match group {
        Group { nodes, .. } if !nodes.is_empty() => ElectrodeContact::Node(nodes[0]),
        Group { edges, .. } if !edges.is_empty() => ElectrodeContact::Edges(edges.clone()),
        Group { triangles: faces, .. } => {
            ElectrodeContact::Faces(faces.iter().map(|&it| triangles[it]).collect())
        }
    }
}

fn in_any_order(triangles: &[[usize; 3]]) -> Vec<[usize; 3]> {
    let mut sorted = triangles.to_vec();
    sorted.sort_unstable();
    sorted
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn msh_reads_back_as_the_same_mesh_with_its_electrodes(mesh in square()) {
        let read = parse(Format::Msh, &msh(&mesh), None).unwrap();
        prop_assert_eq!(&read.nodes, &mesh.nodes);
        // Triangles under an electrode come first.
        prop_assert_eq!(in_any_order(&read.triangles), in_any_order(&mesh.elements));
        for (electrode, number) in mesh.electrodes.iter().zip(1..) {
            let name = format!("electrode_{number}");
            let group = read.groups.iter().find(|group| group.name == name).unwrap();
            prop_assert_eq!(&contact(group, &read.triangles), electrode);
            prop_assert_eq!(group.off_mesh, 0);
        }
        let skin = read.groups.iter().find(|group| group.name == "skin").unwrap();
        prop_assert_eq!(skin.triangles.len(), mesh.elements.len());
        prop_assert_eq!(read.groups.len(), mesh.electrodes.len() + 1);
    }

    #[test]
    fn ply_reads_back_as_the_same_mesh_whatever_values_it_carries(mesh in square(), on_nodes in any::<bool>()) {
        let values: Vec<_> = (0..mesh.elements.len()).map(|i| i as f64 * 0.1).collect();
        let scalars = [
            Scalars { name: "conductivity", on: On::Elements, values: &values },
            Scalars { name: "potential", on: On::Nodes, values: &values[..mesh.nodes.len()] },
        ];
        let read = parse(Format::Ply, &ply(&mesh, &scalars[..1 + usize::from(on_nodes)]).unwrap(), None).unwrap();
        prop_assert_eq!(&read.nodes, &mesh.nodes);
        prop_assert_eq!(&read.triangles, &mesh.elements);
    }
}

/// Two triangles of very small and very large numbers.
fn pair() -> Mesh {
    let nodes = [[0.0, 0.0, 0.0], [1e-20, 0.0, 0.0], [0.0, 1.0 / 3.0, 0.0], [5e29, -0.1, 7.0]];
    Mesh {
        nodes: nodes.map(Into::into).to_vec(),
        elements: vec![[0, 1, 2], [2, 1, 3]],
        electrodes: vec![ElectrodeContact::Node(3), ElectrodeContact::Edges(vec![[0, 1], [2, 0]])],
    }
}

#[test]
fn msh_of_two_triangles_is_this_text() {
    let mesh = pair();
    let text = String::from_utf8(msh(&mesh)).unwrap();
    let expected = "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n\
        $PhysicalNames\n3\n0 1 \"electrode_1\"\n1 2 \"electrode_2\"\n2 3 \"skin\"\n$EndPhysicalNames\n\
        $Entities\n1 1 1 0\n1 5e29 -1e-1 7e0 1 1\n\
        2 0e0 0e0 0e0 1e-20 3.333333333333333e-1 0e0 1 2 0\n3 0e0 -1e-1 0e0 5e29 3.333333333333333e-1 7e0 1 3 0\n\
        $EndEntities\n\
        $Nodes\n1 4 1 4\n2 3 0 4\n1\n2\n3\n4\n0e0 0e0 0e0\n1e-20 0e0 0e0\n0e0 3.333333333333333e-1 0e0\n5e29 -1e-1 7e0\n\
        $EndNodes\n\
        $Elements\n3 5 1 5\n0 1 15 1\n1 4\n1 2 1 2\n2 1 2\n3 3 1\n2 3 2 2\n4 1 2 3\n5 3 2 4\n$EndElements\n";
    assert_eq!(text, expected);
    assert_eq!(parse(Format::Msh, text.as_bytes(), None).unwrap().nodes, mesh.nodes);
}

#[test]
fn ply_values_stand_behind_their_node_or_triangle() {
    let mesh = pair();
    let conductivity = Scalars { name: "conductivity", on: On::Elements, values: &[2.0, 3.0] };
    let bytes = ply(&mesh, &[conductivity]).unwrap();
    let header = "ply\nformat binary_little_endian 1.0\nelement vertex 4\nproperty double x\nproperty double y\n\
                  property double z\nelement face 2\nproperty list uchar int vertex_indices\n\
                  property double conductivity\nend_header\n";
    assert_eq!(&bytes[..header.len()], header.as_bytes());
    let faces = &bytes[header.len() + 4 * 3 * 8..];
    assert_eq!(faces.len(), 2 * (1 + 3 * 4 + 8));
    assert_eq!(faces[..13], [3, 0, 0, 0, 0, 1, 0, 0, 0, 2, 0, 0, 0]);
    assert_eq!(faces[13..21], 2_f64.to_le_bytes());
    assert_eq!(faces[34..], 3_f64.to_le_bytes());
}

#[test]
fn values_that_do_not_fit_are_refused_by_name() {
    let mesh = pair();
    let refused = |name, on, values: &[f64]| {
        ply(&mesh, &[Scalars { name: "u", on: On::Nodes, values: &[0.0; 4] }, Scalars { name, on, values }])
            .unwrap_err()
            .to_string()
    };
    assert_eq!(refused("c", On::Elements, &[1.0]), "property `c` has 1 values, the mesh needs 2");
    assert_eq!(refused("c", On::Nodes, &[1.0; 2]), "property `c` has 2 values, the mesh needs 4");
    for name in ["", "two words", "x", "u", "line\nend_header", "vertex_index", "\u{e4}"] {
        assert!(refused(name, On::Nodes, &[1.0; 4]).contains("cannot be a property's name"), "{name}");
    }
}
