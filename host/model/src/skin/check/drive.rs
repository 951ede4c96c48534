//! Table `[drive]`.

use super::{Checker, beside::TableField};
use crate::skin::{
    Drive, Pattern, Reciprocal, SkinError,
    file::{DriveTable, Exactly, NumberOrWord, StepTable},
    quantity::{self, Quantity},
    table::Columns,
};
use crate::stimulation::STEP_COLUMNS;
use dermatome_shared::{
    drive::{Component, GAINS, Gain, MAX_INTEGRATION, MAX_SETTLING},
    stimulation::{Driven, Step},
};
use serde::Deserialize;
use std::path::Path;

/// Steps that a table may hold.
pub(super) const MOST_STEPS: usize = u16::MAX as usize;

impl Checker<'_> {
    pub(super) fn drive(&self, table: &DriveTable, electrodes: u8) -> Result<Drive, SkinError> {
        Ok(Drive {
            pattern: self.pattern(table, electrodes)?,
            reciprocal: self.reciprocal(&table.reciprocal)?,
            frequency: self.positive("drive.frequency", &table.frequency, quantity::FREQUENCY)?,
            amplitude: self.positive("drive.amplitude", &table.amplitude, quantity::CURRENT)?,
            frame_rate: self.positive("drive.frame_rate", &table.frame_rate, quantity::FREQUENCY)?,
            phase: self.phase(table.phase.as_ref())?,
            settling: self.settling(table.settling)?,
            integration: self.count(
                "drive.integration",
                table.integration.unwrap_or(1),
                1,
                MAX_INTEGRATION.into(),
            )?,
            gain: self.gain(table.gain.as_ref())?,
            component: self.component(table.component.as_deref())?,
        })
    }

    fn reciprocal(&self, word: &str) -> Result<Reciprocal, SkinError> {
        match word {
            "combined" => Ok(Reciprocal::Combined),
            "kept" => Ok(Reciprocal::Kept),
            "once" => Ok(Reciprocal::Once),
            _ => self.refuse("drive.reciprocal", format!("{word:?}"), "\"combined\", \"kept\" or \"once\""),
        }
    }

    /// In degrees.
    fn phase(&self, written: Option<&Quantity>) -> Result<f64, SkinError> {
        let Some(written) = written else { return Ok(0.0) };
        let degrees = quantity::ANGLE.read(written).map(f64::to_degrees);
        // In the single precision of the board, where 360 deg by way of radians is 360 again.
        match degrees.filter(|&degrees| (0.0..=360.0).contains(&(degrees as f32))) {
            Some(degrees) => Ok(degrees),
            None => self.refuse("drive.phase", written.to_string(), "0 deg to 360 deg"),
        }
    }

    fn settling(&self, written: Option<f64>) -> Result<f64, SkinError> {
        let periods = written.unwrap_or(0.25);
        let fits = (0.0..=f64::from(MAX_SETTLING)).contains(&periods);
        let allowed = || format!("0 to {MAX_SETTLING} carrier periods");
        if fits { Ok(periods) } else { self.refuse("drive.settling", periods.to_string(), &allowed()) }
    }

    fn gain(&self, written: Option<&NumberOrWord>) -> Result<Gain, SkinError> {
        let allowed = "\"automatic\", 1, 2, 4, 8, 16, 32 or 64";
        match written {
            None => Ok(Gain::Automatic),
            Some(NumberOrWord::Word(word)) if word == "automatic" => Ok(Gain::Automatic),
            Some(NumberOrWord::Word(word)) => self.refuse("drive.gain", format!("{word:?}"), allowed),
            Some(NumberOrWord::Number(number)) => {
                match GAINS.into_iter().find(|&gain| f64::from(gain) == *number) {
                    Some(gain) => Ok(Gain::Fixed(gain)),
                    None => self.refuse("drive.gain", number.to_string(), allowed),
                }
            }
        }
    }

    fn component(&self, word: Option<&str>) -> Result<Component, SkinError> {
        match word {
            None | Some("real") => Ok(Component::Real),
            Some("imaginary") => Ok(Component::Imaginary),
            Some("magnitude") => Ok(Component::Magnitude),
            Some(other) => {
                let allowed = "\"real\", \"imaginary\" or \"magnitude\"";
                self.refuse("drive.component", format!("{other:?}"), allowed)
            }
        }
    }

    fn pattern(&self, table: &DriveTable, electrodes: u8) -> Result<Pattern, SkinError> {
        match (&table.table, table.pattern.as_str()) {
            (Some(steps), "table") => Ok(Pattern::Table(self.step_table(table, steps, electrodes)?)),
            (None, "table") => self.refuse("drive.table", "missing".into(), "a list of steps, or a CSV file"),
            (Some(_), _) => {
                self.refuse("drive.table", "given".into(), "nothing (only pattern \"table\" has it)")
            }
            (None, word) => {
                let (drive_distance, sense_distance) = self.distances(word, electrodes)?;
                Ok(Pattern::Cyclic { drive_distance, sense_distance, driven: self.driven(table)? })
            }
        }
    }

    fn distances(&self, pattern: &str, electrodes: u8) -> Result<(u8, u8), SkinError> {
        let skipped = pattern.strip_prefix("skip-").and_then(|n| n.parse::<u8>().ok());
        match (pattern, skipped) {
            ("adjacent", _) => Ok((1, 1)),
            ("opposite", _) if electrodes.is_multiple_of(2) && electrodes >= 6 => Ok((electrodes / 2, 1)),
            (_, Some(n)) if (0..electrodes / 2 - 1).contains(&n) => Ok((n + 1, n + 1)),
            _ => {
                let most = electrodes / 2 - 2;
                let allowed = format!(
                    "\"adjacent\", \"opposite\" (even count from 6 on), \"skip-0\" to \"skip-{most}\", or \"table\""
                );
                self.refuse("drive.pattern", format!("{pattern:?}"), &allowed)
            }
        }
    }

    fn driven(&self, table: &DriveTable) -> Result<Driven, SkinError> {
        match table.driven.as_deref() {
            None | Some("skipped") => Ok(Driven::Skipped),
            Some("measured") => Ok(Driven::Measured),
            Some(other) => self.refuse("drive.driven", format!("{other:?}"), "\"skipped\" or \"measured\""),
        }
    }

    fn step_table(
        &self,
        table: &DriveTable,
        steps: &StepTable,
        electrodes: u8,
    ) -> Result<Vec<Step>, SkinError> {
        if table.driven.is_some() {
            return self.refuse("drive.driven", "given".into(), "nothing (a table lists every step)");
        }
        let (rows, first) = match steps {
            StepTable::Inline(rows) => (rows.iter().map(|Exactly(row)| *row).collect(), 1),
            StepTable::File(file) => (self.step_file(file)?, 0),
        };
        if !(1..=MOST_STEPS).contains(&rows.len()) {
            return self.refuse(
                "drive.table",
                format!("{} steps", rows.len()),
                &format!("1 to {MOST_STEPS}"),
            );
        }
        rows.iter().enumerate().map(|(row, cells)| self.step(row, cells, first, electrodes)).collect()
    }

    /// One row of a table, whose electrodes count from `first`.
    fn step(&self, row: usize, cells: &[i64; 4], first: i64, electrodes: u8) -> Result<Step, SkinError> {
        let last = i64::from(electrodes) - 1 + first;
        let refuse = |what: &str| self.refuse("drive.table", format!("{cells:?} in row {}", row + 1), what);
        if cells.iter().any(|electrode| !(first..=last).contains(electrode)) {
            return refuse(&format!("electrodes {first} to {last}"));
        }
        let step = Step::from_bytes(cells.map(|electrode| (electrode - first) as u8));
        if step.is_valid(electrodes) { Ok(step) } else { refuse("two different electrodes in each pair") }
    }

    /// Rows of a CSV file with the columns [`STEP_COLUMNS`], as `export` writes it.
    fn step_file(&self, file: &Path) -> Result<Vec<[i64; 4]>, SkinError> {
        let rows = self.table(file, &STEP_FILE)?;
        let cells = |row: StepRow| [row.drive_plus, row.drive_minus, row.sense_plus, row.sense_minus];
        Ok(rows.into_iter().map(cells).collect())
    }
}

const STEP_FILE: TableField<'_> = TableField {
    field: "drive.table",
    else_allowed: "a list of steps",
    columns: Columns { required: &STEP_COLUMNS, optional: &[] },
    most: MOST_STEPS,
};

/// A row with the columns [`STEP_COLUMNS`].
#[derive(Deserialize)]
struct StepRow {
    drive_plus: i64,
    drive_minus: i64,
    sense_plus: i64,
    sense_minus: i64,
}
