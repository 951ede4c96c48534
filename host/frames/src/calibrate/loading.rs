//! Trials of a loading machine, and the figures of thesis section 3.6.

/// Loads up to this share of the largest one count as none.
pub(super) const UNLOADED: f64 = 0.02;

/// What a skin read under one load.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reading {
    /// Pressure, kPa.
    pub pressure_kpa: f64,
    /// Mean strength of the region of interest.
    pub strength: f64,
    /// Standard deviation of the mean; 0 if unknown.
    pub deviation: f64,
    /// Mean area of the region of interest, mm^2; none without contact, or if unknown.
    pub area_mm2: Option<f64>,
    /// Where the skin was pressed, m, in its own frame; none without load, or if unknown.
    pub place: Option<[f64; 3]>,
}

/// Loading to the maximum and back, readings in their order.
#[derive(Clone, Debug, PartialEq)]
pub struct Trial {
    /// All readings.
    pub readings: Vec<Reading>,
    /// Index of the first reading under the highest load.
    pub(super) top: usize,
}

/// Splits readings where an unloaded skin is loaded again, and where another place is.
#[must_use]
pub fn trials(readings: &[Reading]) -> Vec<Trial> {
    let largest = readings.iter().fold(0.0, |max: f64, reading| max.max(reading.pressure_kpa));
    let is_loaded = |reading: &Reading| reading.pressure_kpa > UNLOADED * largest;
    let mut parts: Vec<Vec<Reading>> = vec![Vec::new()];
    for (index, reading) in readings.iter().enumerate() {
        let next_is_loaded = readings.get(index + 1).is_some_and(is_loaded);
        let part = parts.last_mut().expect("there is always a part");
        // Where a trial ends unloaded, and the next one starts with the same reading.
        let is_turn = !is_loaded(reading) && next_is_loaded && part.iter().any(is_loaded);
        let before = part.iter().rev().find_map(|reading| reading.place);
        if reading.place.zip(before).is_some_and(|(here, before)| here != before) {
            parts.push(vec![*reading]);
            continue;
        }
        part.push(*reading);
        if is_turn {
            parts.push(vec![*reading]);
        }
    }
    parts.into_iter().filter(|part| part.iter().any(is_loaded)).map(Trial::new).collect()
}

impl Trial {
    fn new(readings: Vec<Reading>) -> Self {
        let mut top = 0;
        for (index, reading) in readings.iter().enumerate() {
            if reading.pressure_kpa > readings[top].pressure_kpa {
                top = index;
            }
        }
        Self { readings, top }
    }

    /// Readings that reach a new highest load, by load.
    #[must_use]
    pub fn loading(&self) -> Vec<Reading> {
        records(self.readings[..=self.top].iter(), |next, last| next > last)
    }

    /// Readings behind the highest load that reach a new lowest one, by load.
    #[must_use]
    pub fn unloading(&self) -> Vec<Reading> {
        let mut down = records(self.readings[self.top..].iter(), |next, last| next < last);
        down.reverse();
        down
    }

    /// Whether it comes back over a load or more to a lower one, so that its hysteresis is known.
    #[must_use]
    pub fn has_way_back(&self) -> bool {
        self.unloading().len() > 2
    }

    /// Rated output: the span of all strengths.
    #[must_use]
    pub fn span(&self) -> f64 {
        let strengths = || self.readings.iter().map(|reading| reading.strength);
        strengths().fold(f64::NEG_INFINITY, f64::max) - strengths().fold(f64::INFINITY, f64::min)
    }

    /// The same loads with other strengths, `[reading]`.
    #[must_use]
    pub fn with_strengths(&self, strengths: &[f64]) -> Self {
        let pairs = self.readings.iter().zip(strengths);
        let readings = pairs.map(|(reading, &strength)| Reading { strength, ..*reading }).collect();
        Self { readings, top: self.top }
    }
}

fn records<'a>(
    readings: impl Iterator<Item = &'a Reading>,
    is_new: impl Fn(f64, f64) -> bool,
) -> Vec<Reading> {
    let mut records: Vec<Reading> = Vec::new();
    for reading in readings {
        if records.last().is_none_or(|last| is_new(reading.pressure_kpa, last.pressure_kpa)) {
            records.push(*reading);
        }
    }
    records
}

/// Hysteresis, per cent of rated output (thesis equation 3.6): the widest deviation of the strengths at one load.
#[must_use]
pub fn hysteresis(trial: &Trial) -> f64 {
    let (up, down) = (trial.loading(), trial.unloading());
    let gap =
        |reading: &Reading| at(&down, reading.pressure_kpa).map(|other| (other - reading.strength).abs());
    100.0 * up.iter().filter_map(gap).fold(0.0, f64::max) / trial.span()
}

/// Repeatability, per cent of rated output (thesis section 5.4.1): the largest difference between trials at
/// one load approached from the same direction. None of a single trial.
#[must_use]
pub fn repeatability(trials: &[Trial]) -> Option<f64> {
    let first = trials.first().filter(|_| trials.len() > 1)?;
    let span = trials.iter().map(Trial::span).sum::<f64>() / trials.len() as f64;
    let widest = |branch: fn(&Trial) -> Vec<Reading>| {
        let branches: Vec<_> = trials.iter().map(branch).collect();
        let spread = |reading: &Reading| {
            let at_load = || branches.iter().filter_map(|branch| at(branch, reading.pressure_kpa));
            at_load().fold(f64::NEG_INFINITY, f64::max) - at_load().fold(f64::INFINITY, f64::min)
        };
        branch(first).iter().map(spread).fold(0.0, f64::max)
    };
    Some(100.0 * widest(Trial::loading).max(widest(Trial::unloading)) / span)
}

/// Strength of a branch at a load, between its readings; none outside of them.
fn at(branch: &[Reading], pressure_kpa: f64) -> Option<f64> {
    let after = branch.iter().position(|reading| reading.pressure_kpa >= pressure_kpa - 1e-9)?;
    let to = branch[after];
    let Some(from) = after.checked_sub(1).map(|before| branch[before]) else {
        return (to.pressure_kpa <= pressure_kpa + 1e-9).then_some(to.strength);
    };
    let share = (pressure_kpa - from.pressure_kpa) / (to.pressure_kpa - from.pressure_kpa);
    Some(from.strength + share * (to.strength - from.strength))
}
