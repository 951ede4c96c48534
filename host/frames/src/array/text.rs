//! Text tables of numbers; comments start with `#`, and one header line may lead.
//!
//! A header names every column: each cell starts with a letter or an underscore and reads as no
//! number, and no name comes twice. Any other first line is numbers, and what is none of them in it
//! is an error: a frame with decimal commas or gaps must not pass for a header.

use super::{Array, ArrayError, MAX_VALUES, Numbers, Values};
use num_complex::Complex64;
use std::{collections::HashSet, str::FromStr};

/// Reads a table whose cells are separated by semicolons, tabs, commas or blanks: the first of these
/// found in its first line.
pub(super) fn parse(bytes: &[u8]) -> Result<Array<'static>, ArrayError> {
    let delimiter = delimiter(bytes);
    let mut reader = csv::ReaderBuilder::new()
        .has_headers(false)
        .flexible(true)
        .comment(Some(b'#'))
        .trim(csv::Trim::All)
        .delimiter(delimiter)
        .from_reader(bytes);
    let mut table = Table::default();
    for (row, record) in reader.records().enumerate() {
        let record = record.map_err(|error| ArrayError::Table(error.to_string()))?;
        let line = record.position().map_or(0, csv::Position::line);
        let cells: Vec<&str> = cells(&record, delimiter);
        if row > 0 || !is_header(&cells) {
            table.add(line, &cells)?;
        }
    }
    Ok(table.into_array())
}

fn delimiter(bytes: &[u8]) -> u8 {
    let mut lines = bytes.split(|&byte| byte == b'\n' || byte == b'\r');
    let is_content = |line: &&[u8]| line.first() != Some(&b'#') && !line.trim_ascii().is_empty();
    let first = lines.find(is_content).unwrap_or_default();
    *[b';', b'\t', b','].iter().find(|&delimiter| first.contains(delimiter)).unwrap_or(&b' ')
}

/// Cells of a row: repeated blanks separate once, and a separator at the end adds nothing.
fn cells(record: &csv::StringRecord, delimiter: u8) -> Vec<&str> {
    let mut cells: Vec<_> = record.iter().filter(|cell| delimiter != b' ' || !cell.is_empty()).collect();
    if cells.last() == Some(&"") {
        cells.pop();
    }
    cells
}

fn is_header(cells: &[&str]) -> bool {
    let is_name = |cell: &&str| {
        cell.starts_with(|first: char| first.is_alphabetic() || first == '_') && number(cell).is_none()
    };
    let different: HashSet<_> = cells.iter().collect();
    !cells.is_empty() && cells.iter().all(is_name) && different.len() == cells.len()
}

#[derive(Default)]
struct Table {
    values: Vec<Complex64>,
    rows: usize,
    columns: usize,
    complex: bool,
}

impl Table {
    fn add(&mut self, line: u64, cells: &[&str]) -> Result<(), ArrayError> {
        if cells.is_empty() {
            return Ok(());
        }
        for (column, cell) in cells.iter().enumerate() {
            let (value, complex) = number(cell).ok_or_else(|| ArrayError::Cell {
                line,
                column: column + 1,
                text: cell.chars().take(40).collect(),
            })?;
            self.values.push(value);
            self.complex |= complex;
        }
        if self.rows > 0 && self.columns != cells.len() {
            return Err(ArrayError::Row { line, found: cells.len(), expected: self.columns });
        }
        if self.values.len() > MAX_VALUES {
            return Err(ArrayError::TooLarge);
        }
        self.columns = cells.len();
        self.rows += 1;
        Ok(())
    }

    fn into_array(self) -> Array<'static> {
        let values = if self.complex {
            Values::Complex(Numbers::Stored(self.values))
        } else {
            Values::Real(Numbers::Stored(self.values.into_iter().map(|value| value.re).collect()))
        };
        Array { shape: vec![self.rows, self.columns], values }
    }
}

/// A real number, or a complex one as Python or NumPy writes it, and which of the two.
fn number(cell: &str) -> Option<(Complex64, bool)> {
    if let Ok(real) = cell.parse::<f64>() {
        return Some((real.into(), false));
    }
    let bare = cell.strip_prefix('(').and_then(|cell| cell.strip_suffix(')')).unwrap_or(cell);
    let value = Complex64::from_str(&bare.replace("+-", "-")).ok()?;
    Some((value, true))
}
