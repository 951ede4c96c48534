//! Reading recorded frames from files of other people's instruments.

pub use crate::array::Source;

use crate::array::{Array, ArrayError, file, show_shape};
use dermatome_shared::stimulation::Step;
use num_complex::Complex64;

/// Recorded frames, and whether they carry a phase.
#[derive(Clone, Debug, PartialEq)]
pub struct Frames {
    /// Measurements in the file's unit: `[frame][measurement]`, never NaN or infinite.
    pub values: Vec<Complex64>,
    /// Number of frames, at least 1.
    pub frames: usize,
    /// Measurements in each frame, at least 1.
    pub measurements: usize,
    /// Whether the source was complex.
    pub complex: bool,
}

impl Frames {
    /// The frames one by one, each `[measurement]`.
    pub fn iter(&self) -> impl ExactSizeIterator<Item = &[Complex64]> {
        self.values.chunks_exact(self.measurements)
    }

    /// Takes an array of n by n values for one frame, the full square `[drive][sense]` of n
    /// electrodes; but not where a frame of the skin has n steps as well.
    #[must_use]
    pub fn with_square(self, electrodes: u8, steps: usize) -> Self {
        let n = usize::from(electrodes);
        if self.frames == n && self.measurements == n && steps != n {
            Self { frames: 1, measurements: n * n, ..self }
        } else {
            self
        }
    }

    /// Columns as frames instead of rows; a single one stays, as a column is read as a frame.
    #[must_use]
    pub fn transposed(self) -> Self {
        let Self { frames, measurements, .. } = self;
        if frames == 1 {
            return self;
        }
        let values = (0..measurements).flat_map(|m| (0..frames).map(move |frame| frame * measurements + m));
        let values = values.map(|place| self.values[place]).collect();
        Self { values, frames: measurements, measurements: frames, complex: self.complex }
    }

    /// Differences of the pairs that a skin senses, from full squares of electrode potentials: `[drive][sense plus]`.
    pub fn apart(self, steps: &[Step], electrodes: u8) -> Result<Self, PotentialsError> {
        let n = usize::from(electrodes);
        if self.measurements != n * n {
            return Err(PotentialsError::Length { found: self.measurements, square: n * n });
        }
        let distance = sense_distance(steps, electrodes).ok_or(PotentialsError::Distances)?;
        let in_row = |row: &[Complex64]| -> Vec<Complex64> {
            (0..n).map(|column| row[column] - row[(column + distance) % n]).collect()
        };
        Ok(Self { values: self.values.chunks_exact(n).flat_map(in_row).collect(), ..self })
    }

    /// Subtracts a constant from every value.
    #[must_use]
    pub fn minus(mut self, offset: f64) -> Self {
        self.values.iter_mut().for_each(|value| *value -= offset);
        self
    }

    /// Their mean, as the only frame.
    #[must_use]
    pub fn averaged(&self) -> Self {
        Self { values: self.mean(), frames: 1, ..*self }
    }

    /// One for each of so many, where there is only one.
    #[must_use]
    pub fn for_each_of(&self, frames: usize) -> Self {
        if self.frames == 1 {
            Self { values: self.values.repeat(frames), frames, ..*self }
        } else {
            self.clone()
        }
    }

    /// Mean of all frames: `[measurement]`.
    #[must_use]
    pub fn mean(&self) -> Vec<Complex64> {
        let mean_of = |m: usize| self.iter().map(|frame| frame[m] / self.frames as f64).sum();
        (0..self.measurements).map(mean_of).collect()
    }
}

/// Why frames are not potentials of a skin's electrodes.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum PotentialsError {
    /// Not full squares.
    #[error("frames hold {found} values each; allowed are {square}: every drive with every electrode")]
    Length {
        /// Values in a frame.
        found: usize,
        /// Electrodes squared.
        square: usize,
    },
    /// A table of pairs.
    #[error("the skin's sense pairs are not all equally far apart; allowed: a pattern, or differences")]
    Distances,
}

/// Electrodes from the plus to the minus input, where it is the same in all steps.
#[must_use]
pub fn sense_distance(steps: &[Step], electrodes: u8) -> Option<usize> {
    let n = u16::from(electrodes.max(1));
    let distance = |step: &Step| (u16::from(step.sense_minus) + n - u16::from(step.sense_plus)) % n;
    let first = distance(steps.first()?);
    steps.iter().all(|step| distance(step) == first).then_some(usize::from(first))
}

/// Frames could not be read from a file.
#[derive(Debug, thiserror::Error)]
#[error("cannot read frames from `{file}`: {problem}")]
pub struct ReadError {
    /// The file, with the key if one was given.
    pub file: String,
    /// What is wrong.
    pub problem: Problem,
}

/// Why a file's content is not frames.
#[derive(Debug, thiserror::Error)]
pub enum Problem {
    /// It holds no array of numbers.
    #[error(transparent)]
    Array(#[from] ArrayError),
    /// Too many or too few dimensions.
    #[error(
        "shape {shape} is not frames; allowed are (measurements,), (frames, measurements) and \
         (frames, electrodes, electrodes)"
    )]
    Shape {
        /// The array's shape.
        shape: String,
    },
    /// Nothing in it.
    #[error("it is empty: shape {shape}")]
    Empty {
        /// The array's shape.
        shape: String,
    },
    /// A measurement that is no number.
    #[error("frame {frame}, measurement {measurement} (counted from 0) is {value}, not a finite number")]
    NotFinite {
        /// Frame, from 0.
        frame: usize,
        /// Measurement, from 0.
        measurement: usize,
        /// What it is.
        value: Complex64,
    },
}

/// Reads all frames of a file.
///
/// Arrays may have the shape (measurements,), (frames, measurements) or (frames, n, n), the full
/// square `[drive][sense]`. A single column is one frame; for a single square see
/// [`Frames::with_square`].
pub fn read(source: &Source) -> Result<Frames, ReadError> {
    file::read(source)
        .map_err(Problem::from)
        .and_then(frames_of)
        .map_err(|problem| ReadError { file: source.to_string(), problem })
}

/// The same, with rows and columns of a MATLAB file exchanged where only columns are frames that `fit`, by their length:
/// MATLAB has no custom.
pub fn read_turned(source: &Source, fits: impl Fn(usize) -> bool) -> Result<Frames, ReadError> {
    let frames = read(source)?;
    let is_matlab = source.path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("mat"));
    let is_turned = is_matlab && !fits(frames.measurements) && fits(frames.frames);
    Ok(if is_turned { frames.transposed() } else { frames })
}

fn frames_of(array: Array<'_>) -> Result<Frames, Problem> {
    let (complex, shape) = (array.is_complex(), array.shape.clone());
    let values = array.into_complex();
    if values.is_empty() {
        return Err(Problem::Empty { shape: show_shape(&shape) });
    }
    let (frames, measurements) =
        frame_shape(&shape).ok_or_else(|| Problem::Shape { shape: show_shape(&shape) })?;
    match values.iter().position(|value| !value.is_finite()) {
        Some(place) => Err(Problem::NotFinite {
            frame: place / measurements,
            measurement: place % measurements,
            value: values[place],
        }),
        None => Ok(Frames { values, frames, measurements, complex }),
    }
}

/// Frames and measurements in each.
fn frame_shape(shape: &[usize]) -> Option<(usize, usize)> {
    match *shape {
        [measurements] | [measurements, 1] => Some((1, measurements)),
        [frames, measurements] => Some((frames, measurements)),
        [frames, drives, senses] if drives == senses => Some((frames, drives * senses)),
        _ => None,
    }
}

#[cfg(test)]
mod tests;
