//! A constant that every value holds, as raw counts of a converter do.

use super::{
    super::{diagnose::RESEMBLING, statistics::median},
    causes::Explained,
    likeness::{Comparison, Likeness},
    reading::Reading,
};
use num_complex::Complex64;
use serde::Serialize;

/// A cause that touches every step leaves at most this share,
pub(super) const LEAVES: f64 = 0.85;
/// and so much less.
pub(super) const LESS: f64 = 0.005;
/// Shares of the fitted offset that are tried.
const SHARES: [f64; 8] = [0.8, 0.9, 0.95, 0.98, 1.0, 1.05, 1.1, 1.2];
/// By how many times the median magnitude without it an offset that hides it is tried apart from the fitted one.
const STEPS: [f64; 7] = [-0.3, -0.2, -0.1, 0.0, 0.1, 0.2, 0.3];
/// Share of the values that may turn their sign when an offset is taken out of values of one sign.
const MOST_TURNED: f64 = 0.05;
/// And of a large offset, beside which exchanged wires may turn some.
const MOST_TURNED_OF_LARGE: f64 = 0.25;
/// Of how far the middle step is from the model an offset leaves this share.
const MUCH_NEARER: f64 = 0.5;
/// A small offset leaves this share of what is missing to a straight line.
const STRAIGHTER: f64 = 0.9;
/// Shares of the median magnitude without it up to which an offset is small, and from which on it hides the logarithms.
const HALF: f64 = 0.5;
const LARGE_OFFSET: f64 = 1.5;
/// And from which on it hides the order.
const HIDING: f64 = 5.0;
/// By how much an offset may lower the correlation.
const MOST_BENT: f64 = 0.06;
/// Error of the model that a fit of the offset expects, share of a voltage.
const MODEL_ERROR: f64 = 0.1;
/// Times the middle step's distance from which on steps count less than half.
const ROBUST: f64 = 2.0;
const ROUNDS: usize = 20;
/// Least offset that is one, as a share of the median magnitude without it.
const LEAST_OFFSET: f64 = 0.2;

/// A constant that every value seems to hold.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Offset {
    /// The constant, in the file's unit.
    pub value: f64,
    /// Its imaginary part; 0 for real data.
    pub imaginary: f64,
    /// Its share of the median magnitude without it, %.
    pub share_percent: f64,
    /// Correlation of log magnitudes with the model, with it.
    pub correlation_before: f64,
    /// The same once it is subtracted.
    pub correlation: f64,
}

impl Offset {
    /// The one that was found, if any.
    pub(super) fn of(found: &[Explained]) -> Option<Self> {
        let is_offset = |it: &Explained| it.reading.offset.norm() > 0.0;
        let (before, after) =
            (found.iter().rfind(|it| !is_offset(it))?, found.iter().find(|it| is_offset(it))?);
        let last = &found[found.len() - 1];
        let offset = last.reading.offset;
        let magnitude = median(last.likeness.measured.iter().map(|value| value.abs())) * last.likeness.gain;
        Some(Self {
            value: offset.re,
            imaginary: offset.im,
            share_percent: 100.0 * offset.norm() / magnitude.max(f64::MIN_POSITIVE),
            correlation_before: before.likeness.correlation(),
            correlation: after.likeness.correlation(),
        })
    }
}

/// The offset with which the model's voltages explain the frame best, if it is large enough.
///
/// A body that is unlike the model, such as a tank that is deeper than its electrodes, makes the logarithms of voltages a
/// steeper or flatter line of the model's; an offset bends the line, so a small one must make it straighter. Logarithms of
/// values that a large offset makes alike say little: there it is enough that the middle step is much nearer to g m + c
/// than to g m.
pub(super) fn found(comparison: &Comparison<'_>, reading: &Reading) -> Option<Reading> {
    let plain = comparison.of(reading).ok()?;
    let is_one = |line: &Line, likeness: &Likeness| {
        let correlation = likeness.correlation();
        let is_straighter =
            correlation > RESEMBLING && 1.0 - correlation < STRAIGHTER * (1.0 - plain.correlation());
        let is_bent = correlation < plain.correlation() - MOST_BENT;
        let is_less = likeness.cost() < LEAVES * plain.cost() - LESS;
        let is_nearer = line.is_large() && likeness.cost() < plain.cost();
        !is_bent && (is_nearer || is_less && (is_straighter || line.share > HALF))
    };
    best(comparison, reading, &plain, MOST_TURNED, is_one)
}

