//! Sections that version 4.1 writes in its own way, text and binary alike: blocks of one entity of
//! the geometry each. Counts and numbers of nodes and elements take 8 bytes, other integers 4.

use super::{
    super::{
        Problem,
        cursor::{Cursor, Scalar},
    },
    Contents, Shape,
};

/// Most physical groups of one entity: each of its elements becomes a member of all.
const MAX_GROUPS: usize = 64;

/// `$Entities`: for each its number, its place, its physical groups, and what bounds it.
pub(super) fn entities(contents: &mut Contents, cursor: &mut Cursor) -> Result<(), Problem> {
    let mut counts = [0; 4];
    for count in &mut counts {
        let bytes = cursor.least_bytes(Scalar::I32) + 3 * cursor.least_bytes(Scalar::F64);
        *count = cursor.count(Scalar::I64, bytes, "the number of entities")?;
    }
    for (dimension, count) in counts.into_iter().enumerate() {
        for _ in 0..count {
            let entity = cursor.integer(Scalar::I32, "the number of an entity")?;
            // A point, or the corners of a box.
            for _ in 0..if dimension == 0 { 3 } else { 6 } {
                cursor.real(Scalar::F64, "a coordinate of an entity")?;
            }
            let field = "the number of an entity's physical groups";
            let groups = integers(cursor, field)?;
            if groups.len() > MAX_GROUPS {
                return Err(cursor.wrong(field, &groups.len(), format!("0 to {MAX_GROUPS}")));
            }
            contents.entities.insert((dimension, entity), groups);
            if dimension > 0 {
                integers(cursor, "the number of entities around an entity")?;
            }
        }
    }
    Ok(())
}

fn integers(cursor: &mut Cursor, field: &'static str) -> Result<Vec<i64>, Problem> {
    let count = cursor.count(Scalar::I64, cursor.least_bytes(Scalar::I32), field)?;
    (0..count).map(|_| cursor.integer(Scalar::I32, "the number of a group or entity")).collect()
}

/// `$Nodes`: in each block first the numbers, then the coordinates.
pub(super) fn nodes(contents: &mut Contents, cursor: &mut Cursor) -> Result<(), Problem> {
    let bytes = cursor.least_bytes(Scalar::I64) + 3 * cursor.least_bytes(Scalar::F64);
    let (blocks, total) = head(cursor, bytes)?;
    let (mut numbers, mut nodes) = (Vec::with_capacity(total), Vec::with_capacity(total));
    for _ in 0..blocks {
        let dimension = dimension(cursor)?;
        cursor.integer(Scalar::I32, "the number of an entity")?;
        let parametric = cursor.natural(Scalar::I32, "whether nodes are parametric")? != 0;
        let count = cursor.count(Scalar::I64, bytes, "the number of nodes in a block")?;
        for _ in 0..count {
            numbers.push(cursor.natural(Scalar::I64, "the number of a node")?);
        }
        for _ in 0..count {
            nodes.push(cursor.point(Scalar::F64)?);
            for _ in 0..if parametric { dimension } else { 0 } {
                cursor.real(Scalar::F64, "a node's place on its entity")?;
            }
        }
    }
    check_total(nodes.len(), total, "the number of nodes in all blocks", cursor)?;
    contents.set_nodes(nodes, &numbers, cursor)
}

/// `$Elements`: in each block one type, then number and nodes of each element.
pub(super) fn elements(contents: &mut Contents, cursor: &mut Cursor) -> Result<(), Problem> {
    let bytes = 2 * cursor.least_bytes(Scalar::I64);
    let (blocks, total) = head(cursor, bytes)?;
    let mut read = 0;
    for _ in 0..blocks {
        let dimension = dimension(cursor)?;
        let entity = cursor.integer(Scalar::I32, "the number of an entity")?;
        let shape = Shape::read(cursor)?;
        let count = cursor.count(Scalar::I64, bytes, "the number of elements in a block")?;
        let groups = contents.entities.get(&(dimension, entity)).cloned().unwrap_or_default();
        for _ in 0..count {
            cursor.natural(Scalar::I64, "the number of an element")?;
            let corners = contents.corners(shape, Scalar::I64, cursor)?;
            contents.add(shape, corners, &groups);
        }
        read += count;
    }
    check_total(read, total, "the number of elements in all blocks", cursor)
}

/// Number of blocks, and of nodes or elements in all of them.
fn head(cursor: &mut Cursor, bytes_each: usize) -> Result<(usize, usize), Problem> {
    let bytes = 3 * cursor.least_bytes(Scalar::I32) + cursor.least_bytes(Scalar::I64);
    let blocks = cursor.count(Scalar::I64, bytes, "the number of blocks")?;
    let total = cursor.count(Scalar::I64, bytes_each, "the number of nodes or elements")?;
    cursor.integer(Scalar::I64, "the smallest number")?;
    cursor.integer(Scalar::I64, "the largest number")?;
    Ok((blocks, total))
}

fn dimension(cursor: &mut Cursor) -> Result<usize, Problem> {
    let found = cursor.natural(Scalar::I32, "the dimension of an entity")?;
    if found <= 3 { Ok(found) } else { Err(cursor.wrong("the dimension of an entity", &found, "0 to 3")) }
}

fn check_total(found: usize, total: usize, field: &'static str, cursor: &Cursor) -> Result<(), Problem> {
    if found == total {
        Ok(())
    } else {
        Err(cursor.wrong(field, &found, format!("{total}, which the section says")))
    }
}
