//! Fingers fitted to the voltages of a true skin, which has a mesh of its own.

use dermatome::{
    model::Model,
    multi_contact::{FittedContact, MultiContactFit, Settings},
    simulate::{Press, TrueSkin},
    skin::Skin,
};
use std::{path::Path, sync::LazyLock};

const RADIUS: f64 = 0.0126;

/// The disc, as it is modelled and as it truly is.
struct Disc {
    model: Model,
    fit: MultiContactFit,
    truth: TrueSkin,
}

static DISC: LazyLock<Disc> = LazyLock::new(|| {
    let file = concat!(env!("CARGO_MANIFEST_DIR"), "/../models/disc-210mm/skin.toml");
    let skin = Skin::load(Path::new(file)).unwrap().made().unwrap();
    let model = Model::build(&skin, |_| ()).unwrap();
    let fit = MultiContactFit::new(&skin, &model, Settings { radius: RADIUS, snr_db: 60.0 }).unwrap();
    Disc { truth: TrueSkin::new(&skin).unwrap(), model, fit }
});

/// What is found of fingers on the true skin, without noise.
fn found(fingers: &[([f64; 2], f64)]) -> Vec<FittedContact> {
    let Disc { model, fit, truth } = &*DISC;
    let presses: Vec<_> = fingers.iter().map(|&(at, depth)| Press::finger(at, RADIUS, depth)).collect();
    let untouched = truth.voltages(&truth.conductivity(&[]), &model.steps);
    let pressed = truth.voltages(&truth.conductivity(&presses), &model.steps);
    let change: Vec<f64> = pressed.iter().zip(&untouched).map(|(v, r)| v - r).collect();
    fit.contacts(&model.difference_data(&change, &untouched))
}

fn distance(found: &FittedContact, at: [f64; 2]) -> f64 {
    (found.position.x - at[0]).hypot(found.position.y - at[1])
}

#[test]
fn an_untouched_skin_has_no_finger() {
    assert_eq!(found(&[]), []);
}

#[test]
fn two_fingers_that_an_image_shows_as_one_are_two() {
    let places = [[-0.02, 0.01], [0.018, 0.012]];
    let found = found(&places.map(|at| (at, 1.0)));
    assert_eq!(found.len(), 2, "{found:?}");
    for at in places {
        assert!(found.iter().any(|finger| distance(finger, at) < 1.5e-3), "{found:?}");
    }
}

#[test]
fn a_weak_finger_in_the_middle_is_seen_beside_strong_ones_at_the_rim() {
    let fingers = [([0.085, 0.0], 1.0), ([-0.06, 0.06], 1.0), ([0.0, -0.01], 0.5)];
    let found = found(&fingers);
    assert_eq!(found.len(), 3, "{found:?}");
    assert!(distance(&found[2], [0.0, -0.01]) < 3e-3, "{found:?}");
    assert!(found[2].strength < 0.75 * found[0].strength, "{found:?}");
}
