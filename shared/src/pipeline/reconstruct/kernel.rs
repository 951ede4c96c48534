//! Kernel: the sums of the reconstruction with the DSP instructions of the Cortex-M4.
//!
//! Four rows at a time, four columns of them at once. Interpolations: LDM load two words of the codes and twice four
//! of the rows, and eight SMLAD each add two products to the sum of a row. Rows that meet data do with SMLALD what
//! needs 64 bits. The blocks of four columns are unrolled, no more than the instruction cache of the flash holds; a
//! group of rows enters them where just enough are left, and goes round again if its rows are longer.
//!
//! By the Cortex-M4's timing table a block takes 3 + 2 * 5 + 8 cycles for 16 products, 1.3 for each; with 64 bits
//! 2 * (2 + 2 * 3 + 4), 1.5 for each. Flash at 170 MHz makes the core wait 4 cycles for each 8 bytes, one more for each
//! product: so rows that lie in RAM are faster. `kernel_cycles` in the firmware measures the cycles on a board.
#![expect(unsafe_code, reason = "the kernel is written in assembly")]

use super::{Codes, LOW_BITS};
use crate::patch::matrix::{GROUP, Rows};
use core::arch::naked_asm;

/// Blocks that are unrolled.
const UNROLLED: usize = 8;

/// What the groups of rows have in common; its order is that of the registers it is loaded into.
#[repr(C)]
struct Groups {
    mantissas: *const u8,
    codes: *const i16,
    values: *mut i32,
    values_end: *const i32,
    /// Blocks before the unrolled ones begin anew, 1 to [`UNROLLED`].
    blocks: usize,
    /// Times that the blocks are gone through, at least one.
    rounds: usize,
}

/// As in plain Rust, which does what does not lie in whole words: with 64 bits if low ones are left out.
#[inline(always)]
pub(super) fn sums(codes: &Codes, rows: &Rows<'_>, values: &mut [i32], low_bits: i32) {
    match Groups::of(codes, rows, values) {
        // SAFETY: the groups are what `Groups::of` promises.
        Some(groups) if low_bits == LOW_BITS => unsafe { sum_groups_of_data(&groups) },
        // SAFETY: the same.
        Some(groups) => unsafe { sum_groups_of_values(&groups) },
        None => super::sums(codes, rows, values, low_bits),
    }
}

impl Groups {
    /// If the mantissas are whole words that lie aligned: at least one group of four rows, of at least one block, and
    /// as many codes as the rows have columns, aligned by their type, with a value for each row. So the kernels read
    /// and write inside of the three only.
    #[inline(always)]
    fn of(codes: &Codes, rows: &Rows<'_>, values: &mut [i32]) -> Option<Self> {
        let blocks = rows.columns / GROUP;
        let is_whole = rows.columns.is_multiple_of(GROUP)
            && (1..=codes.0.len()).contains(&rows.columns)
            && !values.is_empty()
            && values.len().is_multiple_of(GROUP)
            && rows.mantissas.len() == 2 * rows.columns * values.len()
            && rows.mantissas.as_ptr().addr().is_multiple_of(4);
        let rounds = blocks.div_ceil(UNROLLED);
        let range = values.as_mut_ptr_range();
        is_whole.then(|| Self {
            mantissas: rows.mantissas.as_ptr(),
            codes: codes.0.as_ptr(),
            values: range.start,
            values_end: range.end,
            blocks: blocks - UNROLLED * (rounds - 1),
            rounds,
        })
    }
}

/// Registers: r0 mantissas, r1 codes, r2 to r5 sums, r6 to r9 words of the rows, r10 and r11 of the codes, r12 where
/// a row enters the blocks, lr rounds. On the stack: codes, rounds, values, their end.
///
/// # Safety
/// `groups` is from [`Groups::of`], and what it points to is still there.
#[unsafe(naked)]
unsafe extern "C" fn sum_groups_of_values(groups: &Groups) {
    naked_asm!(
        "push {{r4-r11, lr}}",
        "sub sp, #20",
        "ldm r0, {{r0-r5}}",
        // A block has 44 bytes; the lowest bit says Thumb.
        "adr.w r12, 3f",
        "add r6, r4, r4, lsl #1",
        "add r6, r6, r4, lsl #3",
        "sub r12, r12, r6, lsl #2",
        "add r12, r12, #1",
        "strd r1, r5, [sp]",
        "strd r2, r3, [sp, #8]",
        // Four rows.
        "1:",
        "ldrd r1, lr, [sp]",
        "movs r2, #0",
        "movs r3, #0",
        "movs r4, #0",
        "movs r5, #0",
        "bx r12",
        "2:",
        ".rept {unrolled}",
        "ldm.w r1!, {{r10, r11}}",
        "ldm.w r0!, {{r6-r9}}",
        "smlad r2, r6, r10, r2",
        "smlad r3, r7, r10, r3",
        "smlad r4, r8, r10, r4",
        "smlad r5, r9, r10, r5",
        "ldm.w r0!, {{r6-r9}}",
        "smlad r2, r6, r11, r2",
        "smlad r3, r7, r11, r3",
        "smlad r4, r8, r11, r4",
        "smlad r5, r9, r11, r5",
        ".endr",
        "3:",
        "subs.w lr, lr, #1",
        "bne.w 2b",
        "ldrd r6, r7, [sp, #8]",
        "stm r6!, {{r2-r5}}",
        "str r6, [sp, #8]",
        "cmp r6, r7",
        "bne 1b",
        "add sp, #20",
        "pop {{r4-r11, pc}}",
        unrolled = const UNROLLED,
    )
}

