//! Sheets with a grain and with a map of their conductivity, against closed forms and finite differences.
//!
//! A conductivity tensor S in the plane is a coordinate transform: with p' = S^-1/2 p the sheet is isotropic, of
//! conductivity root det S.

use dermatome::{
    forward::{Fields, ForwardModel, SheetTensors},
    jacobian::jacobian,
    mesh::{Lattice, Mesh},
    model::{self, Model, forward_model},
    pixels,
    recorded::{fit::fit, order::Arrangement},
    simulate::{Press, TrueSkin},
    skin::Skin,
};
use dermatome_shared::stimulation::{Driven, Step, pattern};
use nalgebra::{Matrix2, Point3};
use num_complex::Complex64;
use std::path::Path;

const DISC: &str = include_str!("../../models/disc-210mm/skin.toml");
const CONDUCTIVITY: &str = "sheet_conductivity = \"5.88 mS\"";
const GRAIN: &str =
    "sheet_conductivity = \"5.88 mS\"\nsheet_conductivity_across = \"2.1 mS\"\ngrain = \"25 deg\"";
/// Of the conductivities in [`GRAIN`].
const ACROSS: f64 = 2.1 / 5.88;
const MAP: &str = "\nconductivity_map = [[\"-60 mm\", 0, 0.7], [\"60 mm\", 0, 1.3], [0, \"70 mm\", 2.0], [0, \"-70 mm\", 0.9]]";

fn parsed(text: &str) -> Skin {
    Skin::parse(Path::new("disc.toml"), text).unwrap().made().unwrap()
}

fn disc(material: &str) -> Skin {
    parsed(&DISC.replace(CONDUCTIVITY, material))
}

fn points(text: &str) -> String {
    text.replace("model = \"complete\"", "model = \"point\"")
        .replace("width = \"11 mm\"", "")
        .replace("contact_impedance = \"0.18 ohm m\"", "")
}

fn voltages(skin: &Skin, mesh: &Mesh) -> Vec<f64> {
    let model = forward_model::<f64>(skin, mesh).unwrap();
    model.solve(&vec![1.0; mesh.elements.len()]).unwrap().voltages(&skin.steps())
}

/// Largest difference over the largest expected value.
fn largest_error(values: &[f64], expected: &[f64]) -> f64 {
    let largest = expected.iter().map(|v| v.abs()).fold(0.0, f64::max);
    values.iter().zip(expected).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max) / largest
}

#[test]
fn a_sheet_with_a_grain_is_one_without_on_stretched_coordinates() {
    let skin = parsed(&points(&DISC.replace(CONDUCTIVITY, GRAIN)));
    let mesh = model::mesh(&skin, 1.0, Lattice::default()).unwrap();
    let (sine, cosine) = 25_f64.to_radians().sin_cos();
    let turn = Matrix2::new(cosine, -sine, sine, cosine);
    let to_isotropic = turn * Matrix2::new(1.0, 0.0, 0.0, ACROSS.powf(-0.5)) * turn.transpose();
    let mut stretched = mesh.clone();
    for node in &mut stretched.nodes {
        let moved = to_isotropic * node.coords.xy();
        *node = Point3::new(moved.x, moved.y, 0.0);
    }
    let isotropic: ForwardModel = ForwardModel::new(&stretched, &[1.0; 16]).unwrap();
    let fields = isotropic.solve(&vec![ACROSS.sqrt(); mesh.elements.len()]).unwrap();
    let error = largest_error(&voltages(&skin, &mesh), &fields.voltages(&skin.steps()));
    println!("anisotropic disc against the stretched isotropic mesh: {error:.1e}");
    assert!(error < 1e-11, "{error:e}");
}

