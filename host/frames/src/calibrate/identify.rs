//! Identification: the play operators that close the loop of one loading cycle.
//!
//! Thresholds are fixed; weights follow by damped least squares on the pressure that the board's own operator
//! would give, from several starts. First loading passes the operator unchanged, so the curve does not depend
//! on the weights.

use super::Trial;
use dermatome_model::inverse::least_squares::{Problem, Schedule, minimise};
use dermatome_shared::{
    calibration::Calibration,
    hysteresis::{MAX_PLAY_OPERATORS, Memory, PlayOperator},
    units::RelativeConductivity,
};
use nalgebra::{DMatrix, DVector};
use std::convert::Infallible;

/// Shares of the highest strength below which the play operators give way, one over their threshold. The last lies clear of
/// the noise of a loop half as high: an operator that gave way within it would need a weight that amplifies it.
const GIVE_WAY: [f64; MAX_PLAY_OPERATORS] = [0.1, 0.4, 0.7, 0.85, 0.93, 0.975];
/// Weights beyond this amplify noise more than they close loops.
const MOST_WEIGHT: f64 = 31.0;
/// Price of a weight of 1, in shares of the largest pressure: what is left of 0.5 % of noise in a frame after
/// the operator's averaging over eight.
const PRICE: f64 = 1.3e-3;
/// What stays without load differs from press to press: up to so many times it must read as nothing.
const REST_MARGIN: f64 = 1.7;
/// ... but not beyond this share of the way to the lowest load.
const REST_SHARE: f64 = 0.7;
const STARTS: [[f64; 2]; 6] = [[0.3, 0.01], [0.3, 6.0], [2.0, 0.01], [2.0, 3.0], [5.0, 0.01], [0.05, 2.0]];
const SCHEDULE: Schedule = Schedule {
    first: 1e-3,
    rise: 4.0,
    fall: 1.0 / 0.3,
    least: 1e-9,
    most: 4e6,
    ridge: 1e-12,
    steps: usize::MAX,
    attempts: usize::MAX,
    attempts_in_all: 60,
    enough: 0.0,
    enough_share: 0.0,
};
const STEP: f64 = 1e-3;

/// Play operators that take the hysteresis out of one loading cycle under its calibration curve. Empty if the cycle has
/// no way back, or nothing at its top.
#[must_use]
pub fn identify(trial: &Trial, calibration: &Calibration) -> Vec<PlayOperator> {
    let cycle = Cycle::new(trial, calibration);
    if cycle.wanted.is_empty() || cycle.largest <= 0.0 {
        return Vec::new();
    }
    let start = |[slow, quick]: [f64; 2]| {
        let mut weights = DVector::from_element(MAX_PLAY_OPERATORS, 0.05);
        (weights[0], weights[MAX_PLAY_OPERATORS - 1]) = (slow, quick);
        let Ok(fitted) = minimise(&cycle, cycle.weighted(weights), &SCHEDULE);
        fitted.state
    };
    let fits = STARTS.into_iter().map(start);
    let square = |fit: &Weighted| cycle.square(fit);
    let best = fits.min_by(|a, b| square(a).total_cmp(&square(b))).expect("there are starts");
    play_operators(&best.weights)
}

/// Pressures, kPa, that a board gives for these strengths, in their order.
#[must_use]
pub fn compensated(
    strengths: &[f64],
    play_operators: &[PlayOperator],
    calibration: &Calibration,
    noise: f64,
) -> Vec<f64> {
    let mut memory = Memory::default();
    let noise = RelativeConductivity::from_f64(noise);
    let step = |&strength: &f64| {
        let strength = RelativeConductivity::from_f64(strength);
        let clean = match play_operators {
            [] => strength,
            operators => memory.compensate(&operators.iter().copied(), strength, noise),
        };
        f64::from(calibration.pressure(clean.to_f32()).unwrap_or_default()) / 1e3
    };
    strengths.iter().map(step).collect()
}

fn play_operators(weights: &DVector<f64>) -> Vec<PlayOperator> {
    let pairs = GIVE_WAY.into_iter().zip(weights.iter());
    pairs.map(|(share, &weight)| PlayOperator::from_f64(1.0 / share, weight)).collect()
}

