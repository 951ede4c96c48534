//! One finger.

use super::{FINGER, WITHIN};
use crate::trust::{
    Bench, Figure, Options, Pressed, Trial, TrustError, Voltages,
    figure::{largest_over_smallest, mean_95_largest, variation},
    place_of,
};
use dermatome_shared::contact::Contact;
use nalgebra::{Point3, distance};
use std::ops::Range;

/// Ranges of the radius.
const ZONES: [Range<f64>; 4] = [0.0..0.5, 0.5..0.8, 0.8..0.9, 0.9..0.95];

/// A finger somewhere, and what it does to the voltages.
struct Scene {
    place: Point3<f64>,
    radius: f64,
    voltages: Voltages,
}

/// A scene with what the board said of it.
struct Seen<'a> {
    scene: &'a Scene,
    pressed: Pressed,
}

fn scenes(
    bench: &Bench,
    seed: u64,
    count: usize,
    radii: &Range<f64>,
    depth: f64,
) -> Result<Vec<Scene>, TrustError> {
    let mut places = bench.places(seed);
    let drawn = places.draw(count, radii, 0.0)?;
    let scene = |place: Point3<f64>| Scene {
        radius: places.radius(&place),
        voltages: bench.pressed(&[place], FINGER, depth),
        place,
    };
    Ok(drawn.into_iter().map(scene).collect())
}

fn see<'a>(trial: &mut Trial<'_>, scenes: &'a [Scene]) -> Vec<Seen<'a>> {
    scenes.iter().map(|scene| Seen { pressed: trial.press(&scene.voltages), scene }).collect()
}

impl Seen<'_> {
    fn is_one(&self) -> bool {
        self.pressed.are_exactly(1)
    }

    /// The strongest contact of the last frame.
    fn contact(&self) -> Option<&Contact> {
        self.pressed.last().first()
    }

    /// How far that is off, share of the size.
    fn error(&self, size: f64) -> Option<f64> {
        Some(distance(&place_of(self.contact()?), &self.scene.place) / size)
    }

    /// Where the finger was and where the contact is, mm, as seen from above.
    fn words(&self) -> String {
        let at = |point: Point3<f64>| format!("{:.0}, {:.0} mm", 1e3 * point.x, 1e3 * point.y);
        let contact = self.contact().map_or("no place".to_owned(), |contact| at(place_of(contact)));
        format!("{} seen at {contact}", at(self.scene.place))
    }

    /// Whether it is off by no more than twice the deviation that it states; `None` where it states none.
    fn is_as_stated(&self) -> Option<bool> {
        let contact = self.contact()?;
        let deviation = f64::from(contact.evidence?.position_deviation);
        Some(distance(&place_of(contact), &self.scene.place) <= 2.0 * deviation)
    }
}

pub(super) fn one(bench: &Bench, options: &Options) -> Result<Vec<Figure>, TrustError> {
    let mut trial = Trial::new(bench, options.first_snr_db(), options.seed)?;
    let mut figures = Vec::new();
    for depth in [1.0, 0.5] {
        let radii = ZONES[0].start..ZONES[3].end;
        let scenes = scenes(bench, options.seed, options.presses, &radii, depth)?;
        for &snr_db in &options.snr_db {
            trial.change_noise(snr_db, options.seed);
            let seen = see(&mut trial, &scenes);
            figures.extend(of_one(&seen, bench, snr_db, depth));
        }
    }
    Ok(figures)
}

