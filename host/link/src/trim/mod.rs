//! Trim: known resistors in place of the skin tell how a board's front end differs from its design.
//!
//! Each carrier is measured with groups of gains. A group has one amplitude, with which all of its gains have room,
//! and begins with the gain that ends the group before: so gains are compared at the same current, and only the first
//! group, at the largest current, counts on its amplitude. Gains are the same in both ranges of the current source, so a
//! group may be in either.

mod plug;

pub use plug::Plug;

use crate::{
    error::{LinkError, LinkErrorKind},
    link::Link,
};
use dermatome_shared::{
    acquire::{
        FINENESS, FrontEnd,
        trim::{CARRIERS, Factor, Trim},
    },
    demodulate::CLIPPED,
    drive::{Component, Drive, GAINS, Gain},
    frame::FrameFlags,
    protocol::{Request, Selection},
    stimulation::Step,
};
use std::{fmt, ops::RangeInclusive, time::Duration};

/// The largest voltage fills this share of the range.
const FILL: f64 = 0.85;
/// How long a switched voltage settles, s: even at the largest gain, whose pole may be near 100 kHz.
const SETTLING: f32 = 30e-6;
/// Frames that are averaged.
const FRAMES: usize = 16;
/// Frames that never come.
const TIMEOUT: Duration = Duration::from_secs(5);
/// A voltage may be so far from what the plug's resistors give, as a share of the largest.
const MISFIT: f64 = 0.05;
/// By how much the voltages of the plug lag the current, s: part of that flows through the capacitance of the switches,
/// whose resistance lifts the whole ring. With the parts of docs/hardware.md, of both choices, give or take a third.
const PLUG_LAG: f64 = 32e-9;
/// Gains of a group.
const GROUP: usize = 3;

/// A way to measure the plug.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Setting {
    /// Place of the carrier in [`CARRIERS`].
    pub carrier: usize,
    /// Place of the gain in [`GAINS`].
    pub gain: usize,
    /// Share of the full current.
    pub share: f64,
    /// Whether it begins a group.
    pub is_first: bool,
}

/// Voltages in phase and in quadrature that the board gave with a setting, V: `[step]`.
#[derive(Clone, Debug, PartialEq)]
pub struct Measured {
    /// How.
    pub setting: Setting,
    /// What.
    pub volts: Vec<[f64; 2]>,
}

/// Why there is no trim.
#[derive(Debug)]
pub enum TrimError {
    /// The link failed, or the board refused.
    Link(LinkError),
    /// A voltage is not what the plug's resistors give.
    Plug {
        /// Carrier, Hz, and gain.
        at: (f32, u8),
        /// The electrodes between which it was sensed, from 0.
        sensed: [u8; 2],
        /// What was expected, and found, in ohm.
        ohms: [f64; 2],
    },
    /// A factor that no part within its limits needs.
    Factor {
        /// Carrier, Hz, and gain.
        at: (f32, u8),
        /// The factor.
        factor: Factor,
    },
    /// Whoever asked does not want to go on.
    Stopped,
}

impl From<LinkError> for TrimError {
    fn from(error: LinkError) -> Self {
        Self::Link(error)
    }
}

impl std::error::Error for TrimError {}

impl fmt::Display for TrimError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Link(error) => error.fmt(f),
            Self::Plug { at: (hertz, gain), sensed, ohms: [expected, found] } => write!(
                f,
                "{} kHz, gain {gain}: between electrodes {} and {} the plug gives {found:.3} ohm where its resistors make \
                 {expected:.3}: is it the plug, whole and plugged in the right way?",
                hertz / 1e3,
                sensed[0] + 1,
                sensed[1] + 1
            ),
            Self::Factor { at: (hertz, gain), factor: [real, imaginary] } => write!(
                f,
                "{} kHz, gain {gain}: the board would need a factor of {real:.2} {imaginary:+.2}i, which no part within \
                 its limits does: are plug and resistances right, and the front end as in docs/hardware.md?",
                hertz / 1e3
            ),
            Self::Stopped => f.write_str("stopped before the end: the board keeps the trim it had"),
        }
    }
}

