//! Upload: a patch goes to the board, checked before, on the way and after.

use super::Link;
use crate::error::LinkError;
use dermatome_shared::{
    patch::{PatchError, PatchView},
    protocol::{Info, MAX_CHUNK_BYTES, PatchInfo, Request},
};
use std::time::Duration;

/// How long a board has to erase a slot of its flash, and to check and commit what it holds.
/// A reference board erases 96 pages of 22 ms each.
const STORAGE_TIMEOUT: Duration = Duration::from_secs(10);

/// Why a patch is not on the board.
#[derive(Debug, thiserror::Error)]
pub enum UploadError {
    /// The patch itself is not valid; nothing was sent.
    #[error(transparent)]
    Patch(#[from] PatchError),
    /// The board cannot store it; nothing was sent.
    #[error("the patch holds {length} bytes, the board stores at most {max}")]
    TooLong {
        /// Length of the patch, bytes.
        length: usize,
        /// Most the board stores, bytes.
        max: u32,
    },
    /// The board has fewer electrodes; nothing was sent.
    #[error("the patch is for {patch} electrodes, the board has {board}")]
    Electrodes {
        /// Electrodes of the patch.
        patch: u8,
        /// Electrodes of the board.
        board: u8,
    },
    /// The board took the patch and then named another one.
    #[error("the board took the patch {sent:#010x}, but says that it uses another one")]
    Readback {
        /// Checksum of the patch sent.
        sent: u32,
    },
    /// Something went wrong between host and board.
    #[error(transparent)]
    Link(#[from] LinkError),
}

/// Sends a patch, makes the board use it, and reads back what it uses.
///
/// `progress` hears the bytes of each piece once the board has it. Until the end, and whatever
/// fails, the board keeps the patch it had.
pub fn upload(
    link: &mut Link,
    patch: &[u8],
    mut progress: impl FnMut(usize),
) -> Result<PatchInfo, UploadError> {
    let view = PatchView::validate(patch)?;
    check_capacity(&view, &link.info()?)?;
    let begin = Request::BeginUpload { length: patch.len() as u32, crc: view.crc() };
    link.request_within(&begin, STORAGE_TIMEOUT)?;
    for (index, piece) in patch.chunks(MAX_CHUNK_BYTES).enumerate() {
        // A piece is never longer than its place in the message.
        let bytes = piece.iter().copied().collect();
        link.request(&Request::UploadChunk { offset: (index * MAX_CHUNK_BYTES) as u32, bytes })?;
        progress(piece.len());
    }
    link.request_within(&Request::CommitUpload, STORAGE_TIMEOUT)?;
    let used = link.info()?.patch.filter(|used| used.crc == view.crc());
    used.ok_or(UploadError::Readback { sent: view.crc() })
}

fn check_capacity(patch: &PatchView<'_>, info: &Info) -> Result<(), UploadError> {
    let length = patch.bytes().len();
    if length > info.max_patch_bytes as usize {
        return Err(UploadError::TooLong { length, max: info.max_patch_bytes });
    }
    if patch.header.electrodes > info.electrodes {
        return Err(UploadError::Electrodes { patch: patch.header.electrodes, board: info.electrodes });
    }
    Ok(())
}
