//! What explains a frame that is unlike the model: order, numbering, wires, offset, or places in the frame.
//!
//! Each cause alone is tried on top of those already found, and the one that leaves the least is taken, the simplest
//! of those that leave as little. A cause that touches every step must leave much less; one that touches some must
//! explain most of what is unlike in them.

use super::{
    super::{
        diagnose::LEAST_FIT,
        order::{Arrangement, OrderError, SenseOrder},
        read::sense_distance,
        statistics::median,
    },
    channels::{self, Channels},
    likeness::{Comparison, Likeness},
    offset::{self, LEAVES, LESS},
    reading::{Misplacement, Place, Reading, Rows},
    wiring::{Exchange, Role},
};
use num_complex::Complex64;
use rayon::prelude::*;

/// Causes that are looked for.
const MOST_CAUSES: usize = 7;
/// A cause that touches some steps leaves at most this share in the middle one of them,
const LEAVES_THERE: f64 = 0.5;
/// and so much less in each of them on average, and over all steps.
const LESS_THERE: f64 = 0.06;
const LESS_WITH_SOME: f64 = 0.002;
/// What is left may differ by so much, and by this share, between explanations that are as good as each other.
const TIE: f64 = 0.004;
const TIE_SHARE: f64 = 0.03;
/// Lines are as straight as each other up to this factor.
const LINE_TIE: f64 = 1.05;
/// Electrodes that are tried against each other: those that fit worst.
const SUSPECTS: usize = 20;
/// Rows that are tried against each other.
const MOST_ROWS: usize = 64;
/// Places by which a frame may begin late.
const MOST_SHIFTS: usize = 2048;

/// Step of the rank between explanations of which one is simpler.
const SIMPLER: usize = 10_000;

/// A way to read the frame, and how like the model it is then.
#[derive(Clone, Debug)]
pub(super) struct Explained {
    pub(super) reading: Reading,
    pub(super) likeness: Likeness,
}

/// A cause, by how simple it is: the lower the simpler.
struct Candidate {
    reading: Reading,
    rank: usize,
    shows: Shows,
}

/// Where a cause shows.
#[derive(Clone, Copy)]
enum Shows {
    /// In every step and its class.
    Bias,
    /// The same, as an offset that was found.
    Offset,
    /// In every step against others of its class.
    Scatter,
    /// In some steps against others of their class.
    Part,
    /// In steps with drive and sense exchanged, of whose errors it leaves this share.
    Reciprocity(f64),
}

/// A candidate that explains enough, with what it leaves as a share of what was left.
struct Good {
    leaves: f64,
    /// What was left.
    of: f64,
    rank: usize,
    explained: Explained,
}

/// Finds the causes, one after the other: the reading without any, and after each.
pub(super) fn find(comparison: &Comparison<'_>, used: Arrangement) -> Result<Vec<Explained>, OrderError> {
    let electrodes = comparison.expected.electrodes;
    let reading = Reading::new(used, electrodes);
    let likeness = comparison.of(&reading)?;
    let mut found = vec![Explained { reading, likeness }];
    for _ in 0..MOST_CAUSES {
        let last = &found[found.len() - 1];
        let Some(next) = best(comparison, last) else { break };
        found.push(refined(comparison, next));
    }
    Ok(found)
}

/// With what was found of the instrument before fitted anew.
fn refined(comparison: &Comparison<'_>, explained: Explained) -> Explained {
    let reading = instrument_again(comparison, explained.reading.clone());
    match comparison.of(&reading) {
        Ok(likeness) => Explained { reading, likeness },
        Err(_) => explained,
    }
}

fn instrument_again(comparison: &Comparison<'_>, reading: Reading) -> Reading {
    if reading.channels == Channels::default() {
        return reading;
    }
    let reading = channels::again(comparison, &reading).unwrap_or(reading);
    offset::again(comparison, &reading).unwrap_or(reading)
}

