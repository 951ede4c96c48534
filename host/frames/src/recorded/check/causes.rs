//! What explains a frame that is unlike the model: order, numbering, wires, offset, or places in the frame.
//!
//! Each cause alone is tried on top of those already found, and the one that leaves the least is taken, the simplest
//! of those that leave as little. A cause that touches every step must leave much less; one that touches some must
//! explain most of what is unlike in them.

use super::{
    super::{
        diagnose::{LEAST_FIT, RESEMBLING},
        order::{Arrangement, OrderError, SenseOrder},
        read::sense_distance,
        statistics::median,
    },
    likeness::{Comparison, Likeness},
    reading::{Misplacement, Reading, Rows},
    wiring::{Exchange, Role},
};
use num_complex::Complex64;
use rayon::prelude::*;

/// Causes that are looked for.
const MOST_CAUSES: usize = 5;
/// A cause that touches every step leaves at most this share,
const LEAVES: f64 = 0.85;
/// and so much less.
const LESS: f64 = 0.005;
/// A cause that touches some steps leaves at most this share in the middle one of them,
const LEAVES_THERE: f64 = 0.5;
/// and so much less in each of them on average, and over all steps.
const LESS_THERE: f64 = 0.06;
const LESS_WITH_SOME: f64 = 0.002;
/// Steps that it must touch whose voltages are known; they must be explained too.
const LEAST_KNOWN: usize = 4;
/// What is left may differ by so much, and by this share, between explanations that are as good as each other.
const TIE: f64 = 0.004;
const TIE_SHARE: f64 = 0.03;
/// Electrodes that are tried against each other: those that fit worst.
const SUSPECTS: usize = 20;
/// Rows that are tried against each other.
const MOST_ROWS: usize = 64;
/// Places by which a frame may begin late.
const MOST_SHIFTS: usize = 2048;
/// Shares of the fitted offset that are tried.
const SHARES: [f64; 8] = [0.8, 0.9, 0.95, 0.98, 1.0, 1.05, 1.1, 1.2];
/// Share of the values that may turn their sign when an offset is taken out of values of one sign.
const MOST_TURNED: f64 = 0.05;
/// Of how far the middle step is from the model an offset leaves this share.
const MUCH_NEARER: f64 = 0.5;
/// A small offset leaves this share of what is missing to a straight line.
const STRAIGHTER: f64 = 0.9;
/// Shares of the median magnitude without it up to which an offset is small, and from which on it hides the logarithms.
const HALF: f64 = 0.5;
const LARGE_OFFSET: f64 = 1.5;
/// By how much an offset may lower the correlation.
const MOST_BENT: f64 = 0.06;
/// Error of the model that a fit of the offset expects, share of a voltage.
const MODEL_ERROR: f64 = 0.1;
/// Times the middle step's distance from which on steps count less than half.
const ROBUST: f64 = 2.0;
const ROUNDS: usize = 20;
/// Least offset that is one, as a share of the median magnitude without it.
const LEAST_OFFSET: f64 = 0.2;

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
    /// In every step and its class; it leaves at most this share.
    Bias(f64),
    /// In every step against others of its class.
    Scatter,
    /// In some steps against others of their class.
    Part,
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
        found.push(next);
    }
    Ok(found)
}

/// The candidate that leaves the least, if any explains enough.
fn best(comparison: &Comparison<'_>, last: &Explained) -> Option<Explained> {
    let good: Vec<_> = candidates(comparison, last)
        .into_par_iter()
        .filter_map(|candidate| good(comparison, last, candidate))
        .collect();
    let least = good.iter().map(|it| it.leaves).min_by(f64::total_cmp)?;
    let as_good = good.into_iter().filter(|it| ties(it.leaves * it.of, least * it.of));
    let simplest = as_good.min_by(|a, b| a.rank.cmp(&b.rank).then(a.leaves.total_cmp(&b.leaves)));
    simplest.map(|it| it.explained)
}

