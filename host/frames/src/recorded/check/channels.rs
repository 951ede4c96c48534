//! What each channel of an instrument adds to its values: an offset of its own, and a share of the value before.
//!
//! A multiplexer or converter that is read before it has settled holds, for the value x of a step and the y that was
//! measured before it,
//!
//! ```text
//! y_k = (1 - r) x_k + r y_(k-1)        x = v + c_pair
//! ```
//!
//! Steps with drive and sense exchanged have the same v, up to its sign s, on any linear body. So
//!
//! ```text
//! y_ab - s y_ba = (1 - r) (c_b - s c_a) + r (y_(ab-1) - s y_(ba-1))
//! ```
//!
//! tells how far apart the offsets are, and r, without a model of the body: 104 equations for 17 numbers on 16
//! electrodes. Only of real frames, and of tables whose pairs both drive and sense.

use super::{
    super::{order::SenseOrder, statistics::median},
    Expected, gain,
    likeness::{Comparison, Likeness},
    reading::{Place, Reading},
};
use dermatome_model::stimulation::{Repetition, pairs_alike, repetition};
use nalgebra::{DMatrix, DVector};
use num_complex::Complex64;
use serde::Serialize;
use std::collections::BTreeMap;

/// Of the reciprocity error one of the two leaves this share at most, and both together this one.
const LEAVES: f64 = 0.7;
const LEAVES_OF_BOTH: f64 = 0.5;
/// Least offsets that are worth a word: their standard deviation as a share of the median magnitude without them.
const LEAST_APART: f64 = 0.08;
/// Least share of the value before, and the largest one.
const LEAST_KEPT: f64 = 0.03;
const MOST_KEPT: f64 = 0.7;
/// Equations for each number that is sought.
const LEAST_EQUATIONS: usize = 3;
/// Errors of the rest of the instrument: a share of a voltage, and of the middle one.
const ERROR: f64 = 0.1;
const FLOOR: f64 = 0.3;
/// And of a pair's line, for whose slope the large voltages count.
const FLOOR_OF_LINES: f64 = 2.0;
/// Times the middle error from which on an equation counts less than half.
const ROBUST: f64 = 2.0;
const ROUNDS: usize = 20;
/// Keeps what the equations do not tell at zero.
const RIDGE: f64 = 1e-9;
/// From a normal distribution's median magnitude to its standard deviation.
const DEVIATION: f64 = 1.4826;

/// A sense pair whose values hold an offset.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct ChannelOffset {
    /// Its electrodes, plus and minus, by the file's numbers from 0.
    pub electrodes: [u8; 2],
    /// The offset, in the file's unit.
    pub value: f64,
}

/// What the channels add.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Channels {
    /// By how much the offset of each sense pair differs from their mean.
    apart: BTreeMap<[u8; 2], f64>,
    /// Share of the value before that each value holds.
    pub(super) kept: f64,
    /// Order in which the sense pairs of a drive were measured, whatever the order in which they are stored.
    pub(super) scan: SenseOrder,
    /// Logarithm of by how much more each pair reads than it drives, a straight line with another offset.
    pub(super) gains: BTreeMap<[u8; 2], f64>,
    /// Standard deviation of what is left of the small reciprocal differences.
    error: f64,
}

impl Channels {
    /// What a step would have read, had it settled.
    pub(super) fn settled(&self, place: Place, values: &[Complex64]) -> Complex64 {
        (values[place.value] - self.kept * values[place.before]) / (1.0 - self.kept)
    }

    /// Offset of a sense pair against the others'.
    pub(super) fn apart(&self, pair: [u8; 2]) -> f64 {
        self.apart.get(&pair).copied().unwrap_or_default()
    }

    /// To what the offsets are known, if each pair's was found.
    pub(super) fn error(&self) -> Option<f64> {
        self.differ().then_some(self.error)
    }

    /// Whether the offsets differ from pair to pair.
    pub(super) fn differ(&self) -> bool {
        !self.apart.is_empty()
    }

    /// The offsets with what they have in common.
    pub(super) fn offsets(&self, common: f64) -> Vec<ChannelOffset> {
        let offset =
            |(&electrodes, apart): (&[u8; 2], &f64)| ChannelOffset { electrodes, value: common + apart };
        self.apart.iter().map(offset).collect()
    }

    /// Standard deviation of the offsets.
    fn spread(&self) -> f64 {
        let squares: f64 = self.apart.values().map(|apart| apart * apart).sum();
        (squares / self.apart.len().max(1) as f64).sqrt()
    }

