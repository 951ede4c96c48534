//! What must hold of any bytes read as a mesh: every number is in range, whoever looks at the mesh
//! does not panic, and what is exported reads back the same.

use dermatome::mesh::{
    Mesh, export,
    import::{Format, Imported, parse},
    soundness::{inspect, require_sound},
};

/// Larger meshes only slow the search down.
const MOST_TRIANGLES: usize = 10_000;

pub fn check(format: Format, bytes: &[u8]) {
    let Ok(mesh) = parse(format, bytes, None) else { return };
    check_ranges(&mesh);
    if mesh.triangles.len() > MOST_TRIANGLES {
        return;
    }
    check_soundness(&mesh);
    check_export(&mesh);
    if let Ok(welded) = parse(format, bytes, Some(1e-2)) {
        check_ranges(&welded);
        assert!(welded.nodes.len() <= mesh.nodes.len());
        assert_eq!(welded.triangles.len(), mesh.triangles.len());
    }
}

fn check_ranges(mesh: &Imported) {
    assert!(!mesh.triangles.is_empty());
    assert!(mesh.nodes.iter().flat_map(|node| node.iter()).all(|x| x.abs() <= 1e30));
    let mut used = vec![false; mesh.nodes.len()];
    mesh.triangles.iter().flatten().for_each(|&node| used[node] = true);
    assert!(used.iter().all(|&used| used));
    for group in &mesh.groups {
        assert!(group.nodes.iter().chain(group.edges.iter().flatten()).all(|&node| node < used.len()));
        assert!(group.edges.iter().all(|edge| edge[0] != edge[1]));
        assert!(group.triangles.iter().all(|&triangle| triangle < mesh.triangles.len()));
    }
}

fn check_soundness(mesh: &Imported) {
    let found = inspect(&mesh.nodes, &mesh.triangles);
    assert!(found.unknown_nodes.is_empty() && found.not_finite.is_empty() && found.loose_nodes.is_empty());
    assert_eq!(found.parts.iter().map(|part| part.elements).sum::<usize>(), mesh.triangles.len());
    match require_sound(&mesh.nodes, &mesh.triangles, true) {
        // Each boundary edge is in one loop, and of two triangles' edges one is counted twice.
        Ok(sound) => {
            let rim: usize = sound.boundary_loops.iter().map(Vec::len).sum();
            assert!((3 * mesh.triangles.len() - rim) % 2 == 0);
            assert!(sound.boundary_loops.iter().all(|around| around.len() >= 3));
        }
        Err(fault) => assert!(!fault.to_string().is_empty()),
    }
}

fn check_export(mesh: &Imported) {
    let out = Mesh { nodes: mesh.nodes.clone(), elements: mesh.triangles.clone(), electrodes: Vec::new() };
    let ply = export::ply(&out, &[]).unwrap();
    for (format, bytes) in [(Format::Msh, export::msh(&out)), (Format::Ply, ply)] {
        let again = parse(format, &bytes, None).unwrap();
        assert!(again.nodes == mesh.nodes && again.triangles == mesh.triangles);
    }
}
