//! Trim: what one board's front end does otherwise than its design says.
//!
//! Parts have tolerances, and the bandwidth of the chip's amplifier may be half of what is typical. The host measures
//! known resistors at each carrier and gain, and the board keeps the factors that come of it.

use crate::drive::GAINS;
use postcard_schema::Schema;
use serde::{Deserialize, Serialize};

/// Frequencies at which a board is trimmed, Hz, upwards.
pub const CARRIERS: [f32; 5] = [12.5e3, 20e3, 50e3, 100e3, 200e3];
/// No factor is further than this from 1: parts within their limits stay below 0.7.
const FURTHEST: f32 = 0.9;

/// A complex factor: real and imaginary part.
pub type Factor = [f32; 2];
/// Factors of all gains at one frequency, in the order of [`GAINS`].
pub type GainFactors = [Factor; GAINS.len()];

/// What multiplies the lock-in's phasors to make the board one as designed: `[carrier][gain]`, in the order of
/// [`CARRIERS`] and [`GAINS`].
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, Schema)]
pub struct Trim(pub [GainFactors; CARRIERS.len()]);

impl Trim {
    /// A board as designed.
    pub const NONE: Self = Self([[[1.0, 0.0]; GAINS.len()]; CARRIERS.len()]);

    /// Factors at a frequency, Hz; between two carriers on the line between theirs.
    #[must_use]
    pub fn at(&self, frequency: f32) -> GainFactors {
        let above = CARRIERS.iter().position(|&carrier| carrier >= frequency).unwrap_or(CARRIERS.len() - 1);
        let below = above.saturating_sub(1);
        let [Some(&low), Some(&high)] = [below, above].map(|place| CARRIERS.get(place)) else {
            return Self::NONE.0[0];
        };
        let share = if above == below { 0.0 } else { ((frequency - low) / (high - low)).clamp(0.0, 1.0) };
        let mut factors = self.0[below];
        for (factor, next) in factors.iter_mut().zip(&self.0[above]) {
            *factor = [0, 1].map(|part| factor[part] + share * (next[part] - factor[part]));
        }
        factors
    }

    /// The factors with one of them multiplied; nothing else changes, and nothing at all where there is no such place.
    pub fn multiply(&mut self, carrier: usize, gain: usize, by: Factor) {
        if let Some(factor) = self.0.get_mut(carrier).and_then(|factors| factors.get_mut(gain)) {
            *factor = product(*factor, by);
        }
    }

    /// Whether all factors are numbers not far from 1.
    #[must_use]
    pub fn is_plausible(&self) -> bool {
        let is_near = |&[real, imaginary]: &Factor| {
            let real = real - 1.0;
            real * real + imaginary * imaginary <= FURTHEST * FURTHEST
        };
        self.0.as_flattened().iter().all(is_near)
    }
}

/// Product of two complex numbers.
pub(super) fn product([a, b]: Factor, [c, d]: Factor) -> Factor {
    [a * c - b * d, a * d + b * c]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn factors_are_those_of_a_carrier_and_lie_between_two_elsewhere() {
        let mut trim = Trim::NONE;
        trim.multiply(2, 3, [0.5, 0.25]);
        trim.multiply(2, 3, [2.0, 0.0]);
        assert_eq!(trim.at(50e3)[3], [1.0, 0.5]);
        assert_eq!(trim.at(50e3)[2], [1.0, 0.0]);
        assert_eq!(trim.at(62.5e3)[3], [1.0, 0.375]);
        assert_eq!(trim.at(35e3)[3], [1.0, 0.25]);
        for outside in [1e3, 12.5e3, 20e3, 100e3, 200e3, 250e3] {
            assert_eq!(trim.at(outside), [[1.0, 0.0]; 7], "{outside}");
        }
        trim.multiply(0, 1, [1.5, 0.0]);
        assert_eq!((trim.at(8e3)[1], trim.at(12.5e3)[1]), ([1.5, 0.0], [1.5, 0.0]));
    }

    #[test]
    fn what_no_part_can_do_is_not_plausible() {
        assert!(Trim::NONE.is_plausible());
        for (factor, is_plausible) in [
            ([1.89, 0.0], true),
            ([0.5, -0.7], true),
            ([1.91, 0.0], false),
            ([0.05, 0.0], false),
            ([1.0, -0.91], false),
            ([f32::NAN, 0.0], false),
            ([1.0, f32::INFINITY], false),
        ] {
            let mut trim = Trim::NONE;
            trim.0[4][6] = factor;
            assert_eq!(trim.is_plausible(), is_plausible, "{factor:?}");
        }
    }
}
