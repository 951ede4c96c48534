//! Presses, and which of them are one: a press that is larger or smaller than the standard one leaves satellites beside it.

use super::{
    MAX_CONTACTS, MAX_PRESSES, Presses,
    spot::{Spot, UNKNOWNS},
};
use crate::image::surface::square_distance;
use heapless::Vec;

/// A press that is one stays one until its significance falls below this share of the level.
const RELEASE: f32 = 0.7;
/// Unless its strength falls below this share of what it was in the frame before.
const LIFTED: f32 = 0.5;
/// Weaker ones than this share of the strongest are none, as with the quarter of an image's peak.
const LEAST_SHARE: f32 = 0.2;
/// Presses closer than this are one, radii of the standard press.
const ONE_REACH: f32 = 3.4;
/// One that is weaker than this share of a stronger one belongs to it within this reach.
const SATELLITE: f32 = 0.45;
const SATELLITE_REACH: f32 = 3.9;
/// Two that were one for so many frames are one within this reach, as long as both are hardly more than that one was. It
/// may take some frames to tell apart two that come together.
const HELD_FRAMES: u8 = 6;
const HELD_REACH: f32 = 4.5;
const HARDLY_MORE: f32 = 1.2;

/// One press, or a satellite, which stays on its place.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Press {
    /// The place that it is next to.
    pub(super) spot: Spot,
    /// Offset from that place, m.
    pub(super) offset: [f32; 2],
    /// Its centre, m.
    pub(super) position: [f32; 3],
    /// Standard deviation of its centre along each axis of the skin, m.
    pub(super) position_deviation: f32,
    /// Strength: 1 for the standard press.
    pub(super) strength: f32,
    /// Strength in the frame before, where it was one then.
    pub(super) before: f32,
    /// Standard deviation of the strength.
    pub(super) strength_deviation: f32,
    /// By how many standard deviations it is above zero.
    pub(super) significance: f32,
    /// Whether it came with what presses do not account for, and has not accounted for a frame since.
    pub(super) is_doubtful: bool,
}

impl Press {
    /// A press that is not fitted yet.
    pub(super) fn at(spot: Spot, strength: f32) -> Self {
        Self {
            position: spot.point([0.0; 2]),
            spot,
            offset: [0.0; 2],
            position_deviation: 0.0,
            strength,
            before: 0.0,
            strength_deviation: 0.0,
            significance: 0.0,
            is_doubtful: false,
        }
    }

    /// Its position by its offset, no farther than slopes hold for.
    pub(super) fn settle(&mut self) {
        self.offset = self.spot.within_reach(self.offset);
        self.position = self.spot.point(self.offset);
    }

    /// Whether it would lie much farther from its place than slopes hold for: where its strength is hardly any, slopes
    /// explain what no press does. The next solution has no more slope than that strength allows.
    pub(super) fn is_out_of_reach(&self) -> bool {
        self.spot.is_far_out(self.offset)
    }

    /// Its strength, and that times its offset from its spot.
    pub(super) fn solved(&self) -> [f32; UNKNOWNS] {
        self.spot.unknowns_of(self.strength, self.offset)
    }

    /// Whether it belongs to another press.
    pub(super) fn is_satellite(&self) -> bool {
        self.spot.is_fixed()
    }

    /// How many unknowns it has.
    pub(super) fn unknowns(&self) -> usize {
        if self.is_satellite() { 1 } else { UNKNOWNS }
    }

    /// Whether it was none in the frame before.
    pub(super) fn is_new(&self) -> bool {
        self.before == 0.0
    }

    /// Whether a press of the frame before is one still.
    pub(super) fn is_held(&self, level: f32) -> bool {
        let level = if self.strength < LIFTED * self.before { level } else { RELEASE * level };
        self.significance >= level
    }

    /// Whether it is strong enough beside others, of which this is the strongest.
    pub(super) fn is_worth(&self, strongest: f32) -> bool {
        self.strength > 0.0 && (self.is_satellite() || self.strength >= LEAST_SHARE * strongest)
    }

    /// Its strength, for what is a share of it.
    pub(super) fn size(&self) -> f32 {
        self.strength.abs().max(1e-6)
    }

    /// Whether another press there, of this strength, is one with it.
    pub(super) fn is_joined_by(&self, position: [f32; 3], strength: f32, radius: f32) -> bool {
        let reach = if self.is_much_more_than(strength) { SATELLITE_REACH } else { ONE_REACH };
        self.away_from(position) < reach * reach * radius * radius
    }

