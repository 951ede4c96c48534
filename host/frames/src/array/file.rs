//! Files of numbers: which array of which file, and reading it by what its name says it holds.

use super::{
    Array, ArrayError, MAX_BYTES, MAX_VALUES, Numbers, Values, get, mat_read, npy, npz, sciospec, show_shape,
    text,
};
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
    /// Splits at the last colon, but only after a name that ends in `.npz` or `.mat`: `C:\run.npz` has no key.
    #[must_use]
    pub fn new(text: &OsStr) -> Self {
        let split = text.to_str().and_then(|text| text.rsplit_once(':'));
        let has_keys = |path: &str| [".npz", ".mat"].iter().any(|it| path.to_ascii_lowercase().ends_with(it));
        match split.filter(|(path, _)| has_keys(path)) {
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

/// Reads the numbers of a file, of any shape, or of a folder of `.eit` files, one frame each, in the order of their names.
pub fn read(source: &Source) -> Result<Array<'static>, ArrayError> {
    if source.path.is_dir() {
        return read_folder(&source.path);
    }
    let content = Content::of(&source.path)?;
    content.parse(&read_bytes(&source.path)?, source.key.as_deref())
}

fn read_folder(folder: &Path) -> Result<Array<'static>, ArrayError> {
    let entries = std::fs::read_dir(folder).map_err(ArrayError::Io)?;
    let paths: Result<Vec<PathBuf>, _> = entries.map(|entry| entry.map(|entry| entry.path())).collect();
    let mut paths = paths.map_err(ArrayError::Io)?;
    paths.retain(|path| is_eit(path));
    paths.sort();
    let mut shape: Option<Vec<usize>> = None;
    let mut values = Vec::new();
    for path in &paths {
        let file = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
        let in_folder = |problem| ArrayError::InFolder { file: file.clone(), problem: Box::new(problem) };
        let array =
            read_bytes(path).and_then(|bytes| Content::Sciospec.parse(&bytes, None)).map_err(in_folder)?;
        let expected = shape.get_or_insert_with(|| array.shape.clone());
        if array.shape != *expected {
            let (found, expected) = (show_shape(&array.shape), show_shape(expected));
            return Err(ArrayError::Unlike { file, found, expected });
        }
        values.extend(array.into_complex());
        if values.len() > MAX_VALUES {
            return Err(ArrayError::TooLarge);
        }
    }
    let mut shape = shape.ok_or(ArrayError::EmptyFolder)?;
    shape[0] = paths.len();
    Ok(Array { shape, values: Values::Complex(Numbers::Stored(values)) })
}

fn is_eit(path: &Path) -> bool {
    path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("eit"))
}

impl Source {
    /// Whether it holds potentials of electrodes: a Sciospec file, or a folder of them.
    #[must_use]
    pub fn holds_potentials(&self) -> bool {
        is_eit(&self.path) || self.path.is_dir()
    }
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
    Mat,
    Sciospec,
    Get,
}

impl Content {
    fn of(path: &Path) -> Result<Self, ArrayError> {
        let ending = path.extension().unwrap_or_default().to_ascii_lowercase();
        match ending.to_str() {
            Some("npy") => Ok(Self::Npy),
            Some("npz") => Ok(Self::Npz),
            Some("csv" | "txt") => Ok(Self::Table),
            Some("mat") => Ok(Self::Mat),
            Some("eit") => Ok(Self::Sciospec),
            Some("get") => Ok(Self::Get),
            _ => Err(ArrayError::Ending),
        }
    }

    pub(crate) fn parse(self, bytes: &[u8], key: Option<&str>) -> Result<Array<'static>, ArrayError> {
        match self {
            Self::Npy => Ok(npy::parse(bytes)?),
            Self::Npz => npz::parse(bytes, key),
            Self::Table => text::parse(bytes),
            Self::Mat => mat_read::parse(bytes, key),
            Self::Sciospec => sciospec::parse(bytes),
            Self::Get => get::parse(bytes),
        }
    }
}
