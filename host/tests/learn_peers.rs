//! `learn` beside regressions from measurements to places, on simulated skins that their model does not know.

mod peers;

use dermatome::{
    learn::{
        Learnt, Request, Strength,
        judge::judge_board,
        learn,
        presses::{Positions, Presses, Recording},
    },
    model::Model,
    recorded::{order::Arrangement, read::Frames},
    simulate::{Press, TrueSkin},
    skin::Skin,
};
use dermatome_shared::patch::PatchView;
use num_complex::Complex64;
use peers::{Features, median, regression, some_of};
use rand::{Rng, SeedableRng};
use rand_distr::{Distribution, StandardNormal};
use rand_pcg::Pcg64Mcg;
use std::{f64::consts::TAU, path::Path};

/// Presses that nothing is learnt from.
const JUDGED: usize = 80;
const MOST_TAUGHT: usize = 100;

/// How a skin differs from its model.
#[derive(Clone, Copy)]
struct Odd {
    name: &'static str,
    /// Opposite drive, where the model's default is adjacent.
    is_opposite: bool,
    /// Conductivity between a third and three times the model's, in smooth spots.
    is_patchy: bool,
    /// Contact impedances and gains of measurements that the model does not know.
    is_uneven: bool,
    /// Only magnitudes are measured.
    is_magnitude: bool,
    /// Radius of what presses, m, least and most.
    radius: [f64; 2],
    /// Change of conductivity in its middle, least and most.
    depth: [f64; 2],
    /// Each press changes the sheet everywhere, as one on foam does: this share of its change, as wide as half the skin.
    halo: f64,
}

const PLAIN: Odd = Odd {
    name: "",
    is_opposite: false,
    is_patchy: true,
    is_uneven: true,
    is_magnitude: false,
    radius: [0.008, 0.008],
    depth: [0.5, 1.5],
    halo: 0.0,
};

const SKINS: [Odd; 6] = [
    Odd { name: "patchy, uneven contacts", ..PLAIN },
    Odd { name: "opposite, magnitudes", is_opposite: true, is_magnitude: true, ..PLAIN },
    Odd { name: "wide presses of all sizes", radius: [0.006, 0.018], ..PLAIN },
    Odd { name: "strengths 1 to 60, saturating", depth: [0.1, 6.0], ..PLAIN },
    Odd { name: "conductivity falls by 0.3 to 0.95", depth: [-0.95, -0.3], is_opposite: true, ..PLAIN },
    Odd { name: "foam: each press is felt far off", halo: 0.3, radius: [0.01, 0.014], ..PLAIN },
];

const TEXT: &str = r#"
name = "odd"
shape = { kind = "disc", diameter = "100 mm" }
mesh = { edge_length = "6 mm" }
material = { sheet_conductivity = "5.88 mS" }
drive = { pattern = "PATTERN", reciprocal = "combined", frequency = "50 kHz", amplitude = "1 mA", frame_rate = "50 Hz" }
inverse = { prior = "noser", hyperparameter = 0.3, normalised = true }
image = { columns = 20 }
contact = { threshold = 0.05 }
[electrodes]
count = 16
placement = "rim"
model = "complete"
width = "5 mm"
contact_impedance = IMPEDANCE
"#;

fn skin(odd: &Odd, impedance: &str) -> Skin {
    let pattern = if odd.is_opposite { "opposite" } else { "adjacent" };
    let text = TEXT.replace("PATTERN", pattern).replace("IMPEDANCE", impedance);
    Skin::parse(Path::new("odd.toml"), &text).unwrap().made().unwrap()
}

fn normal(random: &mut Pcg64Mcg) -> f64 {
    StandardNormal.sample(random)
}