/// All settings with which a front end measures a plug, in order.
#[must_use]
pub fn settings(front_end: &FrontEnd, plug: &Plug) -> Vec<Setting> {
    let largest = f64::from(front_end.full_scale_current) * plug.largest();
    let range = f64::from(front_end.volts_per_code) * f64::from(FINENESS) * f64::from(CLIPPED);
    let gains = GAINS.iter().filter(|&&gain| gain <= front_end.largest_gain).count();
    let share = move |last: usize| (FILL * range / (largest * f64::from(GAINS[last]))).min(1.0);
    let groups = move |carrier| {
        (0..gains).step_by(GROUP - 1).filter(move |&first| first == 0 || first + 1 < gains).flat_map(
            move |first| {
                let last = (first + GROUP).min(gains) - 1;
                (first..=last).map(move |gain| Setting {
                    carrier,
                    gain,
                    share: share(last),
                    is_first: gain == first,
                })
            },
        )
    };
    (0..CARRIERS.len()).flat_map(groups).collect()
}

/// Measures the plug with every setting. The drive is another one afterwards: see [`Request::Drive`].
///
/// `progress` hears how many settings are done, and says whether to go on.
pub fn measure(
    link: &mut Link,
    settings: &[Setting],
    mut progress: impl FnMut(usize) -> bool,
) -> Result<Vec<Measured>, TrimError> {
    let front_end = front_end(link)?;
    let mut all = Vec::new();
    for (done, &setting) in settings.iter().enumerate() {
        if !progress(done) {
            return Err(TrimError::Stopped);
        }
        let frequency = CARRIERS[setting.carrier];
        let drive = Drive {
            gain: Gain::Fixed(GAINS[setting.gain]),
            settling: (SETTLING * frequency).max(0.25),
            component: Component::Real,
            ..Drive::new(frequency, setting.share as f32 * front_end.full_scale_current, 1e3)
        };
        link.request(&Request::Drive(Some(drive)))?;
        all.push(Measured { setting, volts: mean(link, f64::from(front_end.volts_per_code))? });
    }
    Ok(all)
}

/// The front end of a board, which it must have.
pub fn front_end(link: &mut Link) -> Result<FrontEnd, LinkError> {
    let front_end = link.info()?.front_end;
    front_end.ok_or_else(|| link.error(LinkErrorKind::NoFrontEnd))
}

/// Mean voltages of some frames; a frame with a fault other than the electrodes', which the plug has not, does not count.
fn mean(link: &mut Link, volts_per_code: f64) -> Result<Vec<[f64; 2]>, LinkError> {
    let mut stream = link.subscribe(Selection { measurements: 1, ..Selection::default() })?;
    let (mut sums, mut count) = (Vec::new(), 0);
    while count < FRAMES {
        let frame = stream.next_while(TIMEOUT, || true)?.unwrap_or_default();
        let missed = frame.at.is_some_and(|at| at.flags.contains(FrameFlags::MISSED));
        let Some(measured) = frame.measurements.filter(|_| !missed) else { continue };
        count += 1;
        sums.resize(measured.codes.len(), [0.0; 2]);
        for (sum, (real, imaginary)) in sums.iter_mut().zip(measured.codes.iter().zip(&measured.quadrature)) {
            *sum = [sum[0] + f64::from(real.0), sum[1] + f64::from(imaginary.0)];
        }
    }
    stream.stop()?;
    Ok(sums.into_iter().map(|sum| sum.map(|part| part * volts_per_code / count as f64)).collect())
}

/// The trim that follows from what was measured with [`settings`], by a board with this front end and the trim in it.
pub fn fit(
    front_end: &FrontEnd,
    plug: &Plug,
    steps: &[Step],
    measured: &[Measured],
) -> Result<Trim, TrimError> {
    let regression = Regression::new(plug, steps);
    let mut trim = front_end.trim;
    // What the plug's largest voltage really is in a group.
    let mut truth = [0.0; 2];
    // The correction that the gain before has had: the next group begins with the same one.
    let mut before = [1.0, 0.0];
    for Measured { setting, volts } in measured {
        let (frequency, gain) = (CARRIERS[setting.carrier], setting.gain);
        let current = setting.share * f64::from(front_end.full_scale_current);
        let (at, drive) = ((frequency, GAINS[gain]), Drive::new(frequency, current as f32, 1e3));
        let per_ampere: Vec<[f64; 2]> = volts.iter().map(|volts| volts.map(|part| part / current)).collect();
        let slope = regression.slope(&per_ampere).map_err(|(step, ohms)| {
            let sensed = [steps[step].sense_plus, steps[step].sense_minus];
            TrimError::Plug { at, sensed, ohms }
        })?;
        let found = slope.map(|slope| (slope * current * plug.largest()) as f32);
        if setting.is_first {
            truth = if gain == 0 {
                [1.0, -std::f64::consts::TAU * f64::from(frequency) * PLUG_LAG]
                    .map(|part| (part * current * plug.largest()) as f32)
            } else {
                front_end.corrected(&drive, gain, found, before)
            };
        }
        let factor = front_end.correction(&drive, gain, found, truth).unwrap_or([f32::NAN; 2]);
        before = factor;
        if setting.is_first && gain > 0 {
            continue;
        }
        trim.multiply(setting.carrier, gain, factor);
        if !trim.is_plausible() {
            return Err(TrimError::Factor { at, factor });
        }
    }
    Ok(trim)
}

