//! Uneven: a skin that reads more or less from place to place than its model, and what presses of known load mend of it.

use super::{
    CLOSE, WITHIN,
    force::{CALIBRATED, DEPTHS, Indenter, RADII, stated},
};
use crate::trust::{
    Bench, Figure, Options, Places, Trial, TrustError, Voltages, figure::quantile, trial::is_at,
};
use dermatome_frames::{
    calibrate::{Field, Reading, at_places},
    recorded::statistics::median,
};
use dermatome_patch::write::with_gains;
use std::{f64::consts::TAU, ops::Range};

/// How much the indenter that presses with known loads changes the conductivity.
const KNOWN_DEPTHS: Range<f64> = 0.5..1.0;
/// With how many presses a field of gain is fitted.
const COUNTS: [usize; 4] = [5, 10, 20, 40];
/// From so many on the load is asked to be known as well as on an even skin.
const ENOUGH: usize = 20;
/// The load's median error that is asked for then, %.
const MOST: f64 = 10.0;

/// In what a true skin differs from its model.
#[derive(Clone, Copy)]
struct Unevenness {
    words: &'static str,
    /// Factor at a way from the middle, halves of the size along the field's direction, across it and up.
    factor: fn([f64; 3]) -> f64,
    /// Whether it is that of the sheet's conductivity and not of its response to a press.
    is_of_sheet: bool,
}

const ALL: [Unevenness; 5] = [
    Unevenness { words: "even", factor: |_| 1.0, is_of_sheet: false },
    Unevenness { words: "25 % more on one side", factor: |[u, ..]| 1.0 + 0.25 * u, is_of_sheet: false },
    Unevenness {
        words: "30 % more at the rim",
        factor: |[u, v, w]| 0.85 + 0.3 * (u * u + v * v + w * w),
        is_of_sheet: false,
    },
    Unevenness {
        words: "40 % more round one place",
        factor: |[u, v, w]| 1.0 + 0.4 * (-((u - 0.4).powi(2) + v * v + w * w) / 0.32).exp(),
        is_of_sheet: false,
    },
    // Nowhere a worse conductor than the sheet for whose voltages the simulated converter is set.
    Unevenness {
        words: "sheet 23 % better on one side",
        factor: |[u, ..]| 1.5 + 0.35 * u,
        is_of_sheet: true,
    },
];

/// A true skin that is uneven, and what its scans meet.
struct Uneven<'a> {
    bench: &'a Bench,
    unevenness: Unevenness,
    /// `[element]`.
    factors: Vec<f64>,
}

impl<'a> Uneven<'a> {
    /// With a field in a direction, rad.
    fn new(bench: &'a Bench, unevenness: Unevenness, direction: f64) -> Self {
        let mesh = bench.truth().mesh();
        let [x, y] = bench.middle();
        let half = bench.size() / 2.0;
        let lowest = mesh.nodes.iter().map(|node| node.z).fold(f64::INFINITY, f64::min);
        let factor = |element: usize| {
            let [a, b, c] = mesh.corners(element);
            let centre = (a.coords + b.coords + c.coords) / 3.0;
            let (east, north) = ((centre.x - x) / half, (centre.y - y) / half);
            let (sin, cos) = direction.sin_cos();
            let up = if bench.is_flat() { 0.0 } else { (centre.z - lowest) / half };
            (unevenness.factor)([east * cos + north * sin, north * cos - east * sin, up])
        };
        Self { bench, unevenness, factors: (0..mesh.elements.len()).map(factor).collect() }
    }

    /// What a scan meets under these.
    fn voltages(&self, indenters: &[Indenter]) -> Voltages {
        let press = |one: &Indenter| self.bench.fingers(&[one.place], one.radius, one.depth);
        let presses: Vec<_> = indenters.iter().flat_map(press).collect();
        let conductivity = self.bench.truth().conductivity(&presses);
        let uneven = conductivity.iter().zip(&self.factors).map(|(conductivity, factor)| {
            if self.unevenness.is_of_sheet {
                conductivity * factor
            } else {
                1.0 + (conductivity - 1.0) * factor
            }
        });
        self.bench.solve(&uneven.collect::<Vec<_>>())
    }

    /// One indenter after the other.
    fn scenes(
        &self,
        places: &mut Places<'_>,
        count: usize,
        radii: &Range<f64>,
        depths: &Range<f64>,
    ) -> Result<Vec<(Indenter, Voltages)>, TrustError> {
        let scene = |_| {
            let place = places.draw(1, &WITHIN, 0.0)?[0];
            let radius = if radii.is_empty() { radii.start } else { places.number(radii.clone()) };
            let indenter = Indenter { place, radius, depth: places.number(depths.clone()) };
            let voltages = self.voltages(std::slice::from_ref(&indenter));
            Ok((indenter, voltages))
        };
        (0..count).map(scene).collect()
    }
}

/// What a contact says of an indenter: strength over load, and the share of it that is stated as its deviation.
type Said = (f64, f64);

