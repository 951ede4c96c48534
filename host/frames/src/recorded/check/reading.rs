//! One way to read a frame: where in it each step lies, which electrodes are behind it, and what is added to it.

use super::{
    super::{
        order::{Arrangement, OrderError},
        read::Frames,
    },
    Expected,
    wiring::{Exchange, Wiring},
};
use dermatome_shared::stimulation::Step;
use num_complex::Complex64;
use serde::Serialize;

/// Something that moves values to other places of a frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Misplacement {
    /// A square whose rows are sense pairs and whose columns are drives.
    Transposed,
    /// The whole frame begins so many values late and goes on at its start.
    Shifted(usize),
    /// Each row of a square begins so many values late and goes on at its start.
    ColumnsShifted(usize),
    /// Two drives are in each other's place.
    Rows([usize; 2]),
    /// Two columns of a square are in each other's place.
    Columns([usize; 2]),
}

/// How a frame is read.
#[derive(Clone, Debug)]
pub(super) struct Reading {
    pub(super) wiring: Wiring,
    pub(super) exchanged: Vec<Exchange>,
    pub(super) misplaced: Vec<Misplacement>,
    /// What is subtracted from every value.
    pub(super) offset: Complex64,
    /// Whether columns of a square are potentials, whose differences so many columns apart are meant.
    pub(super) potentials: Option<usize>,
}

impl Reading {
    pub(super) fn new(arrangement: Arrangement, electrodes: u8) -> Self {
        Self {
            wiring: Wiring::new(arrangement, electrodes),
            exchanged: Vec::new(),
            misplaced: Vec::new(),
            offset: Complex64::ZERO,
            potentials: None,
        }
    }

    pub(super) fn arrangement(&self) -> Arrangement {
        self.wiring.arrangement
    }

    /// The same in another order and numbering; exchanges stay.
    pub(super) fn rearranged(&self, arrangement: Arrangement, electrodes: u8) -> Self {
        let wiring = self
            .exchanged
            .iter()
            .fold(Wiring::new(arrangement, electrodes), |wiring, exchange| wiring.with(*exchange));
        Self { wiring, ..self.clone() }
    }

    pub(super) fn with_exchange(&self, exchange: Exchange) -> Self {
        let exchanged = [&self.exchanged[..], &[exchange]].concat();
        Self { wiring: self.wiring.with(exchange), exchanged, ..self.clone() }
    }

    pub(super) fn with_misplaced(&self, misplacement: Misplacement) -> Self {
        Self { misplaced: [&self.misplaced[..], &[misplacement]].concat(), ..self.clone() }
    }

    /// Where each step lies in a frame of so many values, and of potentials where the one lies that is to be
    /// subtracted: `[step, in the file's electrode numbers]`.
    pub(super) fn places(
        &self,
        steps: &[Step],
        electrodes: u8,
        found: usize,
    ) -> Result<Vec<(usize, Option<usize>)>, OrderError> {
        let places = self.arrangement().file_indices(steps, electrodes, found)?;
        let n = usize::from(electrodes);
        let rows = Rows::of(steps, n, found);
        let moved = |place: usize| {
            self.misplaced.iter().rev().fold(place, |place, misplacement| rows.moved(*misplacement, place))
        };
        let other = |place: usize, distance: usize| place / n * n + (place % n + distance) % n;
        Ok(places
            .into_iter()
            .map(|place| (moved(place), self.potentials.map(|distance| moved(other(place, distance)))))
            .collect())
    }
}

/// Rows of a frame, one for each drive.
pub(super) struct Rows {
    /// First value of each, and at last the number of values.
    starts: Vec<usize>,
}

impl Rows {
    /// Of a frame of so many values: the full square, or the steps.
    pub(super) fn of(steps: &[Step], electrodes: usize, found: usize) -> Self {
        if found == electrodes * electrodes {
            return Self { starts: (0..=electrodes).map(|row| row * electrodes).collect() };
        }
        let drive = |step: &Step| [step.drive_plus, step.drive_minus];
        let ends = steps.chunk_by(|a, b| drive(a) == drive(b)).scan(0, |end, run| {
            *end += run.len();
            Some(*end)
        });
        Self { starts: std::iter::once(0).chain(ends).collect() }
    }

    /// Number of rows.
    pub(super) fn count(&self) -> usize {
        self.starts.len() - 1
    }

    /// Number of values.
    fn values(&self) -> usize {
        self.starts[self.count()]
    }

    fn length(&self, row: usize) -> usize {
        self.starts[row + 1] - self.starts[row]
    }

    /// Length of all rows, if they are alike.
    pub(super) fn common_length(&self) -> Option<usize> {
        let first = self.length(0);
        (0..self.count()).all(|row| self.length(row) == first).then_some(first)
    }

    /// Where the value that belongs to a place is instead. Misplacements are of rows that are alike.
    fn moved(&self, misplacement: Misplacement, place: usize) -> usize {
        let row = self.starts.partition_point(|&start| start <= place) - 1;
        let (start, length) = (self.starts[row], self.length(row));
        let column = place - start;
        match misplacement {
            Misplacement::Transposed => self.starts[column] + row,
            Misplacement::Shifted(by) => (place + by) % self.values(),
            Misplacement::ColumnsShifted(by) => start + (column + by) % length,
            Misplacement::Rows([a, b]) if row == a => self.starts[b] + column,
            Misplacement::Rows([a, b]) if row == b => self.starts[a] + column,
            Misplacement::Columns([a, b]) if column == a => start + b,
            Misplacement::Columns([a, b]) if column == b => start + a,
            Misplacement::Rows(_) | Misplacement::Columns(_) => place,
        }
    }
}

/// Frames of potentials with, in the place of each step, the difference that is meant.
pub(super) fn apart(expected: &Expected, frames: &Frames, reading: &Reading) -> Result<Frames, OrderError> {
    let places = reading.places(&expected.steps, expected.electrodes, frames.measurements)?;
    let mut values = frames.values.clone();
    for (apart, frame) in values.chunks_exact_mut(frames.measurements).zip(frames.iter()) {
        for &(place, other) in &places {
            apart[place] = frame[place] - other.map_or(Complex64::ZERO, |other| frame[other]);
        }
    }
    Ok(Frames { values, ..frames.clone() })
}
