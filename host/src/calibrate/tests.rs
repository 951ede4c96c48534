use super::*;
use crate::material::{Material, Transducer};
use dermatome_shared::hysteresis::Play;
use rand::SeedableRng;
use rand_distr::{Distribution, StandardNormal};
use rand_pcg::Pcg64Mcg;

/// Frames while a load is held; the second half of them makes the reading.
const FRAMES: usize = 40;
/// Noise of a frame's strength, share of the material's full change.
const NOISE: f64 = 0.005;
/// Changes up to this share of the full change are averaged (half a contact threshold on a board).
const AVERAGED: f64 = 0.03;

fn stairs(shares: impl DoubleEndedIterator<Item = f64> + Clone) -> Vec<f64> {
    shares.clone().chain(shares.rev().skip(1)).collect()
}

fn even(top: f64, steps: usize) -> Vec<f64> {
    stairs((0..=steps).map(move |step| top * step as f64 / steps as f64))
}

/// A place under a loading machine, as a board sees it: noisy strengths of frames.
struct Bench {
    material: Material,
    place: Transducer,
    random: Pcg64Mcg,
}

impl Bench {
    fn new(name: &str, seed: u64) -> Self {
        let material = Material::named(name).unwrap();
        let place = Transducer::new(&material, seed);
        Self { material, place, random: Pcg64Mcg::seed_from_u64(seed + 1000) }
    }

    /// Strengths of all frames while this share of the range is held.
    fn hold(&mut self, share: f64, seconds: f64) -> Vec<f64> {
        let frame = |_| {
            let normal: f64 = StandardNormal.sample(&mut self.random);
            let change = self.place.respond(share * self.material.range_kpa, seconds / FRAMES as f64);
            change + NOISE * self.material.full_change * normal
        };
        (0..FRAMES).map(frame).collect()
    }

    fn trial(&mut self, shares: &[f64], seconds: f64) -> (Trial, Vec<f64>) {
        let frames: Vec<f64> = shares.iter().flat_map(|&share| self.hold(share, seconds)).collect();
        (self.reading(shares, &frames), frames)
    }

    /// The mean of each load's later frames.
    fn reading(&self, shares: &[f64], frames: &[f64]) -> Trial {
        let mean = |values: &[f64]| values.iter().sum::<f64>() / values.len() as f64;
        let one = |(share, frames): (&f64, &[f64])| Reading {
            pressure_kpa: share * self.material.range_kpa,
            strength: mean(&frames[FRAMES / 2..]),
            deviation: 0.0,
        };
        trials(&shares.iter().zip(frames.chunks(FRAMES)).map(one).collect::<Vec<_>>()).remove(0)
    }
}

/// Curve and plays from one loading cycle of one place.
fn identified(name: &str) -> (dermatome_shared::calibration::Calibration, Vec<Play>) {
    let up = [0.0, 0.02].into_iter().chain((1..=10).map(|n| 0.1 * f64::from(n)));
    let (trial, _) = Bench::new(name, 500).trial(&stairs(up), 10.0);
    let calibration = Curve::of_loading(std::slice::from_ref(&trial)).calibration().unwrap();
    let plays = identify(&trial, &calibration);
    (calibration, plays)
}

/// Mean over places and trials of the hysteresis, raw and compensated, per cent of the loop's own span.
fn judged(name: &str, shares: &[f64], seconds: f64) -> [f64; 3] {
    let (calibration, plays) = identified(name);
    let mut figures = Vec::new();
    for seed in 0..8 {
        let mut bench = Bench::new(name, seed);
        let (mut strengths, mut raw) = (Vec::new(), Vec::new());
        for _ in 0..3 {
            let (trial, frames) = bench.trial(shares, seconds);
            raw.push(hysteresis(&trial));
            strengths.extend(frames);
            strengths.extend(bench.hold(0.0, 1200.0));
        }
        let noise = AVERAGED * bench.material.full_change;
        let pressures = compensated(&strengths, &plays, &calibration, noise);
        let trial_frames = (shares.len() + 1) * FRAMES;
        for (frames, raw) in pressures.chunks(trial_frames).zip(raw) {
            let frames = &frames[..shares.len() * FRAMES];
            figures.push([raw, hysteresis(&bench.reading(shares, frames))]);
        }
    }
    let mean = |which: usize| figures.iter().map(|f| f[which]).sum::<f64>() / figures.len() as f64;
    [mean(0), mean(1), figures.iter().map(|f| f[1]).fold(0.0, f64::max)]
}

#[test]
fn hysteresis_of_loops_not_used_to_fit_it_is_at_most_8_percent() {
    for name in ["sample-1", "sample-2", "sample-3-single", "sample-3-dual"] {
        println!("{name}: plays {:?}", identified(name).1);
        for (what, shares, seconds, most) in [
            ("full, 10 s a load", even(1.0, 12), 10.0, 8.0),
            ("full, 3 s a load", even(1.0, 12), 3.0, 8.0),
            ("full, 30 s a load", even(1.0, 12), 30.0, 14.0),
            ("three quarters", even(0.75, 12), 10.0, 10.0),
            ("half", even(0.5, 12), 10.0, 12.0),
        ] {
            let [raw, mean, worst] = judged(name, &shares, seconds);
            println!("{name}, {what}: raw {raw:.1} %, compensated {mean:.1} %, worst of 24 {worst:.1} %");
            assert!(mean <= most, "{name}, {what}: {mean}");
            assert!(raw > 2.0 * mean, "{name}, {what}: {raw} {mean}");
        }
    }
}
