//! Sections that version 2.2 writes in its own way. Counts are text even in binary files, numbers
//! take 4 bytes.

use super::{
    super::{
        Problem,
        cursor::{Cursor, Encoding, Scalar},
    },
    Contents, Shape,
};
use std::collections::HashMap;

/// `$Nodes`: number, x, y, z.
pub(super) fn nodes(contents: &mut Contents, cursor: &mut Cursor) -> Result<(), Problem> {
    let bytes = cursor.least_bytes(Scalar::I32) + 3 * cursor.least_bytes(Scalar::F64);
    let count = text_count(cursor, bytes, "the number of nodes")?;
    let (mut numbers, mut nodes) = (Vec::with_capacity(count), Vec::with_capacity(count));
    for _ in 0..count {
        numbers.push(cursor.natural(Scalar::I32, "the number of a node")?);
        nodes.push(cursor.point(Scalar::F64)?);
    }
    contents.set_nodes(nodes, &numbers, cursor)
}

/// `$Elements`. In text each element has a head of its own, in binary many may share one.
pub(super) fn elements(contents: &mut Contents, cursor: &mut Cursor) -> Result<(), Problem> {
    let bytes = 2 * cursor.least_bytes(Scalar::I32);
    let count = text_count(cursor, bytes, "the number of elements")?;
    let mut copies = Copies::default();
    let mut read = 0;
    while read < count {
        let block = if cursor.encoding == Encoding::Text { Block::one(cursor) } else { Block::many(cursor) }?;
        if block.count > count - read {
            return Err(cursor.wrong(
                "elements in a block",
                &block.count,
                format!("{} or less", count - read),
            ));
        }
        for _ in 0..block.count {
            block.element(contents, &mut copies, cursor)?;
        }
        read += block.count;
    }
    Ok(())
}

/// Elements of one shape.
struct Block {
    shape: Shape,
    count: usize,
    tags: usize,
}

impl Block {
    /// One element of a text: number, type, number of tags.
    fn one(cursor: &mut Cursor) -> Result<Self, Problem> {
        cursor.integer(Scalar::I32, "the number of an element")?;
        let shape = Shape::read(cursor)?;
        Ok(Self { shape, count: 1, tags: tag_count(cursor)? })
    }

    /// A head in a binary file: type, number of elements, number of tags.
    fn many(cursor: &mut Cursor) -> Result<Self, Problem> {
        let shape = Shape::read(cursor)?;
        let field = "elements in a block";
        let count = cursor.count(Scalar::I32, 4 * (1 + shape.corners()), field)?;
        if count == 0 {
            return Err(cursor.wrong(field, &count, "1 or more"));
        }
        Ok(Self { shape, count, tags: tag_count(cursor)? })
    }

    fn element(
        &self,
        contents: &mut Contents,
        copies: &mut Copies,
        cursor: &mut Cursor,
    ) -> Result<(), Problem> {
        if cursor.encoding != Encoding::Text {
            cursor.integer(Scalar::I32, "the number of an element")?;
        }
        // Physical group, entity, partitions.
        let mut tags = [0; 2];
        for tag in 0..self.tags {
            let value = cursor.integer(Scalar::I32, "a tag of an element")?;
            if let Some(kept) = tags.get_mut(tag) {
                *kept = value;
            }
        }
        let corners = contents.corners(self.shape, Scalar::I32, cursor)?;
        copies.add(contents, self.shape, corners, tags);
        Ok(())
    }
}

fn tag_count(cursor: &mut Cursor) -> Result<usize, Problem> {
    cursor.count(Scalar::I32, cursor.least_bytes(Scalar::I32), "the number of an element's tags")
}

fn text_count(cursor: &mut Cursor, bytes_each: usize, field: &'static str) -> Result<usize, Problem> {
    let encoding = std::mem::replace(&mut cursor.encoding, Encoding::Text);
    let count = cursor.count(Scalar::I64, bytes_each, field)?;
    cursor.encoding = encoding;
    if encoding != Encoding::Text {
        cursor.line();
    }
    Ok(count)
}

/// Triangles read so far, by corners and entity: place, and the first physical group.
///
/// Gmsh writes a triangle of several physical groups once for each. Such copies are one triangle;
/// copies within one group are none, but a fault of the mesh.
#[derive(Default)]
struct Copies(HashMap<([usize; 3], i64), (usize, i64)>);

impl Copies {
    fn add(&mut self, contents: &mut Contents, shape: Shape, corners: [usize; 3], [group, entity]: [i64; 2]) {
        if shape == Shape::Triangle {
            let place = contents.mesh.triangles.len();
            let &mut (first, first_group) = self.0.entry((corners, entity)).or_insert((place, group));
            if first != place && first_group != group {
                return contents.add_to_group(shape, corners, first, group);
            }
        }
        contents.add(shape, corners, &[group]);
    }
}
