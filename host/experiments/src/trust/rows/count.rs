//! How many there are: several fingers, pairs by distance, one large indenter.

use super::{FINGER, WITHIN};
use crate::trust::{
    Bench, Figure, Options, Pressed, Trial, TrustError, Voltages, figure::largest_over_smallest, place_of,
    trial::SETTLING_FRAMES,
};
use nalgebra::{Point3, distance};

/// Radius and distance of several fingers, shares of the size.
pub(super) const RADIUS: f64 = 0.06;
pub(super) const APART: f64 = 0.25;
/// Distances of pairs, shares of the size.
const DISTANCES: [f64; 5] = [0.1, 0.15, 0.2, 0.25, 0.3];
/// Pairs are told apart from where so many of them are.
const MOST: f64 = 0.9;
/// Radii of indenters, shares of the size.
const INDENTERS: [f64; 5] = [0.03, 0.04, 0.06, 0.09, 0.12];
/// Radii of indenters that are held, shares of the size, their depth, and for how many frames.
const HELD: [f64; 4] = [0.08, 0.1, 0.12, 0.16];
const HELD_DEPTH: f64 = 0.5;
const HELD_FRAMES: usize = 150;

pub(super) fn several(bench: &Bench, options: &Options) -> Result<Vec<Figure>, TrustError> {
    let mut trial = Trial::new(bench, options.first_snr_db(), options.seed)?;
    let mut figures = Vec::new();
    for (count, words, least) in [(2, "two fingers counted", 97.0), (3, "three fingers counted", 95.0)] {
        let mut places = bench.places(options.seed);
        let scenes = (0..options.presses).map(|_| {
            let fingers = places.draw(count, &WITHIN, APART)?;
            Ok(bench.pressed(&fingers, RADIUS, 1.0))
        });
        let scenes: Vec<Voltages> = scenes.collect::<Result<_, TrustError>>()?;
        for &snr_db in &options.snr_db {
            trial.change_noise(snr_db, options.seed);
            let right = scenes.iter().filter(|scene| trial.press(scene).last().len() == count).count();
            let figure = Figure::share(words, snr_db, right, scenes.len());
            figures.push(figure.at_least(least, snr_db >= 50.0 && bench.is_flat()));
        }
    }
    Ok(figures)
}

pub(super) fn pairs(bench: &Bench, options: &Options) -> Result<Vec<Figure>, TrustError> {
    let mut trial = Trial::new(bench, options.first_snr_db(), options.seed)?;
    let mut places = bench.places(options.seed);
    let count = options.one_in(2, 5);
    let scenes = DISTANCES.map(|apart| {
        let scene = |_| {
            let pair = places.pair(&WITHIN, apart)?;
            Ok((pair, bench.pressed(&pair, FINGER, 1.0)))
        };
        (0..count).map(scene).collect::<Result<Vec<_>, TrustError>>()
    });
    let mut figures = Vec::new();
    for &snr_db in &options.snr_db {
        trial.change_noise(snr_db, options.seed);
        let mut shares = Vec::new();
        for (apart, scenes) in DISTANCES.iter().zip(&scenes) {
            let scenes = scenes.as_ref().map_err(Clone::clone)?;
            let right =
                scenes.iter().filter(|(pair, scene)| are_told_apart(&trial.press(scene), pair)).count();
            let words = format!("told apart at {:.0} % of the size", 100.0 * apart);
            figures.push(Figure::share(words, snr_db, right, count));
            shares.push(right as f64 / count as f64);
        }
        let from = told_apart_from(&shares).map_or(f64::NAN, |apart| 100.0 * apart);
        let figure = Figure::new("told apart 90 % of the time from", "% of size", snr_db, from);
        figures.push(figure.at_most(20.0, snr_db >= 60.0 && bench.is_flat()));
    }
    Ok(figures)
}

/// Whether there is one contact for each, and no other.
fn are_told_apart(pressed: &Pressed, [a, b]: &[Point3<f64>; 2]) -> bool {
    let [first, second] = pressed.last() else { return false };
    let reach = distance(a, b) / 2.0;
    let are = |x, y| distance(&place_of(first), x) < reach && distance(&place_of(second), y) < reach;
    are(a, b) || are(b, a)
}

