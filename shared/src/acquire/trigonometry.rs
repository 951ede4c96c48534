//! Trigonometry: cosine and sine of turns, the same bits everywhere, in the flash of a small chip.
//!
//! Whole numbers are micromath's, which are exact. Its cosine and its square root would be the largest errors of
//! a measurement; largest errors over the whole range, as this module's tests find them:
//!
//! | function              | here   | micromath | half a step of what it goes into                |
//! |-----------------------|--------|-----------|-------------------------------------------------|
//! | cosine                | 1.8e-7 | 1.1e-3    | 3.1e-5: the lock-in's table                     |
//! | square root, relative | 6.0e-8 | 6.1e-2    | 6.0e-8: the code of a magnitude of a full range |

use core::f32::consts::TAU;
use micromath::F32Ext;

/// Cosine of an angle in turns, to 2e-7 for angles of a few turns.
#[must_use]
pub fn cosine(turns: f32) -> f32 {
    let within_half = turns - F32Ext::floor(turns + 0.5);
    let z = (0.25 - within_half.abs()) * TAU;
    let square = z * z;
    // Taylor's series of the sine up to z^11, on a quarter turn either way.
    let terms = [110.0, 72.0, 42.0, 20.0, 6.0];
    z * terms.iter().fold(1.0, |sum, divisor| 1.0 - square / divisor * sum)
}

/// Sine of an angle in turns.
#[must_use]
pub fn sine(turns: f32) -> f32 {
    cosine(turns - 0.25)
}

/// Length of a vector whose squares stay in range.
#[must_use]
pub fn length(x: f32, y: f32) -> f32 {
    libm::sqrtf(x * x + y * y)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn cosine_and_sine_are_those_of_the_standard_library(turns in -3.0_f32..3.0) {
            let angle = f64::from(turns) * core::f64::consts::TAU;
            prop_assert!((f64::from(cosine(turns)) - angle.cos()).abs() < 2e-6);
            prop_assert!((f64::from(sine(turns)) - angle.sin()).abs() < 2e-6);
        }
    }

    /// Largest error of a cosine over the turn from -1/2 to 1/2, at every 2^-20 of it.
    fn cosine_error(cosine: impl Fn(f32) -> f32) -> f64 {
        let error = |n: i32| {
            let turns = n as f32 / (1 << 20) as f32;
            (f64::from(cosine(turns)) - (f64::from(turns) * core::f64::consts::TAU).cos()).abs()
        };
        (-(1 << 19)..=1 << 19).map(error).fold(0.0, f64::max)
    }

    /// Largest relative error of a square root over all floats from 1 to 4, which stand for all others.
    fn root_error(root: impl Fn(f32) -> f32) -> f64 {
        let error = |bits: u32| {
            let value = f32::from_bits(bits);
            (f64::from(root(value)) / f64::from(value).sqrt() - 1.0).abs()
        };
        (1.0_f32.to_bits()..4.0_f32.to_bits()).map(error).fold(0.0, f64::max)
    }

    #[test]
    #[cfg_attr(miri, ignore = "the whole range takes Miri minutes")]
    fn the_errors_over_the_whole_range_decide_between_ours_and_micromath() {
        let half_step = 0.5 / 16_384.0;
        let [ours, theirs] = [cosine_error(cosine), cosine_error(|turns| F32Ext::cos(turns * TAU))];
        assert!(ours < 1.8e-7 && (1.0e-3..1.1e-3).contains(&theirs), "cosine: {ours} {theirs}");
        assert!(ours < half_step && theirs > 30.0 * half_step);
        let [ours, theirs] = [root_error(libm::sqrtf), root_error(F32Ext::sqrt)];
        assert!(ours < 6.0e-8 && (6.0e-2..6.1e-2).contains(&theirs), "root: {ours} {theirs}");
    }

    #[test]
    #[cfg_attr(miri, ignore = "the whole range takes Miri minutes")]
    fn whole_numbers_of_micromath_are_those_of_the_standard_library() {
        for n in -(1 << 21)..=1 << 21 {
            let value = n as f32 / 128.0;
            assert_eq!(F32Ext::floor(value), value.floor(), "{value}");
            assert_eq!(F32Ext::ceil(value), value.ceil(), "{value}");
            assert_eq!(F32Ext::round(value), value.round(), "{value}");
        }
    }
}