/// Strength at a load on the loading branch, `[strength, load]`: straight lines between readings.
fn strength_at(branch: &[[f64; 2]], load: f64) -> f64 {
    if load <= 0.0 {
        return 0.0;
    }
    let above = branch.iter().position(|reading| reading[1] >= load).unwrap_or(branch.len() - 1);
    let [before, behind] = [branch[above.saturating_sub(1)], branch[above]];
    let share = ((load - before[1]) / (behind[1] - before[1]).max(f64::MIN_POSITIVE)).clamp(0.0, 1.0);
    before[0] + (behind[0] - before[0]) * share
}

/// One loading cycle, and what pressures its way back should give: those that its own way up reads at the same loads.
/// The curve may be of other cycles too, which differ from this one by the gain of a press; play operators are no cure for that.
struct Cycle<'a> {
    calibration: &'a Calibration,
    strengths: Vec<f64>,
    /// kPa, of the last strengths: those behind the top.
    wanted: Vec<f64>,
    largest: f64,
}

impl<'a> Cycle<'a> {
    fn new(trial: &Trial, calibration: &'a Calibration) -> Self {
        let mut pairs: Vec<[f64; 2]> =
            trial.readings.iter().map(|reading| [reading.strength, reading.pressure_kpa]).collect();
        let top = trial.top;
        let unloaded = pairs[top..].iter().position(|pair| pair[1] == 0.0).map(|behind| top + behind);
        if let Some(unloaded) = unloaded.filter(|&unloaded| unloaded > top) {
            let [low, rest] = [pairs[unloaded - 1][0], pairs[unloaded][0]];
            let most = rest + REST_SHARE * (low - rest);
            pairs.insert(unloaded, [(REST_MARGIN * rest).min(most), 0.0]);
        }
        let read = |load: f64| {
            let strength = strength_at(&pairs[..=top], load);
            calibration.pressure(strength as f32).map_or(0.0, |pressure| f64::from(pressure) / 1e3)
        };
        let wanted = pairs[top + 1..].iter().map(|pair| read(pair[1])).collect();
        let strengths = pairs.iter().map(|pair| pair[0]).collect();
        Self { calibration, strengths, wanted, largest: read(pairs[top][1]) }
    }

    fn weighted(&self, weights: DVector<f64>) -> Weighted {
        Weighted { errors: self.errors(&weights), weights }
    }

    /// Errors of the pressures, shares of the largest one, and the price of the weights.
    fn errors(&self, weights: &DVector<f64>) -> DVector<f64> {
        let given = compensated(&self.strengths, &play_operators(weights), self.calibration, 0.0);
        let behind = &given[given.len() - self.wanted.len()..];
        let of_pressures = behind.iter().zip(&self.wanted).map(|(p, wanted)| (p - wanted) / self.largest);
        let price = PRICE * (self.wanted.len() as f64).sqrt();
        let all: Vec<f64> = of_pressures.chain(weights.iter().map(|weight| price * weight)).collect();
        DVector::from_vec(all)
    }
}

/// Weights of the play operators, and the errors that they leave.
struct Weighted {
    weights: DVector<f64>,
    errors: DVector<f64>,
}

impl Problem for Cycle<'_> {
    type State = Weighted;
    type Error = Infallible;

    fn left(&self, state: &Weighted) -> DVector<f64> {
        -&state.errors
    }

    fn square(&self, state: &Weighted) -> f64 {
        state.errors.norm_squared()
    }

    fn slopes(&self, Weighted { weights, errors }: &Weighted) -> Result<DMatrix<f64>, Infallible> {
        let column = |operator: usize| {
            let mut moved = weights.clone();
            // Weights are rounded to 2^-11: the step is taken as it was rounded.
            moved[operator] += STEP + 0.01 * weights[operator];
            (self.errors(&moved) - errors) / (moved[operator] - weights[operator])
        };
        Ok(DMatrix::from_columns(&(0..MAX_PLAY_OPERATORS).map(column).collect::<Vec<_>>()))
    }

    fn moved(&self, state: &Weighted, change: &DVector<f64>) -> Result<Weighted, Infallible> {
        Ok(self.weighted((&state.weights + change).map(|weight| weight.clamp(0.0, MOST_WEIGHT))))
    }
}
