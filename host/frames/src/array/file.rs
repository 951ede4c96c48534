//! Files of numbers: which array of which file, and reading it by what its name says it holds.

use super::{Array, ArrayError, MAX_BYTES, npy, npz, text};
use std::{
    ffi::OsStr,
    fmt,
    fs::File,
    io::Read,
    path::{Path, PathBuf},
};

/// A file of numbers, and for an archive which array: `frames.npy`, `run.npz:frames`.
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

/// Reads the numbers of a file, of any shape.
pub fn read(source: &Source) -> Result<Array<'static>, ArrayError> {
    let content = Content::of(&source.path)?;
    content.parse(&read_bytes(&source.path)?, source.key.as_deref())
}

fn read_bytes(path: &Path) -> Result<Vec<u8>, ArrayError> {
    let mut bytes = Vec::new();
    let file = File::open(path).map_err(ArrayError::Io)?;
    file.take(MAX_BYTES + 1).read_to_end(&mut bytes).map_err(ArrayError::Io)?;
    log::debug!("read `{}`: {} bytes", path.display(), bytes.len());
    if bytes.len() as u64 > MAX_BYTES { Err(ArrayError::TooLarge) } else { Ok(bytes) }
}

/// What a file's name says it holds.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Content {
    Npy,
    Npz,
    Table,
}

impl Content {
    fn of(path: &Path) -> Result<Self, ArrayError> {
        let ending = path.extension().unwrap_or_default().to_ascii_lowercase();
        match ending.to_str() {
            Some("npy") => Ok(Self::Npy),
            Some("npz") => Ok(Self::Npz),
            Some("csv" | "txt") => Ok(Self::Table),
            _ => Err(ArrayError::Ending),
        }
    }

    pub(crate) fn parse(self, bytes: &[u8], key: Option<&str>) -> Result<Array<'static>, ArrayError> {
        match self {
            Self::Npy => Ok(npy::parse(bytes)?),
            Self::Npz => npz::parse(bytes, key),
            Self::Table => text::parse(bytes),
        }
    }
}