/// Registers: r0 mantissas, r1 codes, r2 to r9 sums, r10 and r11 words of the rows, r12 of the codes, lr rounds. On the
/// stack: codes, rounds, values, their end, where a row enters the blocks.
///
/// # Safety
/// `groups` is from [`Groups::of`], and what it points to is still there.
#[unsafe(naked)]
unsafe extern "C" fn sum_groups_of_data(groups: &Groups) {
    naked_asm!(
        "push {{r4-r11, lr}}",
        "sub sp, #20",
        "ldm r0, {{r0-r5}}",
        // A block has 56 bytes; the lowest bit says Thumb.
        "adr.w r12, 3f",
        "rsb r6, r4, r4, lsl #3",
        "sub r12, r12, r6, lsl #3",
        "add r12, r12, #1",
        "strd r1, r5, [sp]",
        "strd r2, r3, [sp, #8]",
        "str r12, [sp, #16]",
        // Four rows.
        "1:",
        "ldrd r1, lr, [sp]",
        "ldr r12, [sp, #16]",
        "movs r2, #0",
        "movs r3, #0",
        "movs r4, #0",
        "movs r5, #0",
        "movs r6, #0",
        "movs r7, #0",
        "mov r8, r2",
        "mov r9, r2",
        "bx r12",
        "2:",
        ".rept 2 * {unrolled}",
        "ldr.w r12, [r1], #4",
        "ldm.w r0!, {{r10, r11}}",
        "smlald r2, r3, r10, r12",
        "smlald r4, r5, r11, r12",
        "ldm.w r0!, {{r10, r11}}",
        "smlald r6, r7, r10, r12",
        "smlald r8, r9, r11, r12",
        ".endr",
        "3:",
        "subs.w lr, lr, #1",
        "bne.w 2b",
        "lsrs r2, r2, #{low_bits}",
        "orr r2, r2, r3, lsl #32 - {low_bits}",
        "lsrs r4, r4, #{low_bits}",
        "orr r3, r4, r5, lsl #32 - {low_bits}",
        "lsrs r6, r6, #{low_bits}",
        "orr r4, r6, r7, lsl #32 - {low_bits}",
        "lsr r8, r8, #{low_bits}",
        "orr r5, r8, r9, lsl #32 - {low_bits}",
        "ldrd r6, r7, [sp, #8]",
        "stm r6!, {{r2-r5}}",
        "str r6, [sp, #8]",
        "cmp r6, r7",
        "bne 1b",
        "add sp, #20",
        "pop {{r4-r11, pc}}",
        unrolled = const UNROLLED,
        low_bits = const LOW_BITS,
    )
}

/// The exact sum of a row's mantissas times codes, in whole blocks of four columns; the row is one of a group.
#[inline(always)]
pub(super) fn row(row: &[u8], codes: &[[i16; GROUP]]) -> i64 {
    // The last block of a row ends three words before that of its group.
    let blocks = codes.len().min((row.len() + 12) / (2 * GROUP * GROUP));
    // SAFETY: the blocks are there.
    if blocks > 0 { unsafe { sum_row(row.as_ptr(), codes.as_ptr(), blocks) } } else { 0 }
}

/// Registers: r0 mantissas, r1 codes, r2 and r3 the sum, r4 to r7 words of both, r12 blocks.
///
/// # Safety
/// So many blocks are there, at least one.
#[unsafe(naked)]
unsafe extern "C" fn sum_row(mantissas: *const u8, codes: *const [i16; GROUP], blocks: usize) -> i64 {
    naked_asm!(
        "push {{r4-r7}}",
        "mov r12, r2",
        "movs r2, #0",
        "movs r3, #0",
        "1:",
        "ldr r4, [r1], #4",
        "ldr r5, [r1], #4",
        "ldr r6, [r0]",
        "ldr r7, [r0, #16]",
        "adds r0, #32",
        "smlald r2, r3, r6, r4",
        "smlald r2, r3, r7, r5",
        "subs.w r12, r12, #1",
        "bne 1b",
        "mov r0, r2",
        "mov r1, r3",
        "pop {{r4-r7}}",
        "bx lr",
    )
}
