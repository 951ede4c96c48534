//! What moves: how soon a touch is a contact, and whether its identity stays.

use super::{CLOSE, FINGER, WITHIN};
use crate::trust::{
    Bench, Figure, Options, Trial, TrustError, Voltages,
    figure::mean_95_largest,
    place_of,
    trial::{Film, SETTLING_FRAMES},
};
use dermatome_shared::contact::{Contact, Contacts};
use nalgebra::{Point3, distance};
use num_complex::Complex64;
use std::{collections::BTreeSet, f64::consts::TAU};

/// Frames a second of a fast stream.
const FAST: f64 = 400.0;
/// A touch that is no contact by then has none, frames.
const LONGEST: usize = 20;
/// Speeds of swipes, m/s, and the fastest that a stream of the first rate is asked to follow.
const SPEEDS: [f64; 4] = [0.5, 1.0, 1.5, 3.0];
const RATES: [(f64, f64); 2] = [(50.0, 1.5), (FAST, 3.0)];
/// Least length of a swipe, and distance of the moments at which it is solved, shares of the size.
const SWIPE: f64 = 0.5;
const STEP: f64 = 0.0125;
/// Fingers that cross pass at these distances, and begin so far from where they meet, shares of the size.
const PASSING: [f64; 2] = [0.2, 0.1];
const RUN_UP: f64 = 0.3;
const CROSSING_SPEED: f64 = 0.25;
/// How long fingers rest before they cross, and what is watched after a gesture, s.
const REST: f64 = 0.2;
const AFTER: f64 = 0.5;
/// Radii of fingers that slide, shares of the size, and their speed, m/s.
const SLIDING: [f64; 3] = [0.04, 0.07, 0.1];
const SLIDING_SPEED: f64 = 0.2;
/// Where the issue names no number: so many gestures keep their identity, per cent.
const KEPT: f64 = 95.0;

pub(super) fn latency(bench: &Bench, options: &Options) -> Result<Vec<Figure>, TrustError> {
    let bench = bench.at_rate(FAST)?;
    let mut trial = Trial::new(&bench, options.first_snr_db(), options.seed)?;
    let places = bench.places(options.seed).draw(options.one_in(2, 5), &WITHIN, 0.0)?;
    let scenes: Vec<_> = places.iter().map(|place| bench.pressed(&[*place], FINGER, 1.0)).collect();
    let mut figures = Vec::new();
    for &snr_db in &options.snr_db {
        trial.change_noise(snr_db, options.seed);
        let until = |trial: &mut Trial<'_>, scene: &Voltages| {
            let frames = (1..=LONGEST).find(|_| !trial.see(scene).contacts().is_empty());
            (0..LONGEST).for_each(|_| {
                trial.see_untouched();
            });
            frames.unwrap_or(LONGEST) as f64
        };
        let frames: Vec<f64> = scenes.iter().map(|scene| until(&mut trial, scene)).collect();
        let [mean, _, largest] = mean_95_largest(&frames);
        figures.push(Figure::new("frames until a contact, mean", "", snr_db, mean));
        let largest = Figure::new("frames until a contact, largest", "", snr_db, largest);
        let largest =
            if frames.contains(&(LONGEST as f64)) { largest.note("never, in 20 frames") } else { largest };
        figures.push(largest.at_most(2.0, snr_db >= 60.0));
    }
    Ok(figures)
}

pub(super) fn sliding(bench: &Bench, options: &Options) -> Result<Vec<Figure>, TrustError> {
    let mut trial = Trial::new(bench, options.first_snr_db(), options.seed)?;
    let mut figures = Vec::new();
    for radius in SLIDING {
        let mut places = bench.places(options.seed);
        let swipes = (0..options.one_in(10, 3)).map(|_| {
            let ends = places.draw(2, &(0.0..0.85), SWIPE)?;
            Ok(Swipe::new(bench, ends[0], ends[1], radius))
        });
        let swipes: Vec<_> = swipes.collect::<Result<_, TrustError>>()?;
        for &snr_db in &options.snr_db {
            trial.change_noise(snr_db, options.seed);
            let seen: Vec<f64> = swipes.iter().flat_map(|swipe| swipe.errors(bench, &mut trial)).collect();
            let one = seen.iter().filter(|error| **error < CLOSE * bench.size()).count();
            let name = |what: &str| format!("radius {:.0} %: {what}", 100.0 * radius);
            let share =
                Figure::share(name("frames with one contact, at the finger"), snr_db, one, seen.len());
            figures.push(share.at_least(KEPT, snr_db >= 50.0 && bench.is_flat()));
            let errors: Vec<f64> = seen
                .iter()
                .filter(|error| error.is_finite())
                .map(|error| 100.0 * error / bench.size())
                .collect();
            let [mean, _, largest] = mean_95_largest(&errors);
            figures.push(Figure::new(name("distance from the finger, mean"), "% of size", snr_db, mean));
            figures.push(Figure::new(
                name("distance from the finger, largest"),
                "% of size",
                snr_db,
                largest,
            ));
        }
    }
    Ok(figures)
}