fn of_one(seen: &[Seen<'_>], bench: &Bench, snr_db: f64, depth: f64) -> Vec<Figure> {
    let is_full = depth == 1.0;
    let name = |what: &str| format!("{}: {what}", if is_full { "full depth" } else { "half depth" });
    let count = |seen: &[&Seen<'_>]| seen.iter().filter(|seen| seen.is_one()).count();
    let all: Vec<_> = seen.iter().collect();
    let least = if snr_db >= 60.0 { 99.0 } else { 95.0 };
    let exactly = Figure::share(name("exactly one contact"), snr_db, count(&all), all.len());
    let mut figures = vec![exactly.at_least(least, is_full && snr_db >= 50.0)];
    for zone in ZONES {
        let here: Vec<_> = seen.iter().filter(|seen| zone.contains(&seen.scene.radius)).collect();
        let what =
            format!("exactly one, {:.0} to {:.0} % of the radius", 100.0 * zone.start, 100.0 * zone.end);
        figures.push(Figure::share(name(&what), snr_db, count(&here), here.len()));
    }
    let left = seen.iter().filter(|seen| seen.pressed.left > 0).count();
    figures.push(Figure::share(name("contact left three frames after"), snr_db, left, seen.len()));
    figures.extend(errors(seen, bench, snr_db, is_full, &name));
    figures
}

/// Position errors of fingers within 90 % of the radius that were detected.
fn errors(
    seen: &[Seen<'_>],
    bench: &Bench,
    snr_db: f64,
    is_full: bool,
    name: &impl Fn(&str) -> String,
) -> Vec<Figure> {
    let within: Vec<_> = seen.iter().filter(|seen| WITHIN.contains(&seen.scene.radius)).collect();
    let errors: Vec<f64> = within.iter().filter_map(|seen| seen.error(bench.size())).collect();
    let [mean, most, largest] = mean_95_largest(&errors).map(|error| 100.0 * error);
    let is_asked = is_full && snr_db >= 50.0 && bench.is_flat();
    let percent = |what: &str, value| Figure::new(name(what), "% of size", snr_db, value);
    let worst = within.iter().max_by(|a, b| {
        let error = |seen: &Seen<'_>| seen.error(bench.size()).unwrap_or(0.0);
        error(a).total_cmp(&error(b))
    });
    let largest = percent("position error to 90 % of the radius, largest", largest).at_most(6.0, is_asked);
    let stated: Vec<bool> = within.iter().filter_map(|seen| seen.is_as_stated()).collect();
    let right = stated.iter().filter(|is_right| **is_right).count();
    let share = Figure::share(name("error within two stated deviations"), snr_db, right, stated.len());
    let says_none = stated.is_empty() && !errors.is_empty();
    vec![
        percent("position error to 90 % of the radius, mean", mean).at_most(2.0, is_asked),
        percent("position error to 90 % of the radius, 95 %", most),
        match worst.filter(|seen| seen.contact().is_some()) {
            Some(seen) => largest.note(seen.words()),
            None => largest,
        },
        if says_none {
            share.note("contacts from an image state none")
        } else {
            share.at_least(95.0, is_asked)
        },
    ]
}

pub(super) fn rim(bench: &Bench, options: &Options) -> Result<Vec<Figure>, TrustError> {
    let mut trial = Trial::new(bench, options.first_snr_db(), options.seed)?;
    let scenes = scenes(bench, options.seed, options.one_in(2, 5), &(0.95..1.0), 1.0)?;
    let mut figures = Vec::new();
    for &snr_db in &options.snr_db {
        trial.change_noise(snr_db, options.seed);
        let seen = see(&mut trial, &scenes);
        let errors: Vec<f64> = seen.iter().filter_map(|seen| seen.error(bench.size())).collect();
        let [mean, _, largest] = mean_95_largest(&errors).map(|error| 100.0 * error);
        let one = seen.iter().filter(|seen| seen.is_one()).count();
        figures.push(Figure::share("exactly one contact", snr_db, one, seen.len()));
        let mean = Figure::new("position error, mean", "% of size", snr_db, mean);
        figures.push(mean.at_most(1.5, snr_db >= 60.0));
        figures.push(Figure::new("position error, largest", "% of size", snr_db, largest));
        let left = seen.iter().filter(|seen| seen.pressed.left > 0).count();
        figures.push(Figure::share("contact left three frames after", snr_db, left, seen.len()));
    }
    Ok(figures)
}

pub(super) fn strength(bench: &Bench, options: &Options) -> Result<Vec<Figure>, TrustError> {
    let mut trial = Trial::new(bench, options.first_snr_db(), options.seed)?;
    let scenes = scenes(bench, options.seed, options.presses, &WITHIN, 1.0)?;
    let mut figures = Vec::new();
    for &snr_db in &options.snr_db {
        trial.change_noise(snr_db, options.seed);
        let seen = see(&mut trial, &scenes);
        let strengths: Vec<f64> =
            seen.iter().filter_map(|seen| Some(f64::from(seen.contact()?.strength))).collect();
        let spread = Figure::new("coefficient of variation", "", snr_db, variation(&strengths));
        figures.push(spread.at_most(0.14, bench.is_flat()));
        figures.push(Figure::new("largest over smallest", "", snr_db, largest_over_smallest(&strengths)));
    }
    Ok(figures)
}
