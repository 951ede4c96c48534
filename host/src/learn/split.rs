//! Split: which presses are learnt from, and which only judge.

use rand::{SeedableRng, seq::SliceRandom};
use rand_pcg::Pcg64Mcg;

/// Indices of presses; none is in both.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Split {
    /// Learnt from.
    pub training: Vec<usize>,
    /// Looked at once, at the end.
    pub test: Vec<usize>,
}

/// Draws a share of `count` presses for the test; the same seed gives the same split.
#[must_use]
pub fn split(count: usize, test_share: f64, seed: u64) -> Split {
    let mut order: Vec<usize> = (0..count).collect();
    order.shuffle(&mut Pcg64Mcg::seed_from_u64(seed));
    let test = (count as f64 * test_share).round() as usize;
    let training = order.split_off(test.min(count));
    Split { training, test: order }
}

/// Parts of the training presses, each of which validates what the others teach.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Folds(Vec<(Vec<usize>, Vec<usize>)>);

impl Folds {
    /// Deals out presses, which come in random order, to `count` folds of nearly equal size.
    #[must_use]
    pub fn new(presses: &[usize], count: usize) -> Self {
        let part = |fold: usize, inside: bool| {
            let dealt = presses.iter().enumerate().filter(|(place, _)| (place % count == fold) == inside);
            dealt.map(|(_, &press)| press).collect()
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

    fn sorted(parts: &[&[usize]]) -> Vec<usize> {
        let mut all = parts.concat();
        all.sort_unstable();
        all
    }

    proptest! {
        #[test]
        fn every_press_is_in_one_part_and_validates_once(count in 0_usize..200, share in 0.0..0.5, seed: u64) {
            let all: Vec<usize> = (0..count).collect();
            let Split { training, test } = split(count, share, seed);
            prop_assert_eq!(sorted(&[&training, &test]), all);
            prop_assert!((test.len() as f64 - share * count as f64).abs() <= 0.5);
            let folds = Folds::new(&training, 5);
            let validated: Vec<&[usize]> = folds.iter().map(|(_, validation)| validation).collect();
            prop_assert_eq!(sorted(&validated), sorted(&[&training]));
            for (training_of_fold, validation) in folds.iter() {
                prop_assert_eq!(sorted(&[training_of_fold, validation]), sorted(&[&training]));
            }
        }
    }

    #[test]
    fn a_seed_always_gives_the_same_split() {
        assert_eq!(split(50, 0.2, 7), split(50, 0.2, 7));
        assert_ne!(split(50, 0.2, 7).test, split(50, 0.2, 8).test);
    }
}
