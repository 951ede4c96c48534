//! Approach: two fingers come close to each other, rest, and part; each should keep the number the board gave it.

use super::{
    ExperimentError,
    report::{Report, Wanted},
    sample_rig::SampleRig,
};
use dermatome_shared::contact::Contact;
use dermatome_simulate::Press;
use num_complex::Complex64;
use rayon::prelude::*;
use serde_json::{Value, json};
use std::f64::consts::PI;

/// Radius of a finger, and how close their middles come, shares of the diameter.
const RADIUS: f64 = 0.04;
const CLOSEST: [f64; 4] = [0.3, 0.2, 0.15, 0.1];
/// At least so far apart, numbers must stay.
const TOLD_APART: f64 = 0.2;
/// Distance at which they begin and end.
const APART: f64 = 0.6;
/// Directions in which they do so, and where their middle lies, share of the diameter.
const DIRECTIONS: u32 = 6;
const MIDDLE: f64 = 0.1;
/// Frames of rest at both ends and at the closest, and of each way.
const REST: u32 = 12;
const WAY: u32 = 25;
/// Frames without a finger between two scenes: longer than a track waits.
const PAUSE: u32 = 25;
/// A contact is a finger's if it is so close, share of the diameter.
const NEAR: f64 = 0.07;

/// What became of the fingers that came so close.
#[derive(Default)]
struct Kept {
    scenes: u32,
    /// Scenes after which both had the numbers they had before.
    both: u32,
    /// Frames, and those in which the board saw two contacts, each at its finger.
    frames: u32,
    two: u32,
    /// Scenes in which it said that one merged.
    merged: u32,
}

/// Plays them on a rig that is tared, and adds what was found to the report.
pub(super) fn show(report: &mut Report, rig: &mut SampleRig) -> Result<Value, ExperimentError> {
    report.words(format!(
        "Fingers that approach each other: two of {:.1} mm radius come from {:.0} mm apart, rest, and part again on the line \
         on which they came, in {DIRECTIONS} directions round places {:.0} mm from the middle. Fingers closer than {:.0} mm need \
         not be told apart.",
        1e3 * RADIUS * rig.side(),
        1e3 * APART * rig.side(),
        1e3 * MIDDLE * rig.side(),
        1e3 * TOLD_APART * rig.side()
    ));
    let mut rows = Vec::new();
    let mut figures = Vec::new();
    for closest in CLOSEST {
        let kept = Kept::of(rig, closest);
        let distance = 1e3 * closest * rig.side();
        let wrong = f64::from(kept.scenes - kept.both);
        let wanted = (closest >= TOLD_APART).then_some(Wanted::AtMost(0.0));
        let what =
            format!("fingers that approach to {distance:.0} mm: of {} pairs, numbers lost", kept.scenes);
        report.compare(what, "", None, wrong, wanted);
        let two = 100.0 * f64::from(kept.two) / f64::from(kept.frames);
        rows.push(vec![
            format!("{distance:.0} mm"),
            format!("{} of {}", kept.both, kept.scenes),
            format!("{two:.1} %"),
            format!("{} of {}", kept.merged, kept.scenes),
        ]);
        figures.push(json!({
            "closest_m": closest * rig.side(),
            "pairs": kept.scenes,
            "numbers_kept": kept.both,
            "two_contacts_percent": two,
            "said_merged": kept.merged,
        }));
    }
    let columns =
        ["closest", "both keep their numbers", "frames with two contacts", "the board says they merged"];
    report.table("Fingers that approach each other and part", &columns, rows);
    Ok(Value::Array(figures))
}

/// Places of both fingers, frame by frame; shares of the diameter.
fn scene(closest: f64, direction: u32) -> Vec<[[f64; 2]; 2]> {
    let turn = PI * f64::from(direction) / f64::from(DIRECTIONS);
    let middle = [MIDDLE * (2.0 * turn).cos(), MIDDLE * (2.0 * turn).sin()];
    let way = (1..=WAY).map(|frame| f64::from(frame) / f64::from(WAY));
    let rest = |at: f64| std::iter::repeat_n(at, REST as usize);
    let there = rest(0.0).chain(way.clone()).chain(rest(1.0));
    let shares = there.chain(way.map(|share| 1.0 - share)).chain(rest(0.0));
    let at = |share: f64| {
        let half = (APART + share * (closest - APART)) / 2.0;
        [half, -half].map(|away| [middle[0] + away * turn.cos(), middle[1] + away * turn.sin()])
    };
    shares.map(at).collect()
}

impl Kept {
    fn of(rig: &mut SampleRig, closest: f64) -> Self {
        let side = rig.side();
        let untouched = rig.solve(&vec![1.0; rig.elements()]);
        let mut kept = Self::default();
        for direction in 0..DIRECTIONS {
            let fingers: Vec<_> =
                scene(closest, direction).iter().map(|pair| pair.map(|at| at.map(|by| by * side))).collect();
            let solve = |pair: &[[f64; 2]; 2]| {
                let presses = pair.map(|at| Press::finger(at, RADIUS * side, 1.0));
                rig.solve(&rig.truth().conductivity(&presses))
            };
            let phasors: Vec<Vec<Complex64>> = fingers.par_iter().map(solve).collect();
            kept.play(rig, &fingers, &phasors);
            (0..PAUSE).for_each(|_| {
                rig.glance(&untouched);
            });
        }
        kept
    }

    fn play(&mut self, rig: &mut SampleRig, fingers: &[[[f64; 2]; 2]], phasors: &[Vec<Complex64>]) {
        let near = NEAR * rig.side();
        let mut merged = false;
        let mut numbers = Vec::new();
        for (pair, phasors) in fingers.iter().zip(phasors) {
            let contacts = rig.glance(phasors);
            let of_pair = pair.map(|at| number_at(&contacts, at, near));
            self.frames += 1;
            self.two += u32::from(contacts.len() == 2 && are_two(of_pair));
            merged |= contacts.iter().any(|contact| contact.identity.is_some_and(|id| id.merged.is_some()));
            numbers.push(of_pair);
        }
        // By the end of the first rest a board has found both.
        let [before, after] = [numbers[REST as usize - 1], numbers[numbers.len() - 1]];
        self.scenes += 1;
        self.both += u32::from(are_two(before) && before == after);
        self.merged += u32::from(merged);
    }
}

fn are_two(numbers: [Option<u32>; 2]) -> bool {
    matches!(numbers, [Some(a), Some(b)] if a != b)
}

/// Number of the nearest contact, if it is near.
fn number_at(contacts: &[Contact], at: [f64; 2], near: f64) -> Option<u32> {
    let distance = |contact: &Contact| {
        let [x, y] = contact.from_above();
        (x - at[0]).hypot(y - at[1])
    };
    let nearest = contacts.iter().min_by(|a, b| distance(a).total_cmp(&distance(b)))?;
    (distance(nearest) < near).then_some(nearest.identity?.number)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fingers_come_as_close_as_asked_and_return_to_where_they_were() {
        for (closest, direction) in [(0.2, 0), (0.1, 5)] {
            let scene = scene(closest, direction);
            let apart = |[a, b]: &[[f64; 2]; 2]| (a[0] - b[0]).hypot(a[1] - b[1]);
            let least = scene.iter().map(apart).fold(f64::INFINITY, f64::min);
            assert!((least - closest).abs() < 1e-12 && (apart(&scene[0]) - APART).abs() < 1e-12);
            assert_eq!(scene.first(), scene.last());
            // On the disc.
            assert!(scene.iter().flatten().all(|[x, y]| x.hypot(*y) < 0.5 - RADIUS));
        }
    }
}
