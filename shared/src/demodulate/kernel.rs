//! Kernel: the lock-in's sums with the DSP instructions of the Cortex-M4, two samples at a time.
//!
//! SMLALD adds two products to an exact 64-bit sum; USUB16 and SEL keep the largest and the smallest sample
//! of two lanes. That is 11 instructions for two samples, where plain Rust takes 40. Samples have 12 bits,
//! so they are halfwords with or without a sign.
#![expect(unsafe_code, reason = "the kernel is written in assembly")]

use super::{MAX_PERIOD, MIDDLE, Reading, Waves};
use core::{arch::asm, mem::offset_of};

/// From a value of the cosine to the sine's, less the word that the cosine's address has moved on.
const TO_SINE: usize = 2 * MAX_PERIOD - 4;
/// The middle in both lanes.
const MIDDLES: u32 = MIDDLE as u32 | (MIDDLE as u32) << 16;

const _: () = assert!(offset_of!(Waves, sine) - offset_of!(Waves, cosine) == TO_SINE + 4);

/// Adds all pairs of samples to the reading; says how many samples those are.
pub(super) fn add_pairs(reading: &mut Reading, samples: &[u16], waves: &Waves, phase: usize) -> usize {
    let pairs = samples.len() / 2;
    let Some(references) = waves.cosine.get(phase..phase + 2 * pairs).filter(|_| pairs > 0) else { return 0 };
    let halves = |sum: i64| [sum as u32, (sum >> 32) as u32];
    let [mut i_low, mut i_high] = halves(reading.in_phase);
    let [mut q_low, mut q_high] = halves(reading.quadrature);
    let (mut highest, mut lowest) = (MIDDLES, MIDDLES);
    // SAFETY: it reads `pairs` words of the samples, of the cosine, and of the sine, which lies
    // TO_SINE + 4 behind the cosine and is as long; a word need not lie aligned for LDR.
    unsafe {
        asm!(
            "2:",
            "ldr {s}, [{samples}], #4",
            "ldr {w}, [{waves}], #4",
            "smlald {i_low}, {i_high}, {s}, {w}",
            "ldr {w}, [{waves}, #{to_sine}]",
            "smlald {q_low}, {q_high}, {s}, {w}",
            "usub16 {w}, {s}, {highest}",
            "sel {highest}, {s}, {highest}",
            "usub16 {w}, {lowest}, {s}",
            "sel {lowest}, {s}, {lowest}",
            "subs {pairs}, {pairs}, #1",
            "bne 2b",
            s = out(reg) _,
            w = out(reg) _,
            samples = inout(reg) samples.as_ptr() => _,
            waves = inout(reg) references.as_ptr() => _,
            pairs = inout(reg) pairs => _,
            i_low = inout(reg) i_low,
            i_high = inout(reg) i_high,
            q_low = inout(reg) q_low,
            q_high = inout(reg) q_high,
            highest = inout(reg) highest,
            lowest = inout(reg) lowest,
            to_sine = const TO_SINE,
            options(nostack, readonly),
        );
    }
    let whole = |low: u32, high: u32| (u64::from(high) << 32 | u64::from(low)) as i64;
    reading.in_phase = whole(i_low, i_high);
    reading.quadrature = whole(q_low, q_high);
    for lanes in [highest, lowest] {
        let [one, other] = [lanes as u16, (lanes >> 16) as u16].map(|sample| sample.abs_diff(MIDDLE));
        reading.peak = reading.peak.max(one).max(other);
    }
    2 * pairs
}
