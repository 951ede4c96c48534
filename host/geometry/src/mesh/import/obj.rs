//! Wavefront OBJ: lines `v X Y Z` and `f CORNER CORNER CORNER...`; all other lines are passed over.
//!
//! A corner is `V`, `V/VT`, `V//VN` or `V/VT/VN`. V counts the vertices so far from 1, or from the
//! last one backwards where it is negative. A backslash at the end of a line continues it.

use super::{
    Imported, Problem,
    cursor::{Cursor, Shown, parse as number},
};
use nalgebra::Point3;

/// Reads an OBJ file.
pub(super) fn parse(bytes: &[u8]) -> Result<Imported, Problem> {
    let mut cursor = Cursor::new(bytes);
    let mut mesh = Imported::default();
    let mut corners = Vec::new();
    while let Some(line) = cursor.continued_line() {
        let mut words =
            line.split(|byte| byte.is_ascii_whitespace() || *byte == b'\\').filter(|w| !w.is_empty());
        match words.next() {
            Some(b"v") => mesh.nodes.push(vertex(&cursor, words)?),
            Some(b"f") => {
                corners.clear();
                for word in words {
                    corners.push(corner(&cursor, word, mesh.nodes.len())?);
                }
                if corners.len() < 3 {
                    return Err(cursor.wrong("the number of a face's corners", &corners.len(), "3 or more"));
                }
                mesh.add_polygon(&corners)?;
            }
            _ => {}
        }
    }
    Ok(mesh)
}

fn vertex<'a>(cursor: &Cursor, mut words: impl Iterator<Item = &'a [u8]>) -> Result<Point3<f64>, Problem> {
    let mut coordinate = |field| {
        let word = words.next().unwrap_or_default();
        let found = number(word).ok_or_else(|| cursor.wrong(field, &Shown(word), "a number"))?;
        cursor.check_coordinate(found, field)
    };
    let (x, y) = (coordinate("x of a vertex")?, coordinate("y of a vertex")?);
    Ok(Point3::new(x, y, coordinate("z of a vertex")?))
}

/// Number of a corner's node, from 0.
fn corner(cursor: &Cursor, word: &[u8], nodes: usize) -> Result<usize, Problem> {
    let vertex = word.split(|&byte| byte == b'/').next().unwrap_or_default();
    let node = match number::<i64>(vertex) {
        Some(0) | None => None,
        Some(from_start @ 1..) => usize::try_from(from_start - 1).ok(),
        Some(from_end) => {
            usize::try_from(from_end.unsigned_abs()).ok().and_then(|back| nodes.checked_sub(back))
        }
    };
    let allowed = || format!("1 to {nodes} or -1 to -{nodes}, a vertex above this line");
    node.filter(|&node| node < nodes)
        .ok_or_else(|| cursor.wrong("the vertex of a face's corner", &Shown(word), allowed()))
}
