//! Newtypes for raw codes, each with its conversion.

use postcard_schema::Schema;
use serde::{Deserialize, Serialize};

/// One demodulated in-phase voltage as the converter delivers it: a signed count.
///
/// Its scale (volts per count) cancels in difference data, which is always a ratio of codes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize, Schema)]
pub struct AdcCode(pub i32);

/// Change of conductivity relative to the untouched skin, in steps of 2^-20.
///
/// Range +-2048 (a skin that conducts 2048 times better), step 9.5e-7. A press that raises the
/// conductivity by 10 % over the whole skin reads 104,858.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize, Schema)]
#[repr(transparent)]
pub struct RelativeConductivity(pub i32);

impl RelativeConductivity {
    /// Binary places after the point.
    pub const FRACTION_BITS: i32 = 20;
    /// One unit: the conductivity doubled.
    pub const ONE: f64 = (1_u32 << Self::FRACTION_BITS) as f64;

    /// Nearest code, saturating at the ends of the range; NaN becomes 0.
    #[must_use]
    pub fn from_f64(value: f64) -> Self {
        let scaled = value * Self::ONE;
        Self((scaled + 0.5_f64.copysign(scaled)) as i32)
    }

    /// As [`Self::from_f64`], where double precision would take its own arithmetic along: on the board.
    #[must_use]
    pub fn from_f32(value: f32) -> Self {
        let scaled = value * Self::ONE as f32;
        Self((scaled + 0.5_f32.copysign(scaled)) as i32)
    }

    /// The change as a plain number: 0.1 is 10 % more conductive.
    #[must_use]
    pub fn to_f64(self) -> f64 {
        f64::from(self.0) / Self::ONE
    }

    /// As [`Self::to_f64`], rounded to single precision.
    #[must_use]
    pub fn to_f32(self) -> f32 {
        self.0 as f32 / Self::ONE as f32
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn relative_conductivity_survives_a_round_trip_to_half_a_step() {
        for value in [-3.0, -1e-6, 0.0, 2e-7, 0.25, 17.123_456] {
            let back = RelativeConductivity::from_f64(value).to_f64();
            assert!((back - value).abs() <= 0.5 / RelativeConductivity::ONE, "{value} -> {back}");
            let single = value as f32;
            assert_eq!(
                RelativeConductivity::from_f32(single),
                RelativeConductivity::from_f64(single.into()),
                "{single}"
            );
        }
    }

    #[test]
    fn relative_conductivity_out_of_range_saturates() {
        assert_eq!(RelativeConductivity::from_f64(1e9).0, i32::MAX);
        assert_eq!(RelativeConductivity::from_f64(-1e9).0, i32::MIN);
        assert_eq!(RelativeConductivity::from_f64(f64::NAN).0, 0);
    }
}
