//! What each reader understands beyond one mesh of plain triangles.

use super::*;

const SQUARE: &str = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";

fn named<'a>(mesh: &'a Imported, name: &str) -> &'a Group {
    mesh.groups.iter().find(|group| group.name == name).expect("the group is there")
}

#[test]
fn polygons_become_fans_around_their_first_corner() {
    let obj = text(Format::Obj, &format!("{SQUARE}v -1 0.5 0\nf 3 4 5 1 2\n")).unwrap();
    assert_eq!(obj.triangles, [[2, 3, 4], [2, 4, 0], [2, 0, 1]]);
    let ply = "ply\nformat ascii 1.0\nelement vertex 4\nproperty int x\nproperty int y\nproperty int z\n\
               element face 1\nproperty list int int vertex_indices\nend_header\n0 0 0 1 0 0 1 1 0 0 1 0\n4 0 1 2 3";
    let ply = text(Format::Ply, ply).unwrap();
    assert_eq!(ply.triangles, [[0, 1, 2], [0, 2, 3]]);
    assert_eq!(ply.nodes[2], Point3::new(1.0, 1.0, 0.0));
}

#[test]
fn vertices_of_no_triangle_are_dropped() {
    let mesh = text(Format::Obj, "v 9 9 9\nv 0 0 0\nv 8 8 8\nv 1 0 0\nv 0 1 0\nv 7 7 7\nf 5 4 2\n").unwrap();
    assert_eq!(mesh.nodes, [Point3::origin(), Point3::new(1.0, 0.0, 0.0), Point3::new(0.0, 1.0, 0.0)]);
    assert_eq!(mesh.triangles, [[2, 1, 0]]);
}

#[test]
fn obj_vertices_may_carry_colours_and_other_lines_are_passed_over() {
    let obj = "vt 0 0\nv 0 0 0 0.5 0.5 0.5\nv 1 0 0 1\ng electrode_1\nv 0 1 0\nusemtl x\nl 1 2\np 1\ns off\nf -3 -2 -1\n";
    assert_eq!(text(Format::Obj, obj).unwrap().triangles, [[0, 1, 2]]);
}

#[test]
fn ply_faces_may_come_before_the_vertices() {
    let ply = "ply\nformat ascii 1.0\nelement face 1\nproperty list uchar int vertex_indices\n\
               element vertex 3\nproperty float x\nproperty float y\nproperty float z\nend_header\n\
               3 2 0 1\n0 0 0\n1 0 0\n0 1 0\n";
    assert_eq!(text(Format::Ply, ply).unwrap().triangles, [[2, 0, 1]]);
}

#[test]
fn text_stl_may_hold_several_solids() {
    let solid = |x: i32| {
        format!(
            "solid\nfacet normal 0 0 1\nouter loop\nvertex {x} 0 0\nvertex {} 0 0\nvertex 1 1 0\nendloop\n\
             endfacet\nendsolid\n",
            x + 1
        )
    };
    let mesh = text(Format::Stl, &(solid(0) + "\n" + &solid(1))).unwrap();
    assert_eq!(mesh.nodes.len(), 4);
    assert_eq!(mesh.triangles, [[0, 1, 2], [1, 3, 2]]);
}

const MSH: &str = "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n2\n0 4 \"electrode_1\"\n\
     1 4 \"electrode_2\"\n$EndPhysicalNames\n$Nodes\n5\n1 0 0 0\n2 1 0 0\n3 1 1 0\n4 0 1 0\n9 5 5 5\n$EndNodes\n";

fn msh(elements: &[&str]) -> Imported {
    text(Format::Msh, &format!("{MSH}$Elements\n{}\n{}\n$EndElements\n", elements.len(), elements.join("\n")))
        .unwrap()
}

#[test]
fn points_and_lines_off_the_mesh_are_left_out_of_their_group_and_counted() {
    let mesh = msh(&[
        "1 2 2 7 1 1 2 3",
        "2 2 2 7 1 1 3 4",
        "3 15 2 4 1 9",
        "4 15 2 4 1 2",
        // An edge, its copy the other way round, the diagonal that is none, and one to nowhere.
        "5 1 2 4 1 4 1",
        "6 1 2 4 1 1 4",
        "7 1 2 4 1 2 4",
        "8 1 2 4 1 4 9",
    ]);
    assert_eq!(mesh.nodes.len(), 4);
    let point = named(&mesh, "electrode_1");
    assert_eq!((&*point.nodes, point.off_mesh), (&[1][..], 1));
    let line = named(&mesh, "electrode_2");
    assert_eq!((&*line.edges, line.off_mesh), (&[[3, 0]][..], 2));
    assert_eq!(named(&mesh, "surface_7").triangles, [0, 1]);
}

