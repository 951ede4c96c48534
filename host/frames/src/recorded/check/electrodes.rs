//! Electrodes one by one: what all measurements that use them have in common.

use super::{
    super::statistics::{median, pearson},
    Expected, Readings,
};
use dermatome_shared::stimulation::Step;
use serde::Serialize;

/// A step is off from this factor between recorded and expected magnitude on.
const OFF_FACTOR: f64 = 2.0;
/// And from so many standard deviations on, as the median deviation estimates them.
const OFF_DEVIATIONS: f64 = 5.0;
/// From a normal distribution's median absolute deviation to its standard deviation.
const DEVIATION: f64 = 1.4826;
/// A step is noisy from so many times the median noise on.
const NOISY: f64 = 5.0;
/// Share of an electrode's steps that must be off or noisy; an electrode beside it reaches a half.
pub(super) const NEARLY_ALL: f64 = 0.75;

/// What all measurements of one electrode have in common.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct ElectrodeCheck {
    /// The electrode, by the file's number from 0.
    pub electrode: u8,
    /// Share of the steps that drive it which are far from the model, %; `null` if none does.
    pub drive_off_percent: Option<f64>,
    /// Share of the steps that sense it which are far from the model, %.
    pub sense_off_percent: Option<f64>,
    /// Share of the steps that drive or sense it which are far noisier than the median, %.
    pub noisy_percent: Option<f64>,
    /// Share of the steps that drive or sense it which are zero, %.
    pub dead_percent: Option<f64>,
}

impl ElectrodeCheck {
    /// Whether nearly all steps that drive it are off.
    #[must_use]
    pub fn drive_is_off(&self) -> bool {
        nearly_all(self.drive_off_percent)
    }

    /// Whether nearly all steps that sense it are off.
    #[must_use]
    pub fn sense_is_off(&self) -> bool {
        nearly_all(self.sense_off_percent)
    }

    /// Whether nearly all its steps are noisy.
    #[must_use]
    pub fn is_noisy(&self) -> bool {
        nearly_all(self.noisy_percent)
    }
}

fn nearly_all(percent: Option<f64>) -> bool {
    percent.is_some_and(|percent| percent >= 100.0 * NEARLY_ALL)
}

/// Each electrode: `[electrode]`.
pub(super) fn check(expected: &Expected, readings: &Readings) -> Vec<ElectrodeCheck> {
    let off = off(readings);
    let noisy = noisy(readings);
    let dead: Vec<bool> = (0..readings.measured.len()).map(|step| readings.is_dead(step)).collect();
    let of = |electrode: u8| {
        let drives = |step: &Step| electrode == step.drive_plus || electrode == step.drive_minus;
        let senses = |step: &Step| electrode == step.sense_plus || electrode == step.sense_minus;
        let share = |flags: &[bool], uses: &dyn Fn(&Step) -> bool| share(&expected.steps, flags, uses);
        ElectrodeCheck {
            electrode,
            drive_off_percent: share(&off, &drives),
            sense_off_percent: share(&off, &senses),
            noisy_percent: share(&noisy, &|step| drives(step) || senses(step)),
            dead_percent: share(&dead, &|step| drives(step) || senses(step)),
        }
    };
    (0..expected.electrodes).map(of).collect()
}

/// Correlation of log magnitudes with the model over the steps that use no electrode that is off.
pub(super) fn sound_correlation(
    expected: &Expected,
    readings: &Readings,
    electrodes: &[ElectrodeCheck],
) -> f64 {
    let is_sound = |step: &Step| {
        let drives = [step.drive_plus, step.drive_minus].map(usize::from);
        let senses = [step.sense_plus, step.sense_minus].map(usize::from);
        !drives.iter().any(|&e| electrodes[e].drive_is_off())
            && !senses.iter().any(|&e| electrodes[e].sense_is_off())
    };
    let alive = |(index, step): &(usize, &Step)| is_sound(step) && !readings.is_dead(*index);
    let steps = expected.steps.iter().enumerate().filter(alive);
    let points: Vec<_> = steps.map(|(index, _)| readings.logarithms[index]).collect();
    pearson(&points)
}

/// Share of flagged steps among those in use, %.
fn share(steps: &[Step], flags: &[bool], uses: &dyn Fn(&Step) -> bool) -> Option<f64> {
    let flags: Vec<bool> =
        steps.iter().zip(flags).filter(|(step, _)| uses(step)).map(|(_, &flag)| flag).collect();
    let flagged = flags.iter().filter(|&&flag| flag).count();
    (!flags.is_empty()).then(|| 100.0 * flagged as f64 / flags.len() as f64)
}

/// Steps far from the model, or zero.
fn off(readings: &Readings) -> Vec<bool> {
    let residuals = &readings.residuals;
    let deviation = DEVIATION * median(residuals.iter().map(|residual| residual.abs()));
    let limit = OFF_FACTOR.ln().max(OFF_DEVIATIONS * deviation);
    let is_off = |(step, residual): (usize, &f64)| readings.is_dead(step) || residual.abs() > limit;
    residuals.iter().enumerate().map(is_off).collect()
}

fn noisy(readings: &Readings) -> Vec<bool> {
    let limit = NOISY * median(readings.noise.iter().copied());
    readings.noise.iter().map(|&noise| limit > 0.0 && noise > limit).collect()
}
