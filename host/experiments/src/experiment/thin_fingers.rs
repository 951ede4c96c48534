//! Thin fingers: one of a 25th of the diameter, all over Sample 3's disc, at full and half depth.
//!
//! Not one of the thesis' experiments: its smallest load is a cube of 20 mm.

use super::{
    ExperimentError,
    report::{Report, Wanted, largest, mean_and_deviation},
    sample::THREE_SINGLE,
    sample_rig::{Artefacts, SampleRig},
};
use dermatome_shared::contact::Contact;
use dermatome_simulate::Press;
use num_complex::Complex64;
use rand::{Rng, SeedableRng};
use rand_pcg::Pcg64Mcg;
use rayon::prelude::*;
use serde_json::{Value, json};
use std::f64::consts::TAU;

/// Radius, share of the diameter.
const RADIUS: f64 = 0.04;
/// Relative conductivity change in the middle.
const DEPTHS: [(f64, &str); 2] = [(1.0, "full"), (0.5, "half")];
const PLACES: usize = 120;
/// Places lie within this share of the skin's radius.
const WITHIN: f64 = 0.95;
/// A contact is the finger's if it is so close, share of the diameter.
const CLOSE: f64 = 0.1;
/// So many are seen as exactly one contact, %.
const SEEN: f64 = 99.0;
const RATE: f64 = 50.0;

/// What the board made of fingers of one depth.
struct Found {
    /// Fingers that were exactly one contact, where they are.
    one: usize,
    /// Fingers without any contact.
    none: usize,
    /// Distances of those that were one, share of the diameter.
    errors: Vec<f64>,
}

/// Presses them and adds what was found to the report.
pub(super) fn show(report: &mut Report) -> Result<Value, ExperimentError> {
    report.words(format!(
        "Thin fingers: one of {:.1} mm radius at each of {PLACES} random places within {WITHIN} of the disc's radius, which \
         doubles the conductivity beneath it (full depth) or raises it by half (half depth), at {RATE} frames a second. \
         Contacts are those that the board finds in the voltages of six frames. Artefacts: {}.",
        RADIUS * 210.0,
        Artefacts::MOVING.words()
    ));
    let mut skin = THREE_SINGLE.skin()?;
    skin.drive.frame_rate = RATE;
    let mut rig = SampleRig::new(skin, Artefacts::MOVING, 1, 1)?;
    rig.tare(&vec![1.0; rig.elements()]);
    let places = places(rig.side() / 2.0);
    let mut figures = serde_json::Map::new();
    for (depth, words) in DEPTHS {
        let found = Found::of(&mut rig, &places, depth);
        let share = |count: usize| 100.0 * count as f64 / places.len() as f64;
        let [mean, _] = mean_and_deviation(&found.errors);
        let name = |what: &str| format!("thin fingers, {words} depth: {what}");
        report.compare(name("seen as exactly one"), "%", None, share(found.one), Some(Wanted::AtLeast(SEEN)));
        report.compare(name("without any contact"), "%", None, share(found.none), None);
        report.compare(name("position error, mean"), "%", None, 100.0 * mean, None);
        let max = 100.0 * largest(found.errors.iter().copied());
        report.compare(name("position error, largest"), "%", None, max, None);
        figures.insert(
            words.to_owned(),
            json!({
                "one_percent": share(found.one),
                "none_percent": share(found.none),
                "position_error_percent": { "mean": 100.0 * mean, "max": max },
            }),
        );
    }
    Ok(Value::Object(figures))
}

/// Random places, even over the disc.
fn places(radius: f64) -> Vec<[f64; 2]> {
    let mut random = Pcg64Mcg::seed_from_u64(1);
    let place = |_| {
        let turn: f64 = random.random_range(0.0..TAU);
        let away = WITHIN * radius * random.random_range(0.0_f64..1.0).sqrt();
        [away * turn.cos(), away * turn.sin()]
    };
    (0..PLACES).map(place).collect()
}

impl Found {
    fn of(rig: &mut SampleRig, places: &[[f64; 2]], depth: f64) -> Self {
        let side = rig.side();
        let press = |at: &[f64; 2]| Press::finger(*at, RADIUS * side, depth);
        let solve = |at| rig.solve(&rig.truth().conductivity(&[press(at)]));
        let pressed: Vec<Vec<Complex64>> = places.par_iter().map(solve).collect();
        let untouched = rig.solve(&vec![1.0; rig.elements()]);
        let mut found = Self { one: 0, none: 0, errors: Vec::new() };
        for (at, phasors) in places.iter().zip(&pressed) {
            rig.settle(&untouched);
            found.count(*at, &rig.settle(phasors), side);
        }
        found
    }

    fn count(&mut self, at: [f64; 2], contacts: &[Contact], side: f64) {
        self.none += usize::from(contacts.is_empty());
        if let [only] = contacts {
            let [x, y] = only.from_above();
            let error = (x - at[0]).hypot(y - at[1]) / side;
            if error < CLOSE {
                self.one += 1;
                self.errors.push(error);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn places_lie_all_over_the_disc() {
        let places = places(0.105);
        let inner = places.iter().filter(|[x, y]| x.hypot(*y) < 0.105 * WITHIN / 2.0).count();
        assert!(places.iter().all(|[x, y]| x.hypot(*y) < 0.105 * WITHIN));
        // A quarter of the area.
        assert!((20..40).contains(&inner), "{inner}");
    }
}