/// A step and what was expected of it and found, ohm.
type Misfit = (usize, [f64; 2]);

/// The plug's steps as a regression takes them: `[step]`.
struct Regression {
    /// Transfer resistances, ohm.
    ohms: Vec<f64>,
    /// What every voltage may hold as well: something common to all, such as the common mode, and something for each
    /// ohm between the sensing electrodes, such as the current that the capacitance of switches takes round the ring.
    nuisances: [Vec<f64>; 2],
    /// What is left of the transfer resistances without these.
    own: Vec<f64>,
}

impl Regression {
    fn new(plug: &Plug, steps: &[Step]) -> Self {
        let ohms: Vec<f64> = steps.iter().map(|&step| plug.transfer(step)).collect();
        let common = vec![1.0; steps.len()];
        let sensed: Vec<f64> = steps.iter().map(|&step| plug.sensed(step)).collect();
        let nuisances = [common.clone(), without(&sensed, &[&common])];
        let own = without(&ohms, &[&nuisances[0], &nuisances[1]]);
        Self { ohms, nuisances, own }
    }

    /// Ohm for each ohm of transfer resistance, in phase and in quadrature, of voltages per ampere, by least squares. Or
    /// the step that fits worst, where it fits badly.
    fn slope(&self, found: &[[f64; 2]]) -> Result<[f64; 2], Misfit> {
        let parts = [0, 1].map(|part| found.iter().map(|found| found[part]).collect::<Vec<f64>>());
        let slope = parts.each_ref().map(|values| dot(values, &self.own) / dot(&self.own, &self.own));
        let [real, imaginary] =
            parts.map(|values| without(&values, &[&self.nuisances[0], &self.nuisances[1], &self.own]));
        let largest = self.ohms.iter().fold(0.0_f64, |largest, ohms| largest.max(ohms.abs()));
        let size = (slope[0] * slope[0] + slope[1] * slope[1]) * largest;
        // In phase with the voltages of resistors, whatever phase the board has.
        let left =
            real.iter().zip(&imaginary).map(|(real, imaginary)| real * slope[0] + imaginary * slope[1]);
        let misfits = left.map(|left| left.abs() / size).enumerate();
        match misfits.max_by(|a, b| a.1.total_cmp(&b.1)) {
            Some((step, misfit)) if misfit.is_nan() || misfit > MISFIT => {
                Err((step, [self.ohms[step], found[step][0]]))
            }
            _ => Ok(slope),
        }
    }
}

/// What is left of values without their share of each of these, which are at right angles to one another.
fn without(values: &[f64], of: &[&[f64]]) -> Vec<f64> {
    let mut left = values.to_vec();
    for basis in of {
        let share = dot(values, basis) / dot(basis, basis);
        left.iter_mut().zip(*basis).for_each(|(left, basis)| *left -= share * basis);
    }
    left
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// How far the factors of each carrier lie from 1, over all gains: magnitude and phase in degrees, smallest to largest.
#[must_use]
pub fn spread(trim: &Trim, carrier: usize) -> [RangeInclusive<f64>; 2] {
    let over = |part: fn(f64, f64) -> f64| {
        let values = trim.0[carrier].iter().map(|&[real, imaginary]| part(real.into(), imaginary.into()));
        let (low, high) = values
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), value| (low.min(value), high.max(value)));
        low..=high
    };
    [over(f64::hypot), over(|real, imaginary| imaginary.atan2(real).to_degrees())]
}

#[cfg(test)]
mod tests;