/// The candidate that leaves the least, if any explains enough.
fn best(comparison: &Comparison<'_>, last: &Explained) -> Option<Explained> {
    let candidates = candidates(comparison, last);
    if let Some(reading) = hidden_by_offset(comparison, last, &candidates) {
        let likeness = comparison.of(&reading).ok()?;
        return Some(Explained { reading, likeness });
    }
    // Values that begin one late hold all of the one before: channels are for what nothing else explains.
    let (of_channels, others): (Vec<_>, Vec<_>) =
        candidates.into_iter().partition(|it| matches!(it.shows, Shows::Reciprocity(_)));
    least_of(comparison, last, others).or_else(|| least_of(comparison, last, of_channels))
}

fn least_of(comparison: &Comparison<'_>, last: &Explained, candidates: Vec<Candidate>) -> Option<Explained> {
    let good: Vec<_> =
        candidates.into_par_iter().filter_map(|candidate| good(comparison, last, candidate)).collect();
    let least = good.iter().map(|it| it.leaves).min_by(f64::total_cmp)?;
    let as_good = good.into_iter().filter(|it| ties(it.leaves * it.of, least * it.of));
    let simplest = as_good.min_by(|a, b| a.rank.cmp(&b.rank).then(a.leaves.total_cmp(&b.leaves)));
    simplest.map(|it| it.explained)
}

/// The order in which a frame is a straight line of the model's voltages with a large offset, which hides all else: with
/// it the logarithms of all values are alike.
fn hidden_by_offset(
    comparison: &Comparison<'_>,
    last: &Explained,
    candidates: &[Candidate],
) -> Option<Reading> {
    if !may_hold_offset(&last.reading) {
        return None;
    }
    let is_order = |it: &&Candidate| matches!(it.shows, Shows::Scatter | Shows::Bias);
    let orders = candidates.iter().filter(is_order).map(|it| (&it.reading, it.rank));
    let orders: Vec<_> = std::iter::once((&last.reading, 0)).chain(orders).collect();
    let lines: Vec<_> = orders
        .into_par_iter()
        .filter_map(|(reading, rank)| Some((reading, rank, offset::line(comparison, reading)?)))
        .collect();
    let holds_offset = lines.first().is_some_and(|(_, rank, line)| *rank == 0 && line.hides());
    let least = lines.iter().map(|(_, _, line)| line.mean).min_by(f64::total_cmp)?;
    let as_good = lines.into_iter().filter(|(_, _, line)| line.mean <= LINE_TIE * least);
    let (reading, _, line) = as_good.min_by(|a, b| a.1.cmp(&b.1).then(a.2.mean.total_cmp(&b.2.mean)))?;
    if line.hides() {
        offset::large(comparison, reading)
    } else {
        // Differences of potentials do not hold it.
        (holds_offset && reading.potentials.is_some()).then(|| reading.clone())
    }
}

fn may_hold_offset(reading: &Reading) -> bool {
    reading.potentials.is_none() && reading.offset == Complex64::ZERO
}

fn good(comparison: &Comparison<'_>, last: &Explained, candidate: Candidate) -> Option<Good> {
    let Candidate { mut reading, rank, shows } = candidate;
    if matches!(shows, Shows::Scatter | Shows::Part) {
        reading = instrument_again(comparison, reading);
    }
    let likeness = comparison.of(&reading).ok()?;
    let (before, after, is_enough) = match shows {
        Shows::Bias | Shows::Offset => {
            let (before, after) = (last.likeness.cost(), likeness.cost());
            let is_offset = matches!(shows, Shows::Offset);
            (before, after, is_offset || after < LEAVES * before - LESS)
        }
        Shows::Reciprocity(leaves) => {
            let before = last.likeness.cost();
            (before, leaves * before, reading.channels.are_worth_a_word(&likeness))
        }
        Shows::Scatter => {
            let (before, after) = (last.likeness.disorder(), likeness.disorder());
            let (all_before, all_after) = (last.likeness.cost(), likeness.cost());
            let is_less = |after: f64, before: f64| after < LEAVES * before - LESS;
            let neither_is_more = after <= before && all_after <= all_before;
            (before, after, is_less(after, before) || (neither_is_more && is_less(all_after, all_before)))
        }
        Shows::Part => {
            let (before, after) = (last.likeness.disorder(), likeness.disorder());
            (before, after, explains_some(comparison, last, &reading, &likeness))
        }
    };
    // Where nothing fits the model only the order and whole rows may be told, from what steps have in common.
    let fits = likeness.correlation() >= LEAST_FIT;
    if !is_enough || !(fits || is_of_order(last, &reading)) {
        return None;
    }
    let explained = Explained { reading, likeness };
    Some(Good { leaves: after / before, of: before, rank, explained })
}

