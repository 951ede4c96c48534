//! Scope: the samples behind one voltage, as the board's converter took them.

use crate::{
    error::{LinkError, LinkErrorKind},
    link::Link,
};
use dermatome_shared::{
    demodulate::{CLIPPED, MIDDLE},
    protocol::{Info, Selection, SlotSamples},
    scan::Timing,
};
use std::{f64::consts::TAU, time::Duration};

/// Samples of one slot.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Trace {
    /// Slot of the scan.
    pub slot: u16,
    /// Gain of the programmable amplifier.
    pub gain: u8,
    /// Samples at the start that are left out while the voltage settles.
    pub settling: usize,
    /// Samples of a carrier period.
    pub period: usize,
    /// Samples per second.
    pub sample_rate: u32,
    /// Codes of the converter, 0 to 4095.
    pub samples: Vec<u16>,
}

/// The sine that the lock-in finds in the samples behind the settling ones.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fit {
    /// Mean code.
    pub offset: f64,
    /// Amplitude, LSB.
    pub amplitude: f64,
    /// Phase at the first measured sample, degrees; 0 is a crest.
    pub phase: f64,
    /// Root mean square of what the sine does not explain, LSB.
    pub residual: f64,
}

/// Fetches the next samples of a slot; none if `go_on`, asked while nothing comes, says no. Silence for `timeout` is an
/// error.
pub fn capture(
    link: &mut Link,
    info: &Info,
    slot: u16,
    timeout: Duration,
    go_on: impl Fn() -> bool,
) -> Result<Option<Trace>, LinkError> {
    let (sample_rate, timing) = timing(info).map_err(|kind| link.error(kind))?;
    let mut stream = link.subscribe(Selection { scope: 1, scope_slot: slot, ..Selection::default() })?;
    let mut samples = None;
    while samples.is_none() && go_on() {
        let Some(frame) = stream.next_while(timeout, &go_on)? else { break };
        samples = frame.scope;
    }
    stream.stop()?;
    Ok(samples.map(|samples| Trace::new(&samples, sample_rate, timing)))
}

/// Sampling rate and timing of the drive in effect.
fn timing(info: &Info) -> Result<(u32, Timing), LinkErrorKind> {
    let both = info.front_end.zip(info.drive);
    let (front_end, drive) = both.ok_or(LinkErrorKind::NoFrontEnd)?;
    let sample_rate = front_end.sample_rate;
    let frequency = drive.frequency;
    let timing = Timing::new(&drive, sample_rate);
    Ok((sample_rate, timing.ok_or(LinkErrorKind::NoCarrier { frequency, sample_rate })?))
}

impl Trace {
    fn new(samples: &SlotSamples, sample_rate: u32, timing: Timing) -> Self {
        Self {
            slot: samples.slot,
            gain: samples.gain,
            settling: samples.settling.into(),
            period: timing.period.into(),
            sample_rate,
            samples: samples.samples.to_vec(),
        }
    }

    /// Samples at the ends of the converter's range, settling ones left out.
    #[must_use]
    pub fn clipped(&self) -> usize {
        self.measured().iter().filter(|&&sample| sample.abs_diff(MIDDLE) >= CLIPPED).count()
    }

    /// The sine in the measured samples; none if they are less than a period.
    #[must_use]
    pub fn fit(&self) -> Option<Fit> {
        // Over whole periods cosine, sine and a constant are at right angles.
        let whole = self.measured().len() / self.period.max(1) * self.period;
        let measured: Vec<f64> = self.measured().get(..whole)?.iter().map(|&sample| sample.into()).collect();
        if measured.is_empty() {
            return None;
        }
        let count = whole as f64;
        let offset = measured.iter().sum::<f64>() / count;
        let sum = |of: fn(f64) -> f64| {
            measured.iter().enumerate().map(|(n, sample)| sample * of(self.turns(n))).sum::<f64>()
        };
        let (cosine, sine) = (2.0 / count * sum(f64::cos), 2.0 / count * sum(f64::sin));
        let fit = Fit {
            offset,
            amplitude: cosine.hypot(sine),
            phase: (-sine).atan2(cosine).to_degrees(),
            residual: 0.0,
        };
        let at = |n: usize| fit.at(self, (self.settling + n) as f64);
        let squares = measured.iter().enumerate().map(|(n, sample)| (sample - at(n)).powi(2)).sum::<f64>();
        Some(Fit { residual: (squares / count).sqrt(), ..fit })
    }

    fn measured(&self) -> &[u16] {
        self.samples.get(self.settling..).unwrap_or_default()
    }

    fn turns(&self, n: usize) -> f64 {
        TAU * n as f64 / self.period as f64
    }
}

impl Fit {
    /// The sine at a sample of the trace.
    #[must_use]
    pub fn at(&self, trace: &Trace, sample: f64) -> f64 {
        let turns = (sample - trace.settling as f64) / trace.period as f64;
        self.offset + self.amplitude * (TAU * turns + self.phase.to_radians()).cos()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn trace(amplitude: f64) -> Trace {
        let sample = |n: i32| {
            let angle = TAU * f64::from(n - 10) / 40.0 + 0.5;
            (2050.0 + amplitude * angle.cos()).round().clamp(0.0, 4095.0) as u16
        };
        let samples = (0..90).map(sample).collect();
        Trace { slot: 0, gain: 4, settling: 10, period: 40, sample_rate: 2_000_000, samples }
    }

    #[test]
    fn the_fit_finds_the_sine_behind_the_settling_samples() {
        let mut trace = trace(900.0);
        trace.samples[..10].fill(4095);
        let fit = trace.fit().unwrap();
        assert!((fit.offset - 2050.0).abs() < 0.1 && (fit.amplitude - 900.0).abs() < 0.2, "{fit:?}");
        assert!((fit.phase - 0.5_f64.to_degrees()).abs() < 0.05 && fit.residual < 0.5, "{fit:?}");
        assert_eq!(trace.clipped(), 0);
    }

    #[test]
    fn a_clipped_sine_is_counted_and_leaves_a_residual() {
        let trace = trace(2500.0);
        assert!(trace.clipped() > 10 && trace.fit().unwrap().residual > 50.0);
    }

    #[test]
    fn less_than_a_period_has_no_fit() {
        let short = Trace { samples: vec![2048; 30], ..trace(1.0) };
        assert_eq!((short.fit(), short.clipped()), (None, 0));
        assert_eq!(Trace { samples: Vec::new(), period: 0, ..short }.fit(), None);
    }
}
