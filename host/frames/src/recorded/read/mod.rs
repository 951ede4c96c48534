//! Reading measured frames from files of other people's instruments.

use super::{npy, npz, table};
use num_complex::Complex64;
use std::{
    ffi::OsStr,
    fmt,
    fs::File,
    io::{self, Read},
    path::{Path, PathBuf},
};

pub(crate) use super::npy::Array;
pub use super::{npy::NpyError, npz::Listing};

/// Longest file, and longest array inside an archive, bytes.
pub const MAX_BYTES: u64 = 1 << 30;
/// Most values in one array; they take 16 bytes each in memory.
pub const MAX_VALUES: usize = 1 << 26;

/// Measured frames, and whether they carry a phase.
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

    /// Subtracts a constant from every value.
    #[must_use]
    pub fn minus(mut self, offset: f64) -> Self {
        self.values.iter_mut().for_each(|value| *value -= offset);
        self
    }

    /// Mean of all frames: `[measurement]`.
    #[must_use]
    pub fn mean(&self) -> Vec<Complex64> {
        let mean_of = |m: usize| self.iter().map(|frame| frame[m] / self.frames as f64).sum();
        (0..self.measurements).map(mean_of).collect()
    }
}

/// A file of frames, and for an archive which array: `frames.npy`, `run.npz:frames`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Source {
    /// The file.
    pub path: PathBuf,
    /// Name of the array in an archive.
    pub key: Option<String>,
}

impl Source {
    /// Splits at the last colon, but only after a name that ends in `.npz`: `C:\run.npz` has no key.
    #[must_use]
    pub fn new(text: &OsStr) -> Self {
        let split = text.to_str().and_then(|text| text.rsplit_once(':'));
        match split.filter(|(path, _)| path.to_ascii_lowercase().ends_with(".npz")) {
            Some((path, key)) => Self { path: path.into(), key: Some(key.into()) },
            None => Self { path: text.into(), key: None },
        }
    }
}

impl fmt::Display for Source {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}", self.path.display())?;
        self.key.as_ref().map_or(Ok(()), |key| write!(f, ":{key}"))
    }
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
    /// The file cannot be opened or read.
    #[error("{0}")]
    Io(io::Error),
    /// An unknown ending.
    #[error("its name must end in .npy, .npz, .csv or .txt")]
    Ending,
    /// The file, or the array in it, is too long.
    #[error("it holds more than {MAX_BYTES} bytes or {MAX_VALUES} values, the most that is read at once")]
    TooLarge,
    /// Not a NumPy array of numbers.
    #[error(transparent)]
    Npy(#[from] NpyError),
    /// Not an archive, or a damaged one.
    #[error("not a readable .npz archive: {0}")]
    Archive(String),
    /// An archive without arrays.
    #[error("the archive holds no array")]
    NoArrays,
    /// An archive with several arrays, and none was chosen.
    #[error("the archive holds several arrays; choose one as FILE.npz:KEY from: {arrays}")]
    SeveralArrays {
        /// What there is.
        arrays: Listing,
    },
    /// The array that was asked for is not there.
    #[error("the archive holds no array `{key}`; there are: {arrays}")]
    NoKey {
        /// What was asked for.
        key: String,
        /// What there is.
        arrays: Listing,
    },
    /// Text that is not a table.
    #[error("not a readable table: {0}")]
    Table(String),
    /// A cell that is not a number.
    #[error("line {line}, column {column}: `{text}` is not a number")]
    Cell {
        /// Line, from 1.
        line: u64,
        /// Column, from 1.
        column: usize,
        /// What the cell holds.
        text: String,
    },
    /// Rows of different lengths.
    #[error("line {line} has {found} columns, the lines before it have {expected}")]
    Row {
        /// Line, from 1.
        line: u64,
        /// Columns there.
        found: usize,
        /// Columns expected.
        expected: usize,
    },
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
    read_array(source).and_then(frames_of).map_err(|problem| ReadError { file: source.to_string(), problem })
}

/// Reads the numbers of a file, of any shape.
pub(crate) fn read_array(source: &Source) -> Result<Array, Problem> {
    let content = Content::of(&source.path)?;
    content.parse(&read_bytes(&source.path)?, source.key.as_deref())
}

fn read_bytes(path: &Path) -> Result<Vec<u8>, Problem> {
    let mut bytes = Vec::new();
    let file = File::open(path).map_err(Problem::Io)?;
    file.take(MAX_BYTES + 1).read_to_end(&mut bytes).map_err(Problem::Io)?;
    if bytes.len() as u64 > MAX_BYTES { Err(Problem::TooLarge) } else { Ok(bytes) }
}

/// What a file's name says it holds.
#[derive(Clone, Copy, Debug)]
enum Content {
    Npy,
    Npz,
    Table,
}

impl Content {
    fn of(path: &Path) -> Result<Self, Problem> {
        let ending = path.extension().unwrap_or_default().to_ascii_lowercase();
        match ending.to_str() {
            Some("npy") => Ok(Self::Npy),
            Some("npz") => Ok(Self::Npz),
            Some("csv" | "txt") => Ok(Self::Table),
            _ => Err(Problem::Ending),
        }
    }

    fn parse(self, bytes: &[u8], key: Option<&str>) -> Result<Array, Problem> {
        match self {
            Self::Npy => Ok(npy::parse(bytes)?),
            Self::Npz => npz::parse(bytes, key),
            Self::Table => table::parse(bytes),
        }
    }
}

fn frames_of(array: Array) -> Result<Frames, Problem> {
    let Array { shape, values, complex } = array;
    if values.is_empty() {
        return Err(Problem::Empty { shape: npy::show_shape(&shape) });
    }
    let (frames, measurements) =
        frame_shape(&shape).ok_or_else(|| Problem::Shape { shape: npy::show_shape(&shape) })?;
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