/// By scene; none where there is no contact.
fn said(trial: &mut Trial<'_>, scenes: &[(Indenter, Voltages)], reach: f64) -> Vec<Option<Said>> {
    let of_scene = |(indenter, voltages): &(Indenter, Voltages)| {
        let pressed = trial.press(voltages);
        let contact = pressed.last().iter().find(|contact| is_at(contact, &indenter.place, reach))?;
        Some((f64::from(contact.strength) / indenter.load(), stated(contact)))
    };
    scenes.iter().map(of_scene).collect()
}

/// What a machine with one indenter writes down.
fn readings(scenes: &[(Indenter, Voltages)], said: &[Option<Said>]) -> Vec<Reading> {
    let reading = |((indenter, _), said): (&(Indenter, Voltages), &Option<Said>)| Reading {
        pressure_kpa: indenter.depth,
        strength: said.map_or(0.0, |(factor, _)| factor * indenter.load()),
        deviation: 0.0,
        area_mm2: None,
        place: Some(indenter.place.into()),
    };
    scenes.iter().zip(said).map(reading).collect()
}

/// Strength over load, as these readings have it: median of those with a contact.
fn calibrated(readings: &[Reading], scenes: &[(Indenter, Voltages)]) -> f64 {
    let pairs = readings.iter().zip(scenes).filter(|(reading, _)| reading.strength > 0.0);
    median(pairs.map(|(reading, (indenter, _))| reading.strength / indenter.load()))
}

/// Errors of the loads of what was said, %, by the readings of some presses of known load.
fn errors(said: &[Option<Said>], factor: f64) -> Vec<f64> {
    said.iter().flatten().map(|(one, _)| 100.0 * (one / factor - 1.0).abs()).collect()
}

/// How often errors are within two of the deviations that are stated.
fn covered(said: &[Option<Said>], factor: f64) -> usize {
    let is_right = |(one, stated): &&Said| (one / factor - 1.0).abs() <= 2.0 * stated;
    said.iter().flatten().filter(is_right).count()
}

pub(super) fn run(bench: &Bench, options: &Options) -> Result<Vec<Figure>, TrustError> {
    if !bench.board().patch().header.has_places() {
        return Err(TrustError::Unsuited(
            "contacts are found in the image, where strength is not that of a place",
        ));
    }
    let mut places = bench.places(options.seed);
    let mut all = Vec::new();
    for unevenness in ALL {
        let skin = Uneven::new(bench, unevenness, places.number(0.0..TAU));
        let known =
            skin.scenes(&mut places, COUNTS[COUNTS.len() - 1], &(CALIBRATED..CALIBRATED), &KNOWN_DEPTHS)?;
        let tried = skin.scenes(&mut places, options.one_in(2, 20), &RADII, &DEPTHS)?;
        for &snr_db in &options.snr_db {
            all.extend(of_skin(&skin, snr_db, options.seed, &known, &tried)?);
        }
    }
    Ok(all)
}

/// Loads without a field, and with one from some of the presses of known load.
fn of_skin(
    skin: &Uneven<'_>,
    snr_db: f64,
    seed: u64,
    known: &[(Indenter, Voltages)],
    tried: &[(Indenter, Voltages)],
) -> Result<Vec<Figure>, TrustError> {
    let (bench, words) = (skin.bench, skin.unevenness.words);
    let reach = CLOSE * bench.size();
    let untouched = skin.voltages(&[]);
    let mut trial = Trial::on(bench, untouched.clone(), snr_db, seed)?;
    let readings = readings(known, &said(&mut trial, known, reach));
    let without = said(&mut trial, tried, reach);
    let seen = without.iter().flatten().count();
    let mut all = vec![Figure::share(format!("{words}: with a contact"), snr_db, seen, tried.len())];
    let patch = bench.board().patch();
    for count in COUNTS {
        let readings =
            at_places(&readings[..count], &patch).map_err(|_| TrustError::Unsuited("places are off it"))?;
        let plain = calibrated(&readings, known);
        let (with, factor, note) = match Field::fit(&readings, &patch) {
            Ok(field) => {
                let even = with_gains(patch.bytes(), &field.gains(&patch))?;
                let even = bench.with_patch(even)?;
                let with = said(&mut Trial::on(&even, untouched.clone(), snr_db, seed)?, tried, reach);
                (with, calibrated(&field.corrected(&readings), known), None)
            }
            Err(why) => (without.clone(), plain, Some(why)),
        };
        let is_asked = count >= ENOUGH && snr_db >= 50.0;
        let name = |what: &str| format!("{words}, {count} presses: {what}");
        let figure = |what: &str, said: &[Option<Said>], factor: f64, share: f64| {
            Figure::new(name(what), "%", snr_db, quantile(&errors(said, factor), share))
        };
        let median = figure("median error of the load", &with, factor, 0.5).at_most(MOST, is_asked);
        all.push(figure("median error of the load without a field", &without, plain, 0.5));
        all.push(match note {
            Some(why) => median.note(format!("no field: {why}")),
            None => median,
        });
        all.push(figure("90 % without a field", &without, plain, 0.9));
        all.push(figure("90 %", &with, factor, 0.9));
        let found = with.iter().flatten().count();
        all.push(Figure::share(name("within two stated deviations"), snr_db, covered(&with, factor), found));
    }
    Ok(all)
}