    /// Whether what was found is large enough beside the voltages.
    pub(super) fn are_worth_a_word(&self, likeness: &Likeness) -> bool {
        let middle = median(likeness.measured.iter().map(|value| value.abs())) * likeness.gain;
        let kept = self.kept == 0.0 || (LEAST_KEPT..MOST_KEPT).contains(&self.kept);
        kept && (self.apart.is_empty() || self.spread() > LEAST_APART * middle)
    }
}

/// Readings with what the channels add, and the share of the reciprocity error that each leaves of what `reading` has.
///
/// Rows that begin at the driven pair may have been turned so after they were measured by the pairs' numbers.
pub(super) fn found(comparison: &Comparison<'_>, reading: &Reading) -> Vec<(Reading, f64)> {
    let mut found = found_as_scanned(comparison, reading);
    if reading.arrangement().sense == SenseOrder::Relative && reading.channels.kept == 0.0 {
        let channels = Channels { scan: SenseOrder::Relative, ..reading.channels.clone() };
        found.extend(found_as_scanned(comparison, &Reading { channels, ..reading.clone() }));
    }
    found
}

fn found_as_scanned(comparison: &Comparison<'_>, reading: &Reading) -> Vec<(Reading, f64)> {
    let Some(equations) = Equations::of(comparison, reading) else { return Vec::new() };
    let now = equations.error(reading);
    let fit = |apart: bool, kept: bool| {
        equations.solve(apart, kept).map(|(channels, error)| (channels, error / now))
    };
    let (has_apart, keeps) = (reading.channels.differ(), reading.channels.kept > 0.0);
    let apart = fit(true, keeps).filter(|_| !has_apart);
    let kept = fit(has_apart, true).filter(|_| !keeps);
    let alone = [&apart, &kept].into_iter().flatten().map(|(_, leaves)| *leaves).fold(1.0, f64::min);
    let both = fit(true, true)
        .filter(|(_, leaves)| !has_apart && !keeps && *leaves < LEAVES_OF_BOTH.min(LEAVES * alone));
    let alone = [apart, kept].into_iter().flatten().filter(|(_, leaves)| *leaves < LEAVES);
    let with = |(channels, leaves)| (Reading { channels, ..reading.clone() }, leaves);
    alone.chain(both).map(with).collect()
}

/// The same with channels fitted anew, if any were found.
pub(super) fn again(comparison: &Comparison<'_>, reading: &Reading) -> Option<Reading> {
    let (apart, kept) = (reading.channels.differ(), reading.channels.kept > 0.0);
    let equations = Equations::of(comparison, reading).filter(|_| apart || kept)?;
    let kept = kept && equations.solve(apart, true)?.0.kept >= LEAST_KEPT;
    let (mut channels, _) = equations.solve(apart, kept)?;
    if apart {
        equations.straighten(&mut channels, reading.offset.re);
    }
    Some(Reading { channels, ..reading.clone() })
}

/// What the pairs of steps say that have drive and sense exchanged.
struct Equations {
    scan: SenseOrder,
    /// Sense pairs of the steps.
    pairs: Vec<[u8; 2]>,
    rows: Vec<Equation>,
    /// What is added to scales where slopes are sought.
    floor: f64,
}

struct Equation {
    /// y_ab and y_ba,
    values: [f64; 2],
    /// and the values before.
    before: [f64; 2],
    /// Which pair's offset is in each.
    pairs: [usize; 2],
    sign: f64,
    /// Standard deviation of its other errors, relative to those of other equations.
    scale: f64,
}

impl Equation {
    /// y_ab - s y_ba.
    fn difference(&self) -> f64 {
        self.values[0] - self.sign * self.values[1]
    }

    /// The same of the values before.
    fn before(&self) -> f64 {
        self.before[0] - self.sign * self.before[1]
    }
}

