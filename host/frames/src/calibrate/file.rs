//! Files of a calibration: the loads that a machine applies, and readings that were taken before.

use super::Reading;
use dermatome_model::skin::table::{self, Columns};
use dermatome_patch::input;
use serde::{Deserialize, de::DeserializeOwned};
use std::path::{Path, PathBuf};

/// Rows of a file at most.
const MOST_ROWS: usize = 1_000_000;
const LOADS: Columns<'_> = Columns { required: &["time_s", "pressure_kpa"], optional: &[] };
const READINGS: Columns<'_> = Columns {
    required: &["pressure_kpa", "strength"],
    optional: &["deviation", "area_mm2", "x_mm", "y_mm", "z_mm"],
};

/// A load that a machine holds until the next one.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
pub struct Hold {
    /// When it is applied, s after the stream starts.
    pub time_s: f64,
    /// Pressure, kPa.
    pub pressure_kpa: f64,
}

#[derive(Deserialize)]
struct Row {
    pressure_kpa: f64,
    strength: f64,
    #[serde(default)]
    deviation: f64,
    area_mm2: Option<f64>,
    x_mm: Option<f64>,
    y_mm: Option<f64>,
    z_mm: Option<f64>,
}

/// Reads loads: CSV with the columns time_s and pressure_kpa, at least three rows, times ascending.
pub fn read_loads(path: &Path) -> Result<Vec<Hold>, FileError> {
    let rows: Vec<(u64, Hold)> = rows(path, LOADS)?;
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

/// What a file of readings starts with if it says in which units of strength they were taken.
pub const TAKEN_IN: &str = "# taken in units ";

/// In which units of strength readings were taken, if their file says so.
#[must_use]
pub fn units_of(path: &Path) -> Option<String> {
    let text = input::read_text(path).ok()?;
    text.lines().next()?.strip_prefix(TAKEN_IN).map(|id| id.trim().to_owned())
}

/// Reads readings: CSV with the columns pressure_kpa, strength and, if known, deviation, area_mm2, x_mm, y_mm and z_mm, in the
/// order taken. z of a place whose x and y alone are known is not a number.
pub fn read_readings(path: &Path) -> Result<Vec<Reading>, FileError> {
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
        let place = place(path, line, &row)?;
        let Row { pressure_kpa, strength, deviation, area_mm2, .. } = row;
        Ok(Reading { pressure_kpa, strength, deviation, area_mm2, place })
    };
    rows(path, READINGS)?.into_iter().map(check).collect()
}

/// Where a row says that the skin was pressed.
fn place(path: &Path, line: u64, row: &Row) -> Result<Option<[f64; 3]>, FileError> {
    let (x, y) = match (row.x_mm, row.y_mm) {
        (Some(x), Some(y)) => (x, y),
        (None, None) if row.z_mm.is_none() => return Ok(None),
        (x, _) => {
            let missing = if x.is_none() { "x_mm" } else { "y_mm" };
            return Err(refuse_text(
                path,
                line,
                missing,
                "nothing",
                "a number, or nothing in x_mm, y_mm and z_mm",
            ));
        }
    };
    for (column, value) in [("x_mm", x), ("y_mm", y), ("z_mm", row.z_mm.unwrap_or(0.0))] {
        if !value.is_finite() {
            return refuse(path, line, column, value, "a number");
        }
    }
    Ok(Some([x, y, row.z_mm.unwrap_or(f64::NAN)].map(|mm| 1e-3 * mm)))
}

fn check_pressure(path: &Path, line: u64, pressure_kpa: f64) -> Result<(), FileError> {
    if (0.0..=1e6).contains(&pressure_kpa) {
        return Ok(());
    }
    refuse(path, line, "pressure_kpa", pressure_kpa, "0 to 1000000 kPa")
}

/// Rows with their lines.
fn rows<T: DeserializeOwned>(path: &Path, columns: Columns<'_>) -> Result<Vec<(u64, T)>, FileError> {
    let in_file = |message: String| FileError::new(path, message);
    let rows = table::read(path, columns, MOST_ROWS).map_err(|error| in_file(error.to_string()))?;
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