/// The smallest distance from which on enough pairs are told apart at all distances tried.
fn told_apart_from(shares: &[f64]) -> Option<f64> {
    let enough = DISTANCES.iter().zip(shares).rev().take_while(|(_, share)| **share >= MOST);
    enough.last().map(|(apart, _)| *apart)
}

pub(super) fn indenters(bench: &Bench, options: &Options) -> Result<Vec<Figure>, TrustError> {
    let mut trial = Trial::new(bench, options.first_snr_db(), options.seed)?;
    let places = bench.places(options.seed).draw(options.one_in(2, 5), &WITHIN, 0.0)?;
    let scenes =
        INDENTERS.map(|radius| places.iter().map(|place| bench.pressed(&[*place], radius, 1.0)).collect());
    let scenes: [Vec<Voltages>; 5] = scenes;
    let mut figures = Vec::new();
    for &snr_db in &options.snr_db {
        trial.change_noise(snr_db, options.seed);
        let mut over_area = Vec::new();
        for (radius, scenes) in INDENTERS.iter().zip(&scenes) {
            let pressed: Vec<_> = scenes.iter().map(|scene| trial.press(scene)).collect();
            let one = pressed.iter().filter(|pressed| pressed.last().len() == 1).count();
            figures.push(Figure::share(
                format!("radius {:.0} %: one contact", 100.0 * radius),
                snr_db,
                one,
                scenes.len(),
            ));
            let strengths = pressed.iter().flat_map(Pressed::last).map(|contact| f64::from(contact.strength));
            over_area.push(strengths.sum::<f64>() / scenes.len() as f64 / (radius / FINGER).powi(2));
        }
        let spread = largest_over_smallest(&over_area);
        figures.push(Figure::new("strength over area, largest over smallest", "", snr_db, spread));
    }
    Ok(figures)
}

/// Frames of indenters that are held, which are one contact, with one number, in each.
pub(super) fn held(bench: &Bench, options: &Options) -> Result<Vec<Figure>, TrustError> {
    let mut trial = Trial::new(bench, options.first_snr_db(), options.seed)?;
    let places = bench.places(options.seed).draw(options.one_in(2, 5), &WITHIN, 0.0)?;
    let scenes = HELD.map(|radius| {
        let scenes = places.iter().map(|place| bench.pressed(&[*place], radius, HELD_DEPTH));
        scenes.collect::<Vec<Voltages>>()
    });
    let mut figures = Vec::new();
    for &snr_db in &options.snr_db {
        trial.change_noise(snr_db, options.seed);
        for (radius, scenes) in HELD.iter().zip(&scenes) {
            let (mut right, mut changes) = (0, 0);
            for scene in scenes {
                let numbers = hold(&mut trial, scene);
                right += numbers.iter().flatten().count();
                changes += numbers.windows(2).filter(|pair| pair[0] != pair[1]).count();
            }
            let words = |what: &str| format!("radius {:.0} %: {what}", 100.0 * radius);
            let frames = scenes.len() * HELD_FRAMES;
            figures.push(Figure::share(words("one contact"), snr_db, right, frames));
            let minutes = frames as f64 / bench.frame_rate() / 60.0;
            let changes = changes as f64 / minutes;
            figures.push(Figure::new(words("changes of number or count"), "1/min", snr_db, changes));
        }
    }
    Ok(figures)
}

/// Shows a scene for some frames, and lifts it: in each of them, once settled, the number of the contact if there is one.
fn hold(trial: &mut Trial<'_>, scene: &Voltages) -> Vec<Option<u32>> {
    for _ in 0..SETTLING_FRAMES {
        trial.see(scene);
    }
    let number = |_| match trial.see(scene).contacts().as_slice() {
        [contact] => contact.identity.map(|identity| identity.number),
        _ => None,
    };
    let numbers = (0..HELD_FRAMES).map(number).collect();
    for _ in 0..SETTLING_FRAMES {
        trial.see_untouched();
    }
    numbers
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pairs_are_told_apart_from_where_all_larger_distances_are() {
        assert_eq!(told_apart_from(&[0.0, 0.95, 0.8, 0.9, 1.0]), Some(0.25));
        assert_eq!(told_apart_from(&[1.0; 5]), Some(0.1));
        assert_eq!(told_apart_from(&[1.0, 1.0, 1.0, 1.0, 0.5]), None);
    }
}