fn good(comparison: &Comparison<'_>, last: &Explained, candidate: Candidate) -> Option<Good> {
    let Candidate { reading, rank, shows } = candidate;
    let likeness = comparison.of(&reading).ok()?;
    let (before, after, is_enough) = match shows {
        Shows::Bias(share) => {
            let (before, after) = (last.likeness.cost(), likeness.cost());
            (before, after, after < share * before - LESS || share > 1.0)
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
    others && wires && reading.offset == last.offset && reading.misplaced.iter().all(is_told)
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
        before[*step] != after[*step]
            || last.reading.wiring.step(expected.steps[*step]) != reading.wiring.step(expected.steps[*step])
    };
    let touched: Vec<usize> = (0..expected.steps.len()).filter(touched).collect();
    let share = touched.len() as f64 / expected.steps.len() as f64;
    // Not to know a voltage explains nothing.
    let known = touched.iter().filter(|&&step| likeness.knows(step, &last.likeness));
    let known: Vec<usize> = known.copied().collect();
    let middle = |likeness: &Likeness, steps: &[usize]| {
        median(steps.iter().map(|&step| likeness.residuals[step].abs()))
    };
    let before = middle(&last.likeness, &touched);
    let explains = |steps: &[usize]| middle(likeness, steps) < LEAVES_THERE * before;
    less > LESS_THERE * share && explains(&touched) && known.len() >= LEAST_KNOWN && explains(&known)
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
    if reading.potentials.is_none() && reading.offset == Complex64::ZERO {
        if let Some((offset, leaves)) = offset(comparison, reading) {
            add(Reading { offset, ..reading.clone() }, SIMPLER, Shows::Bias(leaves));
        }
        if distance.is_some() {
            add(Reading { potentials: distance, ..reading.clone() }, SIMPLER, Shows::Bias(LEAVES));
        }
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
                add(Reading { potentials, ..transposed.clone() }, 2 * SIMPLER, Shows::Bias(LEAVES));
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

/// The offset with which the model's voltages explain the frame best, if it is large enough, and the share that must not
/// be left with it.
///
/// A body that is unlike the model, such as a tank that is deeper than its electrodes, makes the logarithms of voltages a
/// steeper or flatter line of the model's; an offset bends the line, so a small one must make it straighter. Logarithms of
/// values that a large offset makes alike say little: there it is enough that the middle step is much nearer to g m + c
/// than to g m.
fn offset(comparison: &Comparison<'_>, reading: &Reading) -> Option<(Complex64, f64)> {
    let (expected, reference) = (comparison.expected, comparison.reference);
    let places = reading.places(&expected.steps, expected.electrodes, reference.values.len()).ok()?;
    let values: Vec<Complex64> = places.iter().map(|&(place, _)| reference.values[place]).collect();
    let plain = comparison.of(reading).ok()?;
    let unknown = &plain.unknown;
    let model: Vec<f64> =
        expected.steps.iter().map(|&step| expected.voltage(reading.wiring.step(step))).collect();
    let magnitudes: Vec<f64> = model.iter().map(|m| m.abs()).collect();
    let has_signs = model.iter().any(|&m| m > 0.0) && model.iter().any(|&m| m < 0.0);
    let one_sign = !values.iter().any(|y| y.im != 0.0)
        && (values.iter().all(|y| y.re > 0.0) || values.iter().all(|y| y.re < 0.0));
    let mut best: Option<(f64, Complex64)> = None;
    for (model, has_signs) in [(&model, has_signs), (&magnitudes, false)] {
        let lines = [false, true].map(|offset| linear(&values, model, unknown, offset));
        let [Some((_, without)), Some((fitted, with))] = lines else { continue };
        for offset in SHARES.map(|share| real_if_nearly(fitted * share)) {
            let rest: Vec<Complex64> = values.iter().map(|y| y - offset).collect();
            let share = offset.norm() / median(rest.iter().map(|y| y.norm()));
            // Counts of a converter that all lie on one side of zero go on doing so, mostly.
            let turned = rest.iter().zip(&values).filter(|(rest, y)| (rest.re > 0.0) != (y.re > 0.0)).count();
            let is_turned = one_sign && !has_signs && turned as f64 > MOST_TURNED * values.len() as f64;
            if share < LEAST_OFFSET || is_turned {
                continue;
            }
            let Ok(likeness) = comparison.of(&Reading { offset, ..reading.clone() }) else { continue };
            let correlation = likeness.correlation();
            let is_straighter =
                correlation > RESEMBLING && 1.0 - correlation < STRAIGHTER * (1.0 - plain.correlation());
            let is_bent = correlation < plain.correlation() - MOST_BENT;
            let is_less = likeness.cost() < LEAVES * plain.cost() - LESS;
            let is_nearer =
                share > LARGE_OFFSET && with < MUCH_NEARER * without && likeness.cost() < plain.cost();
            let is_one = !is_bent && (is_nearer || is_less && (is_straighter || share > HALF));
            if is_one && best.is_none_or(|(least, _)| likeness.cost() < least) {
                best = Some((likeness.cost(), offset));
            }
        }
    }
    best.map(|(_, offset)| (offset, 1.0 + LESS))
}

fn real_if_nearly(offset: Complex64) -> Complex64 {
    if offset.im.abs() < 0.2 * offset.re.abs() { offset.re.into() } else { offset }
}

/// c of y = g m + c, or without one, and how far the middle step is from that.
///
/// Least squares, each step weighed by what the model does not know of it; steps that fit badly count less.
fn linear(values: &[Complex64], model: &[f64], unknown: &[f64], offset: bool) -> Option<(Complex64, f64)> {
    let weight = |(m, d): (&f64, &f64)| 1.0 / (d * d + (MODEL_ERROR * m).powi(2)).max(f64::MIN_POSITIVE);
    let first: Vec<f64> = model.iter().zip(unknown).map(weight).collect();
    let mut weights = first.clone();
    let mut found = None;
    for _ in 0..ROUNDS {
        let (mut s, mut sm, mut smm) = (0.0, 0.0, 0.0);
        let (mut sy, mut smy) = (Complex64::ZERO, Complex64::ZERO);
        for ((y, m), w) in values.iter().zip(model).zip(&weights) {
            (s, sm, smm) = (s + w, sm + w * m, smm + w * m * m);
            (sy, smy) = (sy + y * *w, smy + y * (w * m));
        }
        let (g, c) = if offset {
            let determinant = s * smm - sm * sm;
            ((smy * s - sy * sm) / determinant, (sy * smm - smy * sm) / determinant)
        } else {
            (smy / smm, Complex64::ZERO)
        };
        if !g.is_finite() || !c.is_finite() {
            return found;
        }
        let steps = values.iter().zip(model).zip(&first);
        let left: Vec<f64> = steps.map(|((y, m), w)| (y - g * m - c).norm() * w.sqrt()).collect();
        let middle = median(left.iter().copied());
        found = Some((c, middle));
        if middle == 0.0 {
            break;
        }
        let scale = ROBUST * middle;
        weights = first.iter().zip(&left).map(|(w, r)| w / (1.0 + (r / scale).powi(2))).collect();
    }
    found
}
