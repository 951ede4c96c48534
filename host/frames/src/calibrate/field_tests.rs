use super::{field::*, *};
use dermatome_model::{
    model::Model,
    quantize,
    skin::{FoundIn, Skin},
};
use dermatome_shared::patch::PatchView;
use rand::{Rng, SeedableRng};
use rand_distr::StandardNormal;
use rand_pcg::Pcg64Mcg;
use std::path::Path;

/// Radius of the skin, m.
const RADIUS: f64 = 0.05;

/// A disc of 100 mm.
const TINY: &str = "../tests/data/tiny.toml";

/// The patch of a skin file.
fn built(file: &str, found_in: FoundIn) -> Vec<u8> {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join(file);
    let skin = Skin { contacts_found_in: found_in, ..Skin::load(&file).unwrap().made().unwrap() };
    quantize::patch(&skin, &Model::build(&skin, |_| ()).unwrap()).unwrap()
}

fn random_places(random: &mut Pcg64Mcg, count: usize) -> Vec<[f64; 3]> {
    let mut places = Vec::new();
    while places.len() < count {
        let [x, y] = [(); 2].map(|()| random.random_range(-RADIUS..RADIUS));
        if f64::hypot(x, y) < 0.9 * RADIUS {
            places.push([x, y, 0.0]);
        }
    }
    places
}

/// Presses of other loads at each place, whose strengths bend with the load and have noise.
fn presses(gain: fn([f64; 3]) -> f64, count: usize, noise: f64, seed: u64) -> Vec<Reading> {
    let mut random = Pcg64Mcg::seed_from_u64(seed);
    let places = random_places(&mut random, count);
    let press = |place: &[f64; 3]| {
        let pressure_kpa: f64 = random.random_range(10.0..40.0);
        let curve = 0.02 * pressure_kpa / (1.0 + 0.01 * pressure_kpa);
        let off: f64 = random.sample(StandardNormal);
        let strength = gain(*place) * curve * (noise * off).exp();
        Reading { pressure_kpa, strength, deviation: 0.0, area_mm2: None, place: Some(*place) }
    };
    places.iter().map(press).collect()
}

/// Root mean square over the skin by which a gain is off, but for a common factor.
fn off(field: Option<&Field>, gain: fn([f64; 3]) -> f64) -> f64 {
    let places = random_places(&mut Pcg64Mcg::seed_from_u64(99), 200);
    let logarithm = |place: &[f64; 3]| (field.map_or(1.0, |field| field.gain(*place)) / gain(*place)).ln();
    let all: Vec<f64> = places.iter().map(logarithm).collect();
    let mean = all.iter().sum::<f64>() / all.len() as f64;
    (all.iter().map(|one| (one - mean).powi(2)).sum::<f64>() / all.len() as f64).sqrt()
}

fn tilt([x, ..]: [f64; 3]) -> f64 {
    1.0 + 0.25 * x / RADIUS
}

fn bowl([x, y, _]: [f64; 3]) -> f64 {
    0.85 + 0.3 * (x * x + y * y) / (RADIUS * RADIUS)
}

fn even(_: [f64; 3]) -> f64 {
    1.0
}

#[test]
fn presses_find_a_smooth_field_and_few_of_them_do_no_harm() {
    let patch = built(TINY, FoundIn::Voltages);
    let view = PatchView::validate(&patch).unwrap();
    let mean = |gain: fn([f64; 3]) -> f64, count: usize| {
        let of_seed = |seed| {
            let readings = at_places(&presses(gain, count, 0.05, seed), &view).unwrap();
            off(Field::fit(&readings, &view).ok().as_ref(), gain)
        };
        (0..20).map(of_seed).sum::<f64>() / 20.0
    };
    for (name, gain, most) in [
        ("tilt", tilt as fn([f64; 3]) -> f64, [0.105, 0.06, 0.035, 0.025]),
        ("bowl", bowl, [0.078, 0.072, 0.05, 0.03]),
        ("even", even, [0.015, 0.012, 0.012, 0.01]),
    ] {
        let found = [5, 10, 20, 40].map(|count| mean(gain, count));
        println!("{name}: without {:.3}, with 5, 10, 20, 40 presses {found:.3?}", off(None, gain));
        assert!(found.iter().zip(most).all(|(found, most)| *found <= most), "{name}: {found:?}");
    }
}

#[test]
fn readings_of_a_field_are_those_of_an_even_skin_but_for_a_factor() {
    let patch = built(TINY, FoundIn::Voltages);
    let view = PatchView::validate(&patch).unwrap();
    let readings = at_places(&presses(tilt, 40, 0.0, 3), &view).unwrap();
    let field = Field::fit(&readings, &view).unwrap();
    assert!(field.left_out[1] < 0.02 && field.left_out[0] > 0.1, "{:?}", field.left_out);
    let strengths = field.corrected(&readings);
    let factor =
        |(one, plain): (&Reading, &Reading)| one.strength / (plain.strength / tilt(plain.place.unwrap()));
    let factors: Vec<f64> = strengths.iter().zip(&readings).map(factor).collect();
    let [least, most] = [f64::min, f64::max].map(|of| factors.iter().copied().reduce(of).unwrap());
    assert!(most / least < 1.05, "{least} {most}");
    let gains = field.gains(&view);
    let surface = view.surface();
    for (place, gain) in view.places().iter().zip(gains) {
        let [x, ..] = surface.centre(&surface.pixel(place.pixel.into()).unwrap());
        assert!((gain - tilt([x.into(), 0.0, 0.0])).abs() < 0.05, "{x}: {gain}");
    }
}

