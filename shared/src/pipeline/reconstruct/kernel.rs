//! Kernel: the reconstruction with the DSP instructions of the Cortex-M4.
//!
//! For 8 columns of a row: two LDM load 4 words of the matrix and 4 of the data, and four SMLALD each
//! add two products to the exact 64-bit sum. That is 6 instructions for 8 products. The blocks of 8 are
//! unrolled for the longest row, and each row enters them where just enough are left; up to three words
//! that fill no block come first.
//!
//! A sum of at most 256 products is below 2^38. So its bits from 8 upwards fit a register, the shift by
//! 9 or more that makes a pixel of it can be done there, and ASRS leaves in the carry the bit that
//! rounds to nearest. Shifts of 32 and more in that register give 0, as they should. Smaller shifts,
//! which may saturate, go to [`shift_right_rounded`].
//!
//! A row of 104 columns takes 13 * 6 + 14 = 92 instructions, 0.885 for each product. By the Cortex-M4's
//! timing table (LDM 1 + N cycles, SMLALD 1, taken branch 1 + 3 at most) that is 13 * (5 + 5 + 4) + 25 =
//! 207 cycles, 2.0 for each product, without the wait states of the flash. `kernel_cycles` in the
//! firmware measures the cycles on a board.
#![expect(unsafe_code, reason = "the kernel is written in assembly")]

use super::{frame_shift, shift_right_rounded};
use crate::{
    image::Image, limits::MAX_MEASUREMENTS, patch::PatchView, pipeline::reference::DifferenceData,
    units::RelativeConductivity,
};
use core::arch::naked_asm;

/// Columns of a block.
const BLOCK_COLUMNS: usize = 8;
/// Bits of a sum that the shift in one register leaves out.
const LOW_BITS: i32 = 8;

const _: () = assert!(MAX_MEASUREMENTS == 32 * BLOCK_COLUMNS, "the unrolled blocks take the longest row");

/// What the rows have in common; its order is that of the registers it is loaded into.
#[repr(C)]
struct Rows {
    data: *const u32,
    /// Added to a row's exponent it gives the shift behind the low bits.
    shift: i32,
    /// Where a pixel goes, less four times the address of the exponent behind its own.
    image: usize,
    exponents_end: *const i8,
    matrix: *const u8,
    exponents: *const i8,
    /// Whole blocks of a row.
    blocks: usize,
    /// Words of a row that fill no block.
    words: usize,
}

/// Applies the patch's matrix, if its rows and the data consist of whole words that lie aligned, and are as
/// many.
pub(super) fn apply(patch: &PatchView<'_>, difference: &DifferenceData, image: &mut Image) -> Option<()> {
    let (matrix, exponents) = (patch.matrix(), patch.exponents());
    let columns = difference.codes.len();
    // The data always do: their list begins with its length, or is followed by it.
    let addresses = [matrix.as_ptr().addr(), difference.codes.as_ptr().addr()];
    let is_aligned = addresses.iter().all(|address| address.is_multiple_of(4)) && columns.is_multiple_of(2);
    if !is_aligned || exponents.is_empty() || matrix.len() != exponents.len() * columns * 2 {
        return None;
    }
    if image.len() != exponents.len() {
        image.clear();
        image.resize(exponents.len(), RelativeConductivity(0)).ok()?;
    }
    let exponents = exponents.as_ptr_range();
    let rows = Rows {
        data: difference.codes.as_ptr().cast(),
        shift: frame_shift(difference) - LOW_BITS,
        image: image.as_mut_ptr().expose_provenance().wrapping_sub(4 * (exponents.start.addr() + 1)),
        exponents_end: exponents.end.cast(),
        matrix: matrix.as_ptr(),
        exponents: exponents.start.cast(),
        blocks: columns / BLOCK_COLUMNS,
        words: columns % BLOCK_COLUMNS / 2,
    };
    // SAFETY: the matrix holds as many aligned rows as there are exponents, each of `blocks` times 8
    // columns and `words` times 2 more; as many data follow from `data`, aligned; and the
    // image has a pixel for each exponent. So the kernel reads and writes inside of them only.
    unsafe {
        apply_rows(&rows);
    }
    Some(())
}

/// For shifts that may saturate.
extern "C" fn shift_any(sum: i64, shift: i32) -> i32 {
    shift_right_rounded(sum, shift)
}

/// Registers while a row is summed: r0 matrix, r1 data, r2 and r3 sum, r4-r7 words of the matrix, r8-r11
/// words of the data, r12 where a row starts, lr exponents. On the stack: data, shift, image, end of the
/// exponents, where the blocks of a row start.
///
/// # Safety
/// `rows` describes a matrix of at least one row and at most 32 blocks, aligned to words like the data,
/// and an image with room for a pixel of each row.
#[unsafe(naked)]
unsafe extern "C" fn apply_rows(rows: &Rows) {
    naked_asm!(
        "push {{r4-r11, lr}}",
        "sub sp, #20",
        "ldm r0, {{r1-r8}}",
        // A block has 24 bytes, a word 12; the lowest bit says Thumb.
        "adr.w r9, 3f",
        "add r7, r7, r7, lsl #1",
        "sub r9, r9, r7, lsl #3",
        "add r9, r9, #1",
        "adr.w r10, 2f",
        "add r11, r8, r8, lsl #1",
        "sub r10, r10, r11, lsl #2",
        "add r10, r10, #1",
        "mov r0, r5",
        "mov lr, r6",
        "stm sp, {{r1-r4, r9}}",
        "cmp r8, #0",
        "ite eq",
        "moveq r12, r9",
        "movne r12, r10",
        // A row.
        "1:",
        "movs r2, #0",
        "movs r3, #0",
        "bx r12",
        ".rept 3",
        "ldr r4, [r0], #4",
        "ldr r8, [r1], #4",
        "smlald r2, r3, r4, r8",
        ".endr",
        "2:",
        "ldr r4, [sp, #16]",
        "bx r4",
        ".rept 32",
        "ldm.w r0!, {{r4-r7}}",
        "ldm.w r1!, {{r8-r11}}",
        "smlald r2, r3, r4, r8",
        "smlald r2, r3, r5, r9",
        "smlald r2, r3, r6, r10",
        "smlald r2, r3, r7, r11",
        ".endr",
        "3:",
        "ldrsb r4, [lr], #1",
        "ldm sp, {{r1, r5, r6, r7}}",
        "adds r4, r4, r5",
        "ble 5f",
        "lsrs r2, r2, #8",
        "orr r2, r2, r3, lsl #24",
        "asrs r2, r2, r4",
        "adc r2, r2, #0",
        "4:",
        "str r2, [r6, lr, lsl #2]",
        "cmp lr, r7",
        "bne 1b",
        "add sp, #20",
        "pop {{r4-r11, pc}}",
        // A shift that may saturate.
        "5:",
        "push {{r0, r1, r12, lr}}",
        "mov r0, r2",
        "mov r1, r3",
        "add r2, r4, #8",
        "bl {shift_any}",
        "mov r2, r0",
        "pop {{r0, r1, r12, lr}}",
        "b 4b",
        shift_any = sym shift_any,
    )
}
