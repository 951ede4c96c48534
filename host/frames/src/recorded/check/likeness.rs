//! How like the model a frame is, read in one way.
//!
//! Measured y and model m of a step, the frame's gain and common sign taken out, are compared as signed logarithms
//!
//! ```text
//! e = asinh(y / 2 d) - asinh(m / 2 d)
//! ```
//!
//! which are ratios for values far above d and differences below it. d is what the model cannot know of the step:
//! what it would change if its electrodes lay a share of their distance from where they are thought to be, and the
//! noise. Where a difference of large potentials happens to be nearly zero neither its logarithm nor its sign counts.
//!
//! Steps that are the same but for a turn share what a model gets wrong by its size, its electrodes' width or contacts:
//! the median of e over each such class is the bias, what is left is the scatter. Exchanged wires, rows and columns
//! show in the scatter, an offset in the bias.

use super::{
    super::statistics::{along_common_phase, median, pearson},
    Expected, Reference,
    reading::Reading,
};
use crate::recorded::order::OrderError;
use dermatome_shared::stimulation::Step;
use num_complex::Complex64;
use std::collections::BTreeMap;

/// Errors of an instrument, as a share of its largest value.
const FLOOR: f64 = 0.001;
/// An offset that was found is known to this share.
const OFFSET_ERROR: f64 = 0.03;
/// Share of the bias that counts where the scatter tells.
const BIAS: f64 = 0.4;
/// No step counts for more.
const MOST: f64 = 2.0;
/// Times another reading's error from which on a step is known much less; and the share of its size to which it is known.
const MUCH_LESS_KNOWN: f64 = 2.0;
const KNOWN: f64 = 0.5;
/// Steps that a class needs.
const LEAST_CLASS: usize = 6;

/// How like the model a frame is: the smaller the numbers the more.
#[derive(Clone, Debug)]
pub(super) struct Likeness {
    /// Signed logarithm of measured over model, its class's median taken out: `[step]`.
    pub(super) residuals: Vec<f64>,
    /// Their mean magnitude.
    pub(super) scatter: f64,
    /// Mean magnitude of the classes' medians.
    pub(super) bias: f64,
    /// Measured with the model's scale and common sign: `[step]`.
    pub(super) measured: Vec<f64>,
    /// What that scale is: the frame's unit for the model's.
    pub(super) gain: f64,
    /// What the model says: `[step]`.
    pub(super) model: Vec<f64>,
    /// d: `[step]`.
    pub(super) unknown: Vec<f64>,
}

impl Likeness {
    /// What is left, where the classes' medians may tell: an offset, potentials.
    pub(super) fn cost(&self) -> f64 {
        self.scatter + self.bias
    }

    /// What is left, where it shows in the scatter: places and wires. The bias of a body that is unlike the model must not
    /// hide it.
    pub(super) fn disorder(&self) -> f64 {
        self.scatter + BIAS * self.bias
    }

    /// Whether a step's voltage is known: to half its size, or nearly as well as in another reading.
    pub(super) fn knows(&self, step: usize, other: &Self) -> bool {
        self.unknown[step] <= (MUCH_LESS_KNOWN * other.unknown[step]).max(KNOWN * self.model[step].abs())
    }

    /// Correlation of log magnitudes, where one below what the model does not know counts as about that; a value that is
    /// not there says nothing.
    pub(super) fn correlation(&self) -> f64 {
        let there = self.logarithms().zip(&self.measured).filter(|(_, measured)| **measured != 0.0);
        pearson(&there.map(|(logarithms, _)| logarithms).collect::<Vec<_>>())
    }

    /// Logarithms of magnitude, model and measured: `[step]`.
    pub(super) fn logarithms(&self) -> impl Iterator<Item = (f64, f64)> + '_ {
        let steps = self.model.iter().zip(&self.measured).zip(&self.unknown);
        steps.map(|((m, y), d)| (m.hypot(*d).ln(), y.hypot(*d).ln()))
    }
}

/// Compares frames with what is expected.
pub(super) struct Comparison<'a> {
    pub(super) expected: &'a Expected,
    pub(super) reference: &'a Reference,
    /// Steps that are the same but for a turn: `[class][step]`.
    classes: Vec<Vec<usize>>,
}

