//! Pairs that read too much or too little throughout: a channel with another gain, a drive with another current.
//!
//! Where each pair of electrodes both drives and senses, steps with drive and sense exchanged tell by how much more a
//! pair reads than it drives, whatever the body is; row and column of the pair, compared with the model, tell which of
//! the two is wrong. Elsewhere only the model tells, and much less well: an electrode that lies elsewhere changes
//! its pairs as well.

use super::{super::statistics::median, Expected, Readings};
use dermatome_model::stimulation::pairs_alike;
use dermatome_shared::stimulation::Step;
use serde::Serialize;
use std::collections::BTreeMap;

/// Least gain that is worth a word where reciprocity tells, and where only the model does.
const LEAST: f64 = 1.12;
const LEAST_BY_MODEL: f64 = 1.2;
/// Standard deviations of the other pairs' gains, as their median deviation estimates them, from which on it is one.
const OUTSTANDING: f64 = 4.0;
const OUTSTANDING_BY_MODEL: f64 = 3.0;
/// From a normal distribution's median absolute deviation to its standard deviation.
const DEVIATION: f64 = 1.4826;
/// Steps that a pair needs.
const LEAST_STEPS: usize = 5;
/// Share of a pair's steps that must lie on the same side of the others'.
const MOSTLY: f64 = 0.85;
/// Share of the pairs that may have a gain of their own; where more seem to have one, it is something else.
const MOST_PAIRS: f64 = 0.2;
/// Largest gain: beyond it something is open.
const LARGEST: f64 = 4.0;
/// Twice the difference of log-likelihoods from which on row and column tell which of the two is wrong.
const TELLS: f64 = 4.0;

/// A pair with a gain of its own.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct PairGain {
    /// Its electrodes, plus and minus, by the file's numbers from 0.
    pub electrodes: [u8; 2],
    /// Whether it drives, or senses.
    pub drives: bool,
    /// Times what it should read.
    pub gain: f64,
    /// Whether it could as well be the other one of the two, with the gain's inverse.
    pub ambiguous: bool,
}

/// Logarithms of gains of one pair.
type Gains = BTreeMap<[u8; 2], Vec<f64>>;

/// Looks for them in what is left once everything else is explained; `wired` are the steps as their wires are.
pub(super) fn find(expected: &Expected, wired: &[Step], readings: &Readings) -> Vec<PairGain> {
    let logarithms: Vec<f64> = readings.logarithms.iter().map(|(model, measured)| measured - model).collect();
    let by_model = |drives: bool| by_model(expected, wired, &logarithms, drives);
    let (rows, columns) = (by_model(true), by_model(false));
    let reciprocal = by_reciprocity(expected, wired, readings);
    if reciprocal.len() < 4 {
        let of = |gains: &Gains, drives: bool| -> Vec<PairGain> {
            let found = outstanding(gains, LEAST_BY_MODEL.ln(), OUTSTANDING_BY_MODEL);
            let pair = |(electrodes, gain): ([u8; 2], f64)| PairGain {
                electrodes,
                drives,
                gain: gain.exp(),
                ambiguous: false,
            };
            found.into_iter().map(pair).collect()
        };
        return [of(&rows, true), of(&columns, false)].concat();
    }
    let body = spread(&rows).min(spread(&columns)).max(f64::MIN_POSITIVE);
    let which = |(electrodes, gain): ([u8; 2], f64)| {
        let [row, column] = [&rows, &columns].map(|gains| middle_of(gains, electrodes));
        // What is left for the body to explain, if the column is wrong and if the row is.
        let [by_sense, by_drive] = [row, column].map(|rest| (rest / body).powi(2));
        let ambiguous = (by_sense - by_drive).abs() < TELLS;
        let [a, b] = electrodes;
        if by_drive < by_sense && !ambiguous {
            PairGain { electrodes: [b, a], drives: true, gain: (-gain).exp(), ambiguous }
        } else {
            PairGain { electrodes, drives: false, gain: gain.exp(), ambiguous }
        }
    };
    outstanding(&reciprocal, LEAST.ln(), OUTSTANDING).into_iter().map(which).collect()
}