/// Whether a reading has another order of the sense pairs, or rows in other places, and all else is the same.
fn is_of_order(last: &Explained, reading: &Reading) -> bool {
    let is_told = |it: &Misplacement| matches!(it, Misplacement::Rows(_) | Misplacement::Transposed);
    let last = &last.reading;
    let others =
        Arrangement { sense: last.arrangement().sense, ..reading.arrangement() } == last.arrangement();
    let wires = reading.exchanged == last.exchanged && reading.potentials == last.potentials;
    let instrument = reading.offset == last.offset && reading.channels == last.channels;
    others && wires && instrument && reading.misplaced.iter().all(is_told)
}

/// Whether what is left is as little as the least.
pub(super) fn ties(cost: f64, least: f64) -> bool {
    cost <= least * (1.0 + TIE_SHARE) + TIE
}

/// Whether a cause explains most of what is unlike in the steps that it touches.
fn explains_some(
    comparison: &Comparison<'_>,
    last: &Explained,
    reading: &Reading,
    likeness: &Likeness,
) -> bool {
    let less = last.likeness.disorder() - likeness.disorder();
    if less < LESS_WITH_SOME {
        return false;
    }
    let (expected, found) = (comparison.expected, comparison.reference.values.len());
    let places = |reading: &Reading| reading.places(&expected.steps, expected.electrodes, found);
    let (Ok(before), Ok(after)) = (places(&last.reading), places(reading)) else { return false };
    let touched = |step: &usize| {
        let value = |(place, other): (Place, Option<Place>)| (place.value, other.map(|other| other.value));
        value(before[*step]) != value(after[*step])
            || last.reading.wiring.step(expected.steps[*step]) != reading.wiring.step(expected.steps[*step])
    };
    let touched: Vec<usize> = (0..expected.steps.len()).filter(touched).collect();
    let middle = |likeness: &Likeness| median(touched.iter().map(|&step| likeness.residuals[step].abs()));
    let share = touched.len() as f64 / expected.steps.len() as f64;
    less > LESS_THERE * share && middle(likeness) < LEAVES_THERE * middle(&last.likeness)
}