/// What becomes of one gesture, as a robot's program sees it.
struct Watched<'a, 'b> {
    trial: &'a mut Trial<'b>,
    ids: BTreeSet<u32>,
}

pub(super) fn identity(bench: &Bench, options: &Options) -> Result<Vec<Figure>, TrustError> {
    let snr_db = options.first_snr_db();
    let count = options.one_in(10, 3);
    let mut places = bench.places(options.seed);
    let taps = places.draw(count, &WITHIN, 0.0)?;
    let swipes = (0..count).map(|_| {
        let ends = places.draw(2, &(0.0..0.85), SWIPE)?;
        Ok(Swipe::new(bench, ends[0], ends[1], FINGER))
    });
    let swipes: Vec<_> = swipes.collect::<Result<_, TrustError>>()?;
    let turns: Vec<f64> = (0..count).map(|_| places.number(0.0..TAU)).collect();
    let crossings =
        PASSING.map(|apart| turns.iter().map(|&turn| Crossing::new(bench, turn, apart)).collect());
    let crossings: [Vec<Crossing>; 2] = crossings;
    let mut figures = Vec::new();
    for (rate, fastest) in RATES {
        let bench = bench.at_rate(rate)?;
        let mut trial = Trial::new(&bench, snr_db, options.seed)?;
        let tap = |trial: &mut Trial<'_>, place: &Point3<f64>| {
            Watched::new(trial).tap(&bench.pressed(&[*place], FINGER, 1.0))
        };
        let one = taps.iter().filter(|place| tap(&mut trial, place) == 1).count();
        let name = |what: &str| format!("{what} at {rate} frames a second: one identity");
        figures.push(Figure::share(name("taps of one frame"), snr_db, one, count).at_least(KEPT, true));
        for speed in SPEEDS {
            let one = swipes.iter().filter(|swipe| Watched::new(&mut trial).swipe(swipe, speed) == 1).count();
            let figure = Figure::share(name(&format!("swipes of {speed} m/s")), snr_db, one, count);
            figures.push(figure.at_least(KEPT, speed <= fastest));
        }
        for (apart, crossings) in PASSING.iter().zip(&crossings) {
            let kept = crossings.iter().filter(|crossing| Watched::new(&mut trial).cross(crossing)).count();
            let words = format!(
                "fingers that pass at {:.0} % of the size at {rate} frames a second: both keep theirs",
                100.0 * apart
            );
            figures.push(Figure::share(words, snr_db, kept, count).at_least(KEPT, *apart >= PASSING[0]));
        }
    }
    Ok(figures)
}

/// A finger's way, solved at moments of a speed of 1 m/s.
struct Swipe {
    film: Film,
    length: f64,
    ends: [Point3<f64>; 2],
}

impl Swipe {
    fn new(bench: &Bench, from: Point3<f64>, to: Point3<f64>, radius: f64) -> Self {
        let length = distance(&from, &to);
        let moments = (length / (STEP * bench.size())).ceil() as usize + 1;
        let at = |way: f64| bench.pressed(&[from + (to - from) * (way / length)], radius, 1.0);
        Self { film: Film::even(0.0..length, moments, at), length, ends: [from, to] }
    }

