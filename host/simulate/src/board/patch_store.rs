//! Patch store of a simulated board: memory, and a file if the patch is to outlive the process.

use dermatome_patch::{
    input::{self, MAX_PATCH_BYTES},
    output::write_whole,
};
use dermatome_shared::{
    device::{PatchStore, StoreError},
    patch::{PatchError, PatchView},
};
use std::{
    io::{self, ErrorKind},
    path::{Path, PathBuf},
};

/// Keeps the patch in use, and the one that is being uploaded.
#[derive(Debug, Default)]
pub struct FilePatchStore {
    path: Option<PathBuf>,
    active: Option<Vec<u8>>,
    staged: Vec<u8>,
}

/// Why a patch store could not be opened.
#[derive(Debug, thiserror::Error)]
pub enum OpenError {
    /// The file is there but cannot be read.
    #[error("cannot read the board's patch store `{}`: {reason}", path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// What the system says.
        reason: io::Error,
    },
    /// The file holds no usable patch.
    #[error(
        "the board's patch store `{}` is corrupt: {reason} (delete the file to start without a patch)",
        path.display()
    )]
    Corrupt {
        /// The file.
        path: PathBuf,
        /// What is wrong with it.
        reason: PatchError,
    },
    /// The patch that the board was to start with is not usable.
    #[error("the board cannot start with this patch: {0}")]
    Initial(PatchError),
}

impl FilePatchStore {
    /// The store in the file at `path`, if one is given. Where it holds no patch yet, `initial` is
    /// in use, without being written to the file.
    pub fn open(path: Option<PathBuf>, initial: Option<Vec<u8>>) -> Result<Self, OpenError> {
        if let Some(bytes) = &initial {
            PatchView::validate(bytes).map_err(OpenError::Initial)?;
        }
        let stored = path.as_deref().map(read).transpose()?.flatten();
        Ok(Self { path, active: stored.or(initial), staged: Vec::new() })
    }
}

fn read(path: &Path) -> Result<Option<Vec<u8>>, OpenError> {
    let bytes = match input::read(path, MAX_PATCH_BYTES) {
        Ok(bytes) => bytes,
        Err(error) if error.kind() == ErrorKind::NotFound => return Ok(None),
        Err(reason) => return Err(OpenError::Read { path: path.to_owned(), reason }),
    };
    match PatchView::validate(&bytes) {
        Ok(_) => Ok(Some(bytes)),
        Err(reason) => Err(OpenError::Corrupt { path: path.to_owned(), reason }),
    }
}

impl PatchStore for FilePatchStore {
    fn active(&self) -> Option<&[u8]> {
        self.active.as_deref()
    }

    fn begin(&mut self, length: usize) -> Result<(), StoreError> {
        self.staged = Vec::with_capacity(length);
        Ok(())
    }

    fn append(&mut self, bytes: &[u8]) -> Result<(), StoreError> {
        self.staged.extend(bytes);
        Ok(())
    }

    fn staged(&self) -> &[u8] {
        &self.staged
    }

    fn commit(&mut self) -> Result<(), StoreError> {
        if let Some(path) = &self.path {
            write_whole(path, &self.staged).map_err(|_| StoreError::Failed)?;
        }
        self.active = Some(std::mem::take(&mut self.staged));
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_commit_that_cannot_be_written_leaves_the_old_patch_in_use() {
        let folder = tempfile::tempdir().unwrap();
        let mut store = FilePatchStore {
            path: Some(folder.path().join("missing/patch")),
            active: Some(vec![1]),
            staged: Vec::new(),
        };
        store.begin(1).unwrap();
        store.append(&[2]).unwrap();
        assert_eq!(store.commit(), Err(StoreError::Failed));
        assert_eq!(store.active(), Some(&[1][..]));
    }

    #[test]
    fn a_corrupt_file_is_reported_by_name_and_an_absent_one_is_empty() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("board.patch");
        assert_eq!(FilePatchStore::open(Some(path.clone()), None).unwrap().active(), None);
        std::fs::write(&path, b"DSKPrubbish").unwrap();
        let error = FilePatchStore::open(Some(path), None).unwrap_err().to_string();
        assert!(error.contains("board.patch") && error.contains("corrupt"), "{error}");
        let error = FilePatchStore::open(None, Some(vec![7; 40])).unwrap_err().to_string();
        assert!(error.contains("not a patch"), "{error}");
    }
}
