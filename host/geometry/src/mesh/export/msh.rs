//! Gmsh's MSH 4.1 as text.
//!
//! Each electrode is an entity of the geometry and a physical group `electrode_1`..., and the sheet
//! is the physical group `skin`. Triangles under an electrode are in both groups.

use crate::mesh::{ElectrodeContact, Mesh};
use nalgebra::Point3;
use std::{
    collections::HashSet,
    io::{self, Write},
};

/// The bytes of an MSH file. The elements of electrodes come before those of the skin; no triangle may
/// lie under two electrodes.
#[must_use]
pub fn msh(mesh: &Mesh) -> Vec<u8> {
    let mut bytes = Vec::new();
    write(mesh, &mut bytes).expect("memory takes all bytes");
    bytes
}

/// A piece of the geometry and the elements on it.
struct Entity<'a> {
    dimension: usize,
    number: usize,
    groups: Vec<usize>,
    /// Nodes of each element.
    elements: Vec<&'a [usize]>,
}

/// Dimension of the elements under an electrode, and their nodes.
fn contact(electrode: &ElectrodeContact) -> (usize, Vec<&[usize]>) {
    match electrode {
        ElectrodeContact::Node(node) => (0, vec![std::slice::from_ref(node)]),
        ElectrodeContact::Edges(edges) => (1, edges.iter().map(<[usize; 2]>::as_slice).collect()),
        ElectrodeContact::Faces(faces) => (2, faces.iter().map(<[usize; 3]>::as_slice).collect()),
    }
}

/// Number of the group `skin`: electrodes have their own numbers, from 1.
fn skin_number(mesh: &Mesh) -> usize {
    mesh.electrodes.len() + 1
}

/// Entities by dimension, the skin last.
fn entities(mesh: &Mesh) -> Vec<Entity<'_>> {
    let skin = skin_number(mesh);
    let mut entities = Vec::new();
    for (electrode, number) in mesh.electrodes.iter().zip(1..) {
        let (dimension, elements) = contact(electrode);
        let groups = if dimension == 2 { vec![number, skin] } else { vec![number] };
        entities.push(Entity { dimension, number, groups, elements });
    }
    let covered: HashSet<_> = entities
        .iter()
        .filter(|entity| entity.dimension == 2)
        .flat_map(|entity| entity.elements.iter().map(|&corners| sorted(corners)))
        .collect();
    let bare = |corners: &&[usize]| covered.is_empty() || !covered.contains(&sorted(corners));
    let elements = mesh.elements.iter().map(<[usize; 3]>::as_slice).filter(bare).collect();
    entities.push(Entity { dimension: 2, number: skin, groups: vec![skin], elements });
    entities.retain(|entity| !entity.elements.is_empty());
    entities.sort_by_key(|entity| entity.dimension);
    entities
}

fn sorted(corners: &[usize]) -> Vec<usize> {
    let mut corners = corners.to_vec();
    corners.sort_unstable();
    corners
}

fn write(mesh: &Mesh, out: &mut impl Write) -> io::Result<()> {
    let entities = entities(mesh);
    writeln!(out, "$MeshFormat\n4.1 0 8\n$EndMeshFormat")?;
    write_names(mesh, out)?;
    write_entities(mesh, &entities, out)?;
    write_nodes(mesh, out)?;
    write_elements(&entities, out)
}

fn write_names(mesh: &Mesh, out: &mut impl Write) -> io::Result<()> {
    writeln!(out, "$PhysicalNames\n{}", mesh.electrodes.len() + 1)?;
    for (electrode, number) in mesh.electrodes.iter().zip(1..) {
        writeln!(out, "{} {number} \"electrode_{number}\"", contact(electrode).0)?;
    }
    writeln!(out, "2 {} \"skin\"\n$EndPhysicalNames", skin_number(mesh))
}

fn write_entities(mesh: &Mesh, entities: &[Entity], out: &mut impl Write) -> io::Result<()> {
    let count = |dimension| entities.iter().filter(|entity| entity.dimension == dimension).count();
    writeln!(out, "$Entities\n{} {} {} 0", count(0), count(1), count(2))?;
    for entity in entities {
        write!(out, "{}", entity.number)?;
        let [low, high] = bounding_box(mesh, entity);
        write_point(low, out)?;
        if entity.dimension > 0 {
            write_point(high, out)?;
        }
        write!(out, " {}", entity.groups.len())?;
        for group in &entity.groups {
            write!(out, " {group}")?;
        }
        // Nothing is said about what bounds a curve or surface.
        writeln!(out, "{}", if entity.dimension > 0 { " 0" } else { "" })?;
    }
    writeln!(out, "$EndEntities")
}

fn bounding_box(mesh: &Mesh, entity: &Entity) -> [Point3<f64>; 2] {
    let mut points = entity.elements.iter().copied().flatten().map(|&node| mesh.nodes[node]);
    let start = points.next().unwrap_or_else(Point3::origin);
    points.fold([start; 2], |[low, high], point| [low.inf(&point), high.sup(&point)])
}

/// One block, on the skin; an element's nodes need not be on its own entity.
fn write_nodes(mesh: &Mesh, out: &mut impl Write) -> io::Result<()> {
    let count = mesh.nodes.len();
    writeln!(out, "$Nodes\n1 {count} 1 {count}\n2 {} 0 {count}", skin_number(mesh))?;
    (1..=count).try_for_each(|number| writeln!(out, "{number}"))?;
    for point in &mesh.nodes {
        writeln!(out, "{:e} {:e} {:e}", point.x, point.y, point.z)?;
    }
    writeln!(out, "$EndNodes")
}

fn write_elements(entities: &[Entity], out: &mut impl Write) -> io::Result<()> {
    let count: usize = entities.iter().map(|entity| entity.elements.len()).sum();
    writeln!(out, "$Elements\n{} {count} 1 {count}", entities.len())?;
    let mut numbers = 1..;
    for Entity { dimension, number, elements, .. } in entities {
        // Gmsh's types: point, line, triangle.
        writeln!(out, "{dimension} {number} {} {}", [15, 1, 2][*dimension], elements.len())?;
        for (nodes, number) in elements.iter().zip(&mut numbers) {
            write!(out, "{number}")?;
            nodes.iter().try_for_each(|node| write!(out, " {}", node + 1))?;
            writeln!(out)?;
        }
    }
    writeln!(out, "$EndElements")
}

fn write_point(point: Point3<f64>, out: &mut impl Write) -> io::Result<()> {
    write!(out, " {:e} {:e} {:e}", point.x, point.y, point.z)
}
