//! Signs of the frames against the model's.

use super::{
    super::{diagnose::Signs, order::FileIndex},
    Expected, Readings,
};
use dermatome_shared::stimulation::Step;
use num_complex::Complex64;
use serde::Serialize;
use std::collections::BTreeMap;

/// Share of a pair's steps whose sign must disagree before the pair is called reversed.
const MOSTLY: f64 = 0.9;

/// Signs of the reference against the model's.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Polarity {
    /// Whether the values have no signs although the model's differ.
    pub magnitudes_only: bool,
    /// Whether most signs are the opposite of the model's.
    pub reversed: bool,
    /// Phase of the frames against the model, -180 to 180 degrees; 0 or 180 for real data.
    pub phase_degrees: f64,
    /// Steps whose signs were compared; weak ones, and those that noise decides, are left out.
    pub compared: usize,
    /// Steps whose sign disagrees with the others'.
    pub disagreements: Vec<usize>,
    /// Drive pairs, plus and minus, nearly all of whose steps disagree.
    pub reversed_drives: Vec<[u8; 2]>,
    /// Sense pairs, plus and minus, nearly all of whose steps disagree.
    pub reversed_senses: Vec<[u8; 2]>,
}

impl Polarity {
    pub(super) fn of(expected: &Expected, readings: &Readings) -> Self {
        let map: Vec<_> =
            (0..readings.measured.len()).map(|index| FileIndex { index, flipped: false }).collect();
        let signs = Signs::compare(&readings.model, &readings.clear(), &map);
        let differ = readings.model.iter().any(|&v| v > 0.0) && readings.model.iter().any(|&v| v < 0.0);
        let clear: Vec<bool> = (0..readings.measured.len()).map(|step| readings.is_clear(step)).collect();
        let mostly = |pair: fn(&Step) -> [u8; 2]| mostly(&expected.steps, &clear, &signs.disagreements, pair);
        let along: Complex64 = readings.measured.iter().zip(&readings.model).map(|(v, m)| v * *m).sum();
        Self {
            magnitudes_only: signs.magnitudes_only && differ,
            reversed: signs.reversed,
            phase_degrees: along.arg().to_degrees(),
            compared: signs.compared,
            reversed_drives: mostly(|step| [step.drive_plus, step.drive_minus]),
            reversed_senses: mostly(|step| [step.sense_plus, step.sense_minus]),
            disagreements: signs.disagreements,
        }
    }
}

/// Pairs nearly all of whose steps with a clear sign are among `chosen`.
fn mostly(steps: &[Step], clear: &[bool], chosen: &[usize], pair: fn(&Step) -> [u8; 2]) -> Vec<[u8; 2]> {
    let mut counts: BTreeMap<[u8; 2], [usize; 2]> = BTreeMap::new();
    let of_clear = steps.iter().zip(clear).filter(|(_, clear)| **clear);
    of_clear.for_each(|(step, _)| counts.entry(pair(step)).or_default()[0] += 1);
    chosen.iter().for_each(|&step| counts.entry(pair(&steps[step])).or_default()[1] += 1);
    let mostly = |[all, chosen]: [usize; 2]| all >= 3 && chosen as f64 >= MOSTLY * all as f64;
    counts.into_iter().filter(|(_, counts)| mostly(*counts)).map(|(pair, _)| pair).collect()
}
