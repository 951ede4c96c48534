//! Hysteresis: takes it out of the strength of contacts, before the calibration curve.
//!
//! A sheet that was pressed harder conducts better than it should until it is let go. The inverse is an
//! weighted sum of a few play operators, the generalised Prandtl-Ishlinskii model (Al Janaideh, Rakheja, Su,
//! IEEE/ASME Trans. Mechatronics 16, 2011): one envelope of each operator is the strength x itself, the other
//! is a multiple of it, its threshold,
//!
//! ```text
//! h_i <- max(x, min(h_i, threshold_i x))      state of operator i: what is left of the highest strength
//! v    = max(0, x - sum_i weight_i (h_i - x))
//! ```
//!
//! so that a first press passes unchanged and the loop's shape is the same at every height. Where the sum
//! exceeds x, nothing presses: what reads is what the last press left. The states are then pulled back until v is
//! exactly 0, so that memory fades as its trace in the skin does. No clock is needed: the model follows
//! the order of strengths, not their times.
//!
//! Hysteresis belongs to a place of the skin, so [`Places`] keeps one [`Memory`] for each place that was
//! pressed lately; a contact uses the memory of the place that it is on.

mod places;

pub use places::{Places, Strengths};

use crate::units::RelativeConductivity;

/// Most play operators.
pub const MAX_PLAY_OPERATORS: usize = 6;
/// Bytes of one play operator in a patch.
pub const PLAY_OPERATOR_BYTES: usize = 4;
const THRESHOLD_BITS: u32 = 12;
const WEIGHT_BITS: u32 = 11;
/// Noise is averaged over about two to the power of this many frames.
const SMOOTHING_BITS: u32 = 3;

/// One play operator, in fixed point.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PlayOperator {
    /// The state is at most so many times the strength, in steps of 2^-12: 1 to 15.99.
    pub threshold: u16,
    /// Weight of the state beyond the strength, in steps of 2^-11: 0 to 31.99.
    pub weight: u16,
}

impl PlayOperator {
    /// Nearest operator to these numbers, which are limited to what it can hold.
    #[must_use]
    pub fn from_f64(threshold: f64, weight: f64) -> Self {
        let scale = |value: f64, bits: u32| (value * f64::from(1_u32 << bits) + 0.5) as u16;
        Self {
            threshold: scale(threshold.max(1.0), THRESHOLD_BITS),
            weight: scale(weight.max(0.0), WEIGHT_BITS),
        }
    }

    /// As it lies in a patch, little-endian.
    #[must_use]
    pub fn to_bytes(self) -> [u8; PLAY_OPERATOR_BYTES] {
        (u32::from(self.weight) << 16 | u32::from(self.threshold)).to_le_bytes()
    }

    /// Inverse of [`Self::to_bytes`].
    #[must_use]
    pub fn from_bytes(bytes: [u8; PLAY_OPERATOR_BYTES]) -> Self {
        let word = u32::from_le_bytes(bytes);
        Self { threshold: word as u16, weight: (word >> 16) as u16 }
    }

    /// Whether its state is never below the strength itself.
    #[must_use]
    pub fn is_valid(self) -> bool {
        u32::from(self.threshold) >= 1 << THRESHOLD_BITS
    }
}

/// What one place remembers of its presses. Strengths are in steps of 2^-20.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Memory {
    strength: i32,
    states: [i32; MAX_PLAY_OPERATORS],
}

impl Memory {
    /// The latest strength, smoothed.
    #[must_use]
    pub fn strength(&self) -> RelativeConductivity {
        RelativeConductivity(self.strength)
    }

    /// Takes the next strength in, and gives it without hysteresis.
    ///
    /// Changes up to `noise` are averaged; larger ones count at once.
    pub fn compensate(
        &mut self,
        operators: &(impl Iterator<Item = PlayOperator> + Clone),
        strength: RelativeConductivity,
        noise: RelativeConductivity,
    ) -> RelativeConductivity {
        self.smooth(strength.0, noise.0);
        let x = self.strength.max(0);
        let mut excess = 0_i64;
        for (state, operator) in self.states.iter_mut().zip(operators.clone()) {
            let most = (i64::from(x) * i64::from(operator.threshold)) >> THRESHOLD_BITS;
            *state = i64::from(*state).min(most).max(x.into()).min(i32::MAX.into()) as i32;
            excess += i64::from(*state - x) * i64::from(operator.weight);
        }
        let excess = (excess >> WEIGHT_BITS).min(i32::MAX.into()) as i32;
        if excess > x {
            self.fade(x, x as f32 / excess as f32);
        }
        RelativeConductivity((x - excess).max(0))
    }

    /// A step of a low-pass filter that follows all but the last `noise` of a jump.
    fn smooth(&mut self, strength: i32, noise: i32) {
        let gap = strength.saturating_sub(self.strength);
        let small = gap.clamp(-noise.max(0), noise.max(0));
        let step = (gap - small).saturating_add(small >> SMOOTHING_BITS);
        self.strength = self.strength.saturating_add(step);
    }

    /// Keeps this share of the states beyond the strength.
    fn fade(&mut self, x: i32, share: f32) {
        for state in &mut self.states {
            *state = x.saturating_add(((*state - x).max(0) as f32 * share) as i32);
        }
    }
}

#[cfg(test)]
mod tests;
