//! The same mesh in every format, as other programs write it.

use super::super::{
    Group, Imported,
    cursor::{Encoding, Scalar},
};

/// Bytes of a text or binary file.
struct Sink {
    encoding: Encoding,
    bytes: Vec<u8>,
}

impl Sink {
    fn new(encoding: Encoding, head: &str) -> Self {
        Self { encoding, bytes: head.into() }
    }

    fn text(&mut self, text: &str) {
        self.bytes.extend(text.as_bytes());
    }

    fn number(&mut self, text: &str, little_endian: &[u8]) {
        match self.encoding {
            Encoding::Text => self.text(&format!("{text} ")),
            Encoding::LittleEndian => self.bytes.extend(little_endian),
            Encoding::BigEndian => self.bytes.extend(little_endian.iter().rev()),
        }
    }

    fn real(&mut self, kind: Scalar, value: f64) {
        match kind {
            Scalar::F32 => self.number(&format!("{:e}", value as f32), &(value as f32).to_le_bytes()),
            Scalar::F64 => self.number(&format!("{value}"), &value.to_le_bytes()),
            _ => self.integer(kind, value as i64),
        }
    }

    fn integer(&mut self, kind: Scalar, value: i64) {
        self.number(&value.to_string(), &value.to_le_bytes()[..kind.bytes()]);
    }

    fn end_line(&mut self) {
        if self.encoding == Encoding::Text {
            self.text("\n");
        }
    }
}

pub(super) fn stl_binary(mesh: &Imported) -> Vec<u8> {
    let mut sink = Sink::new(Encoding::LittleEndian, "solid, but binary");
    sink.bytes.resize(80, b' ');
    sink.integer(Scalar::U32, mesh.triangles.len() as i64);
    for corners in &mesh.triangles {
        (0..3).for_each(|_| sink.real(Scalar::F32, f64::NAN));
        for &node in corners {
            mesh.nodes[node].iter().for_each(|&x| sink.real(Scalar::F32, x));
        }
        sink.integer(Scalar::U16, 0xabcd);
    }
    sink.bytes
}

pub(super) fn stl_text(mesh: &Imported) -> Vec<u8> {
    let mut sink = Sink::new(Encoding::Text, "  SOLID a name of words\r\n");
    for corners in &mesh.triangles {
        sink.text("facet normal nan -nan 1e999\n outer loop\n");
        for &node in corners {
            sink.text("  vertex ");
            mesh.nodes[node].iter().for_each(|&x| sink.real(Scalar::F64, x));
            sink.text("\r\n");
        }
        sink.text(" endloop\nendfacet\n");
    }
    sink.text("endsolid a name of words");
    sink.bytes
}

/// Corners count in one of four ways, forwards or backwards.
pub(super) fn obj(mesh: &Imported) -> Vec<u8> {
    let mut sink = Sink::new(Encoding::Text, "# a comment\nmtllib none.mtl\no skin\n");
    for node in &mesh.nodes {
        sink.text("v ");
        node.iter().for_each(|&x| sink.real(Scalar::F64, x));
        sink.text("\nvn 0 0 1\n");
    }
    for (place, corners) in mesh.triangles.iter().enumerate() {
        sink.text("f");
        for &node in corners {
            let back = node as i64 - mesh.nodes.len() as i64;
            let number = if place % 2 == 0 { node as i64 + 1 } else { back };
            let ending = ["", "/7", "//1", "/7/1"][place % 4];
            sink.text(&format!(" {number}{ending}{}", if place % 3 == 0 { " \\\n" } else { "" }));
        }
        sink.text("\n");
    }
    sink.bytes
}

