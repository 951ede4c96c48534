//! Trigonometry: cosine and sine of turns, the same bits everywhere, in the flash of a small chip.

use core::f32::consts::TAU;

/// Cosine of an angle in turns, to 2e-7 for angles of a few turns.
#[must_use]
pub fn cosine(turns: f32) -> f32 {
    let within_half = turns - libm::floorf(turns + 0.5);
    let z = (0.25 - libm::fabsf(within_half)) * TAU;
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
}
