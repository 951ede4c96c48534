//! Reconstruction: fixed matrix times difference data, in integers.
//!
//! `conductivity_from_difference: [pixel][measurement]`, each row i16 with its own exponent. The
//! sum of a row is exact (64 bits); one rounding follows, to [`RelativeConductivity`] steps.
//!
//! Error of one pixel against exact arithmetic, with c the row, e its exponent, y the data and b
//! the data's exponent: at most
//!
//! ```text
//! 2^-(e+1) * sum |y|  +  2^-(b+1) * sum (|c| + 2^-(e+1))  +  2^-21
//! ```
//!
//! from rounding the coefficients, the data, and the result.
//!
//! [`portable`] runs everywhere. With the feature `dsp`, a Cortex-M that has the DSP instructions runs the
//! kernel in `kernel.rs` instead, which gives the same bits.

#[cfg(all(target_arch = "arm", feature = "dsp"))]
mod kernel;

use crate::{
    image::Image, patch::PatchView, pipeline::reference::DifferenceData, units::RelativeConductivity,
};

/// Applies the patch's matrix: `image[pixel] = sum over measurements of matrix * difference`.
// Never inlined, so that a test can find it in the firmware's ELF and count its cycles.
#[inline(never)]
pub fn reconstruct(patch: &PatchView<'_>, difference: &DifferenceData, image: &mut Image) {
    #[cfg(all(target_arch = "arm", feature = "dsp"))]
    if kernel::apply(patch, difference, image).is_some() {
        return;
    }
    portable(patch, difference, image);
}

/// As [`reconstruct`], in plain Rust.
pub fn portable(patch: &PatchView<'_>, difference: &DifferenceData, image: &mut Image) {
    image.clear();
    for (row, exponent) in patch.rows() {
        let shift = i32::from(exponent) + frame_shift(difference);
        let value = shift_right_rounded(dot(row, &difference.codes), shift);
        let _ = image.push(RelativeConductivity(value));
    }
}

/// What the data's exponent and the image's steps add to the shift of every row.
fn frame_shift(difference: &DifferenceData) -> i32 {
    difference.exponent - RelativeConductivity::FRACTION_BITS
}

/// Exact product of one matrix row (little-endian i16) and the data.
///
/// Neither factor is ever -32,768, so a pair of products fits 32 bits; pairs are what both the
/// Cortex-M4 and a workstation multiply at once.
fn dot(row: &[u8], data: &[i16]) -> i64 {
    let product = |c: [u8; 2], d: i16| i32::from(i16::from_le_bytes(c)) * i32::from(d);
    let mut sum = 0_i64;
    let (pairs, data_pairs) = (row.chunks_exact(4), data.chunks_exact(2));
    let (last, last_data) = (pairs.remainder(), data_pairs.remainder());
    for (c, d) in pairs.zip(data_pairs) {
        sum += i64::from(product([c[0], c[1]], d[0]) + product([c[2], c[3]], d[1]));
    }
    if let ([low, high], [d]) = (last, last_data) {
        sum += i64::from(product([*low, *high], *d));
    }
    sum
}

/// `value / 2^shift`, rounded to nearest, ends of the range saturating.
fn shift_right_rounded(value: i64, shift: i32) -> i32 {
    let shifted = match shift {
        64.. => 0,
        1..=63 => ((value >> (shift - 1)) + 1) >> 1,
        -31..=0 => value.saturating_mul(1 << -shift),
        _ => value.signum().saturating_mul(i64::MAX),
    };
    shifted.clamp(i64::from(i32::MIN), i64::from(i32::MAX)) as i32
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use std::vec::Vec;

    proptest! {
        #[test]
        fn dot_is_exact(pairs in prop::collection::vec((-32_767_i16..=32_767, -32_767_i16..=32_767), 0..300)) {
            let row: Vec<u8> = pairs.iter().flat_map(|(c, _)| c.to_le_bytes()).collect();
            let data: Vec<i16> = pairs.iter().map(|(_, d)| *d).collect();
            let exact: i128 = pairs.iter().map(|&(c, d)| i128::from(c) * i128::from(d)).sum();
            prop_assert_eq!(i128::from(dot(&row, &data)), exact);
        }

        /// The argument of `kernel.rs`, which this machine cannot run.
        #[test]
        fn bits_from_8_upwards_are_enough_for_a_shift_by_9_or_more(
            value in -256 * 32_767_i64.pow(2)..=256 * 32_767_i64.pow(2),
            shift in 9_i32..200,
        ) {
            let high = i32::try_from(value >> 8).unwrap();
            // ASRS by 32 and more leaves the sign in the result and in the carry.
            let places = (shift - 8).min(32);
            let (shifted, carry) = (i64::from(high) >> places, i64::from(high) >> (places - 1) & 1);
            prop_assert_eq!(shifted + carry, i64::from(shift_right_rounded(value, shift)));
        }

        #[test]
        fn shift_rounds_to_nearest(value in -(1_i64 << 40)..(1_i64 << 40), shift in -20_i32..70) {
            let exact = value as f64 * 2_f64.powi(-shift);
            let bounded = exact.clamp(f64::from(i32::MIN), f64::from(i32::MAX));
            prop_assert!((f64::from(shift_right_rounded(value, shift)) - bounded).abs() <= 0.5);
        }
    }
}
