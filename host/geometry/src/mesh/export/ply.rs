//! Binary PLY, little-endian, with any number of values on nodes or triangles.

use crate::mesh::Mesh;
use std::fmt::Write;

/// One value for each node or each triangle, as a property of the PLY file.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Scalars<'a> {
    /// Name of the property, such as `conductivity`.
    pub name: &'a str,
    /// What the values belong to.
    pub on: On,
    /// The values, in the mesh's order.
    pub values: &'a [f64],
}

/// What values belong to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum On {
    /// One value for each node.
    Nodes,
    /// One value for each triangle.
    Elements,
}

/// Why no PLY file can be made.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum PlyError {
    /// A list of the wrong length.
    #[error("property `{name}` has {found} values, the mesh needs {expected}")]
    Length {
        /// Name of the property.
        name: String,
        /// Values there.
        found: usize,
        /// Values expected.
        expected: usize,
    },
    /// A name that would break the header.
    #[error("`{name}` cannot be a property's name: it must be one ASCII word, and come once")]
    Name {
        /// The name.
        name: String,
    },
    /// Too many nodes or triangles for PLY's integers.
    #[error("the mesh has {found} nodes, a PLY file holds at most {}", i32::MAX)]
    TooManyNodes {
        /// Nodes of the mesh.
        found: usize,
    },
}

/// The bytes of a PLY file: vertices, faces, and after each its values, all as doubles.
pub fn ply(mesh: &Mesh, scalars: &[Scalars]) -> Result<Vec<u8>, PlyError> {
    check(mesh, scalars)?;
    let mut bytes = header(mesh, scalars).into_bytes();
    for (node, point) in mesh.nodes.iter().enumerate() {
        point.iter().for_each(|coordinate| bytes.extend(coordinate.to_le_bytes()));
        values_on(On::Nodes, scalars).for_each(|it| bytes.extend(it.values[node].to_le_bytes()));
    }
    for (element, corners) in mesh.elements.iter().enumerate() {
        bytes.push(3);
        corners.iter().for_each(|&node| bytes.extend((node as i32).to_le_bytes()));
        values_on(On::Elements, scalars).for_each(|it| bytes.extend(it.values[element].to_le_bytes()));
    }
    Ok(bytes)
}

fn check(mesh: &Mesh, scalars: &[Scalars]) -> Result<(), PlyError> {
    if i32::try_from(mesh.nodes.len()).is_err() {
        return Err(PlyError::TooManyNodes { found: mesh.nodes.len() });
    }
    for (place, it) in scalars.iter().enumerate() {
        let name = it.name.to_owned();
        let taken = |other: &Scalars| other.name == it.name && other.on == it.on;
        let own = ["x", "y", "z", "vertex_index", "vertex_indices"].contains(&it.name);
        let is_word = !name.is_empty() && name.bytes().all(|byte| byte.is_ascii_graphic());
        if !is_word || own || scalars[..place].iter().any(taken) {
            return Err(PlyError::Name { name });
        }
        let expected = if it.on == On::Nodes { mesh.nodes.len() } else { mesh.elements.len() };
        if it.values.len() != expected {
            return Err(PlyError::Length { name, found: it.values.len(), expected });
        }
    }
    Ok(())
}

fn header(mesh: &Mesh, scalars: &[Scalars]) -> String {
    let properties = |on| {
        values_on(on, scalars).fold(String::new(), |mut lines, it| {
            writeln!(lines, "property double {}", it.name).expect("a string takes all text");
            lines
        })
    };
    format!(
        "ply\nformat binary_little_endian 1.0\n\
         element vertex {}\nproperty double x\nproperty double y\nproperty double z\n{}\
         element face {}\nproperty list uchar int vertex_indices\n{}end_header\n",
        mesh.nodes.len(),
        properties(On::Nodes),
        mesh.elements.len(),
        properties(On::Elements)
    )
}

fn values_on<'a>(on: On, scalars: &'a [Scalars<'a>]) -> impl Iterator<Item = &'a Scalars<'a>> {
    scalars.iter().filter(move |it| it.on == on)
}
