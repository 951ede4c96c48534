//! Trust: what a board says, tried on simulated skins and set beside what is asked of it.
//!
//! Everything a board says here is said by its own code ([`Observer`](dermatome_simulate::rig::Observer)) about frames of a
//! true skin on a mesh of its own, with noise and a converter. A scene is solved once, and each of its frames gets noise of
//! its own; what changes with time is solved at moments, and straight between them. Where minutes go by, frames come at
//! fewer a second, by their time stamps; a row that does so says it.
//!
//! [`ROWS`] lists what is tried. Each row is a function from a [`Bench`], one skin with what its contacts are found in, and
//! [`Options`] to [`Figure`]s.

mod bench;
mod figure;
mod rows;
mod trial;

use crate::deform::DeformError;
pub use bench::{Bench, Places, Voltages};
use dermatome_model::{model::ModelError, quantize::PatchBuildError};
use dermatome_shared::patch::PatchError;
use dermatome_simulate::rig::RigError;
pub use figure::{Figure, Verdict};
use rayon::prelude::*;
pub use rows::{ROWS, Row};
use serde_json::{Value, json};
pub use trial::{PRESSED_FRAMES, Pressed, Trial, place_of};

/// What is tried.
#[derive(Clone, Debug, PartialEq)]
pub struct Options {
    /// Seed of places and noise.
    pub seed: u64,
    /// Signal-to-noise ratios, dB, as in [`dermatome_simulate::Noise`]; rows in time take the first. Not empty.
    pub snr_db: Vec<f64>,
    /// Presses of a row at one noise; rows in which each takes long try a part of them.
    pub presses: usize,
    /// Frames of the untouched skin at one noise.
    pub frames: usize,
}

impl Options {
    /// The noise of rows in time, dB.
    fn first_snr_db(&self) -> f64 {
        self.snr_db.first().copied().unwrap_or(60.0)
    }

    /// One in so many presses, at least `least`.
    fn one_in(&self, share: usize, least: usize) -> usize {
        (self.presses / share).max(least)
    }

    /// The options for the row of this number: its own random numbers.
    fn for_row(&self, number: usize) -> Self {
        Self { seed: self.seed.wrapping_mul(1000).wrapping_add(number as u64), ..self.clone() }
    }
}

/// What one row found on one bench.
#[derive(Clone, Debug)]
pub struct RowFigures {
    /// Its name.
    pub name: &'static str,
    /// What it tries.
    pub about: &'static str,
    /// What it found, or why it could not be tried on this skin.
    pub figures: Result<Vec<Figure>, String>,
}

/// Why something cannot be tried on a skin.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum TrustError {
    /// No model or no patch.
    #[error(transparent)]
    Rig(#[from] RigError),
    /// Places cannot lie so.
    #[error(
        "no room for {count} places {apart} of the size apart between {from} and {to} of the way to the rim"
    )]
    NoRoom {
        /// How many.
        count: usize,
        /// Least normalised radius.
        from: f64,
        /// Largest normalised radius.
        to: f64,
        /// Distance from each other, a share of the size.
        apart: f64,
    },
    /// The skin has nothing of the kind.
    #[error("{0}")]
    Unsuited(&'static str),
}

impl From<DeformError> for TrustError {
    fn from(DeformError(why): DeformError) -> Self {
        Self::Unsuited(why)
    }
}

impl From<PatchError> for TrustError {
    fn from(error: PatchError) -> Self {
        Self::Rig(PatchBuildError::Invalid(error).into())
    }
}

impl From<ModelError> for TrustError {
    fn from(error: ModelError) -> Self {
        Self::Rig(error.into())
    }
}

/// Tries rows on benches, as many at once as there are processors: `[bench][row]`. `on_done` hears of each that is done.
#[must_use]
pub fn run(
    benches: &[Bench],
    rows: &[Row],
    options: &Options,
    on_done: impl Fn() + Sync,
) -> Vec<Vec<RowFigures>> {
    // Neighbours in this list take about as long: all benches of a row stand together.
    let tasks: Vec<_> = rows.iter().flat_map(|row| benches.iter().map(move |bench| (row, bench))).collect();
    let try_one = |&(row, bench): &(&Row, &Bench)| {
        let number = ROWS.iter().position(|other| other.name == row.name).unwrap_or_default();
        let figures = (row.run)(bench, &options.for_row(number)).map_err(|error| error.to_string());
        on_done();
        RowFigures { name: row.name, about: row.about, figures }
    };
    let done: Vec<_> = tasks.par_iter().with_max_len(1).map(try_one).collect();
    let of_bench = |bench| done.iter().skip(bench).step_by(benches.len()).cloned().collect();
    (0..benches.len()).map(of_bench).collect()
}

/// What was found on one bench, for scripts; keys are documented in docs/cli.md.
#[must_use]
pub fn json(rows: &[RowFigures]) -> Value {
    let row = |row: &RowFigures| {
        let figures = row.figures.iter().flatten().map(Figure::json).collect::<Vec<_>>();
        json!({ "row": row.name, "figures": figures, "not_run": row.figures.as_ref().err() })
    };
    rows.iter().map(row).collect()
}