/// Median gain of a pair, whichever way round it is.
fn middle_of(gains: &Gains, [a, b]: [u8; 2]) -> f64 {
    let gains = gains.get(&[a, b]).or_else(|| gains.get(&[b, a]));
    gains.map_or(0.0, |gains| median(gains.iter().copied()))
}

/// Standard deviation of the pairs' median gains, as their median deviation estimates it.
fn spread(gains: &Gains) -> f64 {
    DEVIATION * median(gains.values().map(|gains| median(gains.iter().copied()).abs()))
}

/// By how much more each pair reads than the model says, step by step, without what all steps like it share.
fn by_model(expected: &Expected, wired: &[Step], logarithms: &[f64], drives: bool) -> Gains {
    let mut gains = Gains::new();
    for class in super::likeness::classes(&expected.steps, expected.electrodes) {
        let middle = median(class.iter().map(|&step| logarithms[step]));
        for step in class.into_iter().filter(|&step| is_known(expected.steps[step], wired[step])) {
            let Step { drive_plus, drive_minus, sense_plus, sense_minus } = expected.steps[step];
            let pair = if drives { [drive_plus, drive_minus] } else { [sense_plus, sense_minus] };
            gains.entry(pair).or_default().push(logarithms[step] - middle);
        }
    }
    gains
}

/// Whether a step measures no contact that it was not meant to, through exchanged wires.
fn is_known(step: Step, wired: Step) -> bool {
    step == wired || !wired.senses_driven()
}

/// By how much more each pair reads than when it drives, with each other pair.
fn by_reciprocity(expected: &Expected, wired: &[Step], readings: &Readings) -> Gains {
    let mut gains = Gains::new();
    // Where the expected voltages are not reciprocal, against these.
    let size = |step: usize| readings.logarithms[step].1 - readings.logarithms[step].0;
    for (one, other, _) in pairs_alike(wired) {
        let sense = |step: usize| [wired[step].sense_plus, wired[step].sense_minus];
        let drive = |step: usize| [wired[step].drive_plus, wired[step].drive_minus];
        let same = |a: [u8; 2], b: [u8; 2]| a == b || a == [b[1], b[0]];
        let is_known = |step: usize| is_known(expected.steps[step], wired[step]);
        if !is_known(one)
            || !is_known(other)
            || readings.is_dead(one)
            || readings.is_dead(other)
            || !same(sense(one), drive(other))
        {
            continue;
        }
        let more = size(one) - size(other);
        gains.entry(sense(one)).or_default().push(more);
        gains.entry(sense(other)).or_default().push(-more);
    }
    gains
}

/// Pairs whose gain stands out, with its logarithm.
fn outstanding(gains: &Gains, least: f64, deviations: f64) -> Vec<([u8; 2], f64)> {
    let enough = gains.iter().filter(|(_, gains)| gains.len() >= LEAST_STEPS);
    let middles: Vec<_> = enough.map(|(pair, gains)| (*pair, median(gains.iter().copied()))).collect();
    let middle = median(middles.iter().map(|(_, gain)| *gain));
    let deviation = DEVIATION * median(middles.iter().map(|(_, gain)| (gain - middle).abs()));
    let limit = least.max(deviations * deviation);
    let is_throughout = |pair: &[u8; 2], gain: f64| {
        let gains = &gains[pair];
        let alike = gains.iter().filter(|it| (*it - middle) * gain > 0.0).count();
        alike as f64 >= MOSTLY * gains.len() as f64
    };
    let found: Vec<_> = middles
        .iter()
        .map(|&(pair, gain)| (pair, gain - middle))
        .filter(|(pair, gain)| gain.abs() > limit && gain.abs() < LARGEST.ln() && is_throughout(pair, *gain))
        .collect();
    if found.len() as f64 > MOST_PAIRS * middles.len() as f64 { Vec::new() } else { found }
}