/// Meshes of their own: a disc with a grain along x, and an ellipse that is longer across it.
#[test]
fn a_disc_with_a_grain_is_an_ellipse_without() {
    let across = 0.36_f64;
    let stretch = across.powf(-0.5);
    let around = |angle: f64| [0.105 * angle.cos(), 0.105 * angle.sin()];
    let of_each = |place: &dyn Fn([f64; 2]) -> [f64; 2]| -> Vec<[f64; 2]> {
        (0..16).map(|e| place(around(std::f64::consts::TAU * f64::from(e) / 16.0))).collect()
    };
    let skin = |material: &str, shape: &str, positions: Vec<[f64; 2]>| {
        let placement = format!("placement = \"points\"\npositions = {positions:?}");
        let text = points(&DISC.replace(CONDUCTIVITY, material))
            .replace("placement = \"rim\"", &placement)
            .replace("first = \"90 deg\"", "")
            .replace("direction = \"clockwise\"", "")
            .replace("kind = \"disc\"\ndiameter = \"210 mm\"", shape)
            .replace(
                "edge_length = \"4.5 mm\"",
                "edge_length = \"4.5 mm\"\nelectrode_edge_length = \"0.5 mm\"",
            );
        parsed(&text)
    };
    let grain = format!("{CONDUCTIVITY}\nsheet_conductivity_across = {}", 5.88e-3 * across);
    let disc = skin(&grain, "kind = \"disc\"\ndiameter = \"210 mm\"", of_each(&|place| place));
    let ellipse = format!("kind = \"ellipse\"\nwidth = 0.21\nheight = {}", 0.21 * stretch);
    let ellipse = skin(CONDUCTIVITY, &ellipse, of_each(&|[x, y]| [x, y * stretch]));
    let of = |skin: &Skin| voltages(skin, &model::mesh(skin, 1.0, Lattice::default()).unwrap());
    let expected: Vec<f64> = of(&ellipse).iter().map(|v| v / across.sqrt()).collect();
    let error = largest_error(&of(&disc), &expected);
    println!("anisotropic disc against an isotropic ellipse, meshed apart: {error:.1e}");
    assert!(error < 3e-3, "{error:e}");
    // Without the grain it is another skin.
    let plain = skin(CONDUCTIVITY, "kind = \"disc\"\ndiameter = \"210 mm\"", of_each(&|place| place));
    assert!(largest_error(&of(&plain), &expected) > 0.1);
}

/// Bent without being stretched, a sheet is what it was: the grain goes round with it.
#[test]
fn a_cylinder_has_the_voltages_of_its_flat_sheet() {
    let skin = |shape: &str, grain: &str| {
        let material = format!("{CONDUCTIVITY}\nsheet_conductivity_across = \"2 mS\"\ngrain = \"{grain}\"");
        parsed(
            &DISC
                .replace(CONDUCTIVITY, &material)
                .replace("kind = \"disc\"\ndiameter = \"210 mm\"", shape)
                .replace("columns = 32", "pixels = 300"),
        )
    };
    let flat = |grain| skin("kind = \"rectangle\"\nwidth = 0.2\nheight = 0.15", grain);
    let bent = |grain| skin("kind = \"cylinder\"\nradius = 0.1\nangle = 2\nheight = 0.15", grain);
    let of = |skin: &Skin| voltages(skin, &model::mesh(skin, 1.0, Lattice::default()).unwrap());
    for grain in ["0 deg", "90 deg"] {
        let error = largest_error(&of(&bent(grain)), &of(&flat(grain)));
        println!("cylinder against its flat sheet, grain at {grain}: {error:.1e}");
        assert!(error < 1e-3, "{grain}: {error:e}");
    }
    assert!(largest_error(&of(&flat("0 deg")), &of(&flat("90 deg"))) > 0.1);
}

/// A strip between electrodes along its ends.
#[test]
fn a_strip_with_a_map_has_the_resistance_of_its_integral() {
    let text = |material: &str| {
        DISC.replace(CONDUCTIVITY, material)
            .replace(
                "kind = \"disc\"\ndiameter = \"210 mm\"",
                "kind = \"rectangle\"\nwidth = 0.2\nheight = 0.1",
            )
            .replace("count = 16", "count = 4")
            .replace("width = \"11 mm\"", "width = [0.0999, 0.001, 0.0999, 0.001]")
            .replace("contact_impedance = \"0.18 ohm m\"", "contact_impedance = \"1e-9 ohm m\"")
            .replace("placement = \"rim\"", "placement = \"sides\"\npitch = \"1 mm\"")
            .replace("first = \"90 deg\"", "first = \"45 deg\"")
            .replace("pattern = \"adjacent\"", "pattern = \"table\"\ntable = [[1, 3, 1, 3]]")
            .replace("reciprocal = \"combined\"", "reciprocal = \"kept\"")
    };
    let resistance = |material: &str| {
        let skin = parsed(&text(material));
        voltages(&skin, &model::mesh(&skin, 0.5, Lattice::default()).unwrap())[0].abs()
    };
    let plain = resistance(CONDUCTIVITY);
    assert!((plain - 2.0).abs() < 0.01, "{plain}");
    // The logarithm goes straight from ln(1/2) to ln 2 along the axis: the integral of 2 * 4^-t over t from 0 to 1.
    let map = format!("{CONDUCTIVITY}\nconductivity_map = [[-0.1, 0, 0.5], [0.1, 0, 2]]");
    let found = resistance(&map);
    // Off the axis it is by the distances to two points, a little less far from the middle.
    let exact = 2.0 * (2.0 - 0.5) / 4_f64.ln();
    assert!((found / exact - 1.0).abs() < 0.05, "{found} {exact}");
    let along = resistance(&format!("{CONDUCTIVITY}\nsheet_conductivity_across = 1e-3"));
    assert!((along / plain - 1.0).abs() < 0.01, "{along}");
    let across =
        resistance(&format!("{CONDUCTIVITY}\nsheet_conductivity_across = 1.47e-3\ngrain = \"90 deg\""));
    assert!((across / plain / 4.0 - 1.0).abs() < 0.01, "{across}");
}

