//! Gmsh's MSH 2.2 and 4.1, text and binary: points, lines and triangles of first order, and which
//! physical groups they belong to. Format: Gmsh reference manual, "Gmsh file formats".
//!
//! ```text
//! $MeshFormat                version, 0 (text) or 1 (binary), 8 bytes; in binary then the integer 1
//! $PhysicalNames             dimension, number and name of each group; always text
//! $Entities     (only 4.1)   which groups each point, curve and surface of the geometry is in
//! $Nodes                     numbers and coordinates
//! $Elements                  type, group (2.2) or entity (4.1), nodes
//! ```
//!
//! Other sections are passed over.

mod contents;
mod shape;
mod v2;
mod v4;

use super::{
    Imported, Problem,
    cursor::{Cursor, Encoding, Scalar, Shown},
};
use contents::Contents;
use shape::Shape;

/// Reads an MSH file.
pub(super) fn parse(bytes: &[u8]) -> Result<Imported, Problem> {
    let mut cursor = Cursor::new(bytes);
    let version = format(&mut cursor)?;
    let mut contents = Contents::default();
    while let Some(name) = section(&mut cursor)? {
        let read = match (name, version) {
            (b"PhysicalNames", _) => physical_names,
            (b"Entities", Version::V4) => v4::entities,
            (b"PartitionedEntities", _) => {
                return Err(cursor.wrong("a section", &Shown(name), "no partition"));
            }
            (b"Nodes", Version::V2) => v2::nodes,
            (b"Nodes", Version::V4) => v4::nodes,
            (b"Elements", Version::V2) => v2::elements,
            (b"Elements", Version::V4) => v4::elements,
            _ => {
                skip_section(name, &mut cursor)?;
                continue;
            }
        };
        read(&mut contents, &mut cursor)?;
        end_section(name, &mut cursor)?;
    }
    Ok(contents.finish())
}

#[derive(Clone, Copy)]
enum Version {
    V2,
    V4,
}

fn format(cursor: &mut Cursor) -> Result<Version, Problem> {
    cursor.keyword("$MeshFormat")?;
    let version = match cursor.word("the version")? {
        b"2.2" => Version::V2,
        b"4.1" => Version::V4,
        other => return Err(cursor.wrong("the version", &Shown(other), "2.2 or 4.1")),
    };
    let encoding = cursor.natural(Scalar::I32, "the file type")?;
    if encoding > 1 {
        return Err(cursor.wrong("the file type", &encoding, "0 (text) or 1 (binary)"));
    }
    let bytes = cursor.natural(Scalar::I32, "the length of a number")?;
    if bytes != 8 {
        return Err(cursor.wrong("the length of a number", &bytes, "8 bytes"));
    }
    cursor.line();
    if encoding == 1 {
        cursor.encoding = byte_order(cursor)?;
    }
    end_section(b"MeshFormat", cursor)?;
    Ok(version)
}

fn byte_order(cursor: &mut Cursor) -> Result<Encoding, Problem> {
    match cursor.take(4, "the integer 1")? {
        [1, 0, 0, 0] => Ok(Encoding::LittleEndian),
        [0, 0, 0, 1] => Ok(Encoding::BigEndian),
        other => Err(cursor.wrong("the integer 1", &format!("{other:?}"), "1 in either byte order")),
    }
}

/// Name of the section that begins here, or nothing at the end of the file.
fn section<'a>(cursor: &mut Cursor<'a>) -> Result<Option<&'a [u8]>, Problem> {
    cursor.skip_blank();
    let Some(line) = cursor.line() else { return Ok(None) };
    let name = line.trim_ascii().strip_prefix(b"$");
    name.map(Some).ok_or_else(|| cursor.wrong("a section", &Shown(line), "`$` and its name"))
}

fn end_section(name: &[u8], cursor: &mut Cursor) -> Result<(), Problem> {
    let found = cursor.word("the end of a section")?;
    let expected = format!("$End{}", String::from_utf8_lossy(name));
    if found == expected.as_bytes() {
        Ok(())
    } else {
        Err(cursor.wrong("the end of a section", &Shown(found), expected))
    }
}

/// Passes over a section and the line of its end.
fn skip_section(name: &[u8], cursor: &mut Cursor) -> Result<(), Problem> {
    let end = [b"$End", name].concat();
    while let Some(line) = cursor.line() {
        if line.trim_ascii().ends_with(&end) {
            return Ok(());
        }
    }
    end_section(name, cursor)
}

fn physical_names(contents: &mut Contents, cursor: &mut Cursor) -> Result<(), Problem> {
    let encoding = std::mem::replace(&mut cursor.encoding, Encoding::Text);
    let count = cursor.count(Scalar::I32, 4, "the number of physical names")?;
    for _ in 0..count {
        let dimension = cursor.natural(Scalar::I32, "the dimension of a physical group")?;
        let number = cursor.integer(Scalar::I32, "the number of a physical group")?;
        let line = cursor.line().unwrap_or_default().trim_ascii();
        let quoted = line.strip_prefix(b"\"").and_then(|rest| rest.strip_suffix(b"\""));
        let text = quoted.and_then(|name| std::str::from_utf8(name).ok());
        let allowed = "text in double quotes";
        let name = text.ok_or_else(|| cursor.wrong("the name of a physical group", &Shown(line), allowed))?;
        contents.names.insert((dimension, number), name.to_owned());
    }
    cursor.encoding = encoding;
    Ok(())
}
