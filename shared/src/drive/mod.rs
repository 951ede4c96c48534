//! Drive: how a skin is driven and measured.

pub mod stimulation;

use postcard_schema::Schema;
use serde::{Deserialize, Serialize};

/// Most carrier periods over which one voltage is measured.
pub const MAX_INTEGRATION: u8 = 64;
/// Longest time for a switched voltage to settle, carrier periods.
pub const MAX_SETTLING: f32 = 100.0;
/// Most frames a second, Hz: no board scans a skin so often.
pub const MAX_FRAME_RATE: f32 = 100e3;
/// Gains a board may have, largest last.
pub const GAINS: [u8; 7] = [1, 2, 4, 8, 16, 32, 64];

/// How a skin is driven and measured.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, Schema)]
pub struct Drive {
    /// Carrier frequency, Hz.
    pub frequency: f32,
    /// Current amplitude, A.
    pub amplitude: f32,
    /// Frames per second; more than the scan allows means as many as it allows.
    pub frame_rate: f32,
    /// By how much the in-phase reference lags the current, degrees, 0 to 360.
    pub phase: f32,
    /// Carrier periods between switching and measuring.
    pub settling: f32,
    /// Carrier periods over which a voltage is measured, whole.
    pub integration: u8,
    /// Gain of the programmable amplifier.
    pub gain: Gain,
    /// Which part of a voltage goes into the image.
    pub component: Component,
}

/// Gain of the programmable amplifier.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub enum Gain {
    /// Each step has the largest gain that leaves room for a press, found before each tare.
    Automatic,
    /// The same for all steps; one of [`GAINS`].
    Fixed(u8),
}

/// Part of a complex voltage.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub enum Component {
    /// In phase with the current.
    Real,
    /// In quadrature with it.
    Imaginary,
    /// Length of the phasor.
    Magnitude,
}

impl Drive {
    /// A drive at this frequency (Hz), amplitude (A) and frame rate (1/s), all else as usual: one
    /// period for each voltage, a quarter to settle, automatic gain, the part in phase.
    #[must_use]
    pub const fn new(frequency: f32, amplitude: f32, frame_rate: f32) -> Self {
        Self {
            frequency,
            amplitude,
            frame_rate,
            phase: 0.0,
            settling: 0.25,
            integration: 1,
            gain: Gain::Automatic,
            component: Component::Real,
        }
    }

    /// Whether the numbers make sense; else the field that does not, with what is allowed.
    pub fn check(&self) -> Result<(), &'static str> {
        let positive = |value: f32| value.is_finite() && value > 0.0;
        let checks = [
            (positive(self.frequency), "drive.frequency (more than 0 Hz)"),
            (positive(self.amplitude), "drive.amplitude (more than 0 A)"),
            (
                positive(self.frame_rate) && self.frame_rate <= MAX_FRAME_RATE,
                "drive.frame_rate (more than 0 Hz, at most 100 kHz)",
            ),
            ((0.0..=360.0).contains(&self.phase), "drive.phase (0 to 360 degrees)"),
            ((0.0..=MAX_SETTLING).contains(&self.settling), "drive.settling (0 to 100 carrier periods)"),
            (
                (1..=MAX_INTEGRATION).contains(&self.integration),
                "drive.integration (1 to 64 carrier periods)",
            ),
            (self.gain.is_known(), "drive.gain (automatic, 1, 2, 4, 8, 16, 32 or 64)"),
        ];
        checks.into_iter().find(|(is_right, _)| !is_right).map_or(Ok(()), |(_, field)| Err(field))
    }
}

impl Gain {
    /// Whether an amplifier with gains up to `largest` can have it.
    #[must_use]
    pub fn is_within(self, largest: u8) -> bool {
        match self {
            Self::Automatic => true,
            Self::Fixed(gain) => gain <= largest,
        }
    }

    fn is_known(self) -> bool {
        match self {
            Self::Automatic => true,
            Self::Fixed(gain) => GAINS.contains(&gain),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_drive_out_of_range_names_its_field() {
        let usual = Drive::new(50e3, 1e-3, 50.0);
        assert_eq!(usual.check(), Ok(()));
        let cases = [
            (Drive { frequency: 0.0, ..usual }, "drive.frequency"),
            (Drive { amplitude: f32::NAN, ..usual }, "drive.amplitude"),
            (Drive { frame_rate: f32::INFINITY, ..usual }, "drive.frame_rate"),
            (Drive { phase: 361.0, ..usual }, "drive.phase"),
            (Drive { settling: -0.5, ..usual }, "drive.settling"),
            (Drive { integration: 0, ..usual }, "drive.integration"),
            (Drive { gain: Gain::Fixed(3), ..usual }, "drive.gain"),
        ];
        for (drive, field) in cases {
            assert!(drive.check().unwrap_err().starts_with(field), "{field}");
        }
    }
}