/// One that is so large that the frame tells no order as long as it is there.
pub(super) fn large(comparison: &Comparison<'_>, reading: &Reading) -> Option<Reading> {
    let plain = comparison.of(reading).ok()?;
    best(comparison, reading, &plain, MOST_TURNED_OF_LARGE, |line, _| line.hides())
}

/// The same reading with the offset fitted anew, if it has one or its channels were found to differ.
pub(super) fn again(comparison: &Comparison<'_>, reading: &Reading) -> Option<Reading> {
    let plain = comparison.of(reading).ok()?;
    let better =
        best(comparison, reading, &plain, MOST_TURNED_OF_LARGE, |_, likeness| likeness.cost() < plain.cost());
    better.filter(|_| reading.offset != Complex64::ZERO)
}

/// How straight a line of the model's voltages a frame is with an offset.
#[derive(Clone, Copy)]
pub(super) struct Line {
    /// How far steps are from it on average, as a share of how far they are from none,
    pub(super) mean: f64,
    /// and the middle one, over what may be expected.
    left: f64,
    /// The same without an offset.
    without: f64,
    /// The offset's share of the median magnitude without it.
    share: f64,
}

impl Line {
    /// Whether the offset is so large that logarithms say little.
    fn is_large(&self) -> bool {
        self.share > LARGE_OFFSET && self.left < MUCH_NEARER * self.without
    }

    /// Whether it is so large that the frame tells no order as long as it is there.
    pub(super) fn hides(&self) -> bool {
        self.share > HIDING && self.is_large()
    }
}

/// With the offset that fits best; none of potentials, whose differences do not hold it.
pub(super) fn line(comparison: &Comparison<'_>, reading: &Reading) -> Option<Line> {
    let plain = comparison.of(reading).ok()?;
    let values = values(comparison, reading)?;
    let of_model = |model: &Vec<f64>| {
        let without = linear(&values, model, &plain.unknown, false)?;
        if reading.potentials.is_some() {
            return Some(Line {
                left: without.middle,
                mean: without.mean,
                without: without.middle,
                share: 0.0,
            });
        }
        let with = linear(&values, model, &plain.unknown, true)?;
        let share = share(&values, real_if_nearly(with.offset));
        Some(Line { left: with.middle, mean: with.mean, without: without.middle, share })
    };
    let lines = models(comparison, reading).map(|(model, _)| of_model(&model));
    lines.into_iter().flatten().min_by(|a, b| a.mean.total_cmp(&b.mean))
}

/// What each step measured without an offset.
fn values(comparison: &Comparison<'_>, reading: &Reading) -> Option<Vec<Complex64>> {
    let without = Reading { offset: Complex64::ZERO, ..reading.clone() };
    let values = without.values(comparison.expected, comparison.reference).ok()?;
    Some(values.into_iter().map(|(value, _)| value).collect())
}

/// The model's voltages, and their magnitudes: `[step]`, and whether signs differ.
fn models(comparison: &Comparison<'_>, reading: &Reading) -> [(Vec<f64>, bool); 2] {
    let expected = comparison.expected;
    let model: Vec<f64> =
        expected.steps.iter().map(|&step| expected.voltage(reading.wiring.step(step))).collect();
    let has_signs = model.iter().any(|&m| m > 0.0) && model.iter().any(|&m| m < 0.0);
    let magnitudes = model.iter().map(|m| m.abs()).collect();
    [(model, has_signs), (magnitudes, false)]
}

