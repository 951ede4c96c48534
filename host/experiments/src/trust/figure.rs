//! Figure: what was asked for, what was measured, and whether that is met.

use crate::experiment::Wanted;
use serde_json::{Value, json};

/// One measured figure.
#[derive(Clone, Debug, PartialEq)]
pub struct Figure {
    /// What it is.
    pub what: String,
    /// Its unit; may be empty.
    pub unit: &'static str,
    /// Signal-to-noise ratio at which it was measured, dB.
    pub snr_db: f64,
    /// What it should be; `None` where nothing is asked for.
    pub wanted: Option<Wanted>,
    /// What was measured; `None` where there was nothing to measure it on.
    pub found: Option<f64>,
    /// In how many trials or frames a share was counted.
    pub of: Option<usize>,
    /// What else there is to say: why there is no figure, or why it shows nothing yet.
    pub note: Option<String>,
    is_open: bool,
}

/// What became of what was asked for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// It is met.
    Met,
    /// It is not.
    NotMet,
    /// Too little was tried to say.
    Open,
}

impl Figure {
    /// A figure that nothing is asked of. One that is not finite was not to be measured.
    pub(super) fn new(what: impl Into<String>, unit: &'static str, snr_db: f64, found: f64) -> Self {
        let found = found.is_finite().then_some(found);
        Self { what: what.into(), unit, snr_db, wanted: None, found, of: None, note: None, is_open: false }
    }

    /// A share of trials, in per cent.
    pub(super) fn share(what: impl Into<String>, snr_db: f64, count: usize, of: usize) -> Self {
        let share = Self::new(what, "%", snr_db, 100.0 * count as f64 / of as f64);
        Self { of: Some(of), ..share }
    }

    /// It should be at least this, where `is_asked`.
    pub(super) fn at_least(self, least: f64, is_asked: bool) -> Self {
        Self { wanted: is_asked.then_some(Wanted::AtLeast(least)), ..self }
    }

    /// It should be at most this, where `is_asked`.
    pub(super) fn at_most(self, most: f64, is_asked: bool) -> Self {
        Self { wanted: is_asked.then_some(Wanted::AtMost(most)), ..self }
    }

    /// Says more about it.
    pub(super) fn note(self, note: impl Into<String>) -> Self {
        Self { note: Some(note.into()), ..self }
    }

    /// It cannot be said whether it is met, and why.
    pub(super) fn open(self, why: impl Into<String>) -> Self {
        Self { is_open: true, ..self.note(why) }
    }

    /// Whether what was asked for is met; `None` where nothing is. What was not to be measured is not met.
    #[must_use]
    pub fn verdict(&self) -> Option<Verdict> {
        let is_met = match (self.wanted?, self.found) {
            _ if self.is_open => return Some(Verdict::Open),
            (_, None) => false,
            (Wanted::AtMost(most), Some(found)) => found <= most,
            (Wanted::AtLeast(least), Some(found)) => found >= least,
        };
        Some(if is_met { Verdict::Met } else { Verdict::NotMet })
    }

    pub(super) fn json(&self) -> Value {
        let (at_most, at_least) = match self.wanted {
            Some(Wanted::AtMost(most)) => (Some(most), None),
            Some(Wanted::AtLeast(least)) => (None, Some(least)),
            None => (None, None),
        };
        json!({
            "what": self.what,
            "unit": self.unit,
            "noise_db": self.snr_db,
            "found": self.found,
            "of": self.of,
            "at_most": at_most,
            "at_least": at_least,
            "verdict": self.verdict().map(Verdict::words),
            "note": self.note,
        })
    }
}

impl Verdict {
    /// In words.
    #[must_use]
    pub fn words(self) -> &'static str {
        match self {
            Self::Met => "met",
            Self::NotMet => "not met",
            Self::Open => "open",
        }
    }
}

/// Mean, and what 95 % are no more than, and the largest; NaN of nothing.
pub(super) fn mean_95_largest(values: &[f64]) -> [f64; 3] {
    let mean = values.iter().sum::<f64>() / values.len() as f64;
    [mean, quantile(values, 0.95), quantile(values, 1.0)]
}