fn candidates(comparison: &Comparison<'_>, last: &Explained) -> Vec<Candidate> {
    let (expected, found) = (comparison.expected, comparison.reference.values.len());
    let (n, reading) = (usize::from(expected.electrodes), &last.reading);
    let rows = Rows::of(&expected.steps, n, found);
    let mut candidates = Vec::new();
    let mut add =
        |reading: Reading, rank: usize, shows: Shows| candidates.push(Candidate { reading, rank, shows });
    for arrangement in Arrangement::all(expected.electrodes) {
        let rank = changes(arrangement, reading.arrangement());
        if rank > 0 {
            add(reading.rearranged(arrangement, expected.electrodes), rank * SIMPLER, Shows::Scatter);
        }
    }
    let is_square = found == n * n;
    let distance = sense_distance(&expected.steps, expected.electrodes).filter(|_| is_square);
    if may_hold_offset(reading) {
        if let Some(with_offset) = offset::found(comparison, reading) {
            add(with_offset, SIMPLER, Shows::Offset);
        }
        if distance.is_some() {
            add(Reading { potentials: distance, ..reading.clone() }, SIMPLER, Shows::Bias);
        }
    }
    for (found, leaves) in channels::found(comparison, reading) {
        let reading = offset::again(comparison, &found).unwrap_or(found);
        add(reading, 2 * SIMPLER, Shows::Reciprocity(leaves));
    }
    let misplaced = |misplacement: Misplacement| reading.with_misplaced(misplacement);
    if is_square && !reading.misplaced.contains(&Misplacement::Transposed) {
        let transposed = misplaced(Misplacement::Transposed);
        add(transposed.clone(), SIMPLER, Shows::Scatter);
        for sense in [SenseOrder::Absolute, SenseOrder::Relative] {
            let arrangement = Arrangement { sense, ..reading.arrangement() };
            let potentials = distance.filter(|_| reading.offset == Complex64::ZERO);
            if sense != reading.arrangement().sense {
                add(transposed.rearranged(arrangement, expected.electrodes), 2 * SIMPLER, Shows::Scatter);
            } else if potentials.is_some() && reading.potentials.is_none() {
                add(Reading { potentials, ..transposed.clone() }, 2 * SIMPLER, Shows::Bias);
            }
        }
    }
    let is_shifted =
        |it: &Misplacement| matches!(it, Misplacement::Shifted(_) | Misplacement::ColumnsShifted(_));
    if found <= MOST_SHIFTS && !reading.misplaced.iter().any(is_shifted) {
        for by in 1..found {
            add(misplaced(Misplacement::Shifted(by)), 3 * SIMPLER + by.min(found - by), Shows::Scatter);
        }
        if is_square {
            for by in 1..n {
                add(
                    misplaced(Misplacement::ColumnsShifted(by)),
                    3 * SIMPLER + by.min(n - by),
                    Shows::Scatter,
                );
            }
        }
    }
    let mut add_some = |reading: Reading, rank: usize| add(reading, rank * SIMPLER, Shows::Part);
    if rows.common_length().is_some() && rows.count() <= MOST_ROWS {
        for (a, b) in pairs(rows.count()) {
            add_some(misplaced(Misplacement::Rows([a, b])), 3);
            // Columns of potentials are electrodes: those in each other's place are exchanged wires.
            if is_square && reading.potentials.is_none() {
                add_some(misplaced(Misplacement::Columns([a, b])), 3);
            }
        }
    }
    let suspects = suspects(comparison, last);
    for (i, j) in pairs(suspects.len()) {
        let [a, b] = [suspects[i], suspects[j]];
        for role in [Role::Both, Role::Drive, Role::Sense] {
            add_some(reading.with_exchange(Exchange { electrodes: [a.min(b), a.max(b)], role }), 2);
        }
    }
    candidates
}

fn pairs(count: usize) -> impl Iterator<Item = (usize, usize)> {
    (0..count).flat_map(|b| (0..b).map(move |a| (a, b)))
}

fn changes(a: Arrangement, b: Arrangement) -> usize {
    [a.sense != b.sense, a.rotation != b.rotation, a.mirrored != b.mirrored]
        .iter()
        .filter(|&&set| set)
        .count()
}

/// Electrodes whose steps fit worst.
fn suspects(comparison: &Comparison<'_>, last: &Explained) -> Vec<u8> {
    let expected = comparison.expected;
    let mut sums = vec![(0.0, 0_u32); usize::from(expected.electrodes)];
    for (step, residual) in expected.steps.iter().zip(&last.likeness.residuals) {
        for electrode in step.to_bytes() {
            let (sum, count) = &mut sums[usize::from(electrode)];
            *sum += residual.abs();
            *count += 1;
        }
    }
    let mean = |electrode: &u8| {
        let (sum, count) = sums[usize::from(*electrode)];
        sum / f64::from(count.max(1))
    };
    let mut electrodes: Vec<u8> = (0..expected.electrodes).collect();
    electrodes.sort_by(|a, b| mean(b).total_cmp(&mean(a)));
    electrodes.truncate(SUSPECTS);
    electrodes
}
