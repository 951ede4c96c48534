//! Trim: a board's own factors, in two pages that take turns as the patches' slots do.
//!
//! A page has a factor in each double word from its start, and the commit record in its last one.

use super::{ERASED, Flash, NO_SEQUENCE, PAGE_BYTES, WORD_BYTES, following, is_later, record};
use crate::{
    acquire::trim::{Factor, Trim},
    device::StoreError,
    limits::RECORD_BYTES,
    patch::checksum::crc32,
};

/// The slots that are the pages.
const SLOTS: [usize; 2] = [2, 3];

/// A page that counts.
#[derive(Clone, Copy, Debug)]
pub(super) struct Kept {
    slot: usize,
    sequence: u32,
    pub(super) trim: Trim,
}

/// The page in use.
pub(super) fn latest(flash: &impl Flash) -> Option<Kept> {
    match SLOTS.map(|slot| kept(flash.slot(slot), slot)) {
        [Some(a), Some(b)] => Some(if is_later(b.sequence, a.sequence) { b } else { a }),
        [a, b] => a.or(b),
    }
}

/// Keeps a trim in the page that is not in use. Until its record is programmed, that page does not count.
pub(super) fn keep(flash: &mut impl Flash, active: Option<&Kept>, trim: &Trim) -> Result<Kept, StoreError> {
    let slot = active.map_or(SLOTS[0], |active| SLOTS[0] + SLOTS[1] - active.slot);
    let sequence = active.map_or(0, |active| following(active.sequence));
    flash.erase(slot, 0)?;
    let words = trim.0.as_flattened().iter().map(word);
    for (word, offset) in words.clone().zip((0..).step_by(WORD_BYTES)) {
        flash.program(slot, offset, word)?;
    }
    let (content, _) = flash.slot(slot).as_chunks();
    let content = content.get(..words.len()).ok_or(StoreError::Failed)?;
    // A page that was programmed wrong does not count.
    if !words.eq(content.iter().copied()) {
        return Err(StoreError::Failed);
    }
    flash.program(slot, PAGE_BYTES - RECORD_BYTES, record(sequence, crc32(&[content.as_flattened()])))?;
    let found = kept(flash.slot(slot), slot);
    found.filter(|found| found.trim == *trim).ok_or(StoreError::Failed)
}

fn kept(bytes: &[u8], slot: usize) -> Option<Kept> {
    let mut trim = Trim::NONE;
    let factors = trim.0.as_flattened_mut();
    let length = factors.len() * WORD_BYTES;
    let (content, found) = bytes.split_last_chunk::<RECORD_BYTES>()?;
    let content = content.get(..length)?;
    let [s0, s1, s2, s3, ..] = *found;
    let sequence = u32::from_le_bytes([s0, s1, s2, s3]);
    if sequence == NO_SEQUENCE || *found != record(sequence, crc32(&[content])) {
        return None;
    }
    let words = content.as_chunks::<WORD_BYTES>().0;
    factors.iter_mut().zip(words).for_each(|(factor, word)| *factor = factor_of(*word));
    trim.is_plausible().then_some(Kept { slot, sequence, trim })
}

fn word([real, imaginary]: &Factor) -> [u8; WORD_BYTES] {
    let mut word = [ERASED; WORD_BYTES];
    let (first, second) = word.split_at_mut(WORD_BYTES / 2);
    first.copy_from_slice(&real.to_le_bytes());
    second.copy_from_slice(&imaginary.to_le_bytes());
    word
}

fn factor_of([r0, r1, r2, r3, i0, i1, i2, i3]: [u8; WORD_BYTES]) -> Factor {
    [f32::from_le_bytes([r0, r1, r2, r3]), f32::from_le_bytes([i0, i1, i2, i3])]
}
