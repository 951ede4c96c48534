//! Store: where a board keeps its patch and its trim.

use crate::{acquire::trim::Trim, protocol::Refusal};

/// Where a board keeps its patch: one slot in use, one being filled.
///
/// Until [`PatchStore::commit`] returns, the slot in use must survive anything, power cuts included.
pub trait PatchStore {
    /// Bytes of the patch in use.
    fn active(&self) -> Option<&[u8]>;
    /// Prepares the other slot for a patch of `length` bytes.
    fn begin(&mut self, length: usize) -> Result<(), StoreError>;
    /// Takes the next bytes for the other slot.
    fn append(&mut self, bytes: &[u8]) -> Result<(), StoreError>;
    /// Writes what [`Self::append`] has only taken. It may block for as long as the storage does; an
    /// error shows at the next call. Nothing but speed depends on when it is called.
    fn settle(&mut self) {}
    /// What the other slot holds so far; complete only once settled.
    fn staged(&self) -> &[u8];
    /// Makes the other slot the one in use.
    fn commit(&mut self) -> Result<(), StoreError>;
    /// The board's trim, if one is kept.
    fn trim(&self) -> Option<Trim> {
        None
    }
    /// Keeps a trim. Until it returns, the one before must survive anything.
    fn keep_trim(&mut self, _trim: &Trim) -> Result<(), StoreError> {
        Err(StoreError::Unsupported)
    }
}

/// Why a patch store did not do what was asked.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum StoreError {
    /// This board has no storage.
    Unsupported,
    /// Writing failed.
    Failed,
}

impl From<StoreError> for Refusal {
    fn from(error: StoreError) -> Self {
        match error {
            StoreError::Unsupported => Self::Unsupported,
            StoreError::Failed => Self::Storage,
        }
    }
}
