//! Stereolithography: triangles with corners of their own, binary or text.
//!
//! ```text
//! 0   header, 80 bytes                  solid NAME
//! 80  number of triangles, u32            facet normal X Y Z
//! 84  for each triangle 50 bytes:           outer loop
//!       normal and 3 corners,                 vertex X Y Z   (three times)
//!       each 3 * f32, little-endian;        endloop
//!       u16 that nobody uses              endfacet
//!                                       endsolid NAME
//! ```

use super::{
    Imported, Problem,
    cursor::{Cursor, Encoding, Scalar},
};

const HEADER_BYTES: usize = 80;
const TRIANGLE_BYTES: usize = 50;

/// Reads an STL file. No two triangles share a node.
pub(super) fn parse(bytes: &[u8]) -> Result<Imported, Problem> {
    if is_text(bytes) { text(Cursor::new(bytes)) } else { binary(Cursor::new(bytes)) }
}

/// Binary headers may begin with `solid` too, but they end in zeros, and so does the count.
fn is_text(bytes: &[u8]) -> bool {
    let start = &bytes[..bytes.len().min(HEADER_BYTES + 4)];
    start.trim_ascii_start().get(..5).is_some_and(|word| word.eq_ignore_ascii_case(b"solid"))
        && !start.contains(&0)
}

fn binary(mut cursor: Cursor) -> Result<Imported, Problem> {
    cursor.encoding = Encoding::LittleEndian;
    cursor.take(HEADER_BYTES, "the header of 80 bytes")?;
    let count = cursor.count(Scalar::U32, TRIANGLE_BYTES, "the number of triangles")?;
    let most = cursor.rest().len() / TRIANGLE_BYTES;
    if count != most {
        return Err(cursor.wrong("the number of triangles", &count, format!("{most}, which the file holds")));
    }
    let mut mesh = Imported::default();
    mesh.nodes.reserve(3 * count);
    for _ in 0..count {
        cursor.take(12, "a normal")?;
        triangle(&mut mesh, &mut cursor)?;
        cursor.take(2, "the end of a triangle")?;
    }
    Ok(mesh)
}

fn text(mut cursor: Cursor) -> Result<Imported, Problem> {
    let mut mesh = Imported::default();
    cursor.skip_blank();
    cursor.line();
    loop {
        let word = cursor.word("`endsolid`")?;
        if word.eq_ignore_ascii_case(b"facet") {
            facet(&mut mesh, &mut cursor)?;
        } else if word.eq_ignore_ascii_case(b"endsolid") {
            cursor.line();
            cursor.skip_blank();
            // Another solid may follow.
            if cursor.line().is_none() {
                return Ok(mesh);
            }
        } else {
            return Err(cursor.wrong("a keyword", &super::cursor::Shown(word), "`facet` or `endsolid`"));
        }
    }
}

fn facet(mesh: &mut Imported, cursor: &mut Cursor) -> Result<(), Problem> {
    cursor.keyword("normal")?;
    for _ in 0..3 {
        // Often not a number, and of no use.
        cursor.word("a normal")?;
    }
    cursor.keyword("outer")?;
    cursor.keyword("loop")?;
    triangle(mesh, cursor)?;
    cursor.keyword("endloop")?;
    cursor.keyword("endfacet")
}

fn triangle(mesh: &mut Imported, cursor: &mut Cursor) -> Result<(), Problem> {
    let first = mesh.nodes.len();
    for _ in 0..3 {
        if cursor.encoding == Encoding::Text {
            cursor.keyword("vertex")?;
        }
        mesh.nodes.push(cursor.point(Scalar::F32)?);
    }
    mesh.triangles.push([first, first + 1, first + 2]);
    Ok(())
}
