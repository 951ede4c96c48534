//! Does a reference frame look like the model's voltages, and if not, which order would?
//!
//! Pearson correlation of the logarithms of magnitude: gain and unit do not matter, and the
//! U-shape of each drive (large beside the driven electrodes, small opposite) counts in full.

use super::{
    order::{Arrangement, FileIndex, OrderError},
    statistics::{median, pearson},
    wording::{Rearrangement, Wording},
};
use dermatome_shared::stimulation::Step;
use num_complex::Complex64;
use serde::Serialize;

/// Arrangements whose correlations differ by less are as good as each other.
pub const TIE: f64 = 0.005;
/// Another arrangement must correlate better by more than this to be recommended.
pub const CLEARLY_BETTER: f64 = 0.02;
/// An arrangement that correlates less is as good as none: it is never recommended. Of all the orders
/// of a frame of pure noise some reach 0.3.
pub const LEAST_FIT: f64 = 0.5;
/// Below this correlation something is wrong.
pub const RESEMBLING: f64 = 0.9;
/// References smaller than this share of the median magnitude are dead.
pub const DEAD: f64 = 1e-6;
/// Signs of values smaller than this share of the median magnitude are not compared: noise decides them.
pub const WEAK: f64 = 0.02;

/// What a reference frame says about the order it is read in.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Diagnosis {
    /// The arrangement in use.
    pub used: Arrangement,
    /// Its correlation of log magnitudes with the model, -1 to 1.
    pub correlation: f64,
    /// The best arrangement; of those that tie, the one with the fewest changes.
    pub best: Arrangement,
    /// The correlation of `best`.
    pub best_correlation: f64,
    /// Whether another rotation is as good as the best one, as on any disc.
    pub rotation_ambiguous: bool,
    /// Whether the reference holds magnitudes only, so that its signs say nothing.
    pub magnitudes_only: bool,
    /// Steps whose sign disagrees with the model, after one common flip.
    pub sign_disagreements: Vec<usize>,
    /// Steps whose signs were compared.
    pub signs_compared: usize,
    /// Measurements of the file whose reference is zero.
    pub dead: Vec<usize>,
}

/// Compares a reference frame, in the file's order, with the model's voltages `[step]` under every
/// arrangement.
pub fn diagnose(
    steps: &[Step],
    electrodes: u8,
    model: &[f64],
    reference: &[Complex64],
    used: Arrangement,
) -> Result<Diagnosis, OrderError> {
    let map = used.index_map(steps, electrodes, reference.len())?;
    let floor = dead_below(reference, &map);
    let correlations: Vec<_> = Arrangement::all(electrodes)
        .filter_map(|arrangement| {
            let map = arrangement.index_map(steps, electrodes, reference.len()).ok()?;
            Some((arrangement, correlation(model, reference, &map, floor)))
        })
        .collect();
    let (best, best_correlation) = best(&correlations, used);
    let mut dead: Vec<_> =
        map.iter().map(|place| place.index).filter(|&index| reference[index].norm() <= floor).collect();
    dead.sort_unstable();
    let signs = Signs::compare(model, reference, &map);
    Ok(Diagnosis {
        used,
        correlation: correlation(model, reference, &map, floor),
        best,
        best_correlation,
        rotation_ambiguous: another_rotation_ties(&correlations, best),
        magnitudes_only: signs.magnitudes_only,
        sign_disagreements: signs.disagreements,
        signs_compared: signs.compared,
        dead,
    })
}

impl Diagnosis {
    /// Share of the compared signs that disagree, 0 to 0.5.
    #[must_use]
    pub fn sign_disagreement(&self) -> f64 {
        self.sign_disagreements.len() as f64 / self.signs_compared.max(1) as f64
    }

    /// What looks wrong, and which setting mends it; empty where all is well.
    #[must_use]
    pub fn warnings(&self, wording: &impl Wording) -> Vec<String> {
        let better = is_clearly_better(self.best_correlation, self.correlation);
        let order = if better {
            Some(self.other_order(wording))
        } else {
            (self.correlation < RESEMBLING).then(|| self.no_resemblance())
        };
        // In the wrong order signs disagree anyway.
        let signs = (!better && !self.sign_disagreements.is_empty()).then(|| self.signs());
        let dead = (!self.dead.is_empty()).then(|| self.dead());
        [order, signs, dead].into_iter().flatten().collect()
    }

    fn other_order(&self, wording: &impl Wording) -> String {
        let Self { used, best, rotation_ambiguous, .. } = *self;
        let advice = Rearrangement { used, best, rotation_ambiguous }.told(wording);
        let rotation = if rotation_ambiguous {
            "; the rotation cannot be told from the reference, other rotations fit as well"
        } else {
            ""
        };
        format!(
            "the reference fits the model better in another order (correlation {:.3} instead of {:.3}): \
             {advice}{rotation}",
            self.best_correlation, self.correlation
        )
    }

    fn no_resemblance(&self) -> String {
        if self.best_correlation < LEAST_FIT {
            return format!(
                "nothing fits: no order of the measurements correlates with the model by {LEAST_FIT} or more \
                 (best {:.3}); check that the skin file's electrodes, drive pattern and shape are those of the \
                 measurement",
                self.best_correlation
            );
        }
        format!(
            "the reference resembles the model only weakly (correlation {:.3}), and no other order fits \
             better: check that the skin file's electrodes, drive pattern and shape are those of the \
             measurement",
            self.correlation
        )
    }

