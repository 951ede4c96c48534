use super::*;
use std::{path::Path, sync::LazyLock};

const RADIUS: f64 = 0.0126;

struct Disc {
    skin: Skin,
    model: Model,
}

static DISC: LazyLock<Disc> = LazyLock::new(|| {
    let file = concat!(env!("CARGO_MANIFEST_DIR"), "/../../models/disc-210mm/skin.toml");
    let skin = Skin::load(Path::new(file)).unwrap().made().unwrap();
    let model = Model::build(&skin, |_| ()).unwrap();
    Disc { skin, model }
});

#[test]
fn what_is_beside_a_strong_finger_belongs_to_it_and_a_weak_one_is_none() {
    let finger = |x: f64, strength: f64| FittedContact { position: Point3::new(x, 0.0, 0.0), strength };
    let fingers = joined(vec![finger(0.0, 0.6), finger(0.08, 0.1), finger(0.02, 0.2)], 2.0 * RADIUS);
    assert_eq!(fingers.len(), 2);
    assert!((fingers[0].position.x - 0.005).abs() < 1e-12 && (fingers[0].strength - 0.8).abs() < 1e-12);
    assert_eq!(strong(fingers).len(), 1);
}

/// Between nodes the polynomials meet the response that is summed there.
#[test]
fn responses_between_nodes_are_those_of_a_finger_there() {
    let Disc { skin, model } = &*DISC;
    let summed = |fingers: &Pixels| {
        let responses = responses(skin, model, fingers, 1.0).unwrap();
        move |finger: usize| DVector::from_fn(responses.nrows(), |m, _| responses[(m, finger)])
    };
    let atlas = Atlas::new(&model.mesh, summed(&atlas::fingers(&model.mesh, RADIUS)));
    let centre = (0..model.mesh.elements.len())
        .map(|element| dermatome_geometry::mesh::triangle::centroid(model.mesh.corners(element)))
        .find(|centre| (centre.coords.norm() - 0.08).abs() < 1e-3)
        .unwrap();
    let truth = summed(&atlas::fingers_at(&model.mesh, &[centre], RADIUS))(0);
    let found = atlas.response(atlas.nearest(centre)).value;
    assert!(
        (&found - &truth).norm() < 0.01 * truth.norm(),
        "{} of {}",
        (&found - &truth).norm(),
        truth.norm()
    );
}

#[test]
fn settings_without_sense_are_named() {
    let Disc { skin, model } = &*DISC;
    let error = MultiContactFit::new(skin, model, Settings { radius: -1.0, snr_db: 60.0 }).unwrap_err();
    assert_eq!(error.to_string(), "`radius` is -1; allowed: a number above zero");
}
