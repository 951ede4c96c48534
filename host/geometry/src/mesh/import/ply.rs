//! Polygon file format: a header in text that names elements and their properties, then their
//! values in the same order, as text or binary.
//!
//! ```text
//! ply
//! format binary_little_endian 1.0
//! element vertex 4
//! property float x
//! property float y
//! property float z
//! element face 2
//! property list uchar int vertex_indices
//! end_header
//! ```
//!
//! Vertices need x, y and z of any type; faces need a list of any integers. Everything else is
//! passed over.

use super::{
    Imported, Problem,
    cursor::{Cursor, Encoding, Scalar, Shown},
};
use nalgebra::Point3;

/// Reads a PLY file.
pub(super) fn parse(bytes: &[u8]) -> Result<Imported, Problem> {
    let mut cursor = Cursor::new(bytes);
    let (encoding, elements) = header(&mut cursor)?;
    cursor.encoding = encoding;
    let vertices = named(&elements, "vertex")?.count;
    named(&elements, "face")?;
    let mut mesh = Imported::default();
    for element in &elements {
        element.check(&cursor)?;
        match element.name.as_str() {
            "vertex" => read_vertices(&mut mesh, element, &mut cursor)?,
            "face" => read_faces(&mut mesh, element, vertices, &mut cursor)?,
            _ => element.skip(&mut cursor)?,
        }
    }
    Ok(mesh)
}

/// Elements of one kind.
struct Element {
    name: String,
    count: usize,
    properties: Vec<Property>,
}

struct Property {
    name: String,
    /// Type of the number before the values, if this is a list.
    count: Option<Scalar>,
    value: Scalar,
}

fn named<'a>(elements: &'a [Element], name: &str) -> Result<&'a Element, Problem> {
    let element = elements.iter().find(|element| element.name == name);
    element.ok_or_else(|| Problem::Missing { what: format!("element `{name}`") })
}

impl Element {
    /// Refuses a count that the rest of the file cannot hold.
    fn check(&self, cursor: &Cursor) -> Result<(), Problem> {
        if self.properties.is_empty() {
            return Err(Problem::Missing { what: format!("properties of element `{}`", self.name) });
        }
        let least = |property: &Property| cursor.least_bytes(property.count.unwrap_or(property.value));
        let bytes = self.properties.iter().map(least).sum();
        cursor.check_count(self.count, bytes, "the number of elements").map(drop)
    }

    fn skip(&self, cursor: &mut Cursor) -> Result<(), Problem> {
        for _ in 0..self.count {
            self.properties.iter().try_for_each(|property| property.skip(cursor))?;
        }
        Ok(())
    }
}

fn header(cursor: &mut Cursor) -> Result<(Encoding, Vec<Element>), Problem> {
    let mut encoding = None;
    let mut elements: Vec<Element> = Vec::new();
    cursor.keyword("ply")?;
    loop {
        match cursor.word("`end_header`")? {
            b"format" => encoding = Some(read_encoding(cursor)?),
            b"comment" | b"obj_info" => {}
            b"element" => elements.push(Element {
                name: Shown(cursor.word("an element's name")?).to_string(),
                count: cursor.natural(Scalar::I64, "the number of elements")?,
                properties: Vec::new(),
            }),
            b"property" => {
                let property = read_property(cursor)?;
                let element = elements.last_mut();
                element
                    .ok_or_else(|| cursor.wrong("a keyword", &"property", "`element`"))?
                    .properties
                    .push(property);
            }
            b"end_header" => break,
            other => {
                let allowed = "`format`, `comment`, `element`, `property` or `end_header`";
                return Err(cursor.wrong("a keyword", &Shown(other), allowed));
            }
        }
        cursor.line();
    }
    cursor.line();
    Ok((encoding.ok_or_else(|| Problem::Missing { what: "line `format`".into() })?, elements))
}

fn read_encoding(cursor: &mut Cursor) -> Result<Encoding, Problem> {
    let encoding = match cursor.word("the format")? {
        b"ascii" => Encoding::Text,
        b"binary_little_endian" => Encoding::LittleEndian,
        b"binary_big_endian" => Encoding::BigEndian,
        other => {
            let allowed = "`ascii`, `binary_little_endian` or `binary_big_endian`";
            return Err(cursor.wrong("the format", &Shown(other), allowed));
        }
    };
    cursor.keyword("1.0").map(|()| encoding)
}

