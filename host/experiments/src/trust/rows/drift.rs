//! Drift of a minute: even, and of a part of the skin.

use super::FINGER;
use crate::trust::{Bench, Figure, Options, Trial, TrustError, trial::Film};
use dermatome_geometry::mesh::triangle;
use nalgebra::Point3;
use std::ops::Range;

/// How long a scene is, s, and when it is pressed.
const SCENE: Range<f64> = 0.0..90.0;
const PRESSED: Range<f64> = 30.0..60.0;
/// Even drift, relative, a minute.
const RATES: [f64; 4] = [0.03, -0.03, 0.1, -0.1];
/// By how much a part warms, relative, and when.
const WARMS: f64 = 0.12;
const WARMING: Range<f64> = 5.0..65.0;
/// Moments at which a scene is solved.
const MOMENTS: usize = 10;
/// So long after a touch begins or ends, s, either is right: a filter may take its time.
const SETTLING: f64 = 0.05;

/// Frames of a scene, by what they should say.
#[derive(Default)]
struct Tally {
    untouched: usize,
    with_contact: usize,
    touched: usize,
    with_one: usize,
}

pub(super) fn uniform(bench: &Bench, options: &Options) -> Result<Vec<Figure>, TrustError> {
    let place = bench.places(options.seed).draw(1, &(0.2..0.6), 0.0)?;
    let mut figures = Vec::new();
    for rate in RATES {
        let drifted = |time: f64, change: f64| change * (1.0 + rate * time / 60.0);
        let tally = play(bench, options, &place, |time, _, change| drifted(time, change))?;
        let words = format!("{:+.0} % a minute", 100.0 * rate);
        figures.extend(tally.figures(&words, options.first_snr_db()));
    }
    Ok(figures)
}

pub(super) fn regional(bench: &Bench, options: &Options) -> Result<Vec<Figure>, TrustError> {
    let mut places = bench.places(options.seed);
    let mut figures = Vec::new();
    let [x, y] = bench.middle();
    // What is right of the middle, and of that what is above it too.
    for (words, least_y) in [("a quarter warms", y), ("half of it warms", f64::NEG_INFINITY)] {
        let place = places.draw(1, &(0.2..0.6), 0.0)?;
        let tally = play(bench, options, &place, |time, point, change| {
            if point.x > x && point.y > least_y { change * (1.0 + warmth(time)) } else { change }
        })?;
        figures.extend(tally.figures(words, options.first_snr_db()));
    }
    Ok(figures)
}

/// By how much a part is warmer at a time, relative.
fn warmth(time: f64) -> f64 {
    WARMS * ((time - WARMING.start) / (WARMING.end - WARMING.start)).clamp(0.0, 1.0)
}

/// Plays a scene in which the conductivity of an element at a point is `changed`(time, point, conductivity when pressed).
fn play(
    bench: &Bench,
    options: &Options,
    place: &[Point3<f64>],
    changed: impl Fn(f64, &Point3<f64>, f64) -> f64,
) -> Result<Tally, TrustError> {
    let truth = bench.truth();
    let mesh = truth.mesh();
    let centroids: Vec<_> =
        (0..mesh.elements.len()).map(|element| triangle::centroid(mesh.corners(element))).collect();
    let film = |fingers: &[Point3<f64>]| {
        let still = truth.conductivity(&bench.fingers(fingers, FINGER, 1.0));
        Film::even(SCENE, MOMENTS, |time| {
            let pairs = still.iter().zip(&centroids);
            bench.solve(&pairs.map(|(&value, point)| changed(time, point, value)).collect::<Vec<_>>())
        })
    };
    let [untouched, touched] = [film(&[]), film(place)];
    let mut trial = Trial::new(bench, options.first_snr_db(), options.seed)?;
    let mut tally = Tally::default();
    let frames = (SCENE.end * bench.frame_rate()) as usize;
    for frame in 0..frames {
        let time = frame as f64 / bench.frame_rate();
        let is_pressed = PRESSED.contains(&time);
        let voltages = if is_pressed { touched.at(time) } else { untouched.at(time) };
        let contacts = trial.see(&voltages).contacts().len();
        let is_settling = [PRESSED.start, PRESSED.end].iter().any(|at| (*at..at + SETTLING).contains(&time));
        if !is_settling {
            tally.count(is_pressed, contacts);
        }
    }
    Ok(tally)
}

impl Tally {
    fn count(&mut self, is_pressed: bool, contacts: usize) {
        if is_pressed {
            self.touched += 1;
            self.with_one += usize::from(contacts == 1);
        } else {
            self.untouched += 1;
            self.with_contact += usize::from(contacts > 0);
        }
    }

    fn figures(&self, words: &str, snr_db: f64) -> [Figure; 2] {
        let untouched = format!("{words}: untouched frames with a contact");
        let touched = format!("{words}: pressed frames with exactly one");
        [
            Figure::share(untouched, snr_db, self.with_contact, self.untouched).at_most(0.0, true),
            Figure::share(touched, snr_db, self.with_one, self.touched).at_least(100.0, true),
        ]
    }
}