fn bent(mut mesh: Mesh) -> Mesh {
    mesh.nodes.iter_mut().for_each(|node| node.z = 0.3 * node.x - 5.0 * node.y * node.y);
    mesh
}

#[test]
fn jacobian_of_a_sheet_with_grain_and_map_agrees_with_finite_differences() {
    let skin = disc(&format!("{GRAIN}{MAP}"));
    let flat = model::mesh(&skin, 3.0, Lattice::default()).unwrap();
    let steps: Vec<Step> = pattern(16, 1, 1, Driven::Measured).collect();
    for (place, mesh) in [("flat", flat.clone()), ("bent", bent(flat))] {
        let model = forward_model::<f64>(&skin, &mesh).unwrap();
        let untouched = vec![1.0; mesh.elements.len()];
        let fields: Fields = model.solve(&untouched).unwrap();
        let jacobian = jacobian(&mesh, &fields, &steps, &pixels::per_element(&mesh));
        let under = mesh.electrodes[5].nodes().next().unwrap();
        let under = mesh.elements.iter().position(|element| element.contains(&under)).unwrap();
        for element in [7, mesh.elements.len() / 2, under] {
            let at = |change: f64| {
                let mut changed = untouched.clone();
                changed[element] += change;
                model.solve(&changed).unwrap().voltages(&steps)
            };
            let (up, down) = (at(1e-4), at(-1e-4));
            let expected: Vec<f64> = up.iter().zip(&down).map(|(a, b)| (a - b) / 2e-4).collect();
            let column: Vec<f64> = jacobian.col(element).iter().copied().collect();
            let error = largest_error(&column, &expected);
            println!("{place}, element {element}: Jacobian against finite differences {error:.1e}");
            assert!(error < 1e-6, "{place} {element}: {error:e}");
        }
    }
}

/// On a woven sheet the model that knows the grain places presses where they are.
#[test]
fn images_of_a_sheet_with_a_grain_are_right_with_its_matrix() {
    let (woven, plain) = (disc(GRAIN), disc(CONDUCTIVITY));
    let truth = TrueSkin::new(&woven).unwrap();
    let steps = woven.steps();
    let reference = truth.voltages(&truth.conductivity(&[]), &steps);
    let errors = |skin: &Skin| -> Vec<f64> {
        let model = Model::build(skin, |_| ()).unwrap();
        let of_press = |place: [f64; 2]| {
            let pressed = truth.voltages(&truth.conductivity(&[Press::finger(place, 0.01, 1.0)]), &steps);
            let change: Vec<f64> = pressed.iter().zip(&reference).map(|(a, b)| a - b).collect();
            let image = model.image(&change, &reference);
            let peak = (0..image.len()).max_by(|&a, &b| image[a].total_cmp(&image[b])).unwrap();
            (model.pixels.centres[peak] - Point3::new(place[0], place[1], 0.0)).norm()
        };
        [[0.03, 0.04], [-0.05, 0.02], [0.0, -0.06], [0.06, -0.03]].map(of_press).to_vec()
    };
    let (right, wrong) = (errors(&woven), errors(&plain));
    println!("peak off by {right:.4?} m with the grain, {wrong:.4?} m without");
    let mean = |errors: &[f64]| errors.iter().sum::<f64>() / errors.len() as f64;
    assert!(mean(&right) < 0.006, "{right:?}");
    assert!(mean(&wrong) > 2.0 * mean(&right), "{wrong:?} {right:?}");
}

