//! Split: which presses are learnt from, and which only judge.

use rand::{SeedableRng, seq::SliceRandom};
use rand_pcg::Pcg64Mcg;
use std::collections::BTreeMap;

/// Indices of presses; none is in both.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Split {
    /// Learnt from.
    pub training: Vec<usize>,
    /// Looked at once, at the end.
    pub test: Vec<usize>,
}

/// Draws a share of the presses for the test; the same seed gives the same split.
///
/// `places` holds the number of each press's place, from 0 in the order of their first presses. Presses at one place
/// are never in both parts: what was learnt from one would be no news in the other. Where places with many presses
/// stand in the way, the test is as large as fits into its share, and one place at least.
#[must_use]
pub fn split(places: &[usize], test_share: f64, seed: u64) -> Split {
    let mut order: Vec<Vec<usize>> = together(places);
    order.shuffle(&mut Pcg64Mcg::seed_from_u64(seed));
    let most = (places.len() as f64 * test_share).round() as usize;
    let mut parts = Split { training: Vec::new(), test: Vec::new() };
    for presses in order {
        let is_first = parts.test.is_empty() && most > 0;
        let fits = is_first || parts.test.len() + presses.len() <= most;
        if fits { parts.test.extend(presses) } else { parts.training.extend(presses) }
    }
    parts
}

/// Presses of each place.
fn together(places: &[usize]) -> Vec<Vec<usize>> {
    let mut presses = vec![Vec::new(); places.iter().max().map_or(0, |last| last + 1)];
    for (press, &place) in places.iter().enumerate() {
        presses[place].push(press);
    }
    presses
}

/// Parts of the training presses, each of which validates what the others teach.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Folds(Vec<(Vec<usize>, Vec<usize>)>);

impl Folds {
    /// Deals out places, whose presses come in random order, to `count` folds of nearly equal numbers of places.
    #[must_use]
    pub fn new(presses: &[usize], places: &[usize], count: usize) -> Self {
        let mut turns = BTreeMap::new();
        for press in presses {
            let next = turns.len();
            turns.entry(places[*press]).or_insert(next);
        }
        let part = |fold: usize, inside: bool| {
            let is_dealt = |press: &&usize| (turns[&places[**press]] % count == fold) == inside;
            presses.iter().filter(is_dealt).copied().collect()
        };
        Self((0..count).map(|fold| (part(fold, false), part(fold, true))).collect())
    }

    /// Training and validation presses of each fold.
    pub fn iter(&self) -> impl ExactSizeIterator<Item = (&[usize], &[usize])> {
        self.0.iter().map(|(training, validation)| (training.as_slice(), validation.as_slice()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use std::collections::BTreeSet;

    fn sorted(parts: &[&[usize]]) -> Vec<usize> {
        let mut all = parts.concat();
        all.sort_unstable();
        all
    }

    proptest! {
        #[test]
        fn every_press_is_in_one_part_and_validates_once(count in 0_usize..200, share in 0.0..0.5, seed: u64) {
            let all: Vec<usize> = (0..count).collect();
            let Split { training, test } = split(&all, share, seed);
            prop_assert_eq!(sorted(&[&training, &test]), all.clone());
            prop_assert!((test.len() as f64 - share * count as f64).abs() <= 0.5);
            let folds = Folds::new(&training, &all, 5);
            let validated: Vec<&[usize]> = folds.iter().map(|(_, validation)| validation).collect();
            prop_assert_eq!(sorted(&validated), sorted(&[&training]));
            for (training_of_fold, validation) in folds.iter() {
                prop_assert_eq!(sorted(&[training_of_fold, validation]), sorted(&[&training]));
            }
        }
    }

    #[test]
    fn a_seed_always_gives_the_same_split() {
        let places: Vec<usize> = (0..50).collect();
        assert_eq!(split(&places, 0.2, 7), split(&places, 0.2, 7));
        assert_ne!(split(&places, 0.2, 7).test, split(&places, 0.2, 8).test);
    }

    #[test]
    fn presses_at_one_place_stay_together() {
        // 20 places, pressed once to four times.
        let places: Vec<usize> = (0..50).map(|press| if press < 20 { press } else { press % 10 }).collect();
        let of = |presses: &[usize]| presses.iter().map(|&press| places[press]).collect::<BTreeSet<_>>();
        for seed in 0..50 {
            let Split { training, test } = split(&places, 0.2, seed);
            assert!(of(&training).is_disjoint(&of(&test)), "{seed}");
            assert!((7..=10).contains(&test.len()) && test.len() + training.len() == 50, "{}", test.len());
            for (taught, validates) in Folds::new(&training, &places, 5).iter() {
                assert!(of(taught).is_disjoint(&of(validates)) && !validates.is_empty());
            }
        }
        let two = [0, 0, 0, 0, 0, 0, 1, 1, 1, 1, 1, 1];
        assert_eq!(split(&two, 0.1, 1).test.len(), 6);
        assert!(split(&two, 0.0, 1).test.is_empty());
    }
}
