//! What explains a frame that is unlike the model: order, numbering, wires, offset, or places in the frame.
//!
//! Each cause alone is tried on top of those already found, and the one that leaves the least is taken, the simplest
//! of those that leave as little. A cause that touches every step must leave much less; one that touches some must
//! explain most of what is unlike in them.

use super::{
    super::{order::{Arrangement, OrderError, SenseOrder}, statistics::median},
    likeness::{Comparison, Likeness},
    numbering::{Exchange, Role},
    reading::{Misplacement, Reading, Rows},
};
use dermatome_shared::stimulation::Step;
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
/// What is left may differ by so much, and by this share, between explanations that are as good as each other.
const TIE: f64 = 0.004;
const TIE_SHARE: f64 = 0.03;
/// Electrodes that are tried against each other: those that fit worst.
const SUSPECTS: usize = 20;
/// Rows that are tried against each other.
const MOST_ROWS: usize = 64;
/// Places by which a frame may begin late.
const MOST_SHIFTS: usize = 2048;
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
    /// Whether it touches every step.
    is_global: bool,
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
    let tried = candidates(comparison, last);
    let explains = |candidate: Candidate| {
        let likeness = comparison.of(&candidate.reading).ok()?;
        let enough = if candidate.is_global {
            likeness.cost() < LEAVES * last.likeness.cost() - LESS
        } else {
            explains_some(comparison, last, &candidate.reading, &likeness)
        };
        enough.then_some((candidate.rank, Explained { reading: candidate.reading, likeness }))
    };
    let good: Vec<_> = tried.into_par_iter().filter_map(explains).collect();
    if std::env::var("DEBUG_CAUSES").is_ok() {
        let mut all: Vec<(f64, f64, bool, Reading)> = candidates(comparison, last).into_iter().filter_map(|c| { let l = comparison.of(&c.reading).ok()?; let (ok, b) = if c.is_global { (l.cost() < LEAVES * last.likeness.cost() - LESS, 0.0) } else { (explains_some(comparison, last, &c.reading, &l), 1.0) }; Some((l.cost(), b, ok, c.reading)) }).collect();
        all.sort_by(|a, b| a.0.total_cmp(&b.0));
        let mut text = format!("left {:.3} + {:.3}\n", last.likeness.scatter, last.likeness.bias);
        for (c, b, ok, r) in all.iter().take(4) { text += &format!("   {c:.3} {b} {ok} {:?} {:?} {:?} off {} pot {:?}\n", r.arrangement(), r.exchanged, r.misplaced, r.offset, r.potentials); }
        eprintln!("{text}");
    }
    let least = good.iter().map(|(_, it)| it.likeness.cost()).min_by(f64::total_cmp)?;
    let as_good = good.into_iter().filter(|(_, it)| ties(it.likeness.cost(), least));
    as_good.min_by(|a, b| a.0.cmp(&b.0).then(a.1.likeness.cost().total_cmp(&b.1.likeness.cost()))).map(|it| it.1)
}

/// Whether what is left is as little as the least.
pub(super) fn ties(cost: f64, least: f64) -> bool {
    cost <= least * (1.0 + TIE_SHARE) + TIE
}

/// Whether a cause explains most of what is unlike in the steps that it touches.
fn explains_some(comparison: &Comparison<'_>, last: &Explained, reading: &Reading, likeness: &Likeness) -> bool {
    let less = last.likeness.cost() - likeness.cost();
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
    let middle = |likeness: &Likeness| median(touched.iter().map(|&step| likeness.residuals[step].abs()));
    let share = touched.len() as f64 / expected.steps.len() as f64;
    less > LESS_THERE * share && middle(likeness) < LEAVES_THERE * middle(&last.likeness)
}

