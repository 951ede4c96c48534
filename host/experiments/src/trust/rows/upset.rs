//! What changes at once and is no press: conductivity, electrodes, shape.

use super::{CLOSE, FINGER};
use crate::{
    deform::{slip, stretch},
    trust::{Bench, Figure, Options, Trial, TrustError, Voltages, trial::is_one_at},
};
use dermatome_shared::frame::FrameFlags;
use dermatome_simulate::TrueSkin;
use nalgebra::Point3;
use rand::SeedableRng;
use rand_pcg::Pcg64Mcg;
use std::collections::BTreeSet;

/// Frames before it is upset.
const UNTOUCHED: usize = 20;
/// Frames for which a finger presses in the moment of the upset.
const AT_ONCE: usize = 30;
/// How long the board may take to heal, s; then it is pressed for a second, and watched for as long again.
const HEALS_IN: f64 = 30.0;
const PRESS: f64 = 1.0;
const SCENE: f64 = 61.0;
/// By how much electrodes slip, m, and the skin is stretched.
const SLIPS: [f64; 2] = [1e-3, 1e-4];
const STRETCHES: [f64; 2] = [0.005, 0.02];
/// Conductivity after a jump over that before.
const JUMP: f64 = 1.05;

/// The upset skin, untouched and pressed.
struct Upset {
    untouched: Voltages,
    pressed: Voltages,
    place: Point3<f64>,
}

/// What the board said of some upset skins.
#[derive(Default)]
struct Said {
    scenes: usize,
    frames: usize,
    with_contact: usize,
    /// Most contacts in a frame.
    most: usize,
    flagged: usize,
    flags: BTreeSet<&'static str>,
    /// Seconds until no contact was left; infinite where one was to the end: `[scene]`.
    healed: Vec<f64>,
    seen: usize,
    seen_at_once: usize,
}

pub(super) fn run(bench: &Bench, options: &Options) -> Result<Vec<Figure>, TrustError> {
    let count = options.one_in(50, 1);
    let places = bench.places(options.seed).draw(count, &(0.0..0.7), 0.0)?;
    let mut figures = Vec::new();
    let jump = |place: &Point3<f64>, _| Ok(upset(bench, bench.truth(), *place, JUMP));
    figures.extend(tried(bench, options, "conductivity up by 5 % at once", &places, jump)?);
    for by in SLIPS {
        let slipped = |place: &Point3<f64>, seed| {
            let mut random = Pcg64Mcg::seed_from_u64(seed);
            let nodes = slip(bench.truth().mesh(), by, &mut random)?;
            Ok(upset(bench, &bench.truth().moved(bench.skin(), nodes)?, *place, 1.0))
        };
        let words = format!("electrodes slipped by {} mm", 1e3 * by);
        figures.extend(tried(bench, options, &words, &places, slipped)?);
    }
    for by in STRETCHES {
        let stretched = |place: &Point3<f64>, _| {
            let nodes = stretch(&bench.truth().mesh().nodes, by, 0.0);
            Ok(upset(bench, &bench.truth().moved(bench.skin(), nodes)?, *place, 1.0))
        };
        figures.extend(tried(bench, options, &format!("stretched by {} %", 100.0 * by), &places, stretched)?);
    }
    Ok(figures)
}

fn upset(bench: &Bench, truth: &TrueSkin, place: Point3<f64>, scale: f64) -> Upset {
    let solve = |places: &[Point3<f64>]| {
        let conductivity = truth.conductivity(&bench.fingers(places, FINGER, 1.0));
        bench.solve_on(truth, &conductivity.iter().map(|value| scale * value).collect::<Vec<_>>())
    };
    Upset { untouched: solve(&[]), pressed: solve(&[place]), place }
}

