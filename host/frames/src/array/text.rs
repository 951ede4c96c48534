//! Text tables of numbers; comments start with `#`, and one header line may lead.
//!
//! A header names every column: each cell starts with a letter or an underscore and reads as no
//! number, and no name comes twice. Any other first line is numbers, and what is none of them in it
//! is an error: a frame with gaps must not pass for a header. Where something else separates cells, a comma in a number
//! is a decimal comma.
//!
//! A table with the columns Vr, Vi and perhaps I, in any letters, is one frame, a measurement a row: Vr + i Vi, over I. So is
//! what follows a line `Data` after lines with colons, as instruments of the IIRC write it: real and imaginary part in the
//! first two columns.

use super::{Array, ArrayError, MAX_VALUES, Numbers, Values};
use num_complex::Complex64;
use std::{collections::HashSet, str::FromStr};

/// Reads a table whose cells are separated by semicolons, tabs, commas or blanks: the first of these
/// found in its first line.
pub(super) fn parse(bytes: &[u8]) -> Result<Array<'static>, ArrayError> {
    if let Some(data) = after_data_line(bytes) {
        return phasors(&read(data)?.1, [0, 1], None);
    }
    let (header, table) = read(bytes)?;
    let column = |name: &str| header.iter().position(|cell| cell.eq_ignore_ascii_case(name));
    match (column("Vr"), column("Vi")) {
        (Some(real), Some(imaginary)) => phasors(&table, [real, imaginary], column("I")),
        _ => Ok(table.into_array()),
    }
}

/// What follows a line `Data`, if all before it are empty or have a colon, and one has.
fn after_data_line(bytes: &[u8]) -> Option<&[u8]> {
    let mut rest = bytes;
    let mut colons = false;
    loop {
        let end = rest.iter().position(|&byte| byte == b'\n')?;
        let (line, next) = (rest[..end].trim_ascii(), &rest[end + 1..]);
        match line {
            b"Data" if colons => return Some(next),
            [] => {}
            line if line.contains(&b':') => colons = true,
            _ => return None,
        }
        rest = next;
    }
}

/// One frame of the rows' real and imaginary parts, over a current.
fn phasors(
    table: &Table,
    [real, imaginary]: [usize; 2],
    current: Option<usize>,
) -> Result<Array<'static>, ArrayError> {
    if table.rows > 0 && table.columns <= real.max(imaginary) {
        return Err(ArrayError::Row { line: 1, found: table.columns, expected: real.max(imaginary) + 1 });
    }
    let row = |(index, row): (usize, &[Complex64])| {
        let current = current.map_or(1.0, |column| row[column].re);
        let voltage = Complex64::new(row[real].re, row[imaginary].re);
        let line = table.first_line + index as u64;
        if current == 0.0 { Err(ArrayError::NoCurrent { line }) } else { Ok(voltage / current) }
    };
    let rows = table.values.chunks_exact(table.columns.max(1)).enumerate();
    let values: Vec<Complex64> = rows.map(row).collect::<Result<_, _>>()?;
    Ok(Array { shape: vec![1, values.len()], values: Values::Complex(Numbers::Stored(values)) })
}

/// The names of the first line, if it has any, and the numbers.
fn read(bytes: &[u8]) -> Result<(Vec<String>, Table), ArrayError> {
    let delimiter = delimiter(bytes);
    let mut header = Vec::new();
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
        if row == 0 && is_header(&cells) {
            header = cells.iter().map(|&cell| cell.to_owned()).collect();
        } else {
            table.add(line, &cells, delimiter != b',')?;
        }
    }
    Ok((header, table))
}

fn delimiter(bytes: &[u8]) -> u8 {
    let mut lines = bytes.split(|&byte| byte == b'\n' || byte == b'\r');
    let is_content = |line: &&[u8]| line.first() != Some(&b'#') && !line.trim_ascii().is_empty();
    let first = lines.find(is_content).unwrap_or_default();
    if has_decimal_commas(first) {
        return b' ';
    }
    *[b';', b'\t', b','].iter().find(|&delimiter| first.contains(delimiter)).unwrap_or(&b' ')
}

/// Whether blanks separate the numbers of a line, several, each of which has one comma between digits.
fn has_decimal_commas(line: &[u8]) -> bool {
    let is_number = |cell: &[u8]| {
        let mut commas = cell.iter().enumerate().filter(|(_, byte)| **byte == b',').map(|(at, _)| at);
        let (Some(at), None) = (commas.next(), commas.next()) else { return false };
        let is_digit = |at: Option<usize>| at.and_then(|at| cell.get(at)).is_some_and(u8::is_ascii_digit);
        is_digit(at.checked_sub(1)) && is_digit(Some(at + 1))
    };
    let cells: Vec<&[u8]> = line.split(|byte| *byte == b' ').filter(|cell| !cell.is_empty()).collect();
    cells.len() > 1
        && !line.contains(&b';')
        && !line.contains(&b'\t')
        && cells.iter().all(|cell| is_number(cell))
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
    first_line: u64,
}

impl Table {
    fn add(&mut self, line: u64, cells: &[&str], decimal_commas: bool) -> Result<(), ArrayError> {
        if cells.is_empty() {
            return Ok(());
        }
        if self.rows == 0 {
            self.first_line = line;
        }
        for (column, cell) in cells.iter().enumerate() {
            let with_point = decimal_commas.then(|| cell.replace(',', "."));
            let (value, complex) = number(with_point.as_deref().unwrap_or(cell)).ok_or_else(|| {
                ArrayError::Cell { line, column: column + 1, text: cell.chars().take(40).collect() }
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
