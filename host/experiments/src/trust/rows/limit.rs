//! Limit: what the board detects, beside what the voltages of one frame hold.
//!
//! White noise of deviation s on each step, and a change v of the steps' voltages without what it has in common with the
//! untouched ones, are told apart by d' = |v| / s standard deviations at most (Kay, Fundamentals of Statistical Signal
//! Processing II, chapter 4).

use super::{FINGER, WITHIN};
use crate::trust::{Bench, Figure, Options, Trial, TrustError, Voltages, trial::is_at};
use dermatome_model::metrics::detectability::passing;
use dermatome_simulate::noise::{root_mean_square, share};
use nalgebra::Point3;

/// Of the limit a board should reach this.
const SHARE: f64 = 0.85;
/// Untouched for so long after the tare, s, and so many frames at least after each press: the limit is that of a still
/// skin.
const TARED: f64 = 15.0;
const REST: f64 = 1.5;
const REST_FRAMES: usize = 40;
/// Frames of one press.
const FRAMES: usize = 10;
/// A contact farther away is not that of the finger, share of the size.
const NEAR: f64 = 0.25;

/// What became of one finger.
struct Seen {
    /// The most that one frame holds, standard deviations.
    limit: f64,
    /// Whether it has a contact in the first frame and in the last.
    is_detected: [bool; 2],
}

pub(super) fn run(bench: &Bench, options: &Options) -> Result<Vec<Figure>, TrustError> {
    let mut trial = Trial::new(bench, options.first_snr_db(), options.seed)?;
    let level = f64::from(bench.board().patch().header.detection.level);
    let places = bench.places(options.seed).draw(options.presses, &WITHIN, 0.0)?;
    let untouched = bench.untouched();
    let mut figures = Vec::new();
    for depth in [1.0, 0.5, 0.2] {
        let scenes: Vec<_> =
            places.iter().map(|place| (place, bench.pressed(&[*place], FINGER, depth))).collect();
        for &snr_db in &options.snr_db {
            trial.change_noise(snr_db, options.seed);
            untouched_for(&mut trial, TARED);
            let see = |(place, voltages): &(&Point3<f64>, Voltages)| Seen {
                limit: limit(bench, &untouched, voltages, snr_db),
                is_detected: are_detected(&mut trial, place, voltages, NEAR * bench.size()),
            };
            let seen: Vec<Seen> = scenes.iter().map(see).collect();
            figures.extend(beside_the_limit(&seen, level, depth, snr_db));
        }
    }
    Ok(figures)
}

/// d' of these voltages.
fn limit(bench: &Bench, untouched: &Voltages, pressed: &Voltages, snr_db: f64) -> f64 {
    let steps = bench.steps();
    let (before, after) = (&untouched[..steps], &pressed[..steps]);
    let noise = root_mean_square(before.iter().map(|v| v.re)) * share(snr_db);
    let sum = |part: &dyn Fn(f64, f64) -> f64| {
        before.iter().zip(after).map(|(before, after)| part(before.re, after.re - before.re)).sum::<f64>()
    };
    let [square, common, size] =
        [sum(&|_, change| change * change), sum(&|v, change| v * change), sum(&|v, _| v * v)];
    (square - common * common / size).max(0.0).sqrt() / noise
}

/// Whether the finger has a contact in the first frame and in the last.
fn are_detected(trial: &mut Trial<'_>, place: &Point3<f64>, voltages: &Voltages, near: f64) -> [bool; 2] {
    let mut see = || trial.see(voltages).contacts().iter().any(|contact| is_at(contact, place, near));
    let first = see();
    let last = (1..FRAMES).map(|_| see()).last().unwrap_or(first);
    untouched_for(trial, REST);
    [first, last]
}

fn untouched_for(trial: &mut Trial<'_>, seconds: f64) {
    let frames = (seconds / trial.period()).ceil() as usize;
    (0..frames.max(REST_FRAMES)).for_each(|_| {
        trial.see_untouched();
    });
}

fn beside_the_limit(seen: &[Seen], level: f64, depth: f64, snr_db: f64) -> [Figure; 2] {
    [(0, "in the first frame", 1.0), (1, "after 10 still frames", FRAMES as f64)].map(
        |(frame, when, frames)| {
            let expected = |share: f64| {
                let passes = |seen: &Seen| passing(level - share * frames.sqrt() * seen.limit);
                100.0 * seen.iter().map(passes).sum::<f64>() / seen.len() as f64
            };
            let detected = seen.iter().filter(|seen| seen.is_detected[frame]).count();
            let what = format!("{:.0} % of the depth: detected {when}", 100.0 * depth);
            let figure = Figure::share(what, snr_db, detected, seen.len());
            // What that share of d' would detect.
            figure.at_least(expected(SHARE).floor(), true).note(format!("the limit: {:.1} %", expected(1.0)))
        },
    )
}