/// Types of a coordinate, a list's length and a node number, by their names in the header.
pub(super) type PlyTypes = [(&'static str, Scalar); 3];

/// With properties and elements that nobody reads between those that are read.
pub(super) fn ply(mesh: &Imported, encoding: Encoding, [real, length, node]: PlyTypes) -> Vec<u8> {
    let format = match encoding {
        Encoding::Text => "ascii",
        Encoding::LittleEndian => "binary_little_endian",
        Encoding::BigEndian => "binary_big_endian",
    };
    let (vertices, faces) = (mesh.nodes.len(), mesh.triangles.len());
    let [real_type, length_type, node_type] = [real.0, length.0, node.0];
    let head = format!(
        "ply\r\nformat {format} 1.0\ncomment made by a test\nelement scanner 2\nproperty uchar on\n\
         element vertex {vertices}\nproperty short quality\nproperty {real_type} z\n\
         property list uchar double extra\nproperty {real_type} x\nproperty {real_type} y\n\
         element face {faces}\nproperty list {length_type} {node_type} vertex_index\n\
         property float red\nend_header\n"
    );
    let mut sink = Sink::new(encoding, &head);
    (0..2).for_each(|_| sink.integer(Scalar::U8, 1));
    for (place, point) in mesh.nodes.iter().enumerate() {
        sink.integer(Scalar::I16, -3);
        sink.real(real.1, point.z);
        sink.integer(Scalar::U8, (place % 3) as i64);
        (0..place % 3).for_each(|_| sink.real(Scalar::F64, f64::NAN));
        sink.real(real.1, point.x);
        sink.real(real.1, point.y);
        sink.end_line();
    }
    for corners in &mesh.triangles {
        sink.integer(length.1, 3);
        corners.iter().for_each(|&corner| sink.integer(node.1, corner as i64));
        sink.real(Scalar::F32, 0.5);
        sink.end_line();
    }
    sink.bytes
}

/// What Gmsh calls a node in these files: neither from 0 nor without gaps, and falling.
fn name(mesh: &Imported, node: usize) -> i64 {
    3 * (mesh.nodes.len() - node) as i64 + 5
}

fn msh_head(mesh: &Imported, encoding: Encoding, version: &str) -> Sink {
    let binary = u8::from(encoding != Encoding::Text);
    let mut sink = Sink::new(encoding, &format!("$MeshFormat\n{version} {binary} 8\n"));
    if encoding != Encoding::Text {
        sink.integer(Scalar::I32, 1);
        sink.text("\n");
    }
    sink.text(&format!(
        "$EndMeshFormat\n$Comments\nany\n$EndComments\n$PhysicalNames\n{}\n",
        3 * mesh.groups.len()
    ));
    for (group, number) in mesh.groups.iter().zip(1..) {
        (0..3).for_each(|dimension| sink.text(&format!("{dimension} {number} \"{}\"\n", group.name)));
    }
    sink.text("$EndPhysicalNames\n");
    sink
}

/// Shape, group and nodes of each element.
fn elements(mesh: &Imported) -> Vec<(i64, i64, Vec<usize>)> {
    let in_a_group: Vec<usize> = mesh.groups.iter().flat_map(|group| group.triangles.clone()).collect();
    let mut all = Vec::new();
    for (place, corners) in mesh.triangles.iter().enumerate() {
        let groups = mesh.groups.iter().zip(1..).filter(|(group, _)| group.triangles.contains(&place));
        all.extend(groups.map(|(_, number)| (2, number, corners.to_vec())));
        if !in_a_group.contains(&place) {
            all.push((2, 0, corners.to_vec()));
        }
    }
    for (Group { nodes, edges, .. }, number) in mesh.groups.iter().zip(1..) {
        all.extend(nodes.iter().map(|&node| (15, number, vec![node])));
        all.extend(edges.iter().map(|edge| (1, number, edge.to_vec())));
    }
    all
}

/// A triangle of several groups comes several times.
pub(super) fn msh2(mesh: &Imported, encoding: Encoding) -> Vec<u8> {
    let mut sink = msh_head(mesh, encoding, "2.2");
    sink.text(&format!("$Nodes\n{}\n", mesh.nodes.len()));
    for (node, point) in mesh.nodes.iter().enumerate() {
        sink.integer(Scalar::I32, name(mesh, node));
        point.iter().for_each(|&x| sink.real(Scalar::F64, x));
        sink.end_line();
    }
    let elements = elements(mesh);
    sink.text(&format!("\n$EndNodes\n$Elements\n{}\n", elements.len()));
    for ((shape, group, nodes), number) in elements.iter().zip(1..) {
        let head =
            if encoding == Encoding::Text { vec![number, *shape, 2] } else { vec![*shape, 1, 2, number] };
        head.iter().chain(&[*group, 9]).for_each(|&value| sink.integer(Scalar::I32, value));
        nodes.iter().for_each(|&node| sink.integer(Scalar::I32, name(mesh, node)));
        sink.end_line();
    }
    sink.text("\n$EndElements\n");
    sink.bytes
}

/// Each triangle is an entity of its own, and so is each group's set of points and lines.
pub(super) fn msh4(mesh: &Imported, encoding: Encoding) -> Vec<u8> {
    let mut sink = msh_head(mesh, encoding, "4.1");
    let groups = mesh.groups.len() as i64;
    sink.text("$Entities\n");
    [groups, groups, mesh.triangles.len() as i64, 0]
        .iter()
        .for_each(|&count| sink.integer(Scalar::I64, count));
    sink.end_line();
    for dimension in 0..2 {
        for number in 1..=groups {
            entity(&mut sink, dimension, number, &[number]);
        }
    }
    for place in 0..mesh.triangles.len() {
        let of = mesh.groups.iter().zip(1..).filter(|(group, _)| group.triangles.contains(&place));
        // A negative number stands for the opposite orientation.
        let of: Vec<_> = of.map(|(_, number): (_, i64)| -number).collect();
        entity(&mut sink, 2, place as i64 + 1, &of);
    }
    sink.text("\n$EndEntities\n");
    msh4_nodes(mesh, &mut sink);
    msh4_elements(mesh, &mut sink);
    sink.bytes
}

fn entity(sink: &mut Sink, dimension: i64, number: i64, groups: &[i64]) {
    sink.integer(Scalar::I32, number);
    (0..if dimension == 0 { 3 } else { 6 }).for_each(|_| sink.real(Scalar::F64, 0.5));
    sink.integer(Scalar::I64, groups.len() as i64);
    groups.iter().for_each(|&group| sink.integer(Scalar::I32, group));
    if dimension > 0 {
        sink.integer(Scalar::I64, 2);
        [-7, 8].iter().for_each(|&around| sink.integer(Scalar::I32, around));
    }
    sink.end_line();
}

/// Two blocks, the second with parametric coordinates.
fn msh4_nodes(mesh: &Imported, sink: &mut Sink) {
    sink.text("$Nodes\n");
    let half = mesh.nodes.len() / 2;
    [2, mesh.nodes.len() as i64, 1, 1].iter().for_each(|&value| sink.integer(Scalar::I64, value));
    for (range, parametric) in [(0..half, 0), (half..mesh.nodes.len(), 1)] {
        [2, 1, parametric].iter().for_each(|&value| sink.integer(Scalar::I32, value));
        sink.integer(Scalar::I64, range.len() as i64);
        range.clone().for_each(|node| sink.integer(Scalar::I64, name(mesh, node)));
        for node in range {
            mesh.nodes[node].iter().for_each(|&x| sink.real(Scalar::F64, x));
            (0..2 * parametric).for_each(|_| sink.real(Scalar::F64, 0.25));
        }
        sink.end_line();
    }
    sink.text("\n$EndNodes\n");
}

fn msh4_elements(mesh: &Imported, sink: &mut Sink) {
    let triangles = mesh.triangles.iter().zip(1..).map(|(corners, entity)| (2, entity, corners.to_vec()));
    let others = elements(mesh).into_iter().filter(|(shape, ..)| *shape != 2);
    let all: Vec<_> = triangles.chain(others).collect();
    sink.text("$Elements\n");
    [all.len(), all.len(), 1, all.len()].iter().for_each(|&value| sink.integer(Scalar::I64, value as i64));
    for ((shape, entity, nodes), number) in all.iter().zip(1..) {
        [nodes.len() as i64 - 1, *entity, *shape].iter().for_each(|&value| sink.integer(Scalar::I32, value));
        [1, number].iter().for_each(|&value| sink.integer(Scalar::I64, value));
        nodes.iter().for_each(|&node| sink.integer(Scalar::I64, name(mesh, node)));
        sink.end_line();
    }
    sink.text("\n$EndElements\n");
}