/// Figures of one kind of upset, at each of these places; a kind that the skin cannot have is a figure that says so.
fn tried(
    bench: &Bench,
    options: &Options,
    words: &str,
    places: &[Point3<f64>],
    upset: impl Fn(&Point3<f64>, u64) -> Result<Upset, TrustError>,
) -> Result<Vec<Figure>, TrustError> {
    let snr_db = options.first_snr_db();
    let mut said = Said::default();
    for (place, number) in places.iter().zip(0..) {
        let seed = options.seed.wrapping_add(number);
        match upset(place, seed) {
            Ok(upset) => {
                let close = CLOSE * bench.size();
                said.press_at_once(&mut untouched(bench, snr_db, seed)?, &upset, close);
                said.play(&mut untouched(bench, snr_db, seed)?, &upset, close);
            }
            Err(TrustError::Unsuited(why)) => {
                return Ok(vec![Figure::new(words, "", snr_db, f64::NAN).open(why)]);
            }
            Err(error) => return Err(error),
        }
    }
    Ok(said.figures(words, snr_db))
}

/// A board that was tared, and has seen some frames.
fn untouched(bench: &Bench, snr_db: f64, seed: u64) -> Result<Trial<'_>, TrustError> {
    let mut trial = Trial::new(bench, snr_db, seed)?;
    for _ in 0..UNTOUCHED {
        trial.see_untouched();
    }
    Ok(trial)
}

impl Said {
    /// A finger that comes in the same frame as the upset: the last of some frames decides.
    fn press_at_once(&mut self, trial: &mut Trial<'_>, upset: &Upset, close: f64) {
        for _ in 1..AT_ONCE {
            trial.see(&upset.pressed);
        }
        let is_seen = is_one_at(trial.see(&upset.pressed).contacts(), &upset.place, close);
        self.seen_at_once += usize::from(is_seen);
    }

    fn play(&mut self, trial: &mut Trial<'_>, upset: &Upset, close: f64) {
        self.scenes += 1;
        let begin = trial.time();
        let mut healed = 0.0;
        let mut seen = None;
        while trial.time() - begin < SCENE {
            let now = trial.time() - begin;
            if (HEALS_IN..HEALS_IN + PRESS).contains(&now) {
                let is_one = is_one_at(trial.see(&upset.pressed).contacts(), &upset.place, close);
                // The latest frame of the press decides.
                seen = Some(is_one);
                continue;
            }
            let state = trial.see(&upset.untouched);
            let (contacts, flags) = (state.contacts().len(), state.flags());
            let has_contact = contacts > 0;
            self.most = self.most.max(contacts);
            self.frames += 1;
            self.with_contact += usize::from(has_contact);
            self.flagged += usize::from(flags != FrameFlags::default());
            self.flags.extend(flags.words());
            if has_contact {
                healed = now + trial.period();
            }
        }
        self.healed.push(if healed >= SCENE { f64::INFINITY } else { healed });
        self.seen += usize::from(seen == Some(true));
    }

    fn figures(&self, words: &str, snr_db: f64) -> Vec<Figure> {
        let name = |what: &str| format!("{words}: {what}");
        let flags = self.flags.iter().copied().collect::<Vec<_>>().join(", ");
        let flagged = Figure::share(name("frames flagged"), snr_db, self.flagged, self.frames);
        let seen = Figure::share(name("press seen 30 s later"), snr_db, self.seen, self.scenes);
        vec![
            Figure::share(name("frames with a contact"), snr_db, self.with_contact, self.frames)
                .at_most(0.0, true),
            Figure::new(name("contacts in a frame, most"), "", snr_db, self.most as f64),
            healed(name("until no contact is left, longest"), snr_db, &self.healed),
            if flags.is_empty() { flagged } else { flagged.note(flags) },
            seen.at_least(100.0, true),
            Figure::share(name("press that comes with it seen"), snr_db, self.seen_at_once, self.scenes),
        ]
    }
}

/// Seconds until no contact was left, the longest of some; infinite ones never came to an end.
pub(super) fn healed(what: impl Into<String>, snr_db: f64, seconds: &[f64]) -> Figure {
    let longest = seconds.iter().copied().fold(0.0, f64::max);
    let figure = Figure::new(what, "s", snr_db, longest).at_most(HEALS_IN, true);
    if longest.is_finite() { figure } else { figure.note("one to the end of a minute") }
}
