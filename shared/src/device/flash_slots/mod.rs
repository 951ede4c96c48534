//! Flash slots: storage of patch and trim in two of them each, whole after a power cut at any moment. They are called
//! slots here.
//!
//! One slot holds the patch in use, the other takes the next one. A slot is the patch from its
//! start and, in its last double word, the *commit record*:
//!
//! ```text
//! sequence: u32   grows by one with each commit, and wraps (little-endian, like all here)
//! check: u32      CRC-32 of the sequence and the CRC-32 that the patch ends with
//! ```
//!
//! In use is the slot whose record and patch are both valid and whose sequence is the later one.
//! [`FlashSlotStore`] erases the page of the other slot's record before anything else, programs the
//! patch, checks it as it reads back, and programs the record last. So up to that one double word the
//! slot does not count, and from then on it counts for ever; a record that the power cut leaves half
//! programmed fails its check.
//!
//! Flash blocks its owner for a long time (22 ms for a page), so [`PatchStore::append`] only takes the
//! bytes, and [`PatchStore::settle`] writes them, while the next ones are on their way.

#[cfg(test)]
mod nor;
#[cfg(test)]
mod tests;
mod trim;

use self::trim::Kept;
use super::{PatchStore, StoreError};
use crate::{
    acquire::trim::Trim,
    limits::RECORD_BYTES,
    patch::{self, PatchView, checksum::crc32},
    protocol::MAX_CHUNK_BYTES,
};
use heapless::Vec;

/// Bytes that are erased together.
pub const PAGE_BYTES: usize = 2048;
/// Bytes that are programmed together: a double word.
pub const WORD_BYTES: usize = 8;

const _: () = assert!(RECORD_BYTES == WORD_BYTES, "the record is written at once");

/// What erased flash reads.
const ERASED: u8 = 0xFF;
/// An erased record reads as this sequence, so it is never given.
const NO_SEQUENCE: u32 = u32::MAX;

/// Flash with two slots for patches, 0 and 1, of the same length, a multiple of [`PAGE_BYTES`]; and two of a page each
/// for trims, 2 and 3.
pub trait Flash {
    /// The bytes of a slot, in place.
    fn slot(&self, slot: usize) -> &[u8];
    /// Erases a page: every byte then reads 0xFF.
    fn erase(&mut self, slot: usize, page: usize) -> Result<(), FlashError>;
    /// Programs the double word at `offset`, which must be erased.
    fn program(&mut self, slot: usize, offset: usize, word: [u8; WORD_BYTES]) -> Result<(), FlashError>;
}

/// Flash did not erase or program.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FlashError;

impl From<FlashError> for StoreError {
    fn from(_: FlashError) -> Self {
        Self::Failed
    }
}

/// A patch store in two slots of flash.
#[derive(Debug)]
pub struct FlashSlotStore<F> {
    flash: F,
    active: Option<Committed>,
    staging: Option<Staging>,
    trim: Option<Kept>,
}

/// A slot that counts.
#[derive(Clone, Copy, Debug)]
struct Committed {
    slot: usize,
    sequence: u32,
    length: usize,
}

/// The slot that takes an upload.
#[derive(Debug)]
struct Staging {
    slot: usize,
    /// Bytes of the whole patch.
    length: usize,
    /// Bytes programmed; a multiple of a double word until the end.
    programmed: usize,
    /// Bytes that follow them, not programmed yet.
    pending: Vec<u8, { MAX_CHUNK_BYTES + WORD_BYTES }>,
    record_is_erased: bool,
    failed: bool,
}

impl<F: Flash> FlashSlotStore<F> {
    /// The store that `flash` holds, with the patch of its latest commit in use.
    pub fn open(flash: F) -> Self {
        let active = match [0, 1].map(|slot| committed(flash.slot(slot), slot)) {
            [Some(a), Some(b)] => Some(if is_later(b.sequence, a.sequence) { b } else { a }),
            [a, b] => a.or(b),
        };
        let trim = trim::latest(&flash);
        Self { flash, active, staging: None, trim }
    }

    /// Programs the record of a staged patch, if that patch reads back valid.
    fn commit_staged(&mut self, staging: &Staging) -> Result<Committed, StoreError> {
        let (patch, slot) = (staged(&self.flash, staging), staging.slot);
        let crc = PatchView::validate(patch).map_err(|_| StoreError::Failed)?.crc();
        let commit = Committed { slot, sequence: self.next_sequence(), length: patch.len() };
        let (record, offset) = (record(commit.sequence, crc), self.flash.slot(slot).len() - RECORD_BYTES);
        self.flash.program(slot, offset, record)?;
        if self.flash.slot(slot)[offset..] == record { Ok(commit) } else { Err(StoreError::Failed) }
    }

    fn next_sequence(&self) -> u32 {
        self.active.map_or(0, |active| following(active.sequence))
    }
}

