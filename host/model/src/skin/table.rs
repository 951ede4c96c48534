//! Tables as people write them: CSV files with a header, their cells between commas, semicolons or tabs.
//!
//! An error says line and column, and quotes no more than one short cell: a file that was taken by mistake stays private.

use dermatome_patch::input::{self, MAX_TEXT_BYTES};
use serde::de::DeserializeOwned;
use std::{io, path::Path};

/// Characters of a cell that an error quotes.
const QUOTED: usize = 40;

/// Columns of a table, in any order.
#[derive(Clone, Copy, Debug)]
pub struct Columns<'a> {
    /// Those that must be there.
    pub required: &'a [&'a str],
    /// Those that may.
    pub optional: &'a [&'a str],
}

/// Why a file is no table of these columns.
#[derive(Debug, thiserror::Error)]
pub enum TableError {
    /// It cannot be read.
    #[error("cannot be read: {0}")]
    Read(#[from] io::Error),
    /// It has more rows than the caller takes.
    #[error("more than {most} rows; allowed: at most that")]
    TooManyRows {
        /// How many may be.
        most: usize,
    },
    /// The header lacks a column.
    #[error("its first line has no column `{column}`; allowed: {allowed}")]
    Missing {
        /// The column.
        column: String,
        /// The columns.
        allowed: String,
    },
    /// The header has a column that is unknown, or one twice.
    #[error("its first line has the column {column:?} {fault}; allowed: {allowed}")]
    Surplus {
        /// The column.
        column: String,
        /// What is wrong with it.
        fault: &'static str,
        /// The columns.
        allowed: String,
    },
    /// A row has more or fewer cells than the header.
    #[error("line {line}: {found} cells; allowed: {expected}, as in the first line")]
    Cells {
        /// The line, from 1.
        line: u64,
        /// How many it has.
        found: u64,
        /// How many the header has.
        expected: u64,
    },
    /// A cell holds something else than the column takes.
    #[error("line {line}, column `{column}` is {text:?}; allowed: {allowed}")]
    Cell {
        /// The line, from 1.
        line: u64,
        /// Name of the column.
        column: String,
        /// What the cell holds.
        text: String,
        /// What it may hold.
        allowed: String,
    },
    /// Something else is wrong with a line.
    #[error("line {line}: {fault}")]
    Line {
        /// The line, from 1.
        line: u64,
        /// What is wrong with it.
        fault: String,
    },
}

/// Reads a table, each row with its line. Lines that start with `#` are comments.
pub fn read<T: DeserializeOwned>(
    path: &Path,
    columns: Columns<'_>,
    most: usize,
) -> Result<Vec<(u64, T)>, TableError> {
    parse(&bytes(path)?, columns, most)
}

/// What a file of a table holds.
pub fn bytes(path: &Path) -> Result<Vec<u8>, TableError> {
    Ok(input::read(path, MAX_TEXT_BYTES)?)
}

fn parse<T: DeserializeOwned>(
    bytes: &[u8],
    columns: Columns<'_>,
    most: usize,
) -> Result<Vec<(u64, T)>, TableError> {
    let mut reader = csv::ReaderBuilder::new()
        .comment(Some(b'#'))
        .trim(csv::Trim::All)
        .delimiter(delimiter(bytes))
        .from_reader(bytes);
    let header = reader.headers().map_err(|error| fault(&error))?.clone();
    columns.check(&header)?;
    let mut rows = Vec::new();
    for record in reader.records() {
        let record = record.map_err(|error| fault(&error))?;
        if rows.len() == most {
            return Err(TableError::TooManyRows { most });
        }
        let line = record.position().map_or(0, csv::Position::line);
        let row = record.deserialize(Some(&header));
        rows.push((line, row.map_err(|error| cell_fault(&error, line, &header, &record))?));
        check_finite(line, &header, &record)?;
    }
    Ok(rows)
}

impl Columns<'_> {
    /// The required ones come first: a file that is no table is not quoted.
    fn check(self, header: &csv::StringRecord) -> Result<(), TableError> {
        let names: Vec<&str> = header.iter().collect();
        if let Some(column) = self.required.iter().find(|column| !names.contains(column)) {
            return Err(TableError::Missing { column: (*column).to_owned(), allowed: self.words() });
        }
        for (place, name) in names.iter().enumerate() {
            let is_known = self.required.contains(name) || self.optional.contains(name);
            let fault = match names[..place].contains(name) {
                true => "twice",
                false if !is_known => "that is unknown",
                false => continue,
            };
            return Err(TableError::Surplus { column: quoted(name), fault, allowed: self.words() });
        }
        Ok(())
    }

    /// What is allowed.
    #[must_use]
    pub fn words(self) -> String {
        let required = self.required.join(",");
        match self.optional {
            [] => required,
            optional => format!("{required} and, if wanted, {}", optional.join(",")),
        }
    }
}