fn candidates(comparison: &Comparison<'_>, last: &Explained) -> Vec<Candidate> {
    let (expected, found) = (comparison.expected, comparison.reference.values.len());
    let (n, reading) = (usize::from(expected.electrodes), &last.reading);
    let rows = Rows::of(&expected.steps, n, found);
    let mut candidates = Vec::new();
    let mut global = |reading: Reading, rank: usize| candidates.push(Candidate { reading, rank, is_global: true });
    for arrangement in Arrangement::all(expected.electrodes) {
        let rank = changes(arrangement, reading.arrangement());
        if rank > 0 {
            global(reading.rearranged(arrangement, expected.electrodes), rank * SIMPLER);
        }
    }
    let is_square = found == n * n;
    let distance = sense_distance(&expected.steps, expected.electrodes).filter(|_| is_square);
    if reading.potentials.is_none() && reading.offset == Complex64::ZERO {
        if let Some(offset) = offset(comparison, reading) {
            global(Reading { offset, ..reading.clone() }, SIMPLER);
        }
        if distance.is_some() {
            global(Reading { potentials: distance, ..reading.clone() }, SIMPLER);
        }
    }
    let misplaced = |misplacement: Misplacement| reading.with_misplaced(misplacement);
    if is_square && !reading.misplaced.contains(&Misplacement::Transposed) {
        let transposed = misplaced(Misplacement::Transposed);
        global(transposed.clone(), SIMPLER);
        for sense in [SenseOrder::Absolute, SenseOrder::Relative] {
            let arrangement = Arrangement { sense, ..reading.arrangement() };
            let potentials = distance.filter(|_| reading.offset == Complex64::ZERO);
            if sense != reading.arrangement().sense {
                global(transposed.rearranged(arrangement, expected.electrodes), 2 * SIMPLER);
            } else if potentials.is_some() && reading.potentials.is_none() {
                global(Reading { potentials, ..transposed.clone() }, 2 * SIMPLER);
            }
        }
    }
    let is_shifted = |it: &Misplacement| matches!(it, Misplacement::Shifted(_) | Misplacement::ColumnsShifted(_));
    if found <= MOST_SHIFTS && !reading.misplaced.iter().any(is_shifted) {
        (1..found).for_each(|by| global(misplaced(Misplacement::Shifted(by)), 3 * SIMPLER + by.min(found - by)));
        if is_square {
            (1..n).for_each(|by| global(misplaced(Misplacement::ColumnsShifted(by)), 2 * SIMPLER + by.min(n - by)));
        }
    }
    let mut local = |reading: Reading, rank: usize| candidates.push(Candidate { reading, rank, is_global: false });
    if rows.common_length().is_some() && rows.count() <= MOST_ROWS {
        for (a, b) in pairs(rows.count()) {
            local(misplaced(Misplacement::Rows([a, b])), 3 * SIMPLER);
            if is_square {
                local(misplaced(Misplacement::Columns([a, b])), 3 * SIMPLER);
            }
        }
    }
    let suspects = suspects(comparison, last);
    for (i, j) in pairs(suspects.len()) {
        let [a, b] = [suspects[i], suspects[j]];
        for role in [Role::Both, Role::Drive, Role::Sense] {
            local(reading.with_exchange(Exchange { electrodes: [a.min(b), a.max(b)], role }), 2 * SIMPLER);
        }
    }
    candidates
}

fn pairs(count: usize) -> impl Iterator<Item = (usize, usize)> {
    (0..count).flat_map(|b| (0..b).map(move |a| (a, b)))
}

fn changes(a: Arrangement, b: Arrangement) -> usize {
    [a.sense != b.sense, a.rotation != b.rotation, a.mirrored != b.mirrored].iter().filter(|&&set| set).count()
}