/// What this share of them is no more than; NaN of nothing.
pub(super) fn quantile(values: &[f64], share: f64) -> f64 {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    let place = (share * sorted.len() as f64).ceil() as usize;
    sorted.get(place.saturating_sub(1)).copied().unwrap_or(f64::NAN)
}

/// Standard deviation over the mean; NaN of fewer than two.
pub(super) fn variation(values: &[f64]) -> f64 {
    let count = values.len() as f64;
    let mean = values.iter().sum::<f64>() / count;
    let squares: f64 = values.iter().map(|value| (value - mean).powi(2)).sum();
    (squares / (count - 1.0)).sqrt() / mean
}

/// Largest over smallest; NaN of nothing.
pub(super) fn largest_over_smallest(values: &[f64]) -> f64 {
    let [least, most] = [f64::min, f64::max].map(|of| values.iter().copied().fold(f64::NAN, of));
    most / least
}

/// Mean of the Poisson variable that is at most `count` with this probability: with 0.05 the one-sided upper 95 % bound of a
/// mean of which so many were counted (Garwood 1936).
pub(super) fn poisson_upper(count: usize, probability: f64) -> f64 {
    let (mut low, mut high) = (0.0, 2.0 * count as f64 + 20.0);
    for _ in 0..60 {
        let middle = (low + high) / 2.0;
        if poisson_cumulative(count, middle) > probability { low = middle } else { high = middle }
    }
    high
}

/// Probability that a Poisson variable of this mean is at most `count`.
fn poisson_cumulative(count: usize, mean: f64) -> f64 {
    let mut log_factorial = 0.0;
    let mut sum = 0.0;
    for i in 0..=count {
        log_factorial += (i.max(1) as f64).ln();
        sum += (i as f64 * mean.ln() - mean - log_factorial).exp();
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_cannot_be_measured_is_not_met_unless_it_is_open() {
        let figure = |found| Figure::new("x", "%", 60.0, found).at_least(99.0, true);
        assert_eq!(figure(99.0).verdict(), Some(Verdict::Met));
        assert_eq!(figure(98.9).verdict(), Some(Verdict::NotMet));
        assert_eq!(figure(f64::NAN).verdict(), Some(Verdict::NotMet));
        assert_eq!(figure(f64::NAN).note("none").verdict(), Some(Verdict::NotMet));
        assert_eq!(figure(99.0).open("too few").verdict(), Some(Verdict::Open));
        assert_eq!(Figure::new("x", "%", 60.0, 1.0).at_least(99.0, false).verdict(), None);
        let share = Figure::share("x", 60.0, 1, 4);
        assert_eq!((share.found, share.of), (Some(25.0), Some(4)));
    }

    #[test]
    fn bounds_of_a_rate_are_those_of_the_tables() {
        // Half the upper 95 % points of chi-squared with 2, 4 and 22 degrees of freedom.
        for (count, bound) in [(0, 2.9957), (1, 4.7439), (10, 16.9622)] {
            let found = poisson_upper(count, 0.05);
            assert!((found - bound).abs() < 1e-3, "{count}: {found}");
        }
        // Half the lower 95 % point with 40 degrees of freedom.
        assert!((poisson_upper(19, 0.95) - 13.2547).abs() < 1e-3);
    }

    #[test]
    fn statistics_of_a_few_values() {
        let values: Vec<f64> = (1..=20).map(f64::from).collect();
        assert_eq!(mean_95_largest(&values), [10.5, 19.0, 20.0]);
        assert!(mean_95_largest(&[])[2].is_nan() && largest_over_smallest(&[]).is_nan());
        assert!((variation(&[1.0, 3.0]) - 2.0_f64.sqrt() / 2.0).abs() < 1e-12);
        assert_eq!(largest_over_smallest(&[2.0, 1.0, 5.0]), 5.0);
    }
}