/// What stands between the cells of the first line that is no comment.
#[must_use]
pub fn delimiter(bytes: &[u8]) -> u8 {
    let mut lines = bytes.split(|byte| matches!(byte, b'\n' | b'\r'));
    let first = lines.find(|line| !line.trim_ascii().is_empty() && line[0] != b'#').unwrap_or_default();
    *b";\t".iter().find(|delimiter| first.contains(delimiter)).unwrap_or(&b',')
}

fn fault(error: &csv::Error) -> TableError {
    let line = error.position().map_or(1, csv::Position::line);
    match error.kind() {
        csv::ErrorKind::UnequalLengths { expected_len, len, .. } => {
            TableError::Cells { line, found: *len, expected: *expected_len }
        }
        csv::ErrorKind::Utf8 { .. } => TableError::Line { line, fault: "no text in UTF-8".into() },
        _ => TableError::Line { line, fault: error.to_string() },
    }
}

/// What reads as a number, as "nan" and "1e999" do, is a finite one.
fn check_finite(line: u64, header: &csv::StringRecord, record: &csv::StringRecord) -> Result<(), TableError> {
    let is_finite = |text: &str| text.parse::<f64>().map_or(true, f64::is_finite);
    let Some((column, text)) = header.iter().zip(record).find(|(_, text)| !is_finite(text)) else {
        return Ok(());
    };
    let (column, text) = (column.to_owned(), quoted(text));
    Err(TableError::Cell { line, column, text, allowed: "a finite number".into() })
}

fn cell_fault(
    error: &csv::Error,
    line: u64,
    header: &csv::StringRecord,
    record: &csv::StringRecord,
) -> TableError {
    let csv::ErrorKind::Deserialize { err, .. } = error.kind() else { return fault(error) };
    let at = err.field().and_then(|field| usize::try_from(field).ok());
    let Some((column, text)) = at.and_then(|at| header.get(at).zip(record.get(at))) else {
        return TableError::Line { line, fault: err.kind().to_string() };
    };
    let allowed = match err.kind() {
        csv::DeserializeErrorKind::ParseFloat(_) => "a number".into(),
        csv::DeserializeErrorKind::ParseInt(_) => "a whole number, 0 or above".into(),
        other => other.to_string(),
    };
    TableError::Cell { line, column: column.to_owned(), text: quoted(text), allowed }
}

fn quoted(text: &str) -> String {
    text.chars().take(QUOTED).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    const COLUMNS: Columns<'_> = Columns { required: &["x", "y"], optional: &["z"] };

    #[derive(Debug, PartialEq, serde::Deserialize)]
    struct Row {
        x: f64,
        y: u8,
        z: Option<f64>,
    }

    fn read_text(text: &str) -> Result<Vec<(u64, Row)>, String> {
        parse(text.as_bytes(), COLUMNS, 3).map_err(|error| error.to_string())
    }

    #[test]
    fn commas_semicolons_and_tabs_separate_cells_and_columns_are_known_by_name() {
        for separator in [",", ";", "\t"] {
            let text = "# made; by hand\n y,x\n1,0.5\n".replace(',', separator);
            assert_eq!(read_text(&text), Ok(vec![(3, Row { x: 0.5, y: 1, z: None })]));
        }
    }

    #[test]
    fn what_is_wrong_is_said_with_line_and_column() {
        for (text, expected) in [
            ("", "its first line has no column `x`"),
            ("root:x:0:0:root\n", "its first line has no column `x`; allowed: x,y and, if wanted, z"),
            ("x,y,w\n1,2,3\n", "has the column \"w\" that is unknown"),
            ("x,x,y\n1,2,3\n", "has the column \"x\" twice"),
            ("x,y\n1,2,3\n", "line 2: 3 cells; allowed: 2"),
            ("x,y\n1,2\none,2\n", "line 3, column `x` is \"one\"; allowed: a number"),
            ("x,y\n,2\n", "line 2, column `x` is \"\"; allowed: a number"),
            ("x;y\n0,5;2\n", "line 2, column `x` is \"0,5\"; allowed: a number"),
            ("x,y\n1,2\nnan,2\n", "line 3, column `x` is \"nan\"; allowed: a finite number"),
            ("x,y\n1e999,2\n", "line 2, column `x` is \"1e999\"; allowed: a finite number"),
            ("x,y\n1,256\n", "line 2, column `y` is \"256\"; allowed: a whole number"),
            ("x,y\n1,2\n1,2\n1,2\n1,2\n", "more than 3 rows"),
        ] {
            let error = read_text(text).unwrap_err();
            assert!(error.contains(expected), "{text:?}: {error}");
        }
        assert!(read_text("root:x:0:0:root\n").unwrap_err().split("root").count() == 1);
        assert!(
            parse::<Row>(b"x,y\n\xff,2\n", COLUMNS, 3).unwrap_err().to_string().contains("line 2: no text")
        );
    }
}
