//! Any bytes as the slots of flash, uploads and trims, and power that fails amid an operation of the flash. What counts is a
//! valid patch and a trim; what was reported as done counts until the next one, and no other takes its place.
#![no_main]

use arbitrary::Arbitrary;
use dermatome_shared::{
    acquire::trim::Trim,
    device::{
        PatchStore,
        flash_slots::{Flash, FlashError, FlashSlotStore, PAGE_BYTES, WORD_BYTES},
    },
    patch::PatchView,
};
use dermatome_shared_fuzz::{damage, small_patch};
use libfuzzer_sys::fuzz_target;

/// Two for patches, two for trims.
const SLOTS: [usize; 4] = [2 * PAGE_BYTES, 2 * PAGE_BYTES, PAGE_BYTES, PAGE_BYTES];

/// Flash whose power fails amid the operation that uses `left` up: it leaves anything.
struct Cells<'a> {
    slots: &'a mut [Vec<u8>; 4],
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
    content: [Vec<u8>; 4],
    records: [[u8; WORD_BYTES]; 4],
    changes: Vec<Change>,
}

#[derive(Arbitrary, Debug)]
enum Change {
    Upload(Upload),
    Trim(NewTrim),
}

#[derive(Arbitrary, Debug)]
struct NewTrim {
    factor: u8,
    operations: u16,
    noise: u8,
}

#[derive(Arbitrary, Debug)]
struct Upload {
    edits: Vec<u8>,
    piece: u16,
    operations: u16,
    noise: u8,
}

/// What counts.
#[derive(Clone, PartialEq)]
struct Held {
    patch: Option<Vec<u8>>,
    trim: Option<Trim>,
}

impl Held {
    fn in_store(store: &impl PatchStore) -> Self {
        Self { patch: store.active().map(<[u8]>::to_vec), trim: store.trim() }
    }
}

fn upload(store: &mut impl PatchStore, patch: &[u8], piece: u16) -> bool {
    let mut pieces = patch.chunks(usize::from(piece % 512) + 1);
    let result = store
        .begin(patch.len())
        .and_then(|()| pieces.try_for_each(|piece| store.append(piece)))
        .and_then(|()| store.commit());
    result.is_ok()
}

fuzz_target!(|input: Input| {
    let mut slots = [0, 1, 2, 3].map(|slot| {
        let mut bytes = input.content[slot].clone();
        bytes.resize(SLOTS[slot], 0xFF);
        bytes[SLOTS[slot] - WORD_BYTES..].copy_from_slice(&input.records[slot]);
        bytes
    });
    let mut held =
        Held::in_store(&FlashSlotStore::open(Cells { slots: &mut slots, left: u16::MAX, noise: 0 }));
    for change in input.changes.iter().take(8) {
        let (operations, noise) = match change {
            Change::Upload(upload) => (upload.operations, upload.noise),
            Change::Trim(trim) => (trim.operations, trim.noise),
        };
        let mut store = FlashSlotStore::open(Cells { slots: &mut slots, left: operations, noise });
        assert!(Held::in_store(&store) == held, "what counts changes by a restart");
        let mut wanted = held.clone();
        let is_done = match change {
            Change::Upload(Upload { edits, piece, .. }) => {
                let patch = damage(small_patch(), edits);
                let is_done = upload(&mut store, &patch, *piece);
                wanted.patch = Some(patch);
                is_done
            }
            Change::Trim(NewTrim { factor, .. }) => {
                let mut trim = Trim::NONE;
                trim.multiply(
                    usize::from(factor % 5),
                    usize::from(factor % 7),
                    [1.0, f32::from(*factor) * 1e-4],
                );
                wanted.trim = Some(trim);
                store.keep_trim(&trim).is_ok()
            }
        };
        if is_done {
            held = wanted.clone();
        }
        assert!(Held::in_store(&store) == held, "what counts is not what was reported");
        let store = FlashSlotStore::open(Cells { slots: &mut slots, left: 0, noise: 0 });
        let found = Held::in_store(&store);
        // One that failed may have come through all the same.
        assert!(found == held || (!is_done && found == wanted), "what counts is lost");
        assert!(found.patch.as_deref().is_none_or(|patch| PatchView::validate(patch).is_ok()));
        held = found;
    }
});