impl<'a> Comparison<'a> {
    pub(super) fn new(expected: &'a Expected, reference: &'a Reference) -> Self {
        Self { expected, reference, classes: classes(&expected.steps, expected.electrodes) }
    }

    pub(super) fn of(&self, reading: &Reading) -> Result<Likeness, OrderError> {
        let (expected, reference) = (self.expected, self.reference);
        let places = reading.places(&expected.steps, expected.electrodes, reference.values.len())?;
        let (values, blur): (Vec<Complex64>, Vec<f64>) =
            places.into_iter().map(|(place, other)| reference.value(place, other, reading.offset)).unzip();
        let steps: Vec<Step> = expected.steps.iter().map(|&step| reading.wiring.step(step)).collect();
        let mut model: Vec<f64> = steps.iter().map(|&step| expected.voltage(step)).collect();
        let mut measured = along_common_phase(&values);
        if measured.iter().all(|&y| y >= 0.0) {
            model.iter_mut().for_each(|m| *m = m.abs());
        }
        let largest = model.iter().fold(0.0, |a: f64, m| a.max(m.abs()));
        let gain = gain(&measured, &model);
        measured.iter_mut().for_each(|y| *y /= gain);
        let offset = OFFSET_ERROR * reading.offset.norm();
        let unknown: Vec<f64> = steps
            .iter()
            .zip(&blur)
            .map(|(&step, blur)| {
                let instrument = (blur.hypot(offset) / gain).hypot(FLOOR * largest);
                expected.error(step).hypot(instrument)
            })
            .collect();
        let signed: Vec<(f64, f64)> = (0..model.len())
            .map(|step| {
                let logarithm = |x: f64| (x / (2.0 * unknown[step])).asinh();
                (logarithm(measured[step]), logarithm(model[step]))
            })
            .collect();
        let along: f64 = signed.iter().map(|(y, m)| y.clamp(-1.0, 1.0) * m.clamp(-1.0, 1.0)).sum();
        let sign = if along < 0.0 { -1.0 } else { 1.0 };
        measured.iter_mut().for_each(|y| *y *= sign);
        let mut residuals: Vec<f64> = signed.iter().map(|(y, m)| (sign * y - m).clamp(-MOST, MOST)).collect();
        let mut bias = 0.0;
        for class in &self.classes {
            let middle = if class.len() < LEAST_CLASS {
                0.0
            } else {
                median(class.iter().map(|&step| residuals[step]))
            };
            bias += middle.abs() * class.len() as f64;
            class.iter().for_each(|&step| residuals[step] -= middle);
        }
        let bias = bias / residuals.len().max(1) as f64;
        Ok(Likeness { scatter: scatter(&residuals), residuals, bias, measured, gain, model, unknown })
    }
}

fn scatter(residuals: &[f64]) -> f64 {
    residuals.iter().map(|e| e.abs().min(MOST)).sum::<f64>() / residuals.len().max(1) as f64
}

/// Median measured magnitude over the model's, above zero.
fn gain(measured: &[f64], model: &[f64]) -> f64 {
    let alive = measured.iter().zip(model).filter(|(y, m)| **y != 0.0 && **m != 0.0);
    let gain = median(alive.map(|(y, m)| (y / m).abs()));
    if gain > 0.0 && gain.is_finite() { gain } else { 1.0 }
}

/// Steps whose electrodes lie the same distances round from where the current leaves.
pub(super) fn classes(steps: &[Step], electrodes: u8) -> Vec<Vec<usize>> {
    let n = u16::from(electrodes.max(1));
    let ahead = |electrode: u8, of: u8| (u16::from(electrode) + n - u16::from(of) % n) % n;
    let mut classes: BTreeMap<[u16; 3], Vec<usize>> = BTreeMap::new();
    for (index, step) in steps.iter().enumerate() {
        let key = [step.drive_plus, step.sense_plus, step.sense_minus];
        classes.entry(key.map(|electrode| ahead(electrode, step.drive_minus))).or_default().push(index);
    }
    classes.into_values().collect()
}
