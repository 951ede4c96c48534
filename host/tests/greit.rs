//! GREIT beside Laplace: what its images are worth, and that training does what it says.
//!
//! `cargo test -p dermatome --test greit -- --nocapture` prints the tables.

use dermatome::{
    forward::ForwardModel,
    inverse::{
        DataSpace, Whitening, figures, greit,
        targets::{Responses, Training, Untouched},
    },
    mesh::Lattice,
    model::{Model, forward_model, mesh, pixels_on},
    pixels::Pixels,
    simulate::{Noise, Press, Script, SimulatedSkin},
    skin::{Criterion, Hyperparameter, Inverse, Method, Prior, Skin},
    stimulation::Stimulation,
};
use faer::Mat;
use nalgebra::{Point3, Vector3};
use rand::SeedableRng;
use rand_distr::{Distribution, Normal};
use rand_pcg::Pcg64Mcg;
use std::{f64::consts::TAU, path::Path};

fn disc() -> Skin {
    Skin::load(&Path::new(env!("CARGO_MANIFEST_DIR")).join("../models/disc-210mm/skin.toml"))
        .unwrap()
        .made()
        .unwrap()
}

const GREIT: Method = Method::Greit { radius: 0.2 };
const LAPLACE: Method = Method::OneStep(Prior::Laplace);

fn at_noise_figure(method: Method, asked: f64) -> Model {
    let mut skin = disc();
    skin.inverse.method = method;
    skin.inverse.hyperparameter = Hyperparameter::Chosen(Criterion::NoiseFigure(asked));
    Model::build(&skin, |_| ()).unwrap()
}

/// Figures of merit of one image (Adler et al. 2009), lengths as shares of the diameter.
struct Figures {
    position_error: f64,
    resolution: f64,
    ringing: f64,
    deformation: f64,
}

impl Figures {
    fn of(image: &[f64], pixels: &Pixels, truth: [f64; 2], diameter: f64) -> Self {
        let level = image.iter().copied().fold(0.0, f64::max) / 4.0;
        let inside: Vec<usize> = (0..image.len()).filter(|&i| image[i] > level).collect();
        let weight = |i: usize| image[i] * pixels.areas[i];
        let total: f64 = inside.iter().map(|&i| weight(i)).sum();
        let centre = Point3::from(
            inside.iter().map(|&i| pixels.centres[i].coords * weight(i)).sum::<Vector3<f64>>() / total,
        );
        let area: f64 = inside.iter().map(|&i| pixels.areas[i]).sum();
        let in_circle = |i: usize| (pixels.centres[i] - centre).norm_squared() < area / (TAU / 2.0);
        let negative = |i: usize| if in_circle(i) { 0.0 } else { -weight(i).min(0.0) };
        let outside: f64 = inside.iter().filter(|&&i| !in_circle(i)).map(|&i| pixels.areas[i]).sum();
        Self {
            position_error: (centre.x - truth[0]).hypot(centre.y - truth[1]) / diameter,
            resolution: (area / pixels.areas.iter().sum::<f64>()).sqrt(),
            ringing: (0..image.len()).map(negative).sum::<f64>() / total,
            deformation: outside / area,
        }
    }
}

/// Fingers at equal angles on rings of these radii, shares of the skin's radius.
const RINGS: [f64; 9] = [0.0, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8];
const ANGLES: usize = 12;

/// Where a finger is, m, and the change of voltages under it: `[step]`.
type Pressed = ([f64; 2], Vec<f64>);