impl<F: Flash> PatchStore for FlashSlotStore<F> {
    fn active(&self) -> Option<&[u8]> {
        self.active.map(|active| &self.flash.slot(active.slot)[..active.length])
    }

    fn begin(&mut self, length: usize) -> Result<(), StoreError> {
        self.staging = None;
        let slot = self.active.map_or(0, |active| 1 - active.slot);
        if length > self.flash.slot(slot).len() - RECORD_BYTES {
            return Err(StoreError::Failed);
        }
        self.staging = Some(Staging::new(slot, length));
        Ok(())
    }

    fn append(&mut self, bytes: &[u8]) -> Result<(), StoreError> {
        self.settle();
        let staging = self.staging.as_mut().filter(|staging| !staging.failed).ok_or(StoreError::Failed)?;
        if staging.programmed + staging.pending.len() + bytes.len() > staging.length {
            return Err(StoreError::Failed);
        }
        staging.pending.extend_from_slice(bytes).map_err(|_| StoreError::Failed)
    }

    fn settle(&mut self) {
        if let Some(staging) = self.staging.as_mut().filter(|staging| !staging.failed) {
            staging.failed = staging.write(&mut self.flash).is_err();
        }
    }

    fn staged(&self) -> &[u8] {
        self.staging.as_ref().map_or(&[], |staging| staged(&self.flash, staging))
    }

    fn commit(&mut self) -> Result<(), StoreError> {
        self.settle();
        let staging = self.staging.take().filter(|staging| !staging.failed).ok_or(StoreError::Failed)?;
        self.active = Some(self.commit_staged(&staging)?);
        Ok(())
    }

    fn trim(&self) -> Option<Trim> {
        self.trim.as_ref().map(|kept| kept.trim)
    }

    fn keep_trim(&mut self, trim: &Trim) -> Result<(), StoreError> {
        self.trim = Some(trim::keep(&mut self.flash, self.trim.as_ref(), trim)?);
        Ok(())
    }
}

impl Staging {
    fn new(slot: usize, length: usize) -> Self {
        Self { slot, length, programmed: 0, pending: Vec::new(), record_is_erased: false, failed: false }
    }

    /// Programs the pending bytes, as far as they fill double words, and all if they end the patch.
    /// The first time it erases the record: from then on the slot does not count.
    fn write(&mut self, flash: &mut impl Flash) -> Result<(), FlashError> {
        let record_page = flash.slot(self.slot).len() / PAGE_BYTES - 1;
        if !self.record_is_erased {
            flash.erase(self.slot, record_page)?;
            self.record_is_erased = true;
        }
        for bytes in core::mem::take(&mut self.pending).chunks(WORD_BYTES) {
            if bytes.len() < WORD_BYTES && self.programmed + bytes.len() < self.length {
                // Part of a double word never exceeds the room there was for all.
                let _ = self.pending.extend_from_slice(bytes);
                break;
            }
            let page = self.programmed / PAGE_BYTES;
            if self.programmed.is_multiple_of(PAGE_BYTES) && page != record_page {
                flash.erase(self.slot, page)?;
            }
            let mut word = [ERASED; WORD_BYTES];
            word[..bytes.len()].copy_from_slice(bytes);
            flash.program(self.slot, self.programmed, word)?;
            self.programmed += bytes.len();
        }
        Ok(())
    }
}

/// What is programmed so far.
fn staged<'a>(flash: &'a impl Flash, staging: &Staging) -> &'a [u8] {
    &flash.slot(staging.slot)[..staging.programmed]
}

/// What a slot has committed, if its record and its patch are valid.
fn committed(bytes: &[u8], slot: usize) -> Option<Committed> {
    let (content, found) = bytes.split_last_chunk::<RECORD_BYTES>()?;
    let [s0, s1, s2, s3, ..] = *found;
    let sequence = u32::from_le_bytes([s0, s1, s2, s3]);
    let patch = patch::at_start(content)?;
    let crc = PatchView::open(patch).ok()?.crc();
    let is_committed = sequence != NO_SEQUENCE && *found == record(sequence, crc);
    (is_committed && PatchView::validate(patch).is_ok()).then_some(Committed {
        slot,
        sequence,
        length: patch.len(),
    })
}

/// The sequence after this one.
fn following(sequence: u32) -> u32 {
    let next = sequence.wrapping_add(1);
    if next == NO_SEQUENCE { 0 } else { next }
}

fn record(sequence: u32, patch_crc: u32) -> [u8; RECORD_BYTES] {
    let [s0, s1, s2, s3] = sequence.to_le_bytes();
    let [c0, c1, c2, c3] = crc32(&[&[s0, s1, s2, s3], &patch_crc.to_le_bytes()]).to_le_bytes();
    [s0, s1, s2, s3, c0, c1, c2, c3]
}

/// Whether `a` comes after `b`, of two sequences that lie close together and may have wrapped.
fn is_later(a: u32, b: u32) -> bool {
    a.wrapping_sub(b) as i32 > 0
}
