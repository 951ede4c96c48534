//! Converter: volts -> codes, and -> the samples behind them, as a board's front end makes them.

use dermatome_shared::{
    acquire::{FINENESS, FrontEnd, PEAK_GOAL, trim::Trim},
    demodulate::MIDDLE,
    drive::{Component, Drive, GAINS, Gain},
    scan::Timing,
    units::AdcCode,
};
use num_complex::Complex64;
use std::f64::consts::TAU;

/// Codes from zero to the end of the range at gain 1: half a 12-bit converter.
const FULL: f64 = 2048.0 * FINENESS as f64;
/// The lock-in tells so many LSB from zero to the end of the range: 12 bits summed over 16 samples.
const LOCK_IN_LSB: f64 = 32_768.0;
/// The largest untouched voltage fills this share of the range.
const FILL: f64 = 0.8;
/// Samples a second of the reference board.
const SAMPLE_RATE: u32 = 2_000_000;
/// Samples in a carrier period where the reference board has no such carrier.
const OTHER_PERIOD: f32 = 40.0;
/// Current at 100 %, A, unless the skin file wants more.
const FULL_SCALE_CURRENT: f32 = 1e-3;
/// Time constant with which a switched voltage settles, s.
const SETTLING_TIME: f64 = 1e-6;

/// A front end at one gain.
#[derive(Clone, Copy, Debug)]
pub(super) struct Converter {
    sample_rate: f64,
    volts_per_code: f64,
    gain: f64,
}

/// A complex voltage as the lock-in reads it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Reading {
    pub(super) real: AdcCode,
    pub(super) imaginary: AdcCode,
    /// Whether it is beyond the end of the range.
    pub(super) is_clipped: bool,
}

impl Converter {
    /// The front end for a skin whose largest slot reads `largest_ohms`.
    pub(super) fn front_end(drive: &Drive, largest_ohms: f64) -> FrontEnd {
        let full_scale_current = drive.amplitude.max(FULL_SCALE_CURRENT);
        let fits = Timing::new(drive, SAMPLE_RATE).is_some();
        FrontEnd {
            sample_rate: if fits { SAMPLE_RATE } else { (drive.frequency * OTHER_PERIOD).round() as u32 },
            volts_per_code: (f64::from(full_scale_current) * largest_ohms / FILL / FULL) as f32,
            full_scale_current,
            small_range: None,
            gain_bandwidth: f32::INFINITY,
            largest_gain: 64,
            bandwidths: [f32::INFINITY; 4],
            lead_corner: f32::INFINITY,
            waveform_rate: 1_000_000_000,
            lead: 0.0,
            trim: Trim::NONE,
        }
    }

    /// The front end at a fixed gain, or at one that lets the largest voltage fill its range.
    pub(super) fn new(front_end: &FrontEnd, gain: Gain, largest_volts: f64) -> Self {
        let volts_per_code = f64::from(front_end.volts_per_code);
        let gain = match gain {
            Gain::Fixed(gain) => gain.into(),
            Gain::Automatic => (FILL * FULL * volts_per_code / largest_volts).max(1.0),
        };
        Self { sample_rate: front_end.sample_rate.into(), volts_per_code, gain }
    }

    pub(super) fn with_gain(&self, gain: f64) -> Self {
        Self { gain, ..*self }
    }

    pub(super) fn read(&self, volts: Complex64) -> Reading {
        let lsb = FULL / self.gain / LOCK_IN_LSB;
        let limit = LOCK_IN_LSB - 1.0;
        let code = |volts: f64| {
            let count = (volts / self.volts_per_code / lsb).round().clamp(-limit, limit);
            AdcCode((count * lsb).round() as i32)
        };
        let is_clipped = volts.norm() / self.volts_per_code / lsb > limit;
        Reading { real: code(volts.re), imaginary: code(volts.im), is_clipped }
    }

    /// Gain and samples, codes of the 12-bit converter, of a slot that holds the second voltage and follows one with the
    /// first.
    pub(super) fn samples(
        &self,
        [before, now]: [Complex64; 2],
        timing: Timing,
        gain: Gain,
        noise: &mut impl FnMut() -> f64,
    ) -> (u8, Vec<u16>) {
        let lsb_per_volt = f64::from(MIDDLE) / FULL / self.volts_per_code;
        let gain = match gain {
            Gain::Fixed(gain) => gain,
            Gain::Automatic => largest_gain(now.norm() * lsb_per_volt),
        };
        let samples_per_settling = SETTLING_TIME * self.sample_rate;
        let sample = |n: usize| {
            let left = (-(n as f64) / samples_per_settling).exp();
            // The lock-in's first sample, behind the settling ones, lies on a crest of the current.
            let turns = (n as f64 - f64::from(timing.settling)) / f64::from(timing.period);
            let voltage = (now + (before - now) * left) * Complex64::from_polar(1.0, TAU * turns);
            let lsb = (voltage.re + noise()) * lsb_per_volt * f64::from(gain);
            (f64::from(MIDDLE) + lsb).round().clamp(0.0, 4095.0) as u16
        };
        (gain, (0..timing.slot_samples()).map(sample).collect())
    }
}

fn largest_gain(peak: f64) -> u8 {
    GAINS.into_iter().rev().find(|&gain| peak * f64::from(gain) <= f64::from(PEAK_GOAL)).unwrap_or(1)
}

impl Reading {
    pub(super) fn part(&self, component: Component) -> AdcCode {
        match component {
            Component::Real => self.real,
            Component::Imaginary => self.imaginary,
            Component::Magnitude => {
                AdcCode(f64::from(self.real.0).hypot(self.imaginary.0.into()).round() as i32)
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const OHMS: f64 = 20.0;

    fn drive(amplitude: f32) -> Drive {
        Drive::new(50e3, amplitude, 50.0)
    }

    fn code(amplitude: f32, gain: Gain, share: f64) -> Reading {
        let front_end = Converter::front_end(&drive(1e-3), OHMS);
        let largest = OHMS * f64::from(amplitude);
        Converter::new(&front_end, gain, largest).read(Complex64::new(0.0, largest * share))
    }

    #[test]
    fn codes_are_the_same_at_every_gain_to_an_lsb_of_the_lock_in() {
        for (amplitude, full) in [(1e-3, 0.8 * FULL), (0.5e-3, 0.4 * FULL)] {
            for gain in [Gain::Automatic, Gain::Fixed(1)] {
                let reading = code(amplitude, gain, 1.0);
                let off = (f64::from(reading.imaginary.0) - full).abs();
                assert!(off <= 129.0 && reading.real.0 == 0 && !reading.is_clipped, "{gain:?}: {reading:?}");
            }
        }
    }

    #[test]
    fn a_voltage_beyond_the_range_is_clipped_and_says_so() {
        assert!(code(1e-3, Gain::Automatic, 1.3).is_clipped);
        assert!(code(1e-3, Gain::Fixed(64), 0.1).is_clipped);
        assert!(!code(1e-3, Gain::Fixed(64), 0.01).is_clipped);
    }

    #[test]
    fn a_carrier_of_no_board_gets_samples_of_its_own() {
        let front_end = Converter::front_end(&Drive::new(7e3, 5e-3, 50.0), OHMS);
        assert_eq!((front_end.sample_rate, front_end.full_scale_current), (280_000, 5e-3));
        assert!(Timing::new(&Drive::new(7e3, 5e-3, 50.0), front_end.sample_rate).is_some());
    }
}