/// Change of voltages under each finger at 60 dB on a finer, turned mesh, and where it is:
/// `[ring][angle]`; and the voltages of the untouched skin.
fn pressed(skin: &Skin) -> (Vec<Vec<Pressed>>, Vec<f64>) {
    let outline = skin.shape.flat().unwrap();
    let nobody = Script::still(&[], outline).unwrap();
    let simulated = SimulatedSkin::new(skin, nobody, Noise { snr_db: 60.0, seed: 1 }).unwrap();
    let (steps, radius) = (skin.steps(), outline.diameter() / 2.0);
    let reference = simulated.voltages(&steps, &[]);
    let mean_square = reference.iter().map(|v| v * v).sum::<f64>() / reference.len() as f64;
    let noise = Normal::new(0.0, mean_square.sqrt() * 1e-3).unwrap();
    let mut random = Pcg64Mcg::seed_from_u64(5);
    let mut press = |ring: f64, angle: usize| {
        let angle = (angle as f64 + ring) / ANGLES as f64 * TAU;
        let position = [ring * radius * angle.cos(), ring * radius * angle.sin()];
        let voltages = simulated.voltages(&steps, &[Press::finger(position, 0.1 * radius, 1.0)]);
        let change =
            voltages.iter().zip(&reference).map(|(v, r)| v - r + noise.sample(&mut random)).collect();
        (position, change)
    };
    (RINGS.iter().map(|&ring| (0..ANGLES).map(|angle| press(ring, angle)).collect()).collect(), reference)
}

#[test]
fn at_equal_noise_figure_greit_places_fingers_better_and_more_evenly_than_laplace() {
    let skin = disc();
    let diameter = skin.shape.flat().unwrap().diameter();
    let (fingers, reference) = pressed(&skin);
    println!("fingers of 21 mm on disc-210mm, 60 dB, noise figure 0.5; position error in % of the diameter");
    println!("          r/R   PE mean   PE max     RES     RNG      SD");
    let mut worst = [0.0; 2];
    for (row, (name, method)) in [("Laplace", LAPLACE), ("GREIT", GREIT)].into_iter().enumerate() {
        let model = at_noise_figure(method, 0.5);
        assert!((model.noise_figure() - 0.5).abs() < 1e-3);
        for (ring, fingers) in RINGS.iter().zip(&fingers) {
            let figures: Vec<Figures> = fingers
                .iter()
                .map(|(truth, change)| {
                    Figures::of(&model.image(change, &reference), &model.pixels, *truth, diameter)
                })
                .collect();
            let mean = |of: fn(&Figures) -> f64| figures.iter().map(of).sum::<f64>() / figures.len() as f64;
            let largest = figures.iter().map(|f| f.position_error).fold(0.0, f64::max);
            println!(
                "{name:<8} {ring:4.1}  {:8.2} {:8.2}  {:6.3}  {:6.3}  {:6.3}",
                100.0 * mean(|f| f.position_error),
                100.0 * largest,
                mean(|f| f.resolution),
                mean(|f| f.ringing),
                mean(|f| f.deformation)
            );
            worst[row] = f64::max(worst[row], largest);
        }
    }
    println!("worst position error: Laplace {:.2} %, GREIT {:.2} %", 100.0 * worst[0], 100.0 * worst[1]);
    assert!(worst[1] <= 0.02, "GREIT is off by {}", worst[1]);
    assert!(worst[1] < worst[0]);
}

/// Training targets of a skin, its pixels, and the whitening of normalised data.
fn trained(skin: &Skin) -> (Training, Pixels, Whitening, Vec<f64>) {
    let mesh = mesh(skin, 1.0, Lattice::default()).unwrap();
    let forward: ForwardModel = forward_model(skin, &mesh).unwrap();
    let fields = forward.solve(&vec![1.0; mesh.elements.len()]).unwrap();
    let Stimulation { steps, combination } = skin.stimulation();
    let inverse = Inverse { method: GREIT, ..skin.inverse.clone() };
    let untouched =
        Untouched { mesh: &mesh, forward: &forward, admittivity: 1.0, fields: &fields, steps: &steps };
    let responses = Responses::simulate(&untouched, &inverse, &combination).unwrap();
    let voltages = dermatome::jacobian::combine_voltages(&fields.voltages(&steps), &combination);
    let weights: Vec<f64> = voltages.iter().map(|v| 1.0 / (v * v)).collect();
    let pixels = pixels_on(skin, &mesh).unwrap();
    (responses.training.unwrap(), pixels, Whitening::from_weights(&weights).unwrap(), voltages)
}

fn norm(matrix: &Mat<f64>) -> f64 {
    matrix.norm_l2()
}

