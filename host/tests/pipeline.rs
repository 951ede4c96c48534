//! Properties of the way from skin file to matrix that hold whatever the numbers are.

use dermatome::{
    forward::ForwardModel,
    jacobian::{combine_rows, combine_voltages},
    mesh::{Lattice, Mesh},
    model::{Model, forward_model, mesh},
    skin::{ImageLayout, Reciprocal, Skin},
    stimulation::Stimulation,
};
use dermatome_shared::patch::Difference;
use faer::{Col, Mat as Matrix};
use std::{f64::consts::PI, path::Path};

fn load(name: &str) -> Skin {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../models").join(name).join("skin.toml");
    Skin::load(&path).unwrap().made().unwrap()
}

/// A coarse variant, quick to solve many times.
fn coarse(name: &str) -> Skin {
    let mut skin = load(name);
    skin.edges = skin.edges.scaled(2.5);
    skin.image = ImageLayout::Grid { columns: 12 };
    skin
}

fn meshed(skin: &Skin, fineness: f64) -> (Mesh, ForwardModel) {
    let mesh = mesh(skin, fineness, Lattice::default()).unwrap();
    let forward = forward_model(skin, &mesh).unwrap();
    (mesh, forward)
}

#[test]
fn every_shipped_skin_builds_about_4000_elements_and_800_pixels() {
    for name in ["disc-210mm", "square-50mm", "square-210mm"] {
        let model = Model::build(&load(name), |_| ()).unwrap();
        assert!((3_800..4_200).contains(&model.mesh.elements.len()), "{name}: {}", model.mesh.elements.len());
        assert_eq!((model.steps.len(), model.jacobian.nrows()), (208, 104), "{name}");
        assert!((780..820).contains(&model.jacobian.ncols()), "{name}: {}", model.jacobian.ncols());
    }
}

/// Point electrodes on a homogeneous disc: v = I / (pi sigma) * sum of +-ln of distances, in the
/// limit of fine meshes, because the rim's potential of a dipole of point currents is logarithmic.
#[test]
fn point_electrodes_on_a_disc_approach_the_closed_form() {
    let text = include_str!("../../models/disc-210mm/skin.toml")
        .replace("model = \"complete\"", "model = \"point\"")
        .replace("width = \"11 mm\"", "")
        .replace("contact_impedance = \"0.18 ohm m\"", "");
    let skin = Skin::parse(Path::new("point.toml"), &text).unwrap().made().unwrap();
    let centres = skin.shape.electrode_centres();
    let error = |edge_length: f64| {
        let (mesh, forward) = meshed(&skin, edge_length / skin.edges.skin);
        let voltages = forward.solve(&vec![1.0; mesh.elements.len()]).unwrap().voltages(&skin.steps());
        let position = |electrode: u8| centres[usize::from(electrode)];
        let log_distance = |a: u8, b: u8| (position(a) - position(b)).norm().ln();
        let exact = skin.steps().into_iter().map(|step| {
            let [dp, dm, sp, sm] = step.to_bytes();
            (log_distance(sp, dm) - log_distance(sp, dp) - log_distance(sm, dm) + log_distance(sm, dp)) / PI
        });
        voltages.iter().zip(exact).map(|(v, e)| ((v - e) / e).abs()).fold(0.0, f64::max)
    };
    let (rough, fine) = (error(6e-3), error(3e-3));
    assert!(fine < 3e-3, "{fine:e}");
    assert!(fine < rough / 2.5, "error {rough:e} -> {fine:e} when edges halve: not second order");
}

/// A uniform change of conductivity scales all voltages of point electrodes: J 1 = -v.
#[test]
fn pixels_together_make_up_the_whole_skin() {
    let text = include_str!("../../models/disc-210mm/skin.toml")
        .replace("model = \"complete\"", "model = \"point\"")
        .replace("width = \"11 mm\"", "")
        .replace("contact_impedance = \"0.18 ohm m\"", "");
    let skin = Skin::parse(Path::new("point.toml"), &text).unwrap().made().unwrap();
    let model = Model::build(&skin, |_| ()).unwrap();
    for (m, voltage) in model.measurements().iter().enumerate() {
        let sum: f64 = model.jacobian.row(m).iter().sum();
        assert!(
            (sum + voltage).abs() < 1e-9 * voltage.abs().max(0.01),
            "measurement {m}: {sum} against {voltage}"
        );
    }
}

#[test]
fn averaging_reciprocal_pairs_loses_nothing() {
    for difference in [Difference::Plain, Difference::Normalised] {
        let mut skin = coarse("disc-210mm");
        skin.inverse.difference = difference;
        let combined = Model::build(&skin, |_| ()).unwrap();
        skin.drive.reciprocal = Reciprocal::Kept;
        let kept = Model::build(&skin, |_| ()).unwrap();
        let noisy: Vec<f64> = (0..208).map(|m| (m as f64 * 1.7).sin()).collect();
        let full = &kept.conductivity_from_difference * Col::from_fn(208, |m| noisy[m]);
        let folded = combine_voltages(&noisy, &combined.combination);
        let short = &combined.conductivity_from_difference * Col::from_fn(104, |m| folded[m]);
        let peak = full.iter().fold(0.0, |max: f64, value| max.max(value.abs()));
        for (a, b) in full.iter().zip(short.iter()) {
            assert!((a - b).abs() < 1e-9 * peak, "{difference:?}: {a} against {b}");
        }
    }
}

#[test]
fn swapping_drive_and_sense_gives_the_same_voltage() {
    let skin = coarse("square-50mm");
    let (mesh, forward) = meshed(&skin, 1.0);
    let fields = forward.solve(&vec![1.0; mesh.elements.len()]).unwrap();
    for step in skin.steps() {
        let [a, b, c, d] = step.to_bytes();
        let swapped = dermatome_shared::stimulation::Step::from_bytes([c, d, a, b]);
        assert!((fields.voltage(step) - fields.voltage(swapped)).abs() < 1e-11);
    }
}

#[test]
fn a_conductivity_that_is_not_positive_is_refused() {
    let skin = coarse("disc-210mm");
    let (mesh, forward) = meshed(&skin, 1.0);
    assert!(forward.solve(&vec![-1.0; mesh.elements.len()]).is_err());
    assert!(forward.solve(&vec![0.0; mesh.elements.len()]).is_err());
    let error = forward.solve(&[1.0]).unwrap_err().to_string();
    assert!(error.contains("got 1"), "{error}");
}

#[test]
fn combined_rows_are_means_of_their_steps() {
    let skin = coarse("disc-210mm");
    let Stimulation { steps, combination } = skin.stimulation();
    let rows = Matrix::from_fn(steps.len(), 1, |step, _| step as f64);
    let combined = combine_rows(&rows, &combination);
    // Step 0 (drive 0-1, sense 2-3) has its reciprocal at drive 2-3, sense 0-1: step 2 * 13.
    assert_eq!(combined[(0, 0)], (0.0 + 26.0) / 2.0);
}
