//! Stimulation: the steps of a frame, and the measurement that each of them goes into.

use dermatome_shared::{
    patch::CombinedInto,
    stimulation::{Reciprocity, Step},
};
use std::collections::HashSet;

/// Steps of a frame, and what becomes of them.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Stimulation {
    /// Stimulation table: `[step]`, in canonical order.
    pub steps: Vec<Step>,
    /// Where each step's code goes: `[step]`.
    pub combination: Vec<CombinedInto>,
}

impl Stimulation {
    /// Every step a measurement of its own.
    #[must_use]
    pub fn separate(steps: Vec<Step>) -> Self {
        Self { combination: keep_all(&steps), steps }
    }

    /// Reciprocal steps share a measurement.
    #[must_use]
    pub fn combined(steps: Vec<Step>) -> Self {
        Self { combination: combine_reciprocal(&steps), steps }
    }
}

/// The steps without those that measure again what one before them does.
#[must_use]
pub fn first_of_pairs(steps: &[Step]) -> Vec<Step> {
    let mut known = HashSet::new();
    steps.iter().copied().filter(|step| known.insert(step.reciprocity().pairs)).collect()
}

fn keep_all(steps: &[Step]) -> Vec<CombinedInto> {
    (0..steps.len() as u16).map(|measurement| CombinedInto { measurement, flipped: false }).collect()
}

/// Measurements in the order in which their first step appears, with that step's sign.
fn combine_reciprocal(steps: &[Step]) -> Vec<CombinedInto> {
    let mut first: Vec<Reciprocity> = Vec::new();
    let mut combine = |step: &Step| {
        let this = step.reciprocity();
        let known = first.iter().position(|other| other.pairs == this.pairs);
        let measurement = known.unwrap_or_else(|| {
            first.push(this);
            first.len() - 1
        });
        CombinedInto { measurement: measurement as u16, flipped: this.flipped != first[measurement].flipped }
    };
    steps.iter().map(&mut combine).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use dermatome_shared::stimulation::{Driven, pattern};

    #[test]
    fn reciprocal_steps_of_the_adjacent_pattern_share_104_measurements_unflipped() {
        let steps: Vec<_> = pattern(16, 1, 1, Driven::Skipped).collect();
        let combination = combine_reciprocal(&steps);
        let mut counts = [0; 104];
        for target in &combination {
            counts[usize::from(target.measurement)] += 1;
            assert!(!target.flipped);
        }
        assert!(counts.iter().all(|&count| count == 2));
    }

    #[test]
    fn each_pair_of_reciprocal_steps_is_measured_once_if_asked() {
        let steps: Vec<_> = pattern(16, 1, 1, Driven::Skipped).collect();
        let once = first_of_pairs(&steps);
        assert_eq!(once.len(), 104);
        let pairs =
            |steps: &[Step]| steps.iter().map(|step| step.reciprocity().pairs).collect::<HashSet<_>>();
        assert_eq!(pairs(&once), pairs(&steps));
    }

    #[test]
    fn opposite_drives_that_differ_in_direction_only_are_subtracted() {
        let steps: Vec<_> = pattern(16, 8, 1, Driven::Skipped).collect();
        let combination = combine_reciprocal(&steps);
        assert_eq!(combination.iter().filter(|target| target.flipped).count(), 96);
        assert_eq!(combination.iter().map(|target| target.measurement).max(), Some(95));
    }
}