    /// Whether one of this strength is weak beside it.
    pub(super) fn is_much_more_than(&self, strength: f32) -> bool {
        strength < SATELLITE * self.strength
    }

    /// Square of its distance from there.
    pub(super) fn away_from(&self, position: [f32; 3]) -> f32 {
        square_distance(self.position, position)
    }

    /// Takes its satellite in: what is pressed lies in the middle of both.
    fn take_in(&mut self, satellite: &Self) {
        let strength = self.strength + satellite.strength;
        let share = satellite.strength / strength;
        for (here, there) in self.position.iter_mut().zip(satellite.position) {
            *here += share * (there - *here);
        }
        self.significance = root(self.significance, satellite.significance);
        self.strength_deviation = root(self.strength_deviation, satellite.strength_deviation);
        self.strength = strength;
    }
}

/// Deviation of what has these two.
pub(super) fn root(a: f32, b: f32) -> f32 {
    libm::sqrtf(a * a + b * b)
}

/// A press of the frame before, with all that lay beside it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Was {
    position: [f32; 3],
    strength: f32,
    /// Frames in which it was one; none as long as it is what several were.
    frames: Option<u8>,
}

/// Makes a list of presses like others; moving one copies all of its room.
// Once on the board, for all that is done with it.
#[inline(never)]
pub(super) fn copy(from: &[Press], to: &mut Vec<Press, MAX_PRESSES>) {
    to.clear();
    let _ = to.extend_from_slice(from);
}

/// What is remembered of presses, if these were those before.
pub(super) fn remembered(presses: &[Press], before: &[Was], radius: f32) -> Vec<Was, MAX_CONTACTS> {
    let reach = HELD_REACH * radius;
    let mut remembered = Vec::new();
    remembered.extend(presses.iter().map(|press| {
        let mut near = before.iter().filter(|was| press.away_from(was.position) < reach * reach);
        let frames = match (near.next(), near.next()) {
            (None, _) => Some(0),
            (Some(was), None) => was.frames.map(|frames| frames.saturating_add(1)),
            // Another one that is still there was not taken in.
            _ if presses.len() >= before.len() => nearest(before, press).and_then(|was| was.frames),
            _ => None,
        };
        Was { position: press.position, strength: press.strength, frames }
    }));
    remembered
}

/// The one of the frame before that lies nearest to a press.
// Once on the board, for all that asks.
#[inline(never)]
fn nearest<'a>(before: &'a [Was], press: &Press) -> Option<&'a Was> {
    let away = |was: &&Was| press.away_from(was.position);
    before.iter().min_by(|a, b| away(a).total_cmp(&away(b)))
}

/// Whether two are one press: they are close, or were one.
// Once on the board, for all that asks.
#[inline(never)]
fn are_one(before: &[Was], one: &Press, other: &Press, radius: f32) -> bool {
    one.is_joined_by(other.position, other.strength, radius) || were_one(before, one, other, radius)
}

/// Whether two are what one of the frame before was: a wide press may be explained by others in each frame.
fn were_one(before: &[Was], one: &Press, other: &Press, radius: f32) -> bool {
    let reach = HELD_REACH * radius;
    nearest(before, one).zip(nearest(before, other)).is_some_and(|(was, of_other)| {
        core::ptr::eq(was, of_other)
            && was.frames >= Some(HELD_FRAMES)
            && one.strength + other.strength < HARDLY_MORE * was.strength
            && one.away_from(other.position) < reach * reach
    })
}

/// Presses, strongest first, with all that lies beside them taken in; `before` are those of the frame before.
// Into a list that is there, as moving one copies all of its room.
pub(super) fn gathered(presses: &[Press], before: &[Was], radius: f32, found: &mut Presses) {
    found.clear();
    for press in presses {
        let away = |one: &&mut Press| square_distance(one.position, press.position);
        let near = found.iter_mut().min_by(|a, b| away(a).total_cmp(&away(b)));
        match near {
            Some(near) if press.is_satellite() || are_one(before, near, press, radius) => near.take_in(press),
            _ => {
                let _ = found.push(*press);
            }
        }
    }
    sort(found);
    // What they took in may have moved two towards each other.
    let mut at = 1;
    while let Some(press) = found.get(at) {
        match found[..at].iter().position(|one| are_one(before, one, press, radius)) {
            Some(one) => {
                let press = found.remove(at);
                found[one].take_in(&press);
                sort(found);
                at = 1;
            }
            None => at += 1,
        }
    }
    let least = LEAST_SHARE * found.first().map_or(0.0, |press| press.strength);
    found.retain(|press| press.strength >= least);
}