#[test]
fn groups_follow_their_nodes_through_welding() {
    // The second triangle has its own copies of the diagonal's ends.
    let mesh = "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n6\n10 0 0 0\n20 1 0 0\n30 1 1 0\n40 0 0 1e-9\n\
                50 1 1 -1e-9\n60 0 1 0\n$EndNodes\n$Elements\n5\n1 2 2 1 1 10 20 30\n2 2 2 1 1 40 50 60\n\
                3 15 2 3 1 50\n4 15 2 3 1 30\n5 1 2 3 1 60 40\n$EndElements\n";
    let apart = text(Format::Msh, mesh).unwrap();
    assert_eq!(apart.nodes.len(), 6);
    assert_eq!(named(&apart, "point_3").nodes, [4, 2]);
    let welded = parse(Format::Msh, mesh.as_bytes(), Some(1e-6)).unwrap();
    assert_eq!(welded.triangles, [[0, 1, 2], [0, 2, 3]]);
    assert_eq!(named(&welded, "point_3").nodes, [2]);
    assert_eq!(named(&welded, "curve_3").edges, [[3, 0]]);
}

#[test]
fn a_triangle_of_two_groups_is_one_and_a_copy_within_a_group_stays_a_fault() {
    let mesh = msh(&["1 2 2 7 1 1 2 3", "2 2 2 8 1 1 2 3", "3 2 2 7 1 1 2 3", "4 2 2 7 5 1 2 3"]);
    assert_eq!(mesh.triangles.len(), 3);
    assert_eq!(named(&mesh, "surface_7").triangles, [0, 1, 2]);
    assert_eq!(named(&mesh, "surface_8").triangles, [0]);
}

#[test]
fn groups_of_one_name_are_one_and_hold_each_triangle_once() {
    let names = MSH.replace("$PhysicalNames\n2\n", "$PhysicalNames\n4\n2 7 \"skin\"\n2 8 \"skin\"\n");
    let elements = "$Elements\n3\n1 2 2 8 1 1 3 4\n2 2 2 7 1 1 2 3\n3 2 2 7 1 1 3 4\n$EndElements\n";
    let mesh = text(Format::Msh, &(names + elements)).unwrap();
    assert_eq!(mesh.groups.len(), 1);
    assert_eq!(named(&mesh, "skin").triangles, [0, 1]);
}

#[test]
fn elements_without_tags_and_with_partitions_are_read() {
    let mesh = msh(&["1 2 0 1 2 3", "2 2 5 4 1 2 1 -2 1 3 4"]);
    assert_eq!(mesh.triangles, [[0, 1, 2], [0, 2, 3]]);
}

#[test]
fn scale_makes_metres_of_millimetres() {
    let mut mesh = text(Format::Obj, &format!("{SQUARE}f 1 2 3\n")).unwrap();
    mesh.scale(1e-3);
    assert_eq!(mesh.nodes[2], Point3::new(1e-3, 1e-3, 0.0));
}

#[test]
fn the_files_ending_tells_the_format_in_any_case() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("Skin.OBJ");
    std::fs::write(&path, format!("{SQUARE}f 1 2 3\n")).unwrap();
    assert_eq!(read(&path, None).unwrap().triangles.len(), 1);
    let message = read(&folder.path().join("skin.step"), None).unwrap_err().to_string();
    assert!(
        message.ends_with("skin.step`: its name must end in .stl, .obj, .ply, .dae or .msh"),
        "{message}"
    );
    let message = read(&folder.path().join("none.stl"), None).unwrap_err().to_string();
    assert!(message.contains("none.stl`: ") && message.contains("os error 2"), "{message}");
    assert!(matches!(read(folder.path(), None).unwrap_err().problem, Problem::Ending));
}

#[test]
fn an_unusable_welding_tolerance_is_refused() {
    for tolerance in [0.0, -1e-6, 0.5, f64::NAN] {
        let error = parse(Format::Obj, format!("{SQUARE}f 1 2 3\n").as_bytes(), Some(tolerance)).unwrap_err();
        assert!(matches!(error, Problem::Tolerance { .. }), "{error}");
    }
}
