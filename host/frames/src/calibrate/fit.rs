//! Fit: readings -> curve, play operators and load share, or why they are no calibration.

use super::{Curve, Reading, Trial, compensated, curve::SAME_LOAD, hysteresis, identify, load_share, trials};
use dermatome_patch::write::Stored;
use dermatome_shared::{calibration::Calibration, hysteresis::PlayOperator};

/// Fewest loads above none, and fewest points of the curve.
const FEWEST: usize = 3;
/// Share of the variance of the loading readings that the curve must explain.
const EXPLAINED: f64 = 0.75;

/// What readings say of a skin.
#[derive(Clone, Debug)]
pub struct Fit {
    /// Up to the largest load and back, in their order.
    pub trials: Vec<Trial>,
    /// Strength by pressure on first loading.
    pub curve: Curve,
    /// What the patch gets.
    pub calibration: Calibration,
    /// What the patch gets against hysteresis; empty without compensation.
    pub play_operators: Vec<PlayOperator>,
    /// Why there are no play operators, or the trial that they were identified with.
    pub compensation: Compensation,
    /// Hysteresis of each trial.
    pub loops: Vec<Loop>,
}

/// What became of the compensation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Compensation {
    /// Not asked for.
    Off,
    /// No trial comes back from its largest load.
    NoWayBack,
    /// The loop of the trial that play operators were identified with became no narrower.
    Useless {
        /// Index of the trial.
        trial: usize,
        /// Its hysteresis with them, per cent.
        percent: f64,
    },
    /// Play operators are stored.
    On {
        /// Index of the trial that they were identified with.
        trial: usize,
    },
}

/// Hysteresis of one trial, per cent of rated output; none where it has no way back.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Loop {
    /// Of the strengths.
    pub raw: Option<f64>,
    /// Of the pressures by curve and play operators.
    pub compensated: Option<f64>,
}

/// Why readings are no calibration.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum FitError {
    /// Too few loads on the way up.
    #[error(
        "the readings have {found} different loads above none on the way up; allowed: {FEWEST} or more, from the \
         smallest to the largest, and back again for the hysteresis"
    )]
    Loads {
        /// How many there are.
        found: usize,
    },
    /// Strengths that have nothing to do with the loads, or fall.
    #[error(
        "strength does not rise with the load (the curve would have {points} points, and explains {percent:.0} % of \
         the readings' variance); allowed: {FEWEST} points or more and {:.0} %, readings of a skin that conducts better \
         under load, taken while it was loaded",
        100.0 * EXPLAINED
    )]
    NoRise {
        /// Points of the curve.
        points: usize,
        /// Variance explained.
        percent: f64,
    },
    /// No area of a region to compare the indenter's with.
    #[error(
        "the indenter's area is given, but no reading under load has an area of the region of interest; allowed: \
         readings with a column `area_mm2`"
    )]
    NoArea,
}

impl Fit {
    /// Curve and play operators from readings; the load share from the area of the indenter, mm^2, if that is known.
    pub fn new(
        readings: &[Reading],
        indenter_mm2: Option<f64>,
        wants_compensation: bool,
    ) -> Result<Self, FitError> {
        let trials = trials(readings);
        let curve = Curve::of_loading(&trials);
        let mut calibration = checked(&trials, &curve)?;
        if let Some(area) = indenter_mm2 {
            calibration.load_share = Some(load_share(readings, area).ok_or(FitError::NoArea)? as f32);
        }
        let (play_operators, compensation) = if wants_compensation {
            play_operators(&trials, &calibration)
        } else {
            (Vec::new(), Compensation::Off)
        };
        let loops = trials.iter().map(|trial| Loop::new(trial, &play_operators, &calibration)).collect();
        Ok(Self { trials, curve, calibration, play_operators, compensation, loops })
    }

    /// What a patch gets of it.
    #[must_use]
    pub fn stored(&self) -> Stored {
        Stored { curve: self.calibration.clone(), play_operators: self.play_operators.clone() }
    }

    /// Mean hysteresis of the trials that have a way back, per cent; none if none has one.
    #[must_use]
    pub fn hysteresis(&self) -> Option<f64> {
        let known: Vec<f64> = self.loops.iter().filter_map(|one| one.raw).collect();
        (!known.is_empty()).then(|| known.iter().sum::<f64>() / known.len() as f64)
    }
}

/// The curve as a patch holds it, if it says anything.
fn checked(trials: &[Trial], curve: &Curve) -> Result<Calibration, FitError> {
    let largest = curve.points.last().map_or(0.0, |point| point.pressure_kpa);
    let found = curve.points.iter().filter(|point| point.pressure_kpa > SAME_LOAD * largest).count();
    if found < FEWEST {
        return Err(FitError::Loads { found });
    }
    let explained = curve.explained(trials);
    let calibration = curve.calibration().unwrap_or_default();
    let points = calibration.points.len();
    if points < FEWEST || explained < EXPLAINED {
        return Err(FitError::NoRise { points, percent: 100.0 * explained });
    }
    Ok(calibration)
}

/// Play operators of the first trial with a way back, if they make its loop narrower.
fn play_operators(trials: &[Trial], calibration: &Calibration) -> (Vec<PlayOperator>, Compensation) {
    let nothing = |why| (Vec::new(), why);
    let Some(trial) = trials.iter().position(Trial::has_way_back) else {
        return nothing(Compensation::NoWayBack);
    };
    let play_operators = identify(&trials[trial], calibration);
    let without = Loop::new(&trials[trial], &[], calibration);
    let with = Loop::new(&trials[trial], &play_operators, calibration).compensated.unwrap_or(f64::INFINITY);
    let is_narrower = |before: Option<f64>| before.is_some_and(|before| with < before);
    if is_narrower(without.raw) && is_narrower(without.compensated) {
        (play_operators, Compensation::On { trial })
    } else {
        nothing(Compensation::Useless { trial, percent: with })
    }
}

impl Loop {
    fn new(trial: &Trial, play_operators: &[PlayOperator], calibration: &Calibration) -> Self {
        if !trial.has_way_back() {
            return Self::default();
        }
        let strengths: Vec<f64> = trial.readings.iter().map(|reading| reading.strength).collect();
        let pressures = compensated(&strengths, play_operators, calibration, 0.0);
        let known = |trial: &Trial| Some(hysteresis(trial)).filter(|percent| percent.is_finite());
        Self { raw: known(trial), compensated: known(&trial.with_strengths(&pressures)) }
    }
}
