//! A simulated NOR flash with the rules of the STM32G4 (RM0440, "Embedded flash memory"), whose power
//! can be cut in the middle of any operation.

use super::{ERASED, Flash, FlashError, PAGE_BYTES, WORD_BYTES};
use std::vec::Vec;

/// What an operation has done when the power fails in it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Cut {
    /// Nothing yet.
    Before,
    /// Cells hold anything, and a double word that was to be programmed reads with an ECC error:
    /// whatever it reads, it does not take another value without being erased.
    Amid,
    /// All.
    After,
}

#[derive(Clone, Debug)]
pub(super) struct Nor {
    slots: [Vec<u8>; 4],
    /// Whether a double word may be programmed: `[slot][word]`.
    erased: [Vec<bool>; 4],
    /// Operations since the power came.
    pub(super) operations: usize,
    /// In which operation the power fails, and how far that one comes.
    pub(super) cut: Option<(usize, Cut)>,
    pub(super) powered: bool,
    /// In which operation a double word is programmed wrong, without a word of it.
    pub(super) wrong: Option<usize>,
    noise: u64,
}

impl Nor {
    /// Flash that holds anything, as one that other firmware has used.
    pub(super) fn new(slot_bytes: usize, seed: u64) -> Self {
        let lengths = [slot_bytes, slot_bytes, PAGE_BYTES, PAGE_BYTES];
        let mut nor = Self {
            slots: lengths.map(|bytes| std::vec![0; bytes]),
            erased: lengths.map(|bytes| std::vec![false; bytes / WORD_BYTES]),
            operations: 0,
            cut: None,
            powered: true,
            wrong: None,
            noise: seed,
        };
        (0..4).for_each(|slot| nor.scramble(slot, 0, lengths[slot]));
        nor
    }

    /// The same flash when the power is back.
    pub(super) fn reboot(mut self) -> Self {
        (self.operations, self.cut, self.powered, self.wrong) = (0, None, true, None);
        self
    }

    pub(super) fn flip(&mut self, slot: usize, offset: usize) {
        self.slots[slot][offset] ^= 1;
    }

    fn scramble(&mut self, slot: usize, offset: usize, length: usize) {
        for place in offset..offset + length {
            // Knuth's MMIX generator.
            self.noise =
                self.noise.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            self.slots[slot][place] = (self.noise >> 56) as u8;
        }
        self.erased[slot][offset / WORD_BYTES..(offset + length) / WORD_BYTES].fill(false);
    }

    /// How far the next operation on these bytes comes; the power is gone if not to its end.
    fn operate(&mut self, slot: usize, offset: usize, length: usize) -> Result<Cut, FlashError> {
        if !self.powered {
            return Err(FlashError);
        }
        let this = self.operations;
        self.operations += 1;
        let reached = self.cut.filter(|(at, _)| *at == this).map(|(_, reached)| reached);
        self.powered = reached.is_none();
        match reached {
            Some(Cut::Amid) => self.scramble(slot, offset, length),
            Some(Cut::Before | Cut::After) | None => {}
        }
        Ok(reached.unwrap_or(Cut::After))
    }

    fn unless_cut(&self) -> Result<(), FlashError> {
        if self.powered { Ok(()) } else { Err(FlashError) }
    }
}

impl Flash for Nor {
    fn slot(&self, slot: usize) -> &[u8] {
        &self.slots[slot]
    }

    fn erase(&mut self, slot: usize, page: usize) -> Result<(), FlashError> {
        let start = page * PAGE_BYTES;
        if self.operate(slot, start, PAGE_BYTES)? == Cut::After {
            self.slots[slot][start..start + PAGE_BYTES].fill(ERASED);
            self.erased[slot][start / WORD_BYTES..(start + PAGE_BYTES) / WORD_BYTES].fill(true);
        }
        self.unless_cut()
    }

    fn program(&mut self, slot: usize, offset: usize, word: [u8; WORD_BYTES]) -> Result<(), FlashError> {
        assert_eq!(offset % WORD_BYTES, 0, "only double words can be programmed");
        assert!(
            !self.powered || self.erased[slot][offset / WORD_BYTES],
            "PROGERR at {offset} of slot {slot}"
        );
        if self.operate(slot, offset, WORD_BYTES)? == Cut::After {
            self.slots[slot][offset..offset + WORD_BYTES].copy_from_slice(&word);
            if self.wrong == Some(self.operations - 1) {
                self.flip(slot, offset);
            }
            self.erased[slot][offset / WORD_BYTES] = false;
        }
        self.unless_cut()
    }
}
