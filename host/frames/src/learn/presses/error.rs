//! Why recorded presses cannot be used.

use super::{POSITIONS, PRESSED, UNPRESSED};
use crate::recorded::{
    order::OrderError,
    read::{PotentialsError, ReadError},
};
use dermatome_model::model::TooManyPixels;
use num_complex::Complex64;

/// Why recorded presses cannot be used.
#[derive(Debug, thiserror::Error)]
pub enum PressError {
    /// A file cannot be read.
    #[error(transparent)]
    Read(#[from] ReadError),
    /// Frames are no potentials of this skin's electrodes.
    #[error("frames as potentials of electrodes: {0}")]
    Potentials(#[from] PotentialsError),
    /// No frames of the untouched skin.
    #[error("`{file}` holds no frames of the untouched skin: give them as a reference of their own{}", also(.archive))]
    NoReference {
        /// The file.
        file: String,
        /// Whether it could hold them.
        archive: bool,
    },
    /// Not one for each press.
    #[error("{what} holds {found} rows, `{PRESSED}` {presses}; allowed: {allowed}")]
    Rows {
        /// The array.
        what: &'static str,
        /// Its rows.
        found: usize,
        /// Presses.
        presses: usize,
        /// What would do.
        allowed: &'static str,
    },
    /// Positions without two coordinates.
    #[error(
        "`{POSITIONS}` has {0} columns; allowed: 2 or more, x, y and on a curved skin z first, in metres"
    )]
    Coordinates(usize),
    /// Columns that make no press.
    #[error(
        "rows hold {columns} numbers; for this skin allowed are {coordinates} and {steps} or {square} measurements, or \
         {coordinates}, force and as many"
    )]
    Columns {
        /// Columns of the table.
        columns: usize,
        /// Which coordinates this skin needs.
        coordinates: &'static str,
        /// Steps of the skin.
        steps: usize,
        /// Electrodes squared.
        square: usize,
    },
    /// Presses without z on a skin that needs it.
    #[error(
        "presses say x and y only, and the skin is curved, or does not lie in the plane z = 0; allowed there: x, y and z, in \
         metres"
    )]
    NoHeight,
    /// Untouched and pressed frames of different instruments.
    #[error(
        "frames of presses hold {pressed} measurements, those of the untouched skin {unpressed}; they must be equal"
    )]
    Lengths {
        /// In a pressed frame.
        pressed: usize,
        /// In an untouched frame.
        unpressed: usize,
    },
    /// A place or force with an imaginary part.
    #[error("{what} of press {press} (counted from 0) is {value}; allowed: a real number")]
    NotReal {
        /// The array.
        what: &'static str,
        /// The press.
        press: usize,
        /// What it is.
        value: Complex64,
    },
    /// A press beside the skin.
    #[error(
        "press {press} (counted from 0) is at ({x}, {y}) m, {far_mm:.1} mm off the skin, which reaches {reach_mm:.1} mm from its \
         centre; allowed: places on the skin, in metres{}", perhaps_millimetres(.x, .y, .reach_mm)
    )]
    OffTheSkin {
        /// The press.
        press: usize,
        /// Its place, m.
        x: f64,
        /// Its place, m.
        y: f64,
        /// From the nearest pixel.
        far_mm: f64,
        /// Half the skin's larger side.
        reach_mm: f64,
    },
    /// A press that lies too far above or beneath a curved skin, or beside it.
    #[error(
        "press {press} (counted from 0) is at ({}, {}, {}) m, {off_mm:.1} mm off the skin, whose nearest point is ({:.4}, {:.4}, \
         {:.4}) m; allowed: up to {most_mm:.1} mm, the width of a pixel{}", .at[0], .at[1], .at[2], .nearest[0], .nearest[1],
        .nearest[2], perhaps_in_mm(.at, .reach_mm)
    )]
    OffTheSurface {
        /// The press.
        press: usize,
        /// Its place, m.
        at: [f64; 3],
        /// The nearest point of the skin, m.
        nearest: [f64; 3],
        /// How far that is.
        off_mm: f64,
        /// Farthest that is allowed.
        most_mm: f64,
        /// Half the skin's larger side.
        reach_mm: f64,
    },
    /// A press without force.
    #[error("the force of press {press} (counted from 0) is {force} N; allowed: above zero")]
    Force {
        /// The press.
        press: usize,
        /// Its force.
        force: f64,
    },
    /// Frames that do not fit the skin.
    #[error(transparent)]
    Order(#[from] OrderError),
    /// A skin with more pixels than a board takes.
    #[error(transparent)]
    Pixels(#[from] TooManyPixels),
}

fn also(archive: &bool) -> String {
    if *archive { format!(", or in the archive as `{UNPRESSED}`") } else { String::new() }
}

fn perhaps_in_mm(at: &[f64; 3], reach_mm: &f64) -> &'static str {
    perhaps_millimetres(&at[0].hypot(at[1]), &at[2], reach_mm)
}

fn perhaps_millimetres(x: &f64, y: &f64, reach_mm: &f64) -> &'static str {
    let is_on_skin_in_mm = x.hypot(*y) <= 2.0 * reach_mm && x.hypot(*y) * 1e3 > 10.0 * reach_mm;
    if is_on_skin_in_mm { " (these look like millimetres)" } else { "" }
}
