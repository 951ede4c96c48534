//! Flash: the pages of the trim and the two patch slots behind the firmware, and what to do about flash that reads badly.
//!
//! The flash has pages of 2 KiB in two banks, as on all our boards. On the NUCLEO-G474RE the first slot has its
//! first half in the bank that the firmware runs from: while that half is erased or programmed, the core waits with
//! its next instruction that is not cached. On the NUCLEO-L496ZG both slots lie in the other bank. Interrupts
//! stay on all the time; the DMA of the link needs none of it.
//!
//! A double word that lost its power while it was programmed can hold more wrong bits than its ECC can
//! correct. The chip then raises the NMI at every read of it, and the read goes on with whatever the
//! cells hold (RM0440 and RM0351, "Error code correction").
//! [`FlashSlotStore`](dermatome_shared::device::flash_slots::FlashSlotStore)
//! checks all it reads, so the handler only clears the flag.

use core::{
    slice,
    sync::atomic::{Ordering, compiler_fence},
};

use cortex_m_rt::exception;
use dermatome_shared::{
    device::flash_slots::{self, FlashError, PAGE_BYTES, WORD_BYTES},
    limits::FLASH_SLOT_BYTES,
};
use embassy_stm32::{
    Peri,
    flash::{Blocking, FLASH_BASE, FLASH_SIZE, Flash},
    peripherals,
};

use crate::board::{self, SLOTS_OFFSET};

/// Where the pages of the trim start: they end where the first slot starts.
const TRIM_OFFSET: usize = SLOTS_OFFSET - 2 * PAGE_BYTES;

const _: () = assert!(SLOTS_OFFSET + 2 * FLASH_SLOT_BYTES <= FLASH_SIZE, "the slots fit the flash");

/// The slots in the chip's flash.
pub struct SlotFlash {
    flash: Flash<'static, Blocking>,
}

impl SlotFlash {
    /// The slots in `flash`.
    pub fn new(flash: Peri<'static, peripherals::FLASH>) -> Self {
        Self { flash: Flash::new_blocking(flash) }
    }
}

impl flash_slots::Flash for SlotFlash {
    fn slot(&self, slot: usize) -> &[u8] {
        let address = FLASH_BASE + offset_of(slot);
        let length = if slot < 2 { FLASH_SLOT_BYTES } else { PAGE_BYTES };
        #[expect(unsafe_code, reason = "a slot is read in place")]
        // SAFETY: these bytes are flash, always readable, and hold nothing but slots (checked above and by
        // the linker, which has only the flash before them). They change through `&mut self` alone.
        unsafe {
            slice::from_raw_parts(address as *const u8, length)
        }
    }

    fn erase(&mut self, slot: usize, page: usize) -> Result<(), FlashError> {
        let start = (offset_of(slot) + page * PAGE_BYTES) as u32;
        let result = self.flash.blocking_erase(start, start + PAGE_BYTES as u32);
        done(result)
    }

    fn program(&mut self, slot: usize, offset: usize, word: [u8; WORD_BYTES]) -> Result<(), FlashError> {
        let result = self.flash.blocking_write((offset_of(slot) + offset) as u32, &word);
        done(result)
    }
}

/// Bytes from the start of the flash to a slot: two of patches, two of the trim.
fn offset_of(slot: usize) -> usize {
    assert!(slot < 4, "there are four slots");
    if slot < 2 { SLOTS_OFFSET + slot * FLASH_SLOT_BYTES } else { TRIM_OFFSET + (slot - 2) * PAGE_BYTES }
}

/// Ends an operation: what was read of the flash before it counts no more.
fn done(result: Result<(), embassy_stm32::flash::Error>) -> Result<(), FlashError> {
    compiler_fence(Ordering::SeqCst);
    result.map_err(|error| {
        defmt::warn!("flash: {}", error);
        FlashError
    })
}

#[exception]
#[allow(unsafe_code, reason = "an exception handler is declared unsafe")]
unsafe fn NonMaskableInt() {
    // The other sources are not switched on.
    assert!(board::clear_flash_error(), "NMI without a flash error");
}
