//! Any bytes as the two flash slots, uploads, and power that fails amid an operation of the flash. What counts is a
//! valid patch; an upload that was reported as done counts until the next one, and no other takes its place.
#![no_main]

use arbitrary::Arbitrary;
use dermatome_shared::{
    device::{
        PatchStore,
        flash_slots::{Flash, FlashError, FlashSlotStore, PAGE_BYTES, WORD_BYTES},
    },
    patch::PatchView,
};
use dermatome_shared_fuzz::{damage, small_patch};
use libfuzzer_sys::fuzz_target;

const SLOT: usize = 2 * PAGE_BYTES;

/// Flash whose power fails amid the operation that uses `left` up: it leaves anything.
struct Cells<'a> {
    slots: &'a mut [Vec<u8>; 2],
    left: u16,
    noise: u8,
}

impl Cells<'_> {
    fn operate(&mut self, slot: usize, start: usize, to: &[u8]) -> Result<(), FlashError> {
        let cells = &mut self.slots[slot][start..start + to.len()];
        self.left = self.left.checked_sub(1).ok_or(FlashError)?;
        if self.left > 0 {
            cells.copy_from_slice(to);
            return Ok(());
        }
        for (place, cell) in cells.iter_mut().enumerate() {
            *cell = cell.wrapping_add(self.noise.wrapping_mul(place as u8));
        }
        Err(FlashError)
    }
}

impl Flash for Cells<'_> {
    fn slot(&self, slot: usize) -> &[u8] {
        &self.slots[slot]
    }
    fn erase(&mut self, slot: usize, page: usize) -> Result<(), FlashError> {
        self.operate(slot, page * PAGE_BYTES, &[0xFF; PAGE_BYTES])
    }
    fn program(&mut self, slot: usize, offset: usize, word: [u8; WORD_BYTES]) -> Result<(), FlashError> {
        assert!(
            self.left == 0 || self.slots[slot][offset..offset + WORD_BYTES] == [0xFF; WORD_BYTES],
            "programmed at {offset} of slot {slot} without being erased"
        );
        self.operate(slot, offset, &word)
    }
}

#[derive(Arbitrary, Debug)]
struct Input {
    /// What the slots begin with, and what lies in their records.
    content: [Vec<u8>; 2],
    records: [[u8; WORD_BYTES]; 2],
    uploads: Vec<Upload>,
}

#[derive(Arbitrary, Debug)]
struct Upload {
    edits: Vec<u8>,
    piece: u16,
    operations: u16,
    noise: u8,
}

fuzz_target!(|input: Input| {
    let mut slots = [0, 1].map(|slot| {
        let mut bytes = input.content[slot].clone();
        bytes.resize(SLOT, 0xFF);
        bytes[SLOT - WORD_BYTES..].copy_from_slice(&input.records[slot]);
        bytes
    });
    let mut held = FlashSlotStore::open(Cells { slots: &mut slots, left: u16::MAX, noise: 0 })
        .active()
        .map(<[u8]>::to_vec);
    for Upload { edits, piece, operations, noise } in input.uploads.iter().take(8) {
        let patch = damage(small_patch(), edits);
        let mut store = FlashSlotStore::open(Cells { slots: &mut slots, left: *operations, noise: *noise });
        assert!(store.active() == held.as_deref(), "what counts changes by a restart");
        let pieces = patch.chunks(usize::from(piece % 512) + 1);
        let result = store
            .begin(patch.len())
            .and_then(|()| pieces.into_iter().try_for_each(|piece| store.append(piece)))
            .and_then(|()| store.commit());
        if result.is_ok() {
            held = Some(patch.clone());
        }
        assert!(store.active() == held.as_deref(), "what counts is not what was reported");
        let store = FlashSlotStore::open(Cells { slots: &mut slots, left: 0, noise: 0 });
        let found = store.active().map(<[u8]>::to_vec);
        // A commit that failed may have come through all the same.
        assert!(found == held || (result.is_err() && found.as_ref() == Some(&patch)), "what counts is lost");
        assert!(found.as_deref().is_none_or(|patch| PatchView::validate(patch).is_ok()));
        held = found;
    }
});