impl Equations {
    /// Of real frames; `None` if they are too few.
    fn of(comparison: &Comparison<'_>, reading: &Reading) -> Option<Self> {
        let (expected, reference) = (comparison.expected, comparison.reference);
        let places = reading.places(&expected.steps, expected.electrodes, reference.values.len()).ok()?;
        let value = |place: usize| reference.values[place].re;
        let of = |step: usize, place: fn(Place) -> usize| {
            let (one, other) = places[step];
            value(place(one)) - other.map_or(0.0, |other| value(place(other)))
        };
        let (pairs, pair_of) = sense_pairs(expected);
        let wired: Vec<_> = expected.steps.iter().map(|&step| reading.wiring.step(step)).collect();
        let size = |step: usize| expected.voltage(wired[step]).abs();
        let middle = median((0..wired.len()).map(size));
        let is_known = |step: usize| !wired[step].senses_driven() || wired[step] == expected.steps[step];
        let rows: Vec<Equation> = pairs_alike(&wired)
            .filter(|&(a, b, _)| repetition(wired[a], wired[b]) == Repetition::Reciprocal)
            .filter(|&(a, b, _)| is_known(a) && is_known(b))
            .map(|(a, b, flipped)| {
                let sign = if flipped { -1.0 } else { 1.0 };
                Equation {
                    values: [a, b].map(|step| of(step, |place| place.value)),
                    before: [a, b].map(|step| of(step, |place| place.before)),
                    pairs: [pair_of[a], pair_of[b]],
                    sign,
                    scale: ERROR * (size(a).max(size(b)) + FLOOR * middle),
                }
            })
            .collect();
        let is_real = reference.values.iter().all(|value| value.im == 0.0);
        let enough = rows.len() >= LEAST_EQUATIONS * (pairs.len() + 1);
        (is_real && enough).then_some(Self {
            scan: reading.channels.scan,
            pairs,
            rows,
            floor: ERROR * FLOOR_OF_LINES * middle,
        })
    }

    /// Middle reciprocity error as a frame is read.
    fn error(&self, reading: &Reading) -> f64 {
        let kept = reading.channels.kept;
        let offset = |pair: usize| (1.0 - kept) * reading.channels.apart(self.pairs[pair]);
        let left = |row: &Equation| {
            let [added, subtracted] = row.pairs;
            let common = (1.0 - kept) * (1.0 - row.sign) * reading.offset.re;
            let offsets = offset(added) - row.sign * offset(subtracted) + common;
            (row.difference() - kept * row.before() - offsets).abs() / row.scale
        };
        median(self.rows.iter().map(left)).max(f64::MIN_POSITIVE) / (1.0 - kept)
    }

    /// Offsets, what is kept, or both, and the middle error with them, made larger by what so many numbers would explain
    /// of noise.
    ///
    /// Least squares; equations that are fulfilled badly count less.
    fn solve(&self, apart: bool, kept: bool) -> Option<(Channels, f64)> {
        // Without offsets of their own all pairs share one, which only steps with opposite signs tell.
        let offsets = if apart { self.pairs.len() } else { 1 };
        let column = |pair: usize| if apart { pair } else { 0 };
        let (m, n) = (self.rows.len(), offsets + usize::from(kept));
        let mut matrix = DMatrix::<f64>::zeros(m, n);
        for (row, equation) in self.rows.iter().enumerate() {
            let [added, subtracted] = equation.pairs.map(column);
            matrix[(row, added)] += 1.0 / equation.scale;
            matrix[(row, subtracted)] -= equation.sign / equation.scale;
            if kept {
                matrix[(row, offsets)] = equation.before() / equation.scale;
            }
        }
        let right = DVector::from_iterator(m, self.rows.iter().map(|row| row.difference() / row.scale));
        let mut weights = DVector::from_element(m, 1.0);
        let mut found = DVector::zeros(n);
        let mut left = right.clone();
        for _ in 0..ROUNDS {
            let weighted = DMatrix::from_fn(m, n, |row, column| weights[row] * matrix[(row, column)]);
            let mut normal = weighted.tr_mul(&matrix);
            for column in 0..n {
                normal[(column, column)] += RIDGE * normal[(column, column)].max(f64::MIN_POSITIVE);
            }
            found = normal.cholesky()?.solve(&weighted.tr_mul(&right));
            left = &right - &matrix * &found;
            let scale = (ROBUST * median(left.iter().map(|left| left.abs()))).max(f64::MIN_POSITIVE);
            weights = left.map(|left| 1.0 / (1.0 + (left / scale).powi(2)));
        }
        let share = if kept { found[offsets] } else { 0.0 };
        if !(share.is_finite() && found.iter().all(|it| it.is_finite()) && (0.0..MOST_KEPT).contains(&share))
        {
            return None;
        }
        let all = found.rows(0, offsets).map(|offset| offset / (1.0 - share));
        let apart = if apart { all.add_scalar(-all.mean()) } else { DVector::zeros(0) };
        let free = (m as f64 / (m - n) as f64).sqrt();
        let channels = Channels {
            apart: self.pairs.iter().copied().zip(apart.iter().copied()).collect(),
            kept: share,
            scan: self.scan,
            gains: BTreeMap::new(),
            error: free * self.deviation(&left) / (1.0 - share),
        };
        let error = median(left.iter().map(|left| left.abs())) * free / (1.0 - share);
        Some((channels, error))
    }