fn read_property(cursor: &mut Cursor) -> Result<Property, Problem> {
    let word = cursor.word("a property's type")?;
    let (count, value) = match word {
        b"list" => (Some(read_type(cursor)?), read_type(cursor)?),
        word => (None, scalar(cursor, word)?),
    };
    if count.is_some_and(Scalar::is_real) {
        return Err(cursor.wrong("the type of a list's length", &"a real type", "an integer type"));
    }
    Ok(Property { name: Shown(cursor.word("a property's name")?).to_string(), count, value })
}

fn read_type(cursor: &mut Cursor) -> Result<Scalar, Problem> {
    let word = cursor.word("a property's type")?;
    scalar(cursor, word)
}

fn scalar(cursor: &Cursor, word: &[u8]) -> Result<Scalar, Problem> {
    Ok(match word {
        b"char" | b"int8" => Scalar::I8,
        b"uchar" | b"uint8" => Scalar::U8,
        b"short" | b"int16" => Scalar::I16,
        b"ushort" | b"uint16" => Scalar::U16,
        b"int" | b"int32" => Scalar::I32,
        b"uint" | b"uint32" => Scalar::U32,
        b"float" | b"float32" => Scalar::F32,
        b"double" | b"float64" => Scalar::F64,
        other => {
            let allowed = "char, uchar, short, ushort, int, uint, float, double or list";
            return Err(cursor.wrong("a property's type", &Shown(other), allowed));
        }
    })
}

fn read_vertices(mesh: &mut Imported, element: &Element, cursor: &mut Cursor) -> Result<(), Problem> {
    let axes: Vec<_> = element.properties.iter().map(Property::axis).collect();
    if let Some(missing) = (0..3).find(|&axis| !axes.contains(&Some(axis))) {
        return Err(Problem::Missing { what: format!("property `{}` of element `vertex`", AXES[missing]) });
    }
    mesh.nodes.reserve(element.count);
    for _ in 0..element.count {
        let mut vertex = Point3::origin();
        for (property, &axis) in element.properties.iter().zip(&axes) {
            match axis {
                Some(axis) => vertex[axis] = cursor.coordinate(property.value, "a vertex's coordinate")?,
                None => property.skip(cursor)?,
            }
        }
        mesh.nodes.push(vertex);
    }
    Ok(())
}

fn read_faces(
    mesh: &mut Imported,
    element: &Element,
    vertices: usize,
    cursor: &mut Cursor,
) -> Result<(), Problem> {
    if !element.properties.iter().any(|property| property.corner_count().is_some()) {
        return Err(Problem::Missing { what: "list `vertex_indices` of integers in element `face`".into() });
    }
    let mut corners = Vec::new();
    for _ in 0..element.count {
        for property in &element.properties {
            match property.corner_count() {
                Some(count) => {
                    read_corners(&mut corners, count, property.value, vertices, cursor)?;
                    mesh.add_polygon(&corners)?;
                }
                None => property.skip(cursor)?,
            }
        }
    }
    Ok(())
}

fn read_corners(
    corners: &mut Vec<usize>,
    count: Scalar,
    value: Scalar,
    vertices: usize,
    cursor: &mut Cursor,
) -> Result<(), Problem> {
    let field = "the number of a face's corners";
    let found = cursor.count(count, cursor.least_bytes(value), field)?;
    if found < 3 {
        return Err(cursor.wrong(field, &found, "3 or more"));
    }
    corners.clear();
    for _ in 0..found {
        let field = "the vertex of a face's corner";
        let node = cursor.integer(value, field)?;
        let known = usize::try_from(node).ok().filter(|&node| node < vertices);
        let allowed = || format!("a number from 0 and below {vertices}");
        corners.push(known.ok_or_else(|| cursor.wrong(field, &node, allowed()))?);
    }
    Ok(())
}

const AXES: [&str; 3] = ["x", "y", "z"];

impl Property {
    /// Which coordinate of a vertex this is.
    fn axis(&self) -> Option<usize> {
        AXES.iter().position(|&axis| axis == self.name).filter(|_| self.count.is_none())
    }

    /// Type of the number of corners, if this is the list of a face's corners.
    fn corner_count(&self) -> Option<Scalar> {
        let is_list = matches!(self.name.as_str(), "vertex_indices" | "vertex_index");
        self.count.filter(|_| is_list && !self.value.is_real())
    }

    fn skip(&self, cursor: &mut Cursor) -> Result<(), Problem> {
        let values = match self.count {
            Some(count) => cursor.count(count, cursor.least_bytes(self.value), "the length of a list")?,
            None => 1,
        };
        (0..values).try_for_each(|_| cursor.real(self.value, "a property").map(drop))
    }
}
