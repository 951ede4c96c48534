//! What a reference could be fooled by: presses that grow slowly, and a finger under the tare.

use super::{CLOSE, FINGER, WITHIN, upset::healed};
use crate::trust::{
    Bench, Figure, Options, Trial, TrustError, Voltages,
    trial::{Film, is_at, is_one_at},
};
use nalgebra::{Point3, distance};

/// Times over which presses grow to their full depth, s; the first is the fast one.
const GROWTHS: [f64; 5] = [1.0, 10.0, 60.0, 160.0, 600.0];
/// Depths at which a press that grows is solved, shares of the full one.
const DEPTHS: [f64; 11] = [0.0, 0.02, 0.05, 0.1, 0.15, 0.2, 0.3, 0.45, 0.6, 0.8, 1.0];
/// Above so many seconds of growth, frames come at [`SLOW_RATE`] a second.
const LONG: f64 = 10.0;
const SLOW_RATE: f64 = 10.0;
/// A slow press is held for so long, s.
const HELD: f64 = 1.0;
/// After a tare with a finger: it stays so long, s; presses are tried at these times after it lifted, and the scene ends.
const STAYS: f64 = 0.5;
const TRIED: [f64; 2] = [1.0, 30.0];
const PRESS: f64 = 1.0;
const APART: f64 = 3.0;
const SCENE: f64 = 60.0;

pub(super) fn growing(bench: &Bench, options: &Options) -> Result<Vec<Figure>, TrustError> {
    let snr_db = options.first_snr_db();
    let count = options.one_in(50, 1);
    let mut places = bench.places(options.seed);
    let mut drawn = places.draw(count, &(0.0..0.5), 0.0)?;
    drawn.extend(places.draw(count, &(0.5..0.9), 0.0)?);
    let mut trial = Trial::new(bench, snr_db, options.seed)?;
    let mut depths: Vec<[Option<f64>; 5]> = Vec::new();
    for place in &drawn {
        let solved = DEPTHS.map(|depth| bench.pressed(&[*place], FINGER, depth));
        depths.push(GROWTHS.map(|growth| detected_at(&mut trial, bench, place, &solved, growth)));
    }
    Ok(GROWTHS
        .iter()
        .enumerate()
        .flat_map(|(index, &growth)| of_growth(&depths, index, growth, snr_db))
        .collect())
}

/// The share of its depth at which a press that grows over this time, s, is first seen.
fn detected_at(
    trial: &mut Trial<'_>,
    bench: &Bench,
    place: &Point3<f64>,
    solved: &[Voltages],
    growth: f64,
) -> Option<f64> {
    let moments = DEPTHS.iter().map(|depth| depth * growth);
    let film = Film(moments.zip(solved.iter().cloned()).collect());
    let rate = if growth > LONG { bench.frame_rate().min(SLOW_RATE) } else { bench.frame_rate() };
    trial.tare_untouched();
    let frames = ((growth + HELD) * rate) as usize;
    let mut times = (1..=frames).map(|frame| frame as f64 / rate);
    let time = times.find(|&time| {
        let contacts = trial.see_after(&film.at(time), 1.0 / rate).contacts();
        contacts.iter().any(|contact| is_at(contact, place, CLOSE * bench.size()))
    })?;
    Some((time / growth).min(1.0))
}

fn of_growth(depths: &[[Option<f64>; 5]], index: usize, growth: f64, snr_db: f64) -> [Figure; 3] {
    let found: Vec<f64> = depths.iter().filter_map(|of| of[index]).collect();
    let ratios = depths.iter().map(|of| Some(of[index]? / of[0]?));
    let most = ratios.map(|ratio| ratio.unwrap_or(f64::NAN)).fold(0.0, |most: f64, ratio| {
        if ratio.is_nan() || most.is_nan() { f64::NAN } else { most.max(ratio) }
    });
    let mean = 100.0 * found.iter().sum::<f64>() / found.len() as f64;
    let detected =
        Figure::share(format!("grows over {growth} s: detected"), snr_db, found.len(), depths.len());
    let detected = detected.at_least(100.0, true);
    [
        if growth > LONG { detected.note(format!("{SLOW_RATE} frames a second")) } else { detected },
        Figure::new(format!("grows over {growth} s: at this part of its depth, mean"), "%", snr_db, mean),
        Figure::new(
            format!("grows over {growth} s: depth over that of the fast one, largest"),
            "",
            snr_db,
            most,
        )
        .at_most(2.0, true),
    ]
}