/// Shares of the fitted offset that are tried, of an offset of this share.
fn shares(of: f64) -> Vec<f64> {
    if of > HIDING { STEPS.iter().map(|step| 1.0 + step / of).collect() } else { SHARES.to_vec() }
}

/// An offset's share of the median magnitude without it.
fn share(values: &[Complex64], offset: Complex64) -> f64 {
    offset.norm() / median(values.iter().map(|y| (y - offset).norm()))
}

/// The reading with the offset that leaves least, of those that are one.
fn best(
    comparison: &Comparison<'_>,
    reading: &Reading,
    plain: &Likeness,
    most_turned: f64,
    is_one: impl Fn(&Line, &Likeness) -> bool,
) -> Option<Reading> {
    let values = values(comparison, reading)?;
    let one_sign = !values.iter().any(|y| y.im != 0.0)
        && (values.iter().all(|y| y.re > 0.0) || values.iter().all(|y| y.re < 0.0));
    let mut best: Option<(f64, Reading)> = None;
    for (model, has_signs) in models(comparison, reading) {
        let lines = [false, true].map(|offset| linear(&values, &model, &plain.unknown, offset));
        let [Some(without), Some(with)] = lines else { continue };
        for factor in shares(share(&values, real_if_nearly(with.offset))) {
            let offset = real_if_nearly(with.offset * factor);
            let share = share(&values, offset);
            // Counts of a converter that all lie on one side of zero go on doing so, mostly.
            let turned = values.iter().filter(|y| ((*y - offset).re > 0.0) != (y.re > 0.0)).count();
            let is_turned = one_sign && !has_signs && turned as f64 > most_turned * values.len() as f64;
            if share < LEAST_OFFSET || is_turned {
                continue;
            }
            let line = Line { left: with.middle, mean: with.mean, without: without.middle, share };
            let reading = Reading { offset, ..reading.clone() };
            let Ok(likeness) = comparison.of(&reading) else { continue };
            let cost = likeness.cost();
            if is_one(&line, &likeness) && best.as_ref().is_none_or(|(least, _)| cost < *least) {
                best = Some((cost, reading));
            }
        }
    }
    best.map(|(_, reading)| reading)
}

fn real_if_nearly(offset: Complex64) -> Complex64 {
    if offset.im.abs() < 0.2 * offset.re.abs() { offset.re.into() } else { offset }
}

/// A straight line of the model's voltages.
struct Fitted {
    /// c of y = g m + c.
    offset: Complex64,
    /// How far the middle step is from it,
    middle: f64,
    /// and all steps on average, as a share of how far they are from their middle.
    mean: f64,
}

/// y = g m + c, or without c.
///
/// Least squares, each step weighed by what the model does not know of it; steps that fit badly count less.
fn linear(values: &[Complex64], model: &[f64], unknown: &[f64], offset: bool) -> Option<Fitted> {
    let weight = |(m, d): (&f64, &f64)| 1.0 / (d * d + (MODEL_ERROR * m).powi(2)).max(f64::MIN_POSITIVE);
    let first: Vec<f64> = model.iter().zip(unknown).map(weight).collect();
    let mut weights = first.clone();
    let middle_value =
        Complex64::new(median(values.iter().map(|y| y.re)), median(values.iter().map(|y| y.im)));
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
        let apart = |y: &Complex64| if offset { (y - middle_value).norm() } else { y.norm() };
        let spread: f64 = values.iter().zip(&first).map(|(y, w)| apart(y) * w.sqrt()).sum();
        let mean = left.iter().sum::<f64>() / spread.max(f64::MIN_POSITIVE);
        found = Some(Fitted { offset: c, middle, mean });
        if middle == 0.0 {
            break;
        }
        let scale = ROBUST * middle;
        weights = first.iter().zip(&left).map(|(w, r)| w / (1.0 + (r / scale).powi(2))).collect();
    }
    found
}
