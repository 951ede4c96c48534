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
    #[error("its name must end in .npy, .npz, .csv, .txt, .mat, .eit or .get")]
    Ending,
    /// The file, or the array in it, is too long.
    #[error("it holds more than {MAX_BYTES} bytes or {MAX_VALUES} values, the most that is read at once")]
    TooLarge,
    /// Not a NumPy array of numbers.
    #[error(transparent)]
    Npy(#[from] NpyError),
    /// Not a MATLAB file that is read.
    #[error(transparent)]
    Mat(#[from] MatError),
    /// Not a frame of a Sciospec instrument.
    #[error(transparent)]
    Sciospec(#[from] SciospecError),
    /// Not frames of a lung instrument.
    #[error(transparent)]
    Get(#[from] GetError),
    /// A folder without frames.
    #[error("the folder holds no file whose name ends in .eit; allowed: one frame a file, of one instrument")]
    EmptyFolder,
    /// A file of a folder.
    #[error("`{file}` in it: {problem}")]
    InFolder {
        /// Name of the file.
        file: String,
        /// What is wrong with it.
        problem: Box<ArrayError>,
    },
    /// A frame that is unlike the others in its folder.
    #[error("`{file}` in it has the shape {found}, those before it {expected}")]
    Unlike {
        /// Name of the file.
        file: String,
        /// Its shape.
        found: String,
        /// Shape of the others.
        expected: String,
    },
    /// A current of zero, by which nothing can be divided.
    #[error("line {line}: the current I is zero; allowed: another number, or no column I")]
    NoCurrent {
        /// Line, from 1.
        line: u64,
    },
    /// Not an archive, or a damaged one.
    #[error("not a readable .npz archive: {0}")]
    Archive(String),
    /// An archive without arrays.
    #[error("the archive holds no array")]
    NoArrays,
    /// An archive with several arrays, and none was chosen.
    #[error("the archive holds several arrays; choose one as FILE:KEY from: {arrays}")]
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

/// Why a MATLAB file cannot be read.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum MatError {
    /// Another format in a file of that name.
    #[error(
        "it is a MATLAB 7.3 file (HDF5), which is not read; allowed is version 7 or 6: in MATLAB `save(file, \
         variables, '-v7')`, in Octave `save -v7`"
    )]
    Version73,
    /// Something else.
    #[error("not a MATLAB file of version 5 to 7: byte order and version are missing at byte 124")]
    Magic,
    /// Damaged.
    #[error("truncated or damaged: an element is not as long as it says, or of no known type")]
    Damaged,
}

/// Why a Sciospec file cannot be read.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum SciospecError {
    /// Not text.
    #[error("not a Sciospec file: it is not text (other instruments' .eit files are not read)")]
    Text,
    /// No header.
    #[error("not a Sciospec file: line 1 is not the number of lines of its header; allowed are 9 to 100")]
    Header,
    /// Several frequencies.
    #[error("line {line} is {found:?}, the number of frequencies; allowed is 1: export one frequency")]
    Frequencies {
        /// Line, from 1.
        line: usize,
        /// What it says.
        found: String,
    },
    /// Unreadable channels.
    #[error("line {line} is {found:?}; allowed are numbers from 1 with commas after `MeasurementChannels:`")]
    Channels {
        /// Line, from 1.
        line: usize,
        /// What it says.
        found: String,
    },
    /// Not an injection.
    #[error(
        "line {line} is {found:?}; allowed are two different electrodes from 1, and then a line of voltages"
    )]
    Injection {
        /// Line, from 1.
        line: usize,
        /// What it says.
        found: String,
    },
    /// Not a number.
    #[error("line {line}, column {column} is {found:?}, not a number")]
    Number {
        /// Line, from 1.
        line: usize,
        /// Column, from 1.
        column: usize,
        /// What it says.
        found: String,
    },
    /// Too few numbers, or half of a complex one.
    #[error("line {line} has {found} numbers; allowed are two for each channel, real and imaginary part")]
    Values {
        /// Line, from 1.
        line: usize,
        /// Numbers there.
        found: usize,
    },
    /// Not one injection from each electrode.
    #[error(
        "{injections} injections with {channels} channels; allowed is one from each electrode, 1 to the number of \
         channels"
    )]
    Square {
        /// Injections.
        injections: usize,
        /// Channels that are measured.
        channels: usize,
    },
}

/// Why a `.get` file cannot be read.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum GetError {
    /// A header without an end.
    #[error("its header does not end in two empty lines")]
    Header,
    /// Bytes that are no whole frames.
    #[error("{found} bytes of frames; allowed are frames of 256 floats, 1024 bytes, at least one")]
    Length {
        /// Bytes there.
        found: usize,
    },
}
