//! Synthetic frames: what a board without an analogue front end sends instead of measurements.
//!
//! They exercise everything behind the front end, from tare to contacts, and mean nothing: a board
//! that sends them says so ([`crate::protocol::FrameSource::Synthetic`]). The same seed, sequence
//! number and steps give the same frame everywhere.

use crate::{frame::Frame, stimulation::Step, units::AdcCode};

/// Largest code of an untouched skin; codes have 16 bits.
const LARGEST: i32 = 26_000;
/// The change of a code lies within one part in this of the code itself.
const CHANGE_PART: i32 = 8;

/// Frame number `sequence` of the sequence that `seed` names.
///
/// Codes fall with the square of the way from the drive pair to the sense pair, as on a sheet with
/// neighbouring pairs, and each changes from frame to frame by up to an eighth, evenly spread.
pub fn frame(seed: u32, sequence: u32, timestamp_us: u64, steps: impl Iterator<Item = Step>) -> Frame {
    let stream = mix(seed ^ mix(sequence));
    let mut frame = Frame { sequence, timestamp_us, ..Frame::default() };
    for (index, step) in (0_u32..).zip(steps) {
        let rest = at_rest(step);
        // -2^15..2^15, so the product fits 32 bits.
        let share = (mix(stream ^ index) >> 16) as i32 - (1 << 15);
        let code = rest + rest * share / (CHANGE_PART << 15);
        if frame.codes.push(AdcCode(code)).is_err() {
            break;
        }
    }
    frame
}

/// The code of the untouched skin.
fn at_rest(step: Step) -> i32 {
    let way = i32::from(step.drive_plus.abs_diff(step.sense_plus).clamp(1, 8));
    LARGEST / (way * way)
}

/// Spreads each bit over all: the finaliser of MurmurHash3.
fn mix(mut word: u32) -> u32 {
    word = word.wrapping_add(0x9E37_79B9);
    word = (word ^ (word >> 16)).wrapping_mul(0x85EB_CA6B);
    word = (word ^ (word >> 13)).wrapping_mul(0xC2B2_AE35);
    word ^ (word >> 16)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::stimulation::{Driven, pattern};
    use std::vec::Vec;

    fn steps() -> impl Iterator<Item = Step> {
        pattern(16, 1, 1, Driven::Skipped)
    }

    fn codes(seed: u32, sequence: u32) -> Vec<i32> {
        frame(seed, sequence, 0, steps()).codes.iter().map(|code| code.0).collect()
    }

    #[test]
    fn the_same_numbers_give_the_same_frame_and_others_another() {
        assert_eq!(codes(1, 2), codes(1, 2));
        assert_ne!(codes(1, 2), codes(1, 3));
        assert_ne!(codes(1, 2), codes(2, 2));
        assert_eq!(codes(7, 9)[..4], [26_243, 6_424, 2_655, 1_464], "frames are the same on every machine");
    }

    #[test]
    fn codes_spread_evenly_over_an_eighth_around_their_rest() {
        let at_rest: Vec<_> = steps().map(at_rest).collect();
        let mut changes = Vec::new();
        for sequence in 0..1000 {
            for (code, rest) in codes(3, sequence).iter().zip(&at_rest) {
                assert!(code.abs() < 1 << 15 && *rest >= 400);
                changes.push(f64::from(code - rest) / f64::from(*rest));
            }
        }
        let count = changes.len() as f64;
        let mean = changes.iter().sum::<f64>() / count;
        let spread = (changes.iter().map(|change| change * change).sum::<f64>() / count).sqrt();
        // An even spread over +-1/8 has the deviation 1 / (8 * sqrt 3) = 0.0722.
        assert!(mean.abs() < 0.001, "{mean}");
        assert!((spread - 0.0722).abs() < 0.001, "{spread}");
    }

    #[test]
    fn a_frame_holds_a_code_for_each_step_and_no_more_than_it_can() {
        assert_eq!(frame(0, 5, 6, steps()).codes.len(), 208);
        let endless = core::iter::repeat_with(|| steps().next().unwrap());
        assert_eq!(frame(0, 5, 6, endless).codes.len(), crate::MAX_STEPS);
    }
}