/// What is left of a finger that was there at the tare.
struct Left {
    /// Seconds until no contact is left; infinite where one was to the end.
    healed: f64,
    with_contact: usize,
    frames: usize,
    /// Whether presses there and elsewhere are seen: `[time tried]`.
    seen: Vec<[bool; 2]>,
}

pub(super) fn tare(bench: &Bench, options: &Options) -> Result<Vec<Figure>, TrustError> {
    let snr_db = options.first_snr_db();
    let mut places = bench.places(options.seed);
    let mut trial = Trial::new(bench, snr_db, options.seed)?;
    let mut left = Vec::new();
    for _ in 0..options.one_in(50, 1) {
        let there = places.draw(1, &(0.88..0.92), 0.0)?[0];
        let mut elsewhere = there;
        while distance(&there, &elsewhere) < APART * CLOSE * bench.size() {
            elsewhere = places.draw(1, &WITHIN, 0.0)?[0];
        }
        left.push(lift(&mut trial, bench, there, elsewhere));
    }
    let sum = |of: fn(&Left) -> usize| left.iter().map(of).sum::<usize>();
    let seconds: Vec<f64> = left.iter().map(|left| left.healed).collect();
    let mut figures = vec![
        Figure::share(
            "frames with a contact once it has lifted",
            snr_db,
            sum(|l| l.with_contact),
            sum(|l| l.frames),
        )
        .at_most(0.0, true),
        healed("until no contact is left, longest", snr_db, &seconds),
    ];
    for (index, after) in TRIED.iter().enumerate() {
        for (which, words) in ["there", "elsewhere"].iter().enumerate() {
            let seen = left.iter().filter(|left| left.seen[index][which]).count();
            let figure =
                Figure::share(format!("a press {words} seen after {after} s"), snr_db, seen, left.len());
            figures.push(figure.at_least(100.0, *after >= 30.0));
        }
    }
    Ok(figures)
}

/// Tares with a finger, lifts it, and watches; presses in between for a second each.
fn lift(trial: &mut Trial<'_>, bench: &Bench, there: Point3<f64>, elsewhere: Point3<f64>) -> Left {
    let places = [there, elsewhere];
    let pressed = places.map(|place| bench.pressed(&[place], FINGER, 1.0));
    let untouched = bench.untouched();
    trial.tare(&pressed[0]);
    let begin = trial.time() + STAYS;
    while trial.time() < begin {
        trial.see(&pressed[0]);
    }
    let mut left = Left { healed: 0.0, with_contact: 0, frames: 0, seen: vec![[false; 2]; TRIED.len()] };
    while trial.time() - begin < SCENE {
        let now = trial.time() - begin;
        let which = |since: f64| [0.0, 2.0 * PRESS].iter().position(|at| (*at..at + PRESS).contains(&since));
        let press = TRIED.iter().enumerate().find_map(|(index, at)| Some((index, which(now - at)?)));
        if let Some((index, which)) = press {
            // The latest frame of the press decides.
            let contacts = trial.see(&pressed[which]).contacts();
            left.seen[index][which] = is_one_at(contacts, &places[which], CLOSE * bench.size());
            continue;
        }
        left.frames += 1;
        if !trial.see(&untouched).contacts().is_empty() {
            left.with_contact += 1;
            left.healed = now + trial.period();
        }
    }
    if left.healed >= SCENE {
        left.healed = f64::INFINITY;
    }
    left
}
