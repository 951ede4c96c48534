//! Writing NumPy's array format.

use super::array::{Array, Values};
use npyz::{AutoSerialize, WriteOptions, WriterBuilder};
use std::io::{self, Write};

/// Writes an array in C order: float64, complex128 or int64.
pub fn write(out: &mut dyn Write, array: &Array<'_>) -> io::Result<()> {
    match &array.values {
        Values::Integer(at) => write_values(out, array, at),
        Values::Real(at) => write_values(out, array, at),
        Values::Complex(at) => write_values(out, array, at),
    }
}

fn write_values<T: AutoSerialize>(
    out: &mut dyn Write,
    array: &Array<'_>,
    at: &dyn Fn(usize, usize) -> T,
) -> io::Result<()> {
    let shape: Vec<u64> = array.shape.iter().map(|&side| side as u64).collect();
    let mut writer = WriteOptions::new().default_dtype().shape(&shape).writer(out).begin_nd()?;
    let [rows, columns] = array.sides();
    for row in 0..rows {
        for column in 0..columns {
            writer.push(&at(row, column))?;
        }
    }
    writer.finish()
}
