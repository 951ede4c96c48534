//! One mesh through every format and back.

use super::{
    super::{
        cursor::{Encoding, Scalar},
        *,
    },
    writers,
};
use proptest::{prelude::*, sample::Index};

/// A bumpy sheet of 2 * width * height triangles, its nodes and triangles in any order, of any
/// orientation, with groups of points, boundary edges and triangles.
fn sheet() -> impl Strategy<Value = Imported> {
    (2..5_usize, 2..5_usize)
        .prop_flat_map(|(width, height)| {
            let nodes = (width + 1) * (height + 1);
            let order = Just((0..nodes).collect::<Vec<_>>()).prop_shuffle();
            let triangles = Just((0..2 * width * height).collect::<Vec<_>>()).prop_shuffle();
            let bumps = prop::collection::vec(-0.3..0.3_f64, 3 * nodes);
            (Just(width), order, triangles, bumps, prop::collection::vec(group(), 0..4))
        })
        .prop_map(|(width, order, triangles, bumps, groups)| {
            let mut mesh = Imported { nodes: vec![Point3::origin(); order.len()], ..Imported::default() };
            for (place, &node) in order.iter().enumerate() {
                let (x, y) = (place % (width + 1), place / (width + 1));
                let bump = &bumps[3 * place..];
                mesh.nodes[node] = Point3::new(x as f64 + bump[0], y as f64 + bump[1], bump[2]);
            }
            for triangle in triangles {
                let (cell, half) = (triangle / 2, triangle % 2);
                let corner = cell % width + cell / width * (width + 1);
                let corners =
                    [[0, 1, width + 2], [width + 1, 0, width + 2]][half].map(|step| order[corner + step]);
                mesh.triangles.push(corners);
            }
            mesh.groups =
                groups.into_iter().enumerate().map(|(number, of)| choose(number, of, &mesh)).collect();
            mesh
        })
}

fn group() -> impl Strategy<Value = [Vec<Index>; 3]> {
    prop::array::uniform3(prop::collection::vec(any::<Index>(), 1..4))
}

fn choose(number: usize, [nodes, edges, triangles]: [Vec<Index>; 3], mesh: &Imported) -> Group {
    let edge = |index: &Index| {
        let [a, b, _] = *index.get(&mesh.triangles);
        [a.min(b), a.max(b)]
    };
    let mut group = Group {
        name: format!("electrode_{}", number + 1),
        nodes: nodes.iter().map(|index| index.index(mesh.nodes.len())).collect(),
        edges: edges.iter().map(edge).collect(),
        triangles: triangles.iter().map(|index| index.index(mesh.triangles.len())).collect(),
        off_mesh: 0,
    };
    group.nodes.sort_unstable();
    group.nodes.dedup();
    group.edges.sort_unstable();
    group.edges.dedup();
    group.triangles.sort_unstable();
    group.triangles.dedup();
    group
}

fn encoding() -> impl Strategy<Value = Encoding> {
    prop_oneof![Just(Encoding::Text), Just(Encoding::LittleEndian), Just(Encoding::BigEndian)]
}

fn corners(mesh: &Imported) -> Vec<[Point3<f64>; 3]> {
    mesh.triangles.iter().map(|corners| corners.map(|node| mesh.nodes[node])).collect()
}