/// Strongest first, by insertion: the library's sort takes 1.6 kB of the board's flash, and there are few.
// Once on the board, for all that asks.
#[inline(never)]
pub(super) fn sort(presses: &mut [Press]) {
    for end in 1..presses.len() {
        let mut at = end;
        while at > 0 && presses[at].strength > presses[at - 1].strength {
            presses.swap(at, at - 1);
            at -= 1;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn gathered(presses: &[Press], before: &[Was], radius: f32) -> Presses {
        let mut found = Presses::new();
        let mut presses = presses.to_vec();
        sort(&mut presses);
        super::gathered(&presses, before, radius, &mut found);
        found
    }

    fn press(x: f32, strength: f32) -> Press {
        Press { position: [x, 0.0, 0.0], significance: 10.0 * strength, ..Press::at(Spot::free(), strength) }
    }

    #[test]
    fn a_weak_press_beside_a_strong_one_is_part_of_it_and_one_as_strong_is_not() {
        // Radius 10 mm: as strong ones are one within 34 mm, weak ones within 39 mm.
        for (away, strength, count) in
            [(0.036, 0.4, 1), (0.036, 0.5, 2), (0.033, 0.9, 1), (0.04, 0.4, 2), (0.035, 1.0, 2)]
        {
            let presses = [press(away, strength), press(0.0, 1.0)];
            let found = gathered(&presses, &[], 0.01);
            assert_eq!(found.len(), count, "{strength} at {away} m: {found:?}");
            let sum: f32 = found.iter().map(|press| press.strength).sum();
            assert!((sum - 1.0 - strength).abs() < 1e-6);
        }
    }

    #[test]
    fn what_was_one_for_long_stays_one_where_others_are_two() {
        // 40 mm from each other, four radii.
        let two = [press(0.02, 1.0), press(-0.02, 0.9)];
        assert_eq!(gathered(&two, &[], 0.01).len(), 2);
        let one = [press(0.0, 1.8)];
        let mut before = remembered(&one, &[], 0.01);
        for _ in 0..HELD_FRAMES {
            assert_eq!(gathered(&two, &before, 0.01).len(), 2, "it was one for too short");
            before = remembered(&one, &before, 0.01);
        }
        let found = gathered(&two, &before, 0.01);
        assert_eq!(found.len(), 1);
        assert!((found[0].strength - 1.9).abs() < 1e-6 && found[0].position[0].abs() < 2e-3, "{found:?}");
        let more = [press(0.02, 1.0), press(-0.02, 1.3)];
        assert_eq!(gathered(&more, &before, 0.01).len(), 2, "another one came");
        let apart = [press(0.025, 1.0), press(-0.025, 0.9)];
        assert_eq!(gathered(&apart, &before, 0.01).len(), 2, "they moved apart");
        let mut of_two = remembered(&two, &before, 0.01);
        for _ in 0..2 * HELD_FRAMES {
            of_two = remembered(&one, &of_two, 0.01);
            assert_eq!(gathered(&two, &of_two, 0.01).len(), 2, "two became one, and are two again");
        }
    }

    #[test]
    fn what_lies_between_two_makes_them_one_where_it_moves_one_close_enough() {
        let two = [press(0.0, 1.0), press(0.036, 0.6)];
        assert_eq!(gathered(&two, &[], 0.01).len(), 2);
        let found = gathered(&[two[0], two[1], press(0.017, 0.4)], &[], 0.01);
        assert!(matches!(&found[..], [one] if (one.strength - 2.0).abs() < 1e-6), "{found:?}");
    }

    #[test]
    fn what_is_taken_in_moves_the_press_by_its_share() {
        let satellite = Press { spot: Spot::default(), ..press(0.03, 0.5) };
        let found = gathered(&[press(0.0, 1.0), satellite], &[], 0.01);
        assert_eq!(found.len(), 1);
        assert!((found[0].position[0] - 0.01).abs() < 1e-6, "{found:?}");
        assert!((found[0].significance - 125.0_f32.sqrt()).abs() < 1e-4, "{found:?}");
    }

    #[test]
    fn a_fifth_of_the_strongest_is_the_least() {
        let presses = [press(0.0, 1.0), press(0.1, 0.19), press(0.2, 0.21)];
        let found = gathered(&presses, &[], 0.01);
        assert_eq!(found.iter().map(|press| press.strength).collect::<std::vec::Vec<_>>(), [1.0, 0.21]);
    }
}
