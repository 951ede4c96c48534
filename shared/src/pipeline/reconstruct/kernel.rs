//! Kernel: the reconstruction with the DSP instructions of the Cortex-M4.
//!
//! Two rows at a time, six columns of them at once: three LDM load 3 words of the data and 3 of each row, and six
//! SMLALD each add two products to the exact 64-bit sum of a row. Each load of data serves both rows. The blocks of 6
//! are unrolled, no more than the instruction cache of the flash holds; a row enters them where just
//! enough are left, and goes round again if it is longer. Up to two words that fill no block come first.
//!
//! A sum of at most 256 products is below 2^38. So its bits from 8 upwards fit a register, the shift by
//! 9 or more that makes a pixel of it can be done there, and ASRS leaves in the carry the bit that
//! rounds to nearest. Shifts of 32 and more in that register give 0, as they should. Smaller shifts,
//! which may saturate, go to [`shift_right_rounded`].
//!
//! By the Cortex-M4's timing table a block takes 3 * 4 + 6 cycles for 12 products, 1.5 for each. Flash at 170 MHz
//! makes the core wait 4 cycles for each 8 bytes, one more for each product: so rows that lie in RAM are faster.
//! `kernel_cycles` in the firmware measures the cycles on a board.
#![expect(unsafe_code, reason = "the kernel is written in assembly")]

use super::{frame_shift, shift_right_rounded};
use crate::{
    image::Image, limits::MAX_MEASUREMENTS, patch::PatchView, pipeline::reference::DifferenceData,
    units::RelativeConductivity,
};
use core::arch::naked_asm;

/// Words of a row in a block, two columns in each.
const BLOCK_WORDS: usize = 3;
/// Blocks that are unrolled: 612 bytes, and enough for the 104 columns of 16 electrodes.
const UNROLLED: usize = 17;
/// Bits of a sum that the shift in one register leaves out.
const LOW_BITS: i32 = 8;

const _: () = assert!(MAX_MEASUREMENTS <= 256, "a sum of more products may need more bits");

/// What the rows have in common; its order is that of the registers it is loaded into.
#[repr(C)]
struct Rows {
    data: *const u32,
    /// Added to a row's exponent it gives the shift behind the low bits.
    shift: i32,
    exponents: *const i8,
    exponents_end: *const i8,
    image: *mut RelativeConductivity,
    row_bytes: usize,
    /// Words of a row that fill no block.
    words: usize,
    /// Blocks before the unrolled ones begin anew, at most [`UNROLLED`].
    blocks: usize,
    /// Times that the blocks are gone through, at least one.
    rounds: usize,
    matrix: *const u8,
}

/// Applies the patch's matrix, if its rows and the data consist of whole words that lie aligned, and are as
/// many.
pub(super) fn apply(patch: &PatchView<'_>, difference: &DifferenceData, image: &mut Image) -> Option<()> {
    let (matrix, exponents) = (patch.matrix(), patch.exponents());
    let columns = difference.codes.len();
    // The data always do: their list begins with its length, or is followed by it.
    let addresses = [matrix.as_ptr().addr(), difference.codes.as_ptr().addr()];
    let is_aligned = addresses.iter().all(|address| address.is_multiple_of(4)) && columns.is_multiple_of(2);
    let count = exponents.len();
    if !is_aligned || count < 2 || matrix.len() != count * columns * 2 {
        return None;
    }
    if image.len() != count {
        image.clear();
        image.resize(count, RelativeConductivity(0)).ok()?;
    }
    let words = columns / 2;
    let blocks = words / BLOCK_WORDS;
    let rounds = blocks.div_ceil(UNROLLED).max(1);
    let mut pairs = |first: usize, end: usize| {
        let (exponents, row_bytes) = (&exponents[first..end], 2 * columns);
        let rows = Rows {
            data: difference.codes.as_ptr().cast(),
            shift: frame_shift(difference) - LOW_BITS,
            exponents: exponents.as_ptr().cast(),
            exponents_end: exponents.as_ptr_range().end.cast(),
            image: image[first..end].as_mut_ptr(),
            row_bytes,
            words: words % BLOCK_WORDS,
            blocks: blocks - UNROLLED * (rounds - 1),
            rounds,
            matrix: matrix[first * row_bytes..end * row_bytes].as_ptr(),
        };
        // SAFETY: the exponents are as many as the aligned rows that begin at `matrix`, an even number of at least
        // two, each of `words` and, in all rounds, of the blocks' words; as many data follow from `data`, aligned;
        // and the image has a pixel for each exponent. So the kernel reads and writes inside of them only.
        unsafe {
            apply_pairs(&rows);
        }
    };
    pairs(0, count & !1);
    if count % 2 == 1 {
        // The last row goes with the one before, once more.
        pairs(count - 2, count);
    }
    Some(())
}

