//! Flash store: where the board will keep its patch. **It stores nothing yet.**
//!
//! It refuses every upload as unsupported at its first request, so a host sees at once that this
//! firmware cannot keep a patch.

use dermatome_shared::device::{PatchStore, StoreError};

/// A patch store without storage.
pub(crate) struct FlashStore;

impl PatchStore for FlashStore {
    fn active(&self) -> Option<&[u8]> {
        None
    }

    fn begin(&mut self, _length: usize) -> Result<(), StoreError> {
        Err(StoreError::Unsupported)
    }

    fn append(&mut self, _bytes: &[u8]) -> Result<(), StoreError> {
        Err(StoreError::Unsupported)
    }

    fn staged(&self) -> &[u8] {
        &[]
    }

    fn commit(&mut self) -> Result<(), StoreError> {
        Err(StoreError::Unsupported)
    }
}
