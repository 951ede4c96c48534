//! Recording: the contacts that `dermatome stream` printed while a machine loaded the skin.
//!
//! One line for each contact, the strongest of a frame first, fields separated by tabs. Frames without contact have no
//! line, so that the frames between two lines are made up again by their sequence numbers, as frames without contact.

use super::{
    FileError, Hold, NoFrames, Pairing, Reading, Strongest,
    file::{refuse, refuse_text},
    pairing::end_of,
};
use dermatome_model::skin::table;
use std::path::{Path, PathBuf};

/// Columns of a line, where no header names them.
const COLUMNS: [&str; 7] = ["sequence", "time_s", "x_mm", "y_mm", "z_mm", "area_mm2", "strength"];
/// Those that are used.
const USED: [&str; 4] = ["sequence", "time_s", "area_mm2", "strength"];
/// And those that are used if there are all of them.
const PLACE: [&str; 3] = ["x_mm", "y_mm", "z_mm"];
/// Most frames under the loads, and between two lines: more than a day at 100 a second.
const MOST_FRAMES: u64 = 10_000_000;

/// Frames of a stream in which the skin was touched.
#[derive(Clone, Debug, PartialEq)]
pub struct Recording {
    path: PathBuf,
    frames: Vec<Frame>,
}

/// A frame with a contact.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Frame {
    /// Line of the file.
    line: u64,
    sequence: u64,
    time_s: f64,
    strongest: Strongest,
}

/// Why a recording gives no readings.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum RecordingError {
    /// The file.
    #[error(transparent)]
    File(#[from] FileError),
    /// A load was held too briefly.
    #[error(transparent)]
    NoFrames(#[from] NoFrames),
    /// No load to begin with.
    #[error("the loads hold no pressure above zero; allowed: loads up and down again")]
    NoLoad,
    /// Loads that last too long for the recording's frame rate.
    #[error("the loads last for {frames:.0} frames of the recording; allowed: up to {MOST_FRAMES}")]
    TooLong {
        /// How many.
        frames: f64,
    },
    /// The last contact comes too early.
    #[error(
        "recording `{}` has its last contact {last_s:.3} s after the loads' time 0, before the load of {pressure_kpa} kPa at \
         `time_s` = {time_s}; allowed: the whole recording, with `--start` at the loads' time 0",
        path.display()
    )]
    EndsEarly {
        /// The file.
        path: PathBuf,
        /// Last contact, s after time 0 of the loads.
        last_s: f64,
        /// The first load behind it.
        time_s: f64,
        /// Its pressure.
        pressure_kpa: f64,
    },
}

impl Recording {
    /// Reads the lines of `stream`, with or without a header.
    pub fn read(path: &Path) -> Result<Self, FileError> {
        let bytes = table::bytes(path).map_err(|error| FileError::new(path, error.to_string()))?;
        let mut open = csv::ReaderBuilder::new();
        open.delimiter(table::delimiter(&bytes)).has_headers(false).flexible(true).comment(Some(b'#'));
        let mut reader = open.from_reader(&bytes[..]);
        let mut columns: Option<Columns> = None;
        let mut frames: Vec<Frame> = Vec::new();
        for record in reader.records() {
            let record = record.map_err(|error| FileError::new(path, error.to_string()))?;
            let line = record.position().map_or(0, csv::Position::line);
            let Some(of) = columns else {
                let (of, is_header) = columns_of(path, line, &record)?;
                columns = Some(of);
                if !is_header {
                    frames.push(frame(path, line, &record, of)?);
                }
                continue;
            };
            let next = frame(path, line, &record, of)?;
            match frames.last() {
                Some(last) if next.sequence == last.sequence => {}
                Some(last) => {
                    check_order(path, last, &next)?;
                    frames.push(next);
                }
                None => frames.push(next),
            }
        }
        if frames.len() < 2 {
            let found = frames.len();
            let message = format!(
                "{found} frames with a contact; allowed: two or more, as `dermatome stream` prints them"
            );
            return Err(FileError::new(path, message));
        }
        Ok(Self { path: path.to_owned(), frames })
    }

    /// One reading for each load. `start`: the loads' time 0 on the recording's clock, s; without it the first frame with a
    /// contact is taken for the start of the first load above zero.
    pub fn readings(&self, loads: &[Hold], start: Option<f64>) -> Result<Vec<Reading>, RecordingError> {
        let first_load = loads.iter().find(|load| load.pressure_kpa > 0.0).ok_or(RecordingError::NoLoad)?;
        let start = start.unwrap_or(self.frames[0].time_s - first_load.time_s);
        let period = self.period();
        let frames = (end_of(loads, loads.len() - 1) - loads[0].time_s) / period;
        if frames > MOST_FRAMES as f64 {
            return Err(RecordingError::TooLong { frames });
        }
        let mut pairing = Pairing::new(loads);
        let mut time = loads[0].time_s;
        for frame in &self.frames {
            let at = frame.time_s - start;
            // Frames without contact have no line.
            while !pairing.is_complete() && time < at - 0.5 * period {
                pairing.add(time, None)?;
                time += period;
            }
            pairing.add(at, Some(frame.strongest))?;
            time = at + period;
        }
        while !pairing.is_complete() {
            pairing.add(time, None)?;
            time += period;
        }
        self.check_end(loads, pairing.into_readings(), start)
    }

