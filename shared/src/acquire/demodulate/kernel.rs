//! Kernel: the lock-in's sums with the DSP instructions of the Cortex-M4, two samples at a time.
//!
//! SMLALD adds two products to an exact 64-bit sum; USUB16 and SEL keep the largest and the smallest sample
//! of two lanes. That is 9 instructions for two samples, where plain Rust takes 40. Samples have 12 bits,
//! so they are halfwords with or without a sign.
//!
//! A slot is one or two runs, so what a run costs beside its samples counts as much: the reading is loaded
//! and stored as a whole.
#![expect(unsafe_code, reason = "the kernel is written in assembly")]

use super::{Reading, Waves};
use crate::limits::MAX_PERIOD;
use core::{arch::naked_asm, mem::offset_of};

/// From a value of the cosine to the sine's, less the word that the cosine's address has moved on.
const TO_SINE: usize = 2 * MAX_PERIOD - 4;

const _: () = assert!(offset_of!(Waves, sine) - offset_of!(Waves, cosine) == TO_SINE + 4);
const _: () = assert!(
    offset_of!(Reading, quadrature) == 8
        && offset_of!(Reading, highest) == 16
        && offset_of!(Reading, lowest) == 20
);

/// Adds all pairs of samples to the reading; says how many samples those are.
pub(super) fn add_pairs(reading: &mut Reading, samples: &[u16], waves: &Waves, phase: usize) -> usize {
    let pairs = samples.len() / 2;
    let references = waves.cosine.get(phase..).unwrap_or_default();
    if pairs == 0 || references.len() < 2 * pairs {
        return 0;
    }
    // SAFETY: it reads `pairs` words of the samples, of the cosine, and of the sine, which lies
    // TO_SINE + 4 behind the cosine and is as long; a word need not lie aligned for LDR.
    unsafe {
        add_words(reading, samples.as_ptr(), references.as_ptr(), pairs);
    }
    2 * pairs
}

/// Registers: r0 reading, r1 samples, r2 cosine, r3 pairs, r4-r7 sums, r8 highest, r9 lowest, r10 and r12
/// samples and references.
///
/// # Safety
/// `pairs` words, at least one, can be read from `samples`, from `cosine`, and TO_SINE + 4 behind that.
#[unsafe(naked)]
unsafe extern "C" fn add_words(reading: &mut Reading, samples: *const u16, cosine: *const i16, pairs: usize) {
    naked_asm!(
        "push {{r4-r10, lr}}",
        "ldm.w r0, {{r4-r9}}",
        "subs r3, r3, #2",
        "blo 3f",
        // Two pairs: what a slot goes through has to stay within the flash's kilobyte of cache, or it waits at each line.
        "2:",
        ".rept 2",
        "ldr r10, [r1], #4",
        "ldr r12, [r2], #4",
        "smlald r4, r5, r10, r12",
        "ldr r12, [r2, #{to_sine}]",
        "smlald r6, r7, r10, r12",
        "usub16 r12, r10, r8",
        "sel r8, r10, r8",
        "usub16 r12, r9, r10",
        "sel r9, r10, r9",
        ".endr",
        "subs r3, r3, #2",
        "bhs 2b",
        "3:",
        "adds r3, r3, #2",
        "beq 5f",
        // One.
        "ldr r10, [r1], #4",
        "ldr r12, [r2], #4",
        "smlald r4, r5, r10, r12",
        "ldr r12, [r2, #{to_sine}]",
        "smlald r6, r7, r10, r12",
        "usub16 r12, r10, r8",
        "sel r8, r10, r8",
        "usub16 r12, r9, r10",
        "sel r9, r10, r9",
        "5:",
        // Of both lanes into each.
        "ror r10, r8, #16",
        "usub16 r12, r10, r8",
        "sel r8, r10, r8",
        "ror r10, r9, #16",
        "usub16 r12, r9, r10",
        "sel r9, r10, r9",
        "stm.w r0, {{r4-r9}}",
        "pop {{r4-r10, pc}}",
        to_sine = const TO_SINE,
    )
}