    /// Compares what each pair reads with what the others read when it drives, as a straight line: its slope is a gain, or
    /// a pair the other way round, which would pass as an offset otherwise. Offsets of pairs whose slope stands out are
    /// those of the lines.
    fn straighten(&self, channels: &mut Channels, common: f64) {
        let lines = (0..self.pairs.len()).filter_map(|pair| Some((pair, self.line(channels, pair)?)));
        let lines: Vec<(usize, (f64, f64))> = lines.collect();
        let forward = lines.iter().filter(|(_, (slope, _))| *slope > 0.0);
        channels.gains = forward.map(|(pair, (slope, _))| (self.pairs[*pair], slope.ln())).collect();
        let standing_out: Vec<[u8; 2]> =
            gain::outstanding_slopes(&channels.gains).into_iter().map(|(pair, _)| pair).collect();
        for (pair, (slope, intercept)) in lines {
            let pair = self.pairs[pair];
            if slope < 0.0 || standing_out.contains(&pair) {
                *channels.apart.entry(pair).or_default() += intercept - common * (1.0 - slope);
            }
        }
    }

    /// Slope and intercept of a pair's readings over those of the other pairs when it drives: the geometric mean of both
    /// regressions; steps that are far off count less.
    fn line(&self, channels: &Channels, pair: usize) -> Option<(f64, f64)> {
        let settled = |row: &Equation, at: usize| {
            (row.values[at] - channels.kept * row.before[at]) / (1.0 - channels.kept)
                - channels.apart(self.pairs[row.pairs[at]])
        };
        let of_row = |row: &Equation| {
            let at = row.pairs.iter().position(|&it| it == pair)?;
            Some((settled(row, 1 - at) * row.sign, settled(row, at), 1.0 / (row.scale + self.floor)))
        };
        let points: Vec<(f64, f64, f64)> = self.rows.iter().filter_map(of_row).collect();
        let mut weights: Vec<f64> = points.iter().map(|point| point.2 * point.2).collect();
        let mut found = None;
        for _ in 0..ROUNDS {
            let sum: f64 = weights.iter().sum();
            let mean = |of: fn(&(f64, f64, f64)) -> f64| {
                points.iter().zip(&weights).map(|(point, w)| w * of(point)).sum::<f64>() / sum
            };
            let (x, y) = (mean(|point| point.0), mean(|point| point.1));
            let (mut xx, mut yy, mut xy) = (0.0, 0.0, 0.0);
            for (point, w) in points.iter().zip(&weights) {
                let (x, y) = (point.0 - x, point.1 - y);
                (xx, yy, xy) = (xx + w * x * x, yy + w * y * y, xy + w * x * y);
            }
            let slope = (yy / xx).sqrt().copysign(xy);
            if !slope.is_finite() || slope == 0.0 {
                return found;
            }
            found = Some((slope, y - slope * x));
            let left = |point: &(f64, f64, f64)| (point.1 - y - slope * (point.0 - x)).abs() * point.2;
            let scale = (ROBUST * median(points.iter().map(left))).max(f64::MIN_POSITIVE);
            weights =
                points.iter().map(|it| (it.2 / (1.0 + (left(it) / scale).powi(2)).sqrt()).powi(2)).collect();
        }
        found
    }

    /// Standard deviation of what is left of the smaller half of the voltages, of one of the two steps.
    fn deviation(&self, left: &DVector<f64>) -> f64 {
        let middle = median(self.rows.iter().map(|row| row.scale));
        let small = self.rows.iter().zip(left.iter()).filter(|(row, _)| row.scale <= middle);
        DEVIATION * median(small.map(|(row, left)| (left * row.scale).abs())) / std::f64::consts::SQRT_2
    }
}

/// Sense pairs of the steps, and which of them each step has.
fn sense_pairs(expected: &Expected) -> (Vec<[u8; 2]>, Vec<usize>) {
    let of_step = || expected.steps.iter().map(|step| [step.sense_plus, step.sense_minus]);
    let mut pairs: Vec<[u8; 2]> = of_step().collect();
    pairs.sort_unstable();
    pairs.dedup();
    let index = of_step().filter_map(|pair| pairs.binary_search(&pair).ok()).collect();
    (pairs, index)
}
