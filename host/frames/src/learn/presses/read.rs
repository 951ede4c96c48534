//! Reading presses: what a file's rows say, before anything is known of the skin but its shape.

use super::{FORCES, POSITIONS, PRESSED, Positions, PressError, Recording, UNPRESSED, place::is_flat};
use crate::{
    array::{ArrayError, Source, file},
    recorded::read::{Frames, read},
};
use dermatome_geometry::{embedding::Embedding, sheet::Sheet};
use dermatome_model::skin::{Shape, Skin};
use num_complex::Complex64;
use std::path::Path;

impl Recording {
    /// Reads the presses of a file. `reference`, frames that are averaged, goes before the file's own; `offset` is
    /// subtracted from every measurement. What the columns of a table are, `skin` says: on a flat one x and y, else z too.
    pub fn read(
        path: &Path,
        reference: Option<Frames>,
        offset: f64,
        skin: &Skin,
    ) -> Result<Self, PressError> {
        let reference = reference.map(|frames| averaged(&frames));
        let is_archive = path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("npz"));
        if is_archive {
            Self::of_archive(path, reference, offset)
        } else {
            Self::of_table(path, reference, offset, skin)
        }
    }

    fn of_archive(path: &Path, reference: Option<Frames>, offset: f64) -> Result<Self, PressError> {
        let source = |key: &str| Source { path: path.into(), key: Some(key.into()) };
        let pressed = read(&source(PRESSED))?.minus(offset);
        let positions = read(&source(POSITIONS))?;
        check_rows(POSITIONS, positions.frames, pressed.frames)?;
        let positions = match positions.measurements {
            0..2 => return Err(PressError::Coordinates(positions.measurements)),
            2 => Positions::FromAbove(places(&positions, [POSITIONS; 2])?),
            _ => Positions::InSpace(places(&positions, [POSITIONS; 3])?),
        };
        let unpressed = match reference {
            Some(reference) => reference,
            None if holds(&source(UNPRESSED)) => read(&source(UNPRESSED))?.minus(offset),
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
        offset: f64,
        skin: &Skin,
    ) -> Result<Self, PressError> {
        let rows = read(&Source { path: path.into(), key: None })?;
        let (is_flat, columns) = (is_flat_shape(&skin.shape), rows.measurements);
        let (coordinates, names) = if is_flat { (2, "x, y") } else { (3, "x, y, z") };
        let (steps, square) = (skin.steps().len(), usize::from(skin.electrodes.count).pow(2));
        let is_frame = |leading: usize| columns == steps + leading || columns == square + leading;
        let leading = match [coordinates, coordinates + 1].into_iter().find(|&leading| is_frame(leading)) {
            Some(leading) => leading,
            None if !is_flat && is_frame(2) => return Err(PressError::NoHeight),
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
        let pressed = Frames { values, measurements: columns - leading, ..rows.clone() }.minus(offset);
        Ok(Self { pressed, unpressed, positions, forces })
    }
}

fn averaged(frames: &Frames) -> Frames {
    Frames { values: frames.mean(), frames: 1, ..frames.clone() }
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
