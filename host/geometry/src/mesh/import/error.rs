//! Why a file is not a mesh, and where in the file that shows.

use std::{fmt, io};

/// Longest file that is read, bytes.
pub const MAX_BYTES: u64 = 1 << 30;
/// Most triangles that a file's polygons may make.
pub const MAX_TRIANGLES: usize = 1 << 25;

/// A mesh could not be read from a file.
#[derive(Debug, thiserror::Error)]
#[error("cannot read a mesh from `{file}`: {problem}")]
pub struct ImportError {
    /// The file.
    pub file: String,
    /// What is wrong.
    pub problem: Problem,
}

/// Why a file's content is not a mesh.
#[derive(Debug, thiserror::Error)]
pub enum Problem {
    /// The file cannot be opened or read.
    #[error("{0}")]
    Io(io::Error),
    /// An unknown ending.
    #[error("its name must end in .stl, .obj, .ply, .dae or .msh")]
    Ending,
    /// The file is too long, or its polygons have too many corners.
    #[error("it holds more than {MAX_BYTES} bytes or {MAX_TRIANGLES} triangles, the most that is read")]
    TooLarge,
    /// A field with a value that is not allowed.
    #[error("{place}: {field} is `{found}`, allowed is {allowed}")]
    Value {
        /// Where the field begins.
        place: Place,
        /// Name of the field.
        field: &'static str,
        /// What stands there.
        found: String,
        /// What may stand there.
        allowed: String,
    },
    /// A text that is not of this format.
    #[error("{place}: {fault}")]
    Text {
        /// Where that shows.
        place: Place,
        /// What is wrong.
        fault: String,
    },
    /// The file ends too soon.
    #[error("{place}: the file ends where {field} should be")]
    Truncated {
        /// The end of the file.
        place: Place,
        /// Name of the missing field.
        field: &'static str,
    },
    /// A count that the rest of the file cannot hold.
    #[error("{place}: {field} is {found}, but the rest of the file holds at most {most}")]
    Count {
        /// Where the count stands.
        place: Place,
        /// What is counted.
        field: &'static str,
        /// The count.
        found: usize,
        /// What could be there.
        most: usize,
    },
    /// Something that no file of this kind may lack.
    #[error("it holds no {what}")]
    Missing {
        /// What is missing.
        what: String,
    },
    /// An unusable welding tolerance.
    #[error("`weld` is {found}, allowed is {allowed:?} of the bounding box's diagonal")]
    Tolerance {
        /// What was asked for.
        found: f64,
        /// What may be asked for.
        allowed: std::ops::RangeInclusive<f64>,
    },
}

/// A place in a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Place {
    /// Line of a text, from 1.
    Line(usize),
    /// Offset of a byte, from 0.
    Byte(usize),
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Line(line) => write!(f, "line {line}"),
            Self::Byte(offset) => write!(f, "byte {offset}"),
        }
    }
}
