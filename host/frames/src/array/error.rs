//! Why a file holds no array of numbers.

use super::{MAX_BYTES, MAX_VALUES, npy::NpyError};
use std::{fmt, io};

/// Arrays an error message lists.
pub(super) const MAX_LISTED: usize = 40;

/// Why a file's content is not an array of numbers.
#[derive(Debug, thiserror::Error)]
pub enum ArrayError {
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
}

/// The arrays of an archive, for an error message.
#[derive(Debug)]
pub struct Listing(pub(super) Vec<String>);

impl fmt::Display for Listing {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}", self.0[..self.0.len().min(MAX_LISTED)].join(", "))?;
        match self.0.len().saturating_sub(MAX_LISTED) {
            0 => Ok(()),
            more => write!(f, " and {more} more"),
        }
    }
}