#[test]
fn a_place_that_fits_nothing_is_left_out_of_many_but_not_of_few() {
    let patch = built(TINY, FoundIn::Voltages);
    let view = PatchView::validate(&patch).unwrap();
    let fit = |count: usize, factor: f64| {
        let mut readings = presses(tilt, count, 0.03, 5);
        readings[2].strength *= factor;
        Field::fit(&at_places(&readings, &view).unwrap(), &view)
    };
    let [right, odd] = [1.0, 0.4].map(|factor| fit(24, factor).unwrap());
    assert_eq!((right.odd, odd.odd, odd.places()), (0, 1, right.places() - 1));
    assert!(off(Some(&odd), tilt) < 0.04, "{}", off(Some(&odd), tilt));
    assert!(fit(7, 0.4).is_ok_and(|field| field.odd == 0) || fit(7, 0.4).is_err());
}

#[test]
fn what_gives_no_field_is_said() {
    let voltages = built(TINY, FoundIn::Voltages);
    let view = PatchView::validate(&voltages).unwrap();
    let all = presses(tilt, 12, 0.02, 1);
    let no = |readings: &[Reading]| Field::fit(&at_places(readings, &view).unwrap(), &view).unwrap_err();
    assert_eq!(no(&all[..3]), NoField::FewPlaces { found: 3 });
    let nowhere: Vec<Reading> = all.iter().map(|reading| Reading { place: None, ..*reading }).collect();
    assert_eq!(no(&nowhere), NoField::NoPlaces);
    let one: Vec<Reading> = all.iter().map(|reading| Reading { place: all[0].place, ..*reading }).collect();
    assert!(
        no(&one).to_string().starts_with("the skin was pressed at 1 place; allowed: 4 or more"),
        "{}",
        no(&one)
    );
    // Within the width of a standard press they are one place.
    let near = |(number, reading): (usize, &Reading)| Reading {
        place: Some([1e-4 * number as f64, 0.0, 0.0]),
        ..*reading
    };
    assert_eq!(no(&all.iter().enumerate().map(near).collect::<Vec<_>>()), NoField::FewPlaces { found: 1 });
    let square = built("../../models/square-50mm/skin.toml", FoundIn::Image);
    let view = PatchView::validate(&square).unwrap();
    let inside =
        |reading: &Reading| Reading { place: reading.place.map(|at| at.map(|part| 0.4 * part)), ..*reading };
    let inside = at_places(&all.iter().map(inside).collect::<Vec<_>>(), &view).unwrap();
    assert_eq!(Field::fit(&inside, &view), Err(NoField::Interpolated));
    // Where no pixel is interpolated from others, each has a gain.
    let image = built(TINY, FoundIn::Image);
    let view = PatchView::validate(&image).unwrap();
    let field = Field::fit(&at_places(&all, &view).unwrap(), &view).unwrap();
    assert_eq!(field.gains(&view).len(), usize::from(view.header.pixels));
}

#[test]
fn places_off_the_skin_are_refused_by_their_number() {
    let patch = built(TINY, FoundIn::Voltages);
    let view = PatchView::validate(&patch).unwrap();
    let mut readings = presses(even, 6, 0.0, 1);
    readings[3].place = Some([0.07, 0.0, f64::NAN]);
    let error = at_places(&readings, &view).unwrap_err().to_string();
    assert!(error.starts_with("reading 4 (counted from 1) is at x = 70.0 mm, y = 0.0 mm,"), "{error}");
    assert!(error.contains("allowed: places on it, in its own frame, x from -4"), "{error}");
    readings[3].place = Some([0.049, 0.0, f64::NAN]);
    assert!(at_places(&readings, &view).is_ok());
}

#[test]
fn another_place_begins_another_trial_and_weak_loads_go_with_strong_ones() {
    let patch = built(TINY, FoundIn::Voltages);
    let view = PatchView::validate(&patch).unwrap();
    let at = |pressure_kpa: f64, x: f64| Reading {
        pressure_kpa,
        strength: 0.01 * pressure_kpa,
        deviation: 0.0,
        area_mm2: None,
        place: (pressure_kpa > 0.0).then_some([x, 0.0, f64::NAN]),
    };
    // Where a weak load is found says little.
    let readings = [
        at(0.0, 0.0),
        at(1.0, 0.03),
        at(20.0, 0.0),
        at(1.0, -0.03),
        at(0.0, 0.0),
        at(20.0, 0.02),
        at(10.0, -0.02),
    ];
    let readings = at_places(&readings, &view).unwrap();
    let found: Vec<_> =
        readings.iter().map(|reading| reading.place.map(|place| (1e3 * place[0]).round())).collect();
    assert_eq!(found, [None, Some(0.0), Some(0.0), Some(0.0), None, Some(20.0), Some(-20.0)]);
    let counts: Vec<usize> = trials(&readings).iter().map(|trial| trial.readings.len()).collect();
    assert_eq!(counts, [5, 2, 1]);
}