    /// Time from frame to frame, s.
    fn period(&self) -> f64 {
        let [first, last] = [self.frames[0], self.frames[self.frames.len() - 1]];
        (last.time_s - first.time_s) / (last.sequence - first.sequence) as f64
    }

    /// Refuses readings of which some are nothing because the recording was cut off: loads behind its last contact that
    /// are no smaller than one that shows.
    fn check_end(
        &self,
        loads: &[Hold],
        readings: Vec<Reading>,
        start: f64,
    ) -> Result<Vec<Reading>, RecordingError> {
        let last_s = self.frames[self.frames.len() - 1].time_s - start;
        let shown = readings.iter().filter(|reading| reading.strength > 0.0 && reading.pressure_kpa > 0.0);
        let least = shown.map(|reading| reading.pressure_kpa).fold(f64::INFINITY, f64::min);
        match loads.iter().find(|load| load.time_s > last_s && load.pressure_kpa >= least) {
            Some(&Hold { time_s, pressure_kpa }) => {
                Err(RecordingError::EndsEarly { path: self.path.clone(), last_s, time_s, pressure_kpa })
            }
            None => Ok(readings),
        }
    }
}

/// Where the columns are that are used: those of [`USED`] and of [`PLACE`].
#[derive(Clone, Copy)]
struct Columns {
    used: [usize; 4],
    place: Option<[usize; 3]>,
}

/// Where the columns are that are used, and whether this first line is a header that says so.
fn columns_of(path: &Path, line: u64, record: &csv::StringRecord) -> Result<(Columns, bool), FileError> {
    let place = |names: &[&str], column: &str| names.iter().position(|name| name.trim() == column);
    if record.get(0).is_some_and(|field| field.trim().parse::<f64>().is_ok()) {
        let known = |column| place(&COLUMNS, column).expect("a used column is one of all");
        return Ok((Columns { used: USED.map(known), place: Some(PLACE.map(known)) }, false));
    }
    let names: Vec<&str> = record.iter().collect();
    let mut places = [0; 4];
    for (to, column) in places.iter_mut().zip(USED) {
        let found = place(&names, column);
        *to = found.ok_or_else(|| {
            let given = names.join(", ");
            refuse_text(
                path,
                line,
                column,
                &format!("missing among {given:?}"),
                "the lines of `dermatome stream`",
            )
        })?;
    }
    let [x, y, z] = PLACE.map(|column| place(&names, column));
    let of_place = x.zip(y).zip(z).map(|((x, y), z)| [x, y, z]);
    Ok((Columns { used: places, place: of_place }, true))
}

fn frame(path: &Path, line: u64, record: &csv::StringRecord, columns: Columns) -> Result<Frame, FileError> {
    let mut values = [0.0; 4];
    for ((value, column), name) in values.iter_mut().zip(columns.used).zip(USED) {
        let field = record.get(column).unwrap_or("").trim();
        let number = field.parse().ok().filter(|number: &f64| number.is_finite() && *number >= 0.0);
        *value = number
            .ok_or_else(|| refuse_text(path, line, name, &format!("{field:?}"), "a number, 0 or above"))?;
    }
    let [sequence, time_s, area_mm2, strength] = values;
    let place = columns.place.map(|columns| place(path, line, record, columns)).transpose()?;
    let strongest = Strongest { strength, area_mm2, place };
    Ok(Frame { line, sequence: sequence as u64, time_s, strongest })
}

/// Where its contact is, m.
fn place(
    path: &Path,
    line: u64,
    record: &csv::StringRecord,
    columns: [usize; 3],
) -> Result<[f64; 3], FileError> {
    let mut place = [0.0; 3];
    for ((value, column), name) in place.iter_mut().zip(columns).zip(PLACE) {
        let field = record.get(column).unwrap_or("").trim();
        let number = field.parse().ok().filter(|number: &f64| number.is_finite());
        *value =
            1e-3 * number.ok_or_else(|| refuse_text(path, line, name, &format!("{field:?}"), "a number"))?;
    }
    Ok(place)
}

/// Later in both, and no farther than the longest gap.
fn check_order(path: &Path, last: &Frame, next: &Frame) -> Result<(), FileError> {
    let Frame { line, sequence, time_s, .. } = *next;
    if !(last.sequence..=last.sequence + MOST_FRAMES).contains(&sequence) {
        let allowed =
            format!("{} to {}: one stream, as it was printed", last.sequence, last.sequence + MOST_FRAMES);
        return refuse(path, line, "sequence", sequence as f64, &allowed);
    }
    if time_s <= last.time_s {
        let allowed =
            format!("more than {}, as in line {}: one stream, without a restart", last.time_s, last.line);
        return refuse(path, line, "time_s", time_s, &allowed);
    }
    Ok(())
}