    /// Distance of the only contact from a finger that rests and then slides, m, in each frame: infinite where there is not
    /// one. The skin is left alone afterwards.
    fn errors(&self, bench: &Bench, trial: &mut Trial<'_>) -> Vec<f64> {
        let [from, to] = self.ends;
        let step = SLIDING_SPEED * trial.period();
        let mut error = |way: f64| {
            let finger = from + (to - from) * (way / self.length);
            let finger = bench.truth().lay([finger.x, finger.y]);
            match &trial.see(&self.film.at(way)).contacts()[..] {
                [contact] => distance(&place_of(contact), &finger),
                _ => f64::INFINITY,
            }
        };
        (0..SETTLING_FRAMES).for_each(|_| {
            error(0.0);
        });
        let errors = (0..=(self.length / step) as usize).map(|frame| error(frame as f64 * step)).collect();
        (0..LONGEST).for_each(|_| {
            trial.see_untouched();
        });
        errors
    }
}

/// Two fingers that pass each other in the middle of the skin.
struct Crossing {
    film: Film,
    length: f64,
    /// Where they are at the beginning and at the end: `[moment][finger]`.
    ends: [[Point3<f64>; 2]; 2],
}

impl Crossing {
    fn new(bench: &Bench, turn: f64, apart: f64) -> Self {
        let (size, [centre_x, centre_y]) = (bench.size(), bench.middle());
        let length = 2.0 * RUN_UP * size;
        let fingers = |way: f64| {
            let (along, across) = (way - length / 2.0, apart / 2.0 * size);
            [1.0, -1.0].map(|side| {
                let (sin, cos) = turn.sin_cos();
                let [x, y] = [side * along, side * across];
                bench.truth().lay([centre_x + x * cos - y * sin, centre_y + x * sin + y * cos])
            })
        };
        let moments = (length / (STEP * size)).ceil() as usize + 1;
        let film = Film::even(0.0..length, moments, |way| bench.pressed(&fingers(way), FINGER, 1.0));
        Self { film, length, ends: [fingers(0.0), fingers(length)] }
    }
}

impl<'a, 'b> Watched<'a, 'b> {
    /// A fresh look: nothing was touched for a while.
    fn new(trial: &'a mut Trial<'b>) -> Self {
        let mut watched = Self { trial, ids: BTreeSet::new() };
        watched.rest();
        watched.ids.clear();
        watched
    }

    fn see(&mut self, voltages: &[Complex64]) -> Contacts {
        let contacts = self.trial.see(voltages).contacts().clone();
        self.ids.extend(contacts.iter().filter_map(number));
        contacts
    }

    /// Nothing touches for a while.
    fn rest(&mut self) {
        let frames = (AFTER / self.trial.period()).ceil() as usize;
        for _ in 0..frames {
            self.ids.extend(self.trial.see_untouched().contacts().iter().filter_map(number));
        }
    }

    /// Identities of a touch of one frame.
    fn tap(mut self, voltages: &[Complex64]) -> usize {
        self.see(voltages);
        self.rest();
        self.ids.len()
    }

    /// Identities of a swipe at this speed, m/s.
    fn swipe(mut self, swipe: &Swipe, speed: f64) -> usize {
        let step = speed * self.trial.period();
        let frames = (swipe.length / step).floor() as usize;
        for frame in 0..=frames {
            self.see(&swipe.film.at(frame as f64 * step));
        }
        self.rest();
        self.ids.len()
    }

    /// Whether two fingers pass each other and keep their identities, and there are no others.
    fn cross(mut self, crossing: &Crossing) -> bool {
        let step = CROSSING_SPEED * self.trial.period();
        let rest = (REST / self.trial.period()) as usize;
        let frames = (crossing.length / step).floor() as usize;
        let mut first = None;
        let mut last = None;
        for frame in 0..=rest + frames {
            let seen = self.see(&crossing.film.at(frame.saturating_sub(rest) as f64 * step));
            if frame == rest {
                first = identities(&seen, &crossing.ends[0]);
            }
            last = identities(&seen, &crossing.ends[1]);
        }
        self.rest();
        first.is_some() && first == last && self.ids.len() == 2
    }
}

fn number(contact: &Contact) -> Option<u32> {
    Some(contact.identity?.number)
}

/// Identity of the contact nearest to each finger; none unless there are two contacts, one for each.
fn identities(contacts: &Contacts, fingers: &[Point3<f64>; 2]) -> Option<[u32; 2]> {
    let [a, b] = &contacts[..] else { return None };
    let nearer = |finger: &Point3<f64>| {
        let away = |contact: &Contact| distance(&place_of(contact), finger);
        if away(a) < away(b) { number(a) } else { number(b) }
    };
    let ids = [nearer(&fingers[0])?, nearer(&fingers[1])?];
    (ids[0] != ids[1]).then_some(ids)
}
