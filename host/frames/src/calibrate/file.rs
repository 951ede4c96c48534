//! Files of a calibration: the loads that a machine applies, and readings that were taken before.

use super::Reading;
use serde::Deserialize;
use std::path::{Path, PathBuf};

/// A load that a machine holds until the next one.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Hold {
    /// When it is applied, s after the stream starts.
    pub time_s: f64,
    /// Pressure, kPa.
    pub pressure_kpa: f64,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Row {
    pressure_kpa: f64,
    strength: f64,
    #[serde(default)]
    deviation: f64,
    #[serde(default)]
    area_mm2: Option<f64>,
}

/// Reads loads: CSV with the columns time_s and pressure_kpa, at least three rows, times ascending.
pub fn read_loads(path: &Path) -> Result<Vec<Hold>, FileError> {
    let rows: Vec<(u64, Hold)> = rows(path, "numbers in the columns time_s and pressure_kpa")?;
    let mut last = f64::NEG_INFINITY;
    for &(line, Hold { time_s, pressure_kpa }) in &rows {
        if !(time_s.is_finite() && time_s >= 0.0 && time_s > last) {
            return refuse(path, line, "time_s", time_s, "seconds, more in each row than in the one before");
        }
        check_pressure(path, line, pressure_kpa)?;
        last = time_s;
    }
    Ok(rows.into_iter().map(|(_, hold)| hold).collect())
}

/// Reads readings: CSV with the columns pressure_kpa, strength and, if known, deviation and area_mm2, in the
/// order taken.
pub fn read_readings(path: &Path) -> Result<Vec<Reading>, FileError> {
    let allowed = "numbers in the columns pressure_kpa, strength and, if known, deviation and area_mm2";
    let check = |(line, row): (u64, Row)| {
        check_pressure(path, line, row.pressure_kpa)?;
        if !row.strength.is_finite() {
            return refuse(path, line, "strength", row.strength, "a number");
        }
        if !(row.deviation.is_finite() && row.deviation >= 0.0) {
            return refuse(path, line, "deviation", row.deviation, "a number, 0 or above");
        }
        if let Some(area) = row.area_mm2.filter(|area| !(area.is_finite() && *area > 0.0)) {
            return refuse(path, line, "area_mm2", area, "a number above 0, or nothing");
        }
        let Row { pressure_kpa, strength, deviation, area_mm2 } = row;
        Ok(Reading { pressure_kpa, strength, deviation, area_mm2 })
    };
    rows(path, allowed)?.into_iter().map(check).collect()
}

fn check_pressure(path: &Path, line: u64, pressure_kpa: f64) -> Result<(), FileError> {
    if (0.0..=1e6).contains(&pressure_kpa) {
        return Ok(());
    }
    refuse(path, line, "pressure_kpa", pressure_kpa, "0 to 1000000 kPa")
}

/// Rows with their lines.
fn rows<T: for<'de> Deserialize<'de>>(path: &Path, allowed: &str) -> Result<Vec<(u64, T)>, FileError> {
    let in_file = |message: String| FileError::new(path, message);
    let open = csv::ReaderBuilder::new().comment(Some(b'#')).trim(csv::Trim::All).from_path(path);
    let mut reader = open.map_err(|error| in_file(error.to_string()))?;
    let headers = reader.headers().map_err(|error| in_file(error.to_string()))?.clone();
    let mut rows = Vec::new();
    for record in reader.records() {
        let record = record.map_err(|error| in_file(error.to_string()))?;
        let line = record.position().map_or(0, csv::Position::line);
        let row = record.deserialize(Some(&headers));
        let row = row.map_err(|error| in_file(format!("line {line}: {error}; allowed: {allowed}")))?;
        rows.push((line, row));
    }
    if rows.len() < 3 {
        return Err(in_file(format!("{} rows; allowed: at least three", rows.len())));
    }
    Ok(rows)
}

pub(super) fn refuse<T>(
    path: &Path,
    line: u64,
    column: &str,
    value: f64,
    allowed: &str,
) -> Result<T, FileError> {
    Err(refuse_text(path, line, column, &value.to_string(), allowed))
}

pub(super) fn refuse_text(path: &Path, line: u64, column: &str, value: &str, allowed: &str) -> FileError {
    FileError::new(path, format!("line {line}, column `{column}` is {value}; allowed: {allowed}"))
}

/// Why a file of loads, readings or contacts cannot be used.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("file `{}`: {message}", path.display())]
pub struct FileError {
    path: PathBuf,
    message: String,
}

impl FileError {
    pub(super) fn new(path: &Path, message: String) -> Self {
        Self { path: path.to_owned(), message }
    }
}