/// A frame of a woven skin from a mesh of its own at 60 dB, and a skin file that is wrong about the grain.
#[test]
fn a_fit_finds_the_grain() {
    let fine = |material: &str| {
        let edges = "edge_length = \"4.5 mm\"\nelectrode_edge_length = \"1 mm\"";
        parsed(&DISC.replace(CONDUCTIVITY, material).replace("edge_length = \"4.5 mm\"", edges))
    };
    let truth = fine(GRAIN);
    let true_skin = TrueSkin::new(&truth).unwrap();
    let voltages = true_skin.voltages(&true_skin.conductivity(&[]), &truth.steps());
    let size = (voltages.iter().map(|v| v * v).sum::<f64>() / voltages.len() as f64).sqrt();
    let noise = |step: usize| 1e-3 * size * (1.9 * step as f64 + 0.3 * (step * step) as f64).sin() * 1.4;
    let frame: Vec<_> =
        voltages.iter().enumerate().map(|(step, v)| Complex64::from(0.2 * (v + noise(step)))).collect();
    for wrong in [
        "sheet_conductivity_across = \"5.88 mS\"",
        "sheet_conductivity_across = \"4 mS\"\ngrain = \"-20 deg\"",
    ] {
        let found = fit(&fine(&format!("{CONDUCTIVITY}\n{wrong}")), &frame, &Arrangement::default()).unwrap();
        let grain = found.grain.unwrap();
        println!("{grain:.4?}, {:.3} % left of {:.1}", found.residual_percent, found.residual_before_percent);
        assert!((grain.across / ACROSS - 1.0).abs() < 0.02, "{grain:?}");
        assert!((grain.angle_degrees - 25.0).abs() < 1.0, "{grain:?}");
        assert!((found.scale / 0.2 - 1.0).abs() < 0.01, "{}", found.scale);
        assert!(found.residual_percent < 0.15 && found.residual_before_percent > 5.0);
    }
    let plain = fit(&fine(CONDUCTIVITY), &frame, &Arrangement::default()).unwrap();
    assert!(plain.grain.is_none() && plain.residual_percent > 1.0, "{}", plain.residual_percent);
}

#[test]
fn tensors_of_a_uniform_sheet_are_none_and_of_a_grain_have_its_eigenvalues() {
    let mesh = bent(model::mesh(&disc(CONDUCTIVITY), 3.0, Lattice::default()).unwrap());
    assert!(SheetTensors::new(&disc(CONDUCTIVITY).material, &mesh).tensor(0).is_none());
    let tensors = SheetTensors::new(&disc(GRAIN).material, &mesh);
    for element in 0..mesh.elements.len() {
        let mut found: Vec<f64> =
            tensors.tensor(element).unwrap().symmetric_eigenvalues().iter().copied().collect();
        found.sort_by(f64::total_cmp);
        let expected = [0.0, ACROSS, 1.0];
        assert!(found.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-12), "{found:?}");
    }
}

#[test]
fn what_is_no_grain_and_no_map_is_refused() {
    let refused = |material: &str| {
        let text = DISC.replace(CONDUCTIVITY, &format!("{CONDUCTIVITY}\n{material}"));
        Skin::parse(Path::new("disc.toml"), &text).unwrap_err().to_string()
    };
    let all: [(&str, &[&str]); 8] = [
        ("grain = \"20 deg\"", &["`material.grain`", "only with `sheet_conductivity_across`"]),
        (
            "sheet_conductivity_across = \"5 uS\"",
            &["`material.sheet_conductivity_across`", "0.01 to 100 times"],
        ),
        ("sheet_conductivity_across = -1", &["`material.sheet_conductivity_across` is -1"]),
        ("conductivity_map = []", &["`material.conductivity_map` is 0 points", "1 to 1000"]),
        ("conductivity_map = [[0, 0, 0]]", &["is 0 at 0, 0, 0 mm", "0.01 to 100"]),
        ("conductivity_map = [[0, 1]]", &["is [0, 1]", "rows of x, y"]),
        ("conductivity_map = [[0, 0, 1], [0, 0, 2]]", &["is 0, 0, 0 mm", "each point once"]),
        ("conductivity_map = \"none.csv\"", &["none.csv", "x_m,y_m,relative"]),
    ];
    for (material, words) in all {
        let error = refused(material);
        assert!(words.iter().all(|word| error.contains(word)), "{material}: {error}");
    }
}

#[test]
fn a_map_in_a_file_is_the_map_in_the_skin_file() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("map.csv"), "x_m,y_m,relative\n-0.06,0,0.7\n0.06,0,1.3\n").unwrap();
    let read = |map: &str| {
        let text = DISC.replace(CONDUCTIVITY, &format!("{CONDUCTIVITY}\nconductivity_map = {map}"));
        Skin::parse(&folder.path().join("skin.toml"), &text).unwrap().material
    };
    assert_eq!(read("\"map.csv\""), read("[[\"-60 mm\", 0, 0.7], [\"60 mm\", 0, 1.3]]"));
}