fn rounded(mesh: &Imported) -> Imported {
    let single = |point: &Point3<f64>| point.map(|x| f64::from(x as f32));
    Imported { nodes: mesh.nodes.iter().map(single).collect(), ..mesh.clone() }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn binary_stl_becomes_the_same_triangles_welded(mesh in sheet()) {
        let read = parse(Format::Stl, &writers::stl_binary(&mesh), None).unwrap();
        prop_assert_eq!(corners(&read), corners(&rounded(&mesh)));
        prop_assert_eq!(read.nodes.len(), mesh.nodes.len());
    }

    #[test]
    fn text_stl_becomes_the_same_triangles_welded(mesh in sheet()) {
        let read = parse(Format::Stl, &writers::stl_text(&mesh), None).unwrap();
        prop_assert_eq!(corners(&read), corners(&mesh));
        prop_assert_eq!(read.nodes.len(), mesh.nodes.len());
    }

    #[test]
    fn obj_becomes_the_same_mesh(mesh in sheet()) {
        let read = parse(Format::Obj, &writers::obj(&mesh), None).unwrap();
        prop_assert_eq!(&read.nodes, &mesh.nodes);
        prop_assert_eq!(&read.triangles, &mesh.triangles);
    }

    #[test]
    fn ply_of_any_types_becomes_the_same_mesh(
        mesh in sheet(),
        encoding in encoding(),
        real in prop::sample::select(vec![("float", Scalar::F32), ("float64", Scalar::F64), ("double", Scalar::F64)]),
        length in prop::sample::select(vec![("uchar", Scalar::U8), ("int8", Scalar::I8), ("uint", Scalar::U32)]),
        node in prop::sample::select(vec![
            ("char", Scalar::I8), ("uint8", Scalar::U8), ("short", Scalar::I16), ("ushort", Scalar::U16),
            ("int", Scalar::I32), ("uint32", Scalar::U32),
        ]),
    ) {
        let read = parse(Format::Ply, &writers::ply(&mesh, encoding, [real, length, node]), None).unwrap();
        let expected = if real.1 == Scalar::F32 && encoding != Encoding::Text { rounded(&mesh) } else { mesh };
        if encoding == Encoding::Text && real.1 == Scalar::F32 {
            for (read, node) in read.nodes.iter().zip(&expected.nodes) {
                prop_assert!((read - node).norm() < 1e-6);
            }
        } else {
            prop_assert_eq!(&read.nodes, &expected.nodes);
        }
        prop_assert_eq!(&read.triangles, &expected.triangles);
    }

    #[test]
    fn msh_4_1_becomes_the_same_mesh_with_its_groups(mesh in sheet(), encoding in encoding()) {
        let read = parse(Format::Msh, &writers::msh4(&mesh, encoding), None).unwrap();
        prop_assert_eq!(read, mesh);
    }

    #[test]
    fn msh_2_2_becomes_the_same_mesh_with_its_groups(mesh in sheet(), encoding in encoding()) {
        let read = parse(Format::Msh, &writers::msh2(&mesh, encoding), None).unwrap();
        prop_assert_eq!(read, mesh);
    }

    #[test]
    fn any_damage_to_a_file_is_refused_or_leaves_a_mesh_in_range(
        mesh in sheet(),
        encoding in encoding(),
        kind in 0..6,
        damages in prop::collection::vec((any::<Index>(), any::<u8>()), 1..6),
        cut in prop::option::of(any::<Index>()),
    ) {
        let types = [("double", Scalar::F64), ("uchar", Scalar::U8), ("int", Scalar::I32)];
        let (format, mut bytes) = match kind {
            0 => (Format::Stl, writers::stl_binary(&mesh)),
            1 => (Format::Stl, writers::stl_text(&mesh)),
            2 => (Format::Obj, writers::obj(&mesh)),
            3 => (Format::Ply, writers::ply(&mesh, encoding, types)),
            4 => (Format::Msh, writers::msh2(&mesh, encoding)),
            _ => (Format::Msh, writers::msh4(&mesh, encoding)),
        };
        for (place, byte) in damages {
            let place = place.index(bytes.len());
            bytes[place] = byte;
        }
        cut.iter().for_each(|cut| bytes.truncate(cut.index(bytes.len())));
        if let Ok(read) = parse(format, &bytes, None) {
            prop_assert!(read.nodes.iter().flat_map(|node| node.iter()).all(|x| x.is_finite()));
            prop_assert!(read.triangles.iter().flatten().all(|&node| node < read.nodes.len()));
            for group in &read.groups {
                prop_assert!(group.nodes.iter().chain(group.edges.iter().flatten()).all(|&node| node < read.nodes.len()));
                prop_assert!(group.triangles.iter().all(|&triangle| triangle < read.triangles.len()));
            }
            drop(crate::mesh::soundness::require_sound(&read.nodes, &read.triangles, false));
        }
    }
}
