//! Writing MATLAB's MAT-files, level 5, uncompressed.
//!
//! ```text
//! 0    text, 116 bytes; no subsystem data, 8 bytes; version 0x0100; byte order "IM" (little-endian)
//! 128  elements: type u32, bytes u32, data, zeros up to a multiple of 8
//! ```
//!
//! A variable is an element of the type matrix, made of the elements flags, dimensions, name, real
//! part, and the imaginary part of a complex matrix. Values lie column after column. Integers are
//! written as doubles, which is what MATLAB reckons with. Format: "MAT-File Format", The MathWorks.

use super::{Array, Values};
use num_complex::Complex64;
use std::io::{self, Write};

/// Most bytes of data in one variable; MATLAB reads no larger ones of this level.
pub const MAX_VARIABLE_BYTES: u64 = (1 << 31) - 256;

const INT8: u32 = 1;
const UINT16: u32 = 4;
const INT32: u32 = 5;
const UINT32: u32 = 6;
const DOUBLE: u32 = 9;
const MATRIX: u32 = 14;
const CLASS_CHAR: u32 = 4;
const CLASS_DOUBLE: u32 = 6;
const COMPLEX: u32 = 0x0800;

/// Whether an array can be a variable.
#[must_use]
pub fn fits(array: &Array<'_>) -> bool {
    let bytes = if array.is_complex() { 16 } else { 8 };
    array
        .shape
        .iter()
        .try_fold(bytes, |product: u64, &side| product.checked_mul(side as u64))
        .is_some_and(|bytes| bytes <= MAX_VARIABLE_BYTES)
}

/// Begins a file.
pub fn write_header(out: &mut dyn Write) -> io::Result<()> {
    let text = concat!("MATLAB 5.0 MAT-file, created by dermatome ", env!("CARGO_PKG_VERSION"));
    write!(out, "{text:<116}")?;
    out.write_all(&[0; 8])?;
    out.write_all(&0x0100_u16.to_le_bytes())?;
    out.write_all(b"IM")
}

/// Adds a matrix of doubles; it must fit, see [`fits`]. A list becomes a column.
pub fn write_array(out: &mut dyn Write, name: &str, array: &Array<'_>) -> io::Result<()> {
    let [rows, columns] = array.sides();
    let column_by_column = || (0..columns).flat_map(move |column| (0..rows).map(move |row| (row, column)));
    let count = rows * columns;
    let flags = if array.is_complex() { CLASS_DOUBLE | COMPLEX } else { CLASS_DOUBLE };
    let parts = if flags & COMPLEX == 0 { 1 } else { 2 };
    begin_variable(out, name, flags, [rows, columns], parts * (8 + 8 * count))?;
    match &array.values {
        Values::Integer(it) => {
            doubles(out, count, column_by_column().map(|(r, c)| it.at(r, c, columns) as f64))
        }
        Values::Real(it) => doubles(out, count, column_by_column().map(|(r, c)| it.at(r, c, columns))),
        Values::Complex(it) => {
            let part =
                |part: fn(Complex64) -> f64| column_by_column().map(move |(r, c)| part(it.at(r, c, columns)));
            doubles(out, count, part(|value| value.re))?;
            doubles(out, count, part(|value| value.im))
        }
    }
}

/// Adds a row of characters.
pub fn write_text(out: &mut dyn Write, name: &str, text: &str) -> io::Result<()> {
    let data: Vec<u8> = text.encode_utf16().flat_map(u16::to_le_bytes).collect();
    begin_variable(out, name, CLASS_CHAR, [1, data.len() / 2], 8 + padded(data.len()))?;
    element(out, UINT16, &data)
}

/// Everything of a variable but its values, which take `value_bytes`.
fn begin_variable(
    out: &mut dyn Write,
    name: &str,
    flags: u32,
    [rows, columns]: [usize; 2],
    value_bytes: usize,
) -> io::Result<()> {
    let dimensions = [rows, columns].map(|side| (side as u32).to_le_bytes()).concat();
    let bytes = 16 + 16 + 8 + padded(name.len()) + value_bytes;
    out.write_all(&MATRIX.to_le_bytes())?;
    out.write_all(&(bytes as u32).to_le_bytes())?;
    element(out, UINT32, &[flags, 0].map(u32::to_le_bytes).concat())?;
    element(out, INT32, &dimensions)?;
    element(out, INT8, name.as_bytes())
}

fn doubles(out: &mut dyn Write, count: usize, values: impl Iterator<Item = f64>) -> io::Result<()> {
    out.write_all(&DOUBLE.to_le_bytes())?;
    out.write_all(&(8 * count as u32).to_le_bytes())?;
    for value in values {
        out.write_all(&value.to_le_bytes())?;
    }
    Ok(())
}

fn element(out: &mut dyn Write, kind: u32, data: &[u8]) -> io::Result<()> {
    out.write_all(&kind.to_le_bytes())?;
    out.write_all(&(data.len() as u32).to_le_bytes())?;
    out.write_all(data)?;
    out.write_all(&[0; 8][..padded(data.len()) - data.len()])
}

fn padded(bytes: usize) -> usize {
    bytes.next_multiple_of(8)
}
