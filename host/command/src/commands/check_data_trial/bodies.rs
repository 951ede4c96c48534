//! Frames of simulated bodies that their skin files know only roughly.

use super::Set;
use anyhow::Context;
use dermatome_frames::recorded::{check::Expected, order::Arrangement, read::Frames};
use dermatome_model::skin::Skin;
use num_complex::Complex64;
use rand::{Rng, SeedableRng};
use rand_distr::{Distribution, StandardNormal};
use rand_pcg::Pcg64Mcg;
use std::{f64::consts::TAU, path::Path};

/// Frames of each body.
const FRAMES: usize = 20;
/// Electrodes lie so far from where they should, standard deviation, as a share of their distance.
const PLACE: f64 = 0.03;
/// Standard deviation of the logarithm of contact impedances, and of channels' gains.
const CONTACT: f64 = 0.5;
const GAIN: f64 = 0.01;
/// Body against skin file: sizes along x and y.
const SIZE: f64 = 0.04;
/// Standard deviation of the logarithm of conductivity from place to place.
const SHEET: f64 = 0.1;

/// A skin file's body: name, electrodes, pattern, and whether it is a square instead of a disc.
const BODIES: [(&str, u8, &str, bool); 6] = [
    ("tank, 16 electrodes, adjacent", 16, "adjacent", false),
    ("tank, 16 electrodes, skip-2", 16, "skip-2", false),
    ("tank, 16 electrodes, opposite", 16, "opposite", false),
    ("tank, 32 electrodes, adjacent", 32, "adjacent", false),
    ("tank, 32 electrodes, skip-4", 32, "skip-4", false),
    ("square skin, 16 electrodes, adjacent", 16, "adjacent", true),
];

/// One set of frames of each.
pub(super) fn bodies(seed: u64) -> anyhow::Result<Vec<Set>> {
    let mut random = Pcg64Mcg::seed_from_u64(seed);
    BODIES.iter().map(|body| set(*body, &mut random).context(body.0)).collect()
}

fn set(
    (name, electrodes, pattern, square): (&str, u8, &str, bool),
    random: &mut Pcg64Mcg,
) -> anyhow::Result<Set> {
    let as_filed = skin(electrodes, pattern, square, None)?;
    let real = skin(electrodes, pattern, square, Some(random))?;
    let (expected, real) = (Expected::of(&as_filed)?, Expected::of(&real)?);
    let snr_db: f64 = random.random_range(30.0..60.0);
    let gains: Vec<f64> = (0..electrodes).map(|_| normal(random, GAIN).exp()).collect();
    let clean: Vec<f64> =
        real.steps.iter().map(|&step| real.voltage(step) * gains[usize::from(step.sense_plus)]).collect();
    let size = (clean.iter().map(|v| v * v).sum::<f64>() / clean.len() as f64).sqrt();
    let noise = size * 10f64.powf(-snr_db / 20.0);
    let values = (0..FRAMES)
        .flat_map(|_| clean.clone())
        .map(|value| Complex64::from(value + normal(random, noise)))
        .collect();
    let frames = Frames { values, frames: FRAMES, measurements: clean.len(), complex: false };
    let (name, model) = (format!("{name}, {snr_db:.0} dB"), expected.clone());
    Ok(Set { name, model, expected, frames, arrangement: Arrangement::default() })
}

fn normal(random: &mut Pcg64Mcg, deviation: f64) -> f64 {
    let normal: f64 = StandardNormal.sample(random);
    deviation * normal
}

/// The skin file's skin, or one that differs from it at random.
fn skin(electrodes: u8, pattern: &str, square: bool, random: Option<&mut Pcg64Mcg>) -> anyhow::Result<Skin> {
    let half = 0.1;
    let width = 0.3 * TAU * half / f64::from(electrodes);
    let mut sides = [2.0 * half; 2];
    let (mut contacts, mut shifts) = (vec![0.05; electrodes.into()], vec![0.0; electrodes.into()]);
    let mut map = String::new();
    let mut edge = 0.008;
    if let Some(random) = random {
        sides = sides.map(|side| side * (1.0 + normal(random, SIZE)));
        contacts.iter_mut().for_each(|contact| *contact *= normal(random, CONTACT).exp());
        shifts.iter_mut().for_each(|shift| *shift = normal(random, PLACE).clamp(-0.1, 0.1));
        edge = 0.0071;
        let rows: Vec<String> = (0..8)
            .map(|_| {
                let [x, y] = [0, 1].map(|_| random.random_range(-half..half));
                format!("[{x:.4}, {y:.4}, {:.4}]", normal(random, SHEET).exp())
            })
            .collect();
        map = format!("conductivity_map = [{}]", rows.join(", "));
    }
    let positions: Vec<String> = shifts
        .iter()
        .enumerate()
        .map(|(k, shift)| {
            let turn = (k as f64 + shift + if square { 0.5 } else { 0.0 }) / f64::from(electrodes);
            let [x, y] = place(turn, square);
            format!("[{:.6}, {:.6}]", x * sides[0] / 2.0, y * sides[1] / 2.0)
        })
        .collect();
    let contacts: Vec<String> = contacts.iter().map(|contact| format!("{contact:.6}")).collect();
    let kind = if square { "rectangle" } else { "ellipse" };
    let [width_x, height] = sides;
    let (positions, contacts) = (positions.join(", "), contacts.join(", "));
    let text = format!(
        "name = \"body\"\n[shape]\nkind = \"{kind}\"\nwidth = {width_x:.6}\nheight = {height:.6}\n\
         [mesh]\nedge_length = {edge}\n[material]\nsheet_conductivity = 0.01\n{map}\n\
         [electrodes]\ncount = {electrodes}\nplacement = \"points\"\npositions = [{positions}]\nmodel = \"complete\"\n\
         width = {width:.6}\ncontact_impedance = [{contacts}]\n\
         [drive]\npattern = \"{pattern}\"\nreciprocal = \"combined\"\nfrequency = 50000\namplitude = 0.001\n\
         frame_rate = 10\n[inverse]\nprior = \"laplace\"\nhyperparameter = 0.03\nnormalised = true\n\
         [image]\ncolumns = 16\n[contact]\nthreshold = 0.05\n"
    );
    Ok(Skin::parse(Path::new("simulated body"), &text)?.made()?)
}

/// A share of the way round, clockwise from the top, on a circle or square of half side 1.
fn place(turn: f64, square: bool) -> [f64; 2] {
    let (x, y) = (TAU * turn).sin_cos();
    if !square {
        return [x, y];
    }
    // Equal ways along the sides: a side is a quarter of the way, the first one right of the top's middle.
    let along = (turn + 0.125).rem_euclid(1.0) * 4.0;
    let on_side = 2.0 * along.fract() - 1.0;
    match along as usize {
        0 => [on_side, 1.0],
        1 => [1.0, -on_side],
        2 => [-on_side, -1.0],
        _ => [-1.0, on_side],
    }
}