/// Presses at random places of such a skin, at 60 dB, as its model sees them.
fn presses(odd: &Odd, model: &Model, count: usize, seed: u64) -> Presses {
    let mut random = Pcg64Mcg::seed_from_u64(seed);
    let impedances: Vec<String> =
        (0..16).map(|_| format!("\"{:.4} ohm m\"", 0.1 * normal(&mut random).exp())).collect();
    let uneven = format!("[{}]", impedances.join(", "));
    let skin = skin(odd, if odd.is_uneven { &uneven } else { "\"0.1 ohm m\"" });
    let truth = TrueSkin::new(&skin).unwrap();
    let steps = skin.steps();
    let spots: Vec<[f64; 3]> = (0..12)
        .map(|_| {
            let spot = [random.random_range(-0.05..0.05), random.random_range(-0.05..0.05)];
            [spot[0], spot[1], if random.random() { 1.1_f64 } else { -1.1 }]
        })
        .collect();
    let sheet: Vec<f64> = (0..truth.mesh().elements.len())
        .map(|element| {
            let [a, b, c] = truth.mesh().corners(element);
            let (x, y) = ((a.x + b.x + c.x) / 3.0, (a.y + b.y + c.y) / 3.0);
            let near = |[u, v, height]: &[f64; 3]| {
                height * (-((x - u).powi(2) + (y - v).powi(2)) / 0.015_f64.powi(2)).exp()
            };
            if odd.is_patchy { spots.iter().map(near).sum::<f64>().clamp(-1.1, 1.1).exp() } else { 1.0 }
        })
        .collect();
    let gains: Vec<f64> =
        steps.iter().map(|_| if odd.is_uneven { (0.2 * normal(&mut random)).exp() } else { 1.0 }).collect();
    let measure = |presses: &[Press], random: &mut Pcg64Mcg| -> Vec<Complex64> {
        let change = truth.conductivity(presses);
        let conductivity: Vec<f64> = sheet.iter().zip(change).map(|(sheet, change)| sheet * change).collect();
        let voltages = truth.voltages(&conductivity, &steps);
        let size = (voltages.iter().map(|v| v * v).sum::<f64>() / voltages.len() as f64).sqrt() * 1e-3;
        let value = |(v, gain): (&f64, &f64)| {
            let value = gain * v + size * normal(random);
            Complex64::from(if odd.is_magnitude { value.abs() } else { value })
        };
        voltages.iter().zip(&gains).map(value).collect()
    };
    let unpressed = measure(&[], &mut random);
    let (mut values, mut positions) = (Vec::new(), Vec::new());
    for _ in 0..count {
        let (far, angle) = (0.042 * random.random::<f64>().sqrt(), random.random_range(0.0..TAU));
        let at = [far * angle.cos(), far * angle.sin()];
        let radius = random.random_range(odd.radius[0]..=odd.radius[1]);
        let ratio: f64 = odd.depth[1] / odd.depth[0];
        let depth = odd.depth[0] * ratio.powf(random.random());
        let mut presses = vec![Press::finger(at, radius, depth)];
        if odd.halo > 0.0 {
            presses.push(Press::finger(at, 0.05, odd.halo * depth));
        }
        values.extend(measure(&presses, &mut random));
        positions.push(at);
    }
    let frames = |values, frames| Frames { values, frames, measurements: steps.len(), complex: false };
    let recording = Recording {
        pressed: frames(values, count),
        unpressed: frames(unpressed, 1),
        positions: Positions::FromAbove(positions),
        forces: None,
    };
    recording.on(model, &Arrangement::default()).unwrap()
}

fn of_learnt(learnt: &Learnt, judged: &Presses) -> (f64, usize) {
    let view = PatchView::validate(&learnt.patch).unwrap();
    let all: Vec<usize> = (0..judged.count()).collect();
    let errors = judge_board(&learnt.model, &view, judged, &all).unwrap().errors();
    (errors.median_mm, errors.seconds + errors.missed)
}

/// Median errors of the places of presses that nothing was learnt from, mm, by [ours, the best ridge, kernel ridge], and
/// our presses with another number of contacts than one.
fn compared(odd: &Odd, skin: &Skin, model: &Model, presses: &Presses, count: usize) -> [f64; 4] {
    let judged = some_of(presses, 0..JUDGED);
    let taught = some_of(presses, JUDGED..JUDGED + count);
    let request = Request { test_share: 0.0, seed: 1, strength: Strength::Response };
    let learnt =
        learn(skin, model, &taught, &request).unwrap_or_else(|error| panic!("{}: {error}", odd.name));
    let (error, wrong) = of_learnt(&learnt, &judged);
    let ridges = [Features::Linear, Features::Direction, Features::Logarithm]
        .map(|kind| median(regression(&taught, &judged, kind, false, |told| told).into_iter()));
    let ridge = ridges.into_iter().fold(f64::INFINITY, f64::min);
    let kernel = regression(&taught, &judged, Features::Direction, true, |told| told);
    [error, ridge, median(kernel.into_iter()), wrong as f64 / JUDGED as f64]
}

#[test]
fn on_skins_far_from_their_model_learning_beats_ridge_but_for_few_presses_felt_far_off() {
    println!(
        "median error, mm, of three skins each  presses   ours  best ridge  kernel ridge  not one contact"
    );
    for odd in &SKINS {
        let skin = skin(odd, "\"0.1 ohm m\"");
        let model = Model::build(&skin, |_| ()).unwrap();
        let skins: Vec<Presses> =
            (1..4).map(|seed| presses(odd, &model, JUDGED + MOST_TAUGHT, seed)).collect();
        for count in [20, 50, 100] {
            let all: Vec<_> =
                skins.iter().map(|presses| compared(odd, &skin, &model, presses, count)).collect();
            let mean = |figure: usize| all.iter().map(|one| one[figure]).sum::<f64>() / all.len() as f64;
            let [ours, ridge, kernel, wrong] = [0, 1, 2, 3].map(mean);
            println!("{:<38} {count:>7} {ours:>6.1} {ridge:>11.1} {kernel:>13.1} {wrong:>16.3}", odd.name);
            // Where a press is felt far off, the few presses leave an image that draws all of them to the middle.
            let most = if odd.halo > 0.0 && count == 20 { 1.25 } else { 0.75 };
            assert!(ours < most * ridge, "{}, {count}: {ours:.1}, ridge {ridge:.1}", odd.name);
        }
    }
}
