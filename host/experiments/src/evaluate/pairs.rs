//! Pairs of equal targets at decreasing distance: from where on are two contacts still two?

use super::{Watch, find::Found, scene::Scene};
use nalgebra::{Point3, Unit, Vector3};
use rayon::prelude::*;

/// Step between the distances of pairs, a share of the skin's diameter.
pub(super) const STEP: f64 = 0.025;
/// So many steps are taken at once until a pair is not told apart; then they are made up for one by one.
const STRIDE: usize = 4;
/// Pairs are tried at places this many times as far apart as those of single targets.
pub(super) const SPARSENESS: f64 = 2.0;
/// First number of the pairs' frames.
const FIRST_FRAME: u64 = 1 << 32;

/// How targets of a pair lie to each other.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Direction {
    /// One farther from the skin's centre than the other.
    Radial,
    /// Side by side.
    Across,
}

/// Pairs about one place in one direction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pair {
    /// Half way between the two, m.
    pub middle: Point3<f64>,
    /// How far out that lies.
    pub normalised_radius: f64,
    /// How the two lie to each other.
    pub direction: Direction,
    /// Smallest distance of their middles, m, at which they are told apart, as they are at all larger
    /// distances tried; `None` if they are not at the largest.
    pub told_apart: Option<f64>,
    /// Largest distance for which there is room, m.
    pub largest: f64,
}

/// Tries pairs about places all over the skin, until told to stop. Places without room for a pair are
/// left out.
pub(super) fn try_all(scene: &Scene<'_>, watch: &dyn Watch) -> Vec<Pair> {
    let places = scene.surface.places(SPARSENESS * scene.spacing);
    watch.begin("places for pairs", places.len());
    let about_place = |(number, &place): (u64, &Point3<f64>)| {
        let directions =
            [Direction::Radial, Direction::Across].into_iter().zip(scene.surface.directions(place));
        let pairs: Vec<_> = directions
            .zip(0..)
            .filter_map(|((direction, along), half)| {
                let tries =
                    Tries { scene, place, along, first_frame: FIRST_FRAME + (2 * number + half) * 1000 };
                tries.run(direction, watch)
            })
            .collect();
        watch.step();
        pairs
    };
    let numbered: Vec<_> = (0..).zip(&places).collect();
    numbered.into_par_iter().flat_map_iter(about_place).collect()
}

/// Pairs about one place along one direction.
struct Tries<'a> {
    scene: &'a Scene<'a>,
    place: Point3<f64>,
    along: Unit<Vector3<f64>>,
    first_frame: u64,
}

impl Tries<'_> {
    /// From the largest distance downwards, to targets that touch.
    fn run(&self, direction: Direction, watch: &dyn Watch) -> Option<Pair> {
        let pairs = self.with_room();
        let closest = closest_passed(pairs.len(), |index| {
            watch.go_on().then(|| self.is_told_apart(&pairs[index], self.first_frame + index as u64))
        })?;
        Some(Pair {
            middle: self.place,
            normalised_radius: self.scene.surface.normalised_radius(self.place),
            direction,
            told_apart: closest.map(|index| distance(&pairs[index])),
            largest: distance(pairs.first()?),
        })
    }

    /// Middles of all pairs that lie wholly on the skin, farthest apart first.
    fn with_room(&self) -> Vec<[Point3<f64>; 2]> {
        let surface = self.scene.surface;
        let least = 2.0 * self.scene.discs.radius;
        let steps = (1.0 / STEP) as u32;
        let apart = (0..=steps).rev().map(|step| least + f64::from(step) * STEP * surface.diameter);
        apart
            .map(|apart| [0.5, -0.5].map(|side| surface.onto(self.place + *self.along * (side * apart))))
            .filter(|middles| self.has_room(middles))
            .collect()
    }

    fn has_room(&self, middles: &[Point3<f64>; 2]) -> bool {
        let radius = self.scene.discs.radius;
        // On a curved skin, points laid onto it from far off may come to lie anywhere.
        let centred =
            (nalgebra::center(&middles[0], &middles[1]) - self.place).norm() < distance(middles) / 2.0;
        centred && middles.iter().all(|&middle| self.scene.surface.depth(middle) >= radius * (1.0 - 1e-9))
    }

    /// Whether the two strongest contacts are one for each target.
    fn is_told_apart(&self, middles: &[Point3<f64>; 2], frame: u64) -> bool {
        let change = self.scene.discs.at(self.scene.surface, middles);
        let seen = self.scene.see(&change.conductivity, frame);
        let [first, second, ..] = seen.contacts.as_slice() else { return false };
        let is_of =
            |contact: &Found, middle: Point3<f64>| (contact.centre - middle).norm() < distance(middles) / 2.0;
        let [a, b] = *middles;
        is_of(first, a) && is_of(second, b) || is_of(first, b) && is_of(second, a)
    }
}

fn distance([a, b]: &[Point3<f64>; 2]) -> f64 {
    (a - b).norm()
}

/// The last of `count` trials, the easiest first, before the first that fails; trials are made in
/// strides, and one by one in the stride with the failure. `None` if a trial could not be made.
fn closest_passed(count: usize, mut passes: impl FnMut(usize) -> Option<bool>) -> Option<Option<usize>> {
    let mut passed = None;
    let mut failed = count;
    for index in (0..count).step_by(STRIDE) {
        if !passes(index)? {
            failed = index;
            break;
        }
        passed = Some(index);
    }
    let Some(coarse) = passed else { return Some(None) };
    for index in coarse + 1..failed {
        if !passes(index)? {
            break;
        }
        passed = Some(index);
    }
    Some(passed)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_last_trial_before_the_first_failure_is_found_in_few_trials() {
        for count in 0..20 {
            for limit in 0..=count {
                let mut trials = 0;
                let found = closest_passed(count, |index| {
                    trials += 1;
                    Some(index < limit)
                });
                assert_eq!(found, Some(limit.checked_sub(1)), "{limit} of {count}");
                assert!(trials <= count / STRIDE + STRIDE, "{limit} of {count}: {trials}");
            }
        }
        assert_eq!(closest_passed(9, |index| (index < 6).then_some(true)), None);
    }
}
