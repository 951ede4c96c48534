use super::*;
use dermatome_simulate::{Press, TrueSkin};
use std::{path::Path, sync::LazyLock};

const RADIUS: f64 = 0.0126;

/// The disc, as it is modelled and as it truly is.
struct Disc {
    skin: Skin,
    model: Model,
    resolver: Resolver,
    truth: TrueSkin,
}

static DISC: LazyLock<Disc> = LazyLock::new(|| {
    let file = concat!(env!("CARGO_MANIFEST_DIR"), "/../../models/disc-210mm/skin.toml");
    let skin = Skin::load(Path::new(file)).unwrap().made().unwrap();
    let model = Model::build(&skin, |_| ()).unwrap();
    let resolver = Resolver::new(&skin, &model, Settings { radius: RADIUS, snr_db: 60.0 }).unwrap();
    Disc { truth: TrueSkin::new(&skin).unwrap(), skin, model, resolver }
});

/// What is found of fingers on the true skin, without noise.
fn found(fingers: &[([f64; 2], f64)]) -> Vec<Resolved> {
    let Disc { model, resolver, truth, .. } = &*DISC;
    let presses: Vec<_> = fingers.iter().map(|&(at, depth)| Press::finger(at, RADIUS, depth)).collect();
    let untouched = truth.voltages(&truth.conductivity(&[]), &model.steps);
    let pressed = truth.voltages(&truth.conductivity(&presses), &model.steps);
    let change: Vec<f64> = pressed.iter().zip(&untouched).map(|(v, r)| v - r).collect();
    resolver.resolve(&model.difference_data(&change, &untouched))
}

fn distance(found: &Resolved, at: [f64; 2]) -> f64 {
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

#[test]
fn what_is_beside_a_strong_finger_belongs_to_it_and_a_weak_one_is_none() {
    let finger = |x: f64, strength: f64| Resolved { position: Point3::new(x, 0.0, 0.0), strength };
    let fingers = joined(vec![finger(0.0, 0.6), finger(0.08, 0.1), finger(0.02, 0.2)], 2.0 * RADIUS);
    assert_eq!(fingers.len(), 2);
    assert!((fingers[0].position.x - 0.005).abs() < 1e-12 && (fingers[0].strength - 0.8).abs() < 1e-12);
    assert_eq!(strong(fingers).len(), 1);
}

/// Between nodes the polynomials meet the answer that is summed there.
#[test]
fn answers_between_nodes_are_those_of_a_finger_there() {
    let Disc { skin, model, .. } = &*DISC;
    let summed = |fingers: &Pixels| {
        let answers = answers(skin, model, fingers, 1.0).unwrap();
        move |finger: usize| DVector::from_fn(answers.nrows(), |m, _| answers[(m, finger)])
    };
    let atlas = Atlas::new(&model.mesh, summed(&atlas::fingers(&model.mesh, RADIUS)));
    let centre = (0..model.mesh.elements.len())
        .map(|element| dermatome_geometry::mesh::triangle::centroid(model.mesh.corners(element)))
        .find(|centre| (centre.coords.norm() - 0.08).abs() < 1e-3)
        .unwrap();
    let truth = summed(&atlas::fingers_at(&model.mesh, &[centre], RADIUS))(0);
    let found = atlas.answer(atlas.nearest(centre)).value;
    assert!(
        (&found - &truth).norm() < 0.01 * truth.norm(),
        "{} of {}",
        (&found - &truth).norm(),
        truth.norm()
    );
}

#[test]
fn settings_without_sense_are_named() {
    let Disc { skin, model, .. } = &*DISC;
    let error = Resolver::new(skin, model, Settings { radius: -1.0, snr_db: 60.0 }).unwrap_err();
    assert_eq!(error.to_string(), "`radius` is -1; allowed: a number above zero");
}