/// Electrodes from the plus to the minus input, where it is the same in all steps.
fn sense_distance(steps: &[Step], electrodes: u8) -> Option<usize> {
    let n = u16::from(electrodes);
    let distance = |step: &Step| (u16::from(step.sense_minus) + n - u16::from(step.sense_plus)) % n;
    let first = distance(steps.first()?);
    steps.iter().all(|step| distance(step) == first).then_some(usize::from(first))
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

/// The offset with which the model's voltages explain the frame best, if it is large enough.
///
/// Least squares of y = g m + c, each step weighed by what the model does not know of it; steps that fit badly count
/// less.
fn offset(comparison: &Comparison<'_>, reading: &Reading) -> Option<Complex64> {
    let (expected, reference) = (comparison.expected, comparison.reference);
    let places = reading.places(&expected.steps, expected.electrodes, reference.values.len()).ok()?;
    let values: Vec<Complex64> = places.iter().map(|&(place, _)| reference.values[place]).collect();
    let likeness = comparison.of(reading).ok()?;
    let model: Vec<f64> = expected.steps.iter().map(|&step| expected.voltage(reading.wiring.step(step))).collect();
    let all_of_one_sign = values.iter().all(|y| y.re > 0.0 && y.im == 0.0) || values.iter().all(|y| y.re < 0.0 && y.im == 0.0);
    let signed = linear(&values, &model, &likeness.unknown);
    let magnitudes: Vec<f64> = model.iter().map(|m| m.abs()).collect();
    let unsigned = linear(&values, &magnitudes, &likeness.unknown);
    let mut best: Option<(f64, Complex64)> = None;
    let model_has_signs = model.iter().any(|&m| m > 0.0) && model.iter().any(|&m| m < 0.0);
    let fits = [(signed, model_has_signs), (unsigned, false)];
    for (fitted, is_signed) in fits.into_iter().filter_map(|(fitted, is_signed)| Some((fitted?, is_signed))) {
        for share in [0.8, 0.9, 0.95, 1.0, 1.05, 1.1, 1.2] {
            let offset = real_if_nearly(fitted * share);
            let rest: Vec<Complex64> = values.iter().map(|y| y - offset).collect();
            let size = median(rest.iter().map(|y| y.norm()));
            // Counts of a converter that all lie above their zero go on doing so.
            let stays = rest.iter().zip(&values).filter(|(rest, y)| (rest.re > 0.0) == (y.re > 0.0)).count();
            if offset.norm() < LEAST_OFFSET * size || (all_of_one_sign && !is_signed && stays * 100 < 95 * values.len()) {
                continue;
            }
            let Ok(likeness) = comparison.of(&Reading { offset, ..reading.clone() }) else { continue };
            if best.is_none_or(|(cost, _)| likeness.cost() < cost) {
                best = Some((likeness.cost(), offset));
            }
        }
    }
    best.map(|(_, offset)| offset)
}

fn real_if_nearly(offset: Complex64) -> Complex64 {
    if offset.im.abs() < 0.2 * offset.re.abs() { offset.re.into() } else { offset }
}

/// c of y = g m + c.
fn linear(values: &[Complex64], model: &[f64], unknown: &[f64]) -> Option<Complex64> {
    let mut weights: Vec<f64> =
        model.iter().zip(unknown).map(|(m, d)| 1.0 / (d * d + (0.1 * m).powi(2)).max(f64::MIN_POSITIVE)).collect();
    let first = weights.clone();
    let mut found = None;
    for _ in 0..20 {
        let (mut s, mut sm, mut smm) = (0.0, 0.0, 0.0);
        let (mut sy, mut smy) = (Complex64::ZERO, Complex64::ZERO);
        for ((y, m), w) in values.iter().zip(model).zip(&weights) {
            (s, sm, smm) = (s + w, sm + w * m, smm + w * m * m);
            (sy, smy) = (sy + y * *w, smy + y * (w * m));
        }
        let determinant = s * smm - sm * sm;
        let g = (smy * s - sy * sm) / determinant;
        let c = (sy * smm - smy * sm) / determinant;
        if !g.is_finite() || !c.is_finite() {
            return found;
        }
        found = Some(c);
        let left: Vec<f64> = values.iter().zip(model).zip(&first).map(|((y, m), w)| (y - g * m - c).norm() * w.sqrt()).collect();
        let scale = 2.0 * median(left.iter().copied());
        if scale == 0.0 {
            break;
        }
        weights = first.iter().zip(&left).map(|(w, r)| w / (1.0 + (r / scale).powi(2))).collect();
    }
    found
}
