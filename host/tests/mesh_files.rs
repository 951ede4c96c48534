//! Mesh files that other programs wrote, see `data/meshes/README.md`: all hold the same mesh.

use dermatome::mesh::{
    import::{Group, Imported, read},
    soundness::{Soundness, require_sound},
    triangle,
};
use nalgebra::Point3;
use serde::Deserialize;
use std::path::{Path, PathBuf};

const WITH_GROUPS: [&str; 4] =
    ["gmsh-2.2-text.msh", "gmsh-2.2-binary.msh", "gmsh-4.1-text.msh", "gmsh-4.1-binary.msh"];
const WITHOUT_GROUPS: [&str; 7] = [
    "gmsh-binary.stl",
    "gmsh.obj",
    "meshio-4.1-binary.msh",
    "meshio-binary.ply",
    "meshio-text.ply",
    "meshio-text.stl",
    "meshio.obj",
];

/// What Gmsh says about the mesh.
#[derive(Deserialize)]
struct Expected {
    nodes: usize,
    triangles: usize,
    area: f64,
    boundary_loops: usize,
    electrode_1: [f64; 3],
    electrode_2: usize,
    electrode_3: usize,
    skin: usize,
}

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/meshes")
}

fn expected() -> Expected {
    serde_json::from_slice(&std::fs::read(folder().join("expected.json")).unwrap()).unwrap()
}

fn load(name: &str) -> (Imported, Soundness) {
    let mesh = read(&folder().join(name), None).unwrap();
    let found = require_sound(&mesh.nodes, &mesh.triangles, false).unwrap();
    (mesh, found)
}

/// The triangles by the nodes of `other` at their corners, sorted: files and programs order them
/// differently.
fn triangles_on(other: &Imported, mesh: &Imported) -> Vec<[usize; 3]> {
    let same = |node: usize| other.nodes.iter().position(|place| (place - mesh.nodes[node]).norm() < 1e-4);
    let mut all: Vec<_> =
        mesh.triangles.iter().map(|corners| corners.map(|node| same(node).expect("a node there"))).collect();
    all.iter_mut().for_each(|corners| corners.sort_unstable());
    all.sort_unstable();
    all
}

#[test]
fn every_file_holds_the_mesh_that_gmsh_says() {
    let expected = expected();
    let (first, _) = load(WITH_GROUPS[0]);
    for name in WITH_GROUPS.iter().chain(&WITHOUT_GROUPS) {
        let (mesh, found) = load(name);
        assert_eq!((mesh.nodes.len(), mesh.triangles.len()), (expected.nodes, expected.triangles), "{name}");
        let corners = mesh.triangles.iter().map(|corners| corners.map(|node| mesh.nodes[node]));
        let area: f64 = corners.map(triangle::area).sum();
        assert!((area / expected.area - 1.0).abs() < 1e-6, "{name}: {area}");
        assert_eq!(found.boundary_loops.len(), expected.boundary_loops, "{name}");
        assert_eq!(found.flipped, 0, "{name}");
        assert_eq!(triangles_on(&first, &mesh), triangles_on(&first, &first), "{name}");
    }
}

#[test]
fn physical_groups_hold_what_gmsh_says() {
    let expected = expected();
    for name in WITH_GROUPS {
        let (mesh, found) = load(name);
        let group = |name: &str| mesh.groups.iter().find(|group| group.name == name).unwrap();
        let names: Vec<_> = mesh.groups.iter().map(|group| &*group.name).collect();
        assert_eq!(names, ["electrode_1", "electrode_2", "electrode_3", "skin"], "{name}");
        assert!(mesh.groups.iter().all(|group| group.off_mesh == 0), "{name}");

        let Group { nodes, edges, triangles, .. } = group("electrode_1");
        let point = Point3::from(expected.electrode_1);
        assert!(nodes.len() == 1 && (mesh.nodes[nodes[0]] - point).norm() < 1e-12, "{name}");
        assert!(edges.is_empty() && triangles.is_empty(), "{name}");

        let Group { edges, .. } = group("electrode_2");
        assert_eq!(edges.len(), expected.electrode_2, "{name}");
        let rim = &found.boundary_loops[0];
        assert!(edges.iter().flatten().all(|node| rim.contains(node)), "{name}");

        assert_eq!(group("electrode_3").triangles.len(), expected.electrode_3, "{name}");
        assert_eq!(group("skin").triangles.len(), expected.skin, "{name}");
    }
}
