//! Reading presses: what a file's rows say, before anything is known of the skin but its shape.

use super::{FORCES, POSITIONS, PRESSED, Positions, PressError, Recording, UNPRESSED, place::is_flat};
use crate::{
    array::{ArrayError, Source, file},
    recorded::read::{Frames, read, read_turned},
};
use dermatome_geometry::{embedding::Embedding, sheet::Sheet};
use dermatome_model::skin::{Shape, Skin};
use num_complex::Complex64;
use std::path::Path;

/// How a file holds its frames.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Layout {
    /// What is subtracted from every measurement.
    pub offset: f64,
    /// Whether presses are columns (of MATLAB's arrays: rows). Arrays of places and forces tell by their size.
    pub turned: bool,
    /// Whether frames are squares of the potentials of electrodes.
    pub potentials: bool,
}

impl Layout {
    fn rows(&self, source: &Source, is_row: impl Fn(usize) -> bool) -> Result<Frames, PressError> {
        Ok(if self.turned { read(source)?.transposed() } else { read_turned(source, is_row)? })
    }

    /// Differences of the pairs that a skin senses.
    fn differences(&self, frames: Frames, skin: &Skin) -> Result<Frames, PressError> {
        let frames = frames.minus(self.offset);
        if self.potentials { Ok(frames.apart(&skin.steps(), skin.electrodes.count)?) } else { Ok(frames) }
    }
}

impl Recording {
    /// Reads the presses of a file. `reference`, one frame of the untouched skin or one for each press, goes before the file's
    /// own, and is differences of pairs already. What the columns of a table are, `skin` says: on a flat one x and y, else
    /// z too.
    pub fn read(
        path: &Path,
        reference: Option<Frames>,
        layout: &Layout,
        skin: &Skin,
    ) -> Result<Self, PressError> {
        let of_key = |key: &str| Source { path: path.into(), key: Some(key.into()) };
        let is = |ending: &str| path.extension().is_some_and(|it| it.eq_ignore_ascii_case(ending));
        // A MATLAB file may be either.
        if is("npz") || is("mat") && file::read(&of_key(PRESSED)).is_ok() {
            Self::of_archive(path, reference, layout, skin)
        } else {
            Self::of_table(path, reference, layout, skin)
        }
    }

    fn of_archive(
        path: &Path,
        reference: Option<Frames>,
        layout: &Layout,
        skin: &Skin,
    ) -> Result<Self, PressError> {
        let source = |key: &str| Source { path: path.into(), key: Some(key.into()) };
        let is_frame = |length: usize| frame_lengths(skin).contains(&length);
        let frames = |key| layout.differences(layout.rows(&source(key), is_frame)?, skin);
        let pressed = frames(PRESSED)?;
        let positions = read_turned(&source(POSITIONS), |columns| matches!(columns, 2 | 3))?;
        check_rows(POSITIONS, positions.frames, pressed.frames)?;
        let positions = match positions.measurements {
            0..2 => return Err(PressError::Coordinates(positions.measurements)),
            2 => Positions::FromAbove(places(&positions, [POSITIONS; 2])?),
            _ => Positions::InSpace(places(&positions, [POSITIONS; 3])?),
        };
        let unpressed = match reference {
            Some(reference) => reference,
            None if holds(&source(UNPRESSED)) => frames(UNPRESSED)?,
            None => return Err(PressError::NoReference { file: path.display().to_string(), archive: true }),
        };
        let forces = if holds(&source(FORCES)) {
            Some(forces(&read(&source(FORCES))?, pressed.frames)?)
        } else {
            None
        };
        Ok(Self { pressed, unpressed, positions, forces })
    }

    fn of_table(
        path: &Path,
        reference: Option<Frames>,
        layout: &Layout,
        skin: &Skin,
    ) -> Result<Self, PressError> {
        let is_flat = is_flat_shape(&skin.shape);
        let (coordinates, names) = if is_flat { (2, "x, y") } else { (3, "x, y, z") };
        let [steps, square] = frame_lengths(skin);
        let is_row =
            |columns: usize, leading: usize| columns == steps + leading || columns == square + leading;
        let leading =
            |columns: usize| [coordinates, coordinates + 1].into_iter().find(|&it| is_row(columns, it));
        let rows =
            layout.rows(&Source { path: path.into(), key: None }, |columns| leading(columns).is_some())?;
        let columns = rows.measurements;
        let leading = match leading(columns) {
            Some(leading) => leading,
            None if !is_flat && is_row(columns, 2) => return Err(PressError::NoHeight),
            None => return Err(PressError::Columns { columns, coordinates: names, steps, square }),
        };
        let Some(unpressed) = reference else {
            return Err(PressError::NoReference { file: path.display().to_string(), archive: false });
        };
        let positions = if is_flat {
            Positions::FromAbove(places(&rows, ["x", "y"])?)
        } else {
            Positions::InSpace(places(&rows, ["x", "y", "z"])?)
        };
        let has_force = leading > coordinates;
        let forces = if has_force { Some(column(&rows, coordinates, "the force")?) } else { None };
        let values = rows.iter().flat_map(|row| &row[leading..]).copied().collect();
        let pressed = Frames { values, measurements: columns - leading, ..rows.clone() };
        let pressed = layout.differences(pressed, skin)?;
        Ok(Self { pressed, unpressed, positions, forces })
    }
}

/// Measurements that a frame of a skin may hold: its steps, or the full square.
fn frame_lengths(skin: &Skin) -> [usize; 2] {
    [skin.steps().len(), usize::from(skin.electrodes.count).pow(2)]
}

/// Whether an archive holds an array of this name.
fn holds(source: &Source) -> bool {
    !matches!(file::read(source), Err(ArrayError::NoKey { .. }))
}

/// The first columns, by what errors call them.
fn places<const N: usize>(rows: &Frames, names: [&'static str; N]) -> Result<Vec<[f64; N]>, PressError> {
    let place = |(press, row): (usize, &[Complex64])| {
        let mut place = [0.0; N];
        for (axis, name) in names.into_iter().enumerate() {
            place[axis] = real(name, press, row[axis])?;
        }
        Ok(place)
    };
    rows.iter().enumerate().map(place).collect()
}

/// Whether x and y say where on a skin a press is, before it is meshed.
fn is_flat_shape(shape: &Shape) -> bool {
    match shape {
        Shape::Sheet(Sheet { embedding, .. }) => matches!(embedding, Embedding::Flat),
        Shape::Mesh { mesh, .. } => is_flat(mesh),
    }
}

fn column(rows: &Frames, column: usize, what: &'static str) -> Result<Vec<f64>, PressError> {
    rows.iter().enumerate().map(|(press, row)| real(what, press, row[column])).collect()
}

/// One number for each press, as a row or a column.
fn forces(values: &Frames, presses: usize) -> Result<Vec<f64>, PressError> {
    check_rows(FORCES, values.values.len(), presses)?;
    values.values.iter().enumerate().map(|(press, &value)| real(FORCES, press, value)).collect()
}

fn check_rows(what: &'static str, found: usize, presses: usize) -> Result<(), PressError> {
    if found == presses {
        return Ok(());
    }
    Err(PressError::Rows { what, found, presses, allowed: "one for each press" })
}

fn real(what: &'static str, press: usize, value: Complex64) -> Result<f64, PressError> {
    if value.im == 0.0 { Ok(value.re) } else { Err(PressError::NotReal { what, press, value }) }
}