#[test]
fn without_noise_training_targets_give_their_desired_images() {
    let (training, pixels, whitening, _) = trained(&disc());
    let answers = whitening.transposed(&training.responses);
    let space: DataSpace = greit::data_space(&training, &whitening, &pixels, 0.2, None);
    let desired = greit::desired_images(&training, &pixels.centres, 0.2);
    let residual = |weight: f64| {
        let images = space.matrix(weight).unwrap() * answers.transpose();
        norm(&(images - &desired)) / norm(&desired)
    };
    let [none, some, much] = [1e-4, 1.0, 100.0].map(residual);
    println!(
        "images of training targets differ from the desired ones by {none:.3}, {some:.3}, {much:.3} at weights 1e-4, 1, 100"
    );
    // 104 measurements cannot give edges as steep everywhere.
    assert!(none < 0.3, "{none}");
    assert!(none < some && some < much);
}

#[test]
fn training_targets_are_placed_to_a_hundredth_of_the_diameter() {
    let skin = disc();
    let (training, pixels, whitening, _) = trained(&skin);
    let answers = whitening.transposed(&training.responses);
    let space = greit::data_space(&training, &whitening, &pixels, 0.2, None);
    let images = space.matrix(1.0).unwrap() * answers.transpose();
    let mut worst: f64 = 0.0;
    for (target, centre) in training.centres.iter().enumerate().filter(|(_, c)| c.coords.norm() < 0.8 * 0.105)
    {
        let image: Vec<f64> = images.col(target).iter().copied().collect();
        worst = worst.max(Figures::of(&image, &pixels, [centre.x, centre.y], 0.21).position_error);
    }
    println!("worst position error of a training target: {:.2} % of the diameter", 100.0 * worst);
    assert!(worst < 0.01, "{worst}");
}

#[test]
fn desired_images_hold_as_much_as_their_targets() {
    let (training, pixels, ..) = trained(&disc());
    let desired = greit::desired_images(&training, &pixels.centres, 0.2);
    let inner = (0..training.areas.len()).filter(|&k| training.centres[k].coords.norm() < 0.7 * 0.105);
    for target in inner {
        let integral: f64 =
            desired.col(target).iter().zip(&pixels.areas).map(|(value, area)| value * area).sum();
        assert!((integral / training.areas[target] - 1.0).abs() < 0.05, "{integral}");
    }
}

/// A small change of conductivity answers as the Jacobian says, which is why targets need no forward
/// solution of their own; a finger that doubles it differs mostly in size.
#[test]
fn linear_targets_stand_for_solved_ones() {
    let skin = disc();
    let mesh = mesh(&skin, 1.0, Lattice::default()).unwrap();
    let forward: ForwardModel = forward_model(&skin, &mesh).unwrap();
    let steps = skin.steps();
    let untouched = forward.solve(&vec![1.0; mesh.elements.len()]).unwrap();
    let patches = dermatome::pixels::element_patches(&mesh, 1000);
    let jacobian = dermatome::jacobian::jacobian(&mesh, &untouched, &steps, &patches);
    for target in (0..1000).step_by(97) {
        let solved = |change: f64| -> Vec<f64> {
            let mut conductivity = vec![1.0; mesh.elements.len()];
            patches.elements[target]
                .iter()
                .for_each(|&(element, share)| conductivity[element] += change * share);
            let voltages = forward.solve(&conductivity).unwrap().voltages(&steps);
            voltages.iter().zip(untouched.voltages(&steps)).map(|(v, r)| v - r).collect()
        };
        let linear: Vec<f64> = jacobian.col(target).iter().copied().collect();
        let cosine = |a: &[f64], b: &[f64]| {
            let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
            dot(a, b) / (dot(a, a) * dot(b, b)).sqrt()
        };
        let small = solved(1e-4);
        let error: f64 = small.iter().zip(&linear).map(|(s, l)| (s / 1e-4 - l).powi(2)).sum();
        assert!(error.sqrt() < 1e-3 * linear.iter().map(|l| l * l).sum::<f64>().sqrt());
        let likeness = cosine(&solved(1.0), &linear);
        // The least of all is 0.988.
        assert!(likeness > 0.985, "{likeness}");
    }
}

#[test]
fn signal_to_noise_of_data_is_mean_magnitude_over_root_mean_variance() {
    let got = figures::signal_to_noise(&[1.0, -3.0], &[1.0, 7.0]);
    assert!((got - 2.0 / 5.0).abs() < 1e-12);
}
