//! Pairs that read too much or too little throughout: a channel with another gain, a drive with another current.
//!
//! The rows of a frame are drives, its columns sense pairs. What the body and its contacts do to a pair shows in its row
//! and in its column alike, by reciprocity; a gain shows in one of them.

use super::{super::statistics::median, Expected, Readings};
use dermatome_shared::stimulation::Step;
use serde::Serialize;
use std::collections::BTreeMap;

/// Least gain that is worth a word.
const LEAST: f64 = 1.15;
/// Standard deviations of the other pairs' gains, as their median deviation estimates them, from which on it is one.
const OUTSTANDING: f64 = 5.0;
/// From a normal distribution's median absolute deviation to its standard deviation.
const DEVIATION: f64 = 1.4826;
/// Steps that a pair needs.
const LEAST_STEPS: usize = 5;
/// Share of the pairs that may have a gain of their own; where more seem to have one, it is something else.
const MOST_PAIRS: f64 = 0.2;

/// A pair with a gain of its own.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct PairGain {
    /// Its electrodes, plus and minus, by the file's numbers from 0.
    pub electrodes: [u8; 2],
    /// Whether it drives, or senses.
    pub drives: bool,
    /// Times what it should read.
    pub gain: f64,
}

type Pair = fn(&Step) -> [u8; 2];

const DRIVE: Pair = |step| [step.drive_plus, step.drive_minus];
const SENSE: Pair = |step| [step.sense_plus, step.sense_minus];

/// Looks for them in what is left once everything else is explained.
pub(super) fn find(expected: &Expected, readings: &Readings) -> Vec<PairGain> {
    let rows = medians(&expected.steps, &readings.residuals, DRIVE);
    let columns = medians(&expected.steps, &readings.residuals, SENSE);
    let [rows, columns] = [own(&rows, &columns), own(&columns, &rows)];
    let mut gains = outstanding(&rows, true);
    gains.extend(outstanding(&columns, false));
    gains
}

/// Median of the residuals of each pair.
fn medians(steps: &[Step], residuals: &[f64], pair: Pair) -> BTreeMap<[u8; 2], f64> {
    let mut of_pairs: BTreeMap<[u8; 2], Vec<f64>> = BTreeMap::new();
    steps.iter().zip(residuals).for_each(|(step, residual)| of_pairs.entry(pair(step)).or_default().push(*residual));
    let enough = of_pairs.into_iter().filter(|(_, residuals)| residuals.len() >= LEAST_STEPS);
    enough.map(|(pair, residuals)| (pair, median(residuals.into_iter()))).collect()
}

/// What pairs do in one role that they do not do in the other one.
fn own(these: &BTreeMap<[u8; 2], f64>, others: &BTreeMap<[u8; 2], f64>) -> BTreeMap<[u8; 2], f64> {
    let other = |[a, b]: [u8; 2]| others.get(&[a, b]).or_else(|| others.get(&[b, a])).copied();
    let of_pair = |(pair, gain): (&[u8; 2], &f64)| {
        let body = other(*pair).filter(|other| other * gain > 0.0).map_or(0.0, |other| other.abs().min(gain.abs()));
        (*pair, gain - body.copysign(*gain))
    };
    these.iter().map(of_pair).collect()
}

fn outstanding(gains: &BTreeMap<[u8; 2], f64>, drives: bool) -> Vec<PairGain> {
    let middle = median(gains.values().copied());
    let deviation = DEVIATION * median(gains.values().map(|gain| (gain - middle).abs()));
    let limit = LEAST.ln().max(OUTSTANDING * deviation);
    let found: Vec<_> = gains
        .iter()
        .filter(|(_, gain)| (*gain - middle).abs() > limit)
        .map(|(&electrodes, gain)| PairGain { electrodes, drives, gain: (gain - middle).exp() })
        .collect();
    if found.len() as f64 > MOST_PAIRS * gains.len() as f64 { Vec::new() } else { found }
}