    fn signs(&self) -> String {
        format!(
            "{} of {} measurements have the opposite sign of the model (steps {}): check the direction \
             of the sense pairs; the model's signs are used",
            self.sign_disagreements.len(),
            self.signs_compared,
            first_few(&self.sign_disagreements)
        )
    }

    fn dead(&self) -> String {
        format!(
            "{} measurements of the reference are zero and are left out (file indices {})",
            self.dead.len(),
            first_few(&self.dead)
        )
    }
}

/// Whether an arrangement is worth recommending over the one in use, by their correlations.
pub(super) fn is_clearly_better(best: f64, used: f64) -> bool {
    best >= LEAST_FIT && best > used + CLEARLY_BETTER
}

/// The first of many numbers.
pub(super) fn first_few(numbers: &[usize]) -> String {
    let shown: Vec<_> = numbers.iter().take(8).map(ToString::to_string).collect();
    format!("{}{}", shown.join(", "), if numbers.len() > 8 { ", ..." } else { "" })
}

/// Pearson correlation of log magnitudes, dead measurements left out; 0 where there is too little
/// to compare.
fn correlation(model: &[f64], reference: &[Complex64], map: &[FileIndex], floor: f64) -> f64 {
    let alive = |(voltage, place): (&f64, &FileIndex)| {
        let (m, r) = (voltage.abs(), reference[place.index].norm());
        (m > 0.0 && r > floor).then(|| (m.ln(), r.ln()))
    };
    let points: Vec<_> = model.iter().zip(map).filter_map(alive).collect();
    pearson(&points)
}

pub(super) fn best(correlations: &[(Arrangement, f64)], used: Arrangement) -> (Arrangement, f64) {
    let highest = correlations.iter().map(|&(_, correlation)| correlation).fold(f64::MIN, f64::max);
    let ties = correlations.iter().filter(|(_, correlation)| *correlation > highest - TIE);
    let fewest_changes = ties.min_by(|a, b| {
        let order = changes(a.0, used).cmp(&changes(b.0, used));
        order.then(b.1.total_cmp(&a.1))
    });
    fewest_changes.copied().unwrap_or((used, 0.0))
}

fn changes(a: Arrangement, b: Arrangement) -> usize {
    [a.sense != b.sense, a.rotation != b.rotation, a.mirrored != b.mirrored]
        .iter()
        .filter(|&&set| set)
        .count()
}

pub(super) fn another_rotation_ties(correlations: &[(Arrangement, f64)], best: Arrangement) -> bool {
    let highest = correlations.iter().map(|&(_, correlation)| correlation).fold(f64::MIN, f64::max);
    correlations.iter().any(|&(other, correlation)| {
        other.rotation != best.rotation
            && (other.sense, other.mirrored) == (best.sense, best.mirrored)
            && correlation > highest - TIE
    })
}

/// How the signs of a reference compare with the model's.
#[derive(Default)]
pub(super) struct Signs {
    pub(super) magnitudes_only: bool,
    /// Steps of the minority, after one common flip.
    pub(super) disagreements: Vec<usize>,
    pub(super) compared: usize,
    /// Whether the majority has the opposite sign.
    pub(super) reversed: bool,
}

impl Signs {
    /// Compares the signs of the reference's part along its common phase (half the angle of the sum
    /// of squares; 0 for real data) with the model's.
    pub(super) fn compare(model: &[f64], reference: &[Complex64], map: &[FileIndex]) -> Self {
        if map.iter().all(|place| reference[place.index].im == 0.0 && reference[place.index].re >= 0.0) {
            return Self { magnitudes_only: true, ..Self::default() };
        }
        let squares: Complex64 = map.iter().map(|place| reference[place.index].powi(2)).sum();
        let back = Complex64::from_polar(1.0, -squares.arg() / 2.0);
        let weak_reference = WEAK * median(map.iter().map(|place| reference[place.index].norm()));
        let weak_model = WEAK * median(model.iter().map(|voltage| voltage.abs()));
        let (mut equal, mut opposite) = (Vec::new(), Vec::new());
        for (step, (place, voltage)) in map.iter().zip(model).enumerate() {
            let real = (reference[place.index] * back).re * if place.flipped { -1.0 } else { 1.0 };
            if real.abs() > weak_reference && voltage.abs() > weak_model {
                if (real > 0.0) == (*voltage > 0.0) { &mut equal } else { &mut opposite }.push(step);
            }
        }
        let compared = equal.len() + opposite.len();
        let reversed = opposite.len() > equal.len();
        let disagreements = if reversed { equal } else { opposite };
        Self { magnitudes_only: false, disagreements, compared, reversed }
    }
}

/// Magnitude up to which a measurement of the reference is dead.
pub(crate) fn dead_below(reference: &[Complex64], map: &[FileIndex]) -> f64 {
    DEAD * median(map.iter().map(|place| reference[place.index].norm()))
}

#[cfg(test)]
mod tests;