/// For shifts that may saturate.
extern "C" fn shift_any(sum: i64, shift: i32) -> i32 {
    shift_right_rounded(sum, shift)
}

/// Registers while two rows are summed: r0 and r6 rows, r1 data, r2 to r5 sums, r7-r9 words of the data, r10-r12
/// words of a row, lr rounds. On the stack: data, shift, exponents, their end, image, bytes of a row, where the
/// words and the blocks of a row start, rounds.
///
/// # Safety
/// `rows` describes an even number of rows, at least two, aligned to words like the data, and an image with room
/// for a pixel of each row.
#[unsafe(naked)]
unsafe extern "C" fn apply_pairs(rows: &Rows) {
    naked_asm!(
        "push {{r4-r11, lr}}",
        "sub sp, #44",
        "ldm r0!, {{r1-r6}}",
        "stm sp, {{r1-r6}}",
        "ldm r0, {{r7-r10}}",
        // A word has 20 bytes, a block 36; the lowest bit says Thumb.
        "adr.w r11, 2f",
        "add r7, r7, r7, lsl #2",
        "sub r11, r11, r7, lsl #2",
        "add r11, r11, #1",
        "adr.w r12, 3f",
        "add r8, r8, r8, lsl #3",
        "sub r12, r12, r8, lsl #2",
        "add r12, r12, #1",
        "strd r11, r12, [sp, #24]",
        "str r9, [sp, #32]",
        "mov r6, r10",
        // Two rows.
        "1:",
        "mov r0, r6",
        "ldr r7, [sp, #20]",
        "ldr r1, [sp]",
        "ldr lr, [sp, #32]",
        "ldr r12, [sp, #24]",
        "add r6, r6, r7",
        "movs r2, #0",
        "movs r3, #0",
        "movs r4, #0",
        "movs r5, #0",
        "bx r12",
        ".rept 2",
        "ldr r7, [r1], #4",
        "ldr r10, [r0], #4",
        "smlald r2, r3, r10, r7",
        "ldr r10, [r6], #4",
        "smlald r4, r5, r10, r7",
        ".endr",
        "2:",
        "ldr r12, [sp, #28]",
        "bx r12",
        "4:",
        ".rept {unrolled}",
        "ldm.w r1!, {{r7-r9}}",
        "ldm.w r0!, {{r10-r12}}",
        "smlald r2, r3, r10, r7",
        "smlald r2, r3, r11, r8",
        "smlald r2, r3, r12, r9",
        "ldm.w r6!, {{r10-r12}}",
        "smlald r4, r5, r10, r7",
        "smlald r4, r5, r11, r8",
        "smlald r4, r5, r12, r9",
        ".endr",
        "3:",
        "subs.w lr, lr, #1",
        "bne.w 4b",
        "ldr r7, [sp, #8]",
        "ldr r8, [sp, #4]",
        "ldr r9, [sp, #16]",
        "ldrsb r10, [r7], #1",
        "ldrsb r11, [r7], #1",
        "str r7, [sp, #8]",
        "adds r10, r10, r8",
        "ble 7f",
        "lsrs r2, r2, #8",
        "orr r2, r2, r3, lsl #24",
        "asrs r2, r2, r10",
        "adc r2, r2, #0",
        "5:",
        "adds r11, r11, r8",
        "ble 8f",
        "lsrs r4, r4, #8",
        "orr r4, r4, r5, lsl #24",
        "asrs r4, r4, r11",
        "adc r4, r4, #0",
        "6:",
        "stm r9!, {{r2, r4}}",
        "ldr r12, [sp, #12]",
        "str r9, [sp, #16]",
        "cmp r7, r12",
        "bne 1b",
        "add sp, #44",
        "pop {{r4-r11, pc}}",
        // Shifts that may saturate.
        "7:",
        "push {{r0, r1}}",
        "mov r0, r2",
        "mov r1, r3",
        "add r2, r10, #8",
        "bl {shift_any}",
        "mov r2, r0",
        "pop {{r0, r1}}",
        "b 5b",
        "8:",
        "push {{r1, r2}}",
        "mov r0, r4",
        "mov r1, r5",
        "add r2, r11, #8",
        "bl {shift_any}",
        "mov r4, r0",
        "pop {{r1, r2}}",
        "b 6b",
        unrolled = const UNROLLED,
        shift_any = sym shift_any,
    )
}
