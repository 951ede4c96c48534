//! Force: what strength says of the load, whatever the indenter.

use super::{CLOSE, WITHIN};
use crate::trust::{
    Bench, Figure, Options, Trial, TrustError, Voltages, figure::mean_95_largest, trial::is_at,
};
use dermatome_frames::recorded::statistics::median;
use dermatome_shared::contact::Contact;
use nalgebra::Point3;
use std::ops::Range;

/// Radius of the indenter that strengths are calibrated with, share of the size.
pub(super) const CALIBRATED: f64 = 0.06;
/// Radii of the others, and how much they change the conductivity.
pub(super) const RADII: Range<f64> = 0.04..0.12;
pub(super) const DEPTHS: Range<f64> = 0.3..1.0;
/// How far two lie apart.
const APART: f64 = 0.35;

/// What presses at one place.
pub(super) struct Indenter {
    pub(super) place: Point3<f64>,
    /// Share of the size.
    pub(super) radius: f64,
    pub(super) depth: f64,
}

impl Indenter {
    /// Its load: the sum of the changes under it, but for a factor.
    pub(super) fn load(&self) -> f64 {
        self.depth * self.radius * self.radius
    }
}

/// Indenters, and what they do to the voltages.
struct Scene {
    indenters: Vec<Indenter>,
    voltages: Voltages,
}

impl Scene {
    fn new(bench: &Bench, indenters: Vec<Indenter>) -> Self {
        let press = |one: &Indenter| bench.fingers(&[one.place], one.radius, one.depth);
        let presses: Vec<_> = indenters.iter().flat_map(press).collect();
        Self { voltages: bench.solve(&bench.truth().conductivity(&presses)), indenters }
    }

    /// Strength of each indenter's contact over its load, and the share of its strength that the board states as its
    /// deviation; none where it has no contact.
    fn factors(&self, trial: &mut Trial<'_>, reach: f64) -> Vec<Option<(f64, f64)>> {
        let pressed = trial.press(&self.voltages);
        let factor = |indenter: &Indenter| {
            let contact = pressed.last().iter().find(|contact| is_at(contact, &indenter.place, reach))?;
            Some((f64::from(contact.strength) / indenter.load(), stated(contact)))
        };
        self.indenters.iter().map(factor).collect()
    }
}

pub(super) fn stated(contact: &Contact) -> f64 {
    contact.evidence.map_or(0.0, |evidence| f64::from(evidence.strength_deviation / contact.strength))
}

pub(super) fn force(bench: &Bench, options: &Options) -> Result<Vec<Figure>, TrustError> {
    let mut trial = Trial::new(bench, options.first_snr_db(), options.seed)?;
    let reach = CLOSE * bench.size();
    // Calibrated where a machine would press it, half of the way to the rim.
    let calibrated = bench.places(options.seed).draw(5, &(0.0..0.5), 0.0)?;
    let calibrating = |place| vec![Indenter { place, radius: CALIBRATED, depth: 1.0 }];
    let calibrated: Vec<_> =
        calibrated.into_iter().map(|place| Scene::new(bench, calibrating(place))).collect();
    let mut figures = Vec::new();
    for (count, most, words) in [(1, 10.0, "one indenter"), (2, 15.0, "two indenters")] {
        let mut places = bench.places(options.seed);
        let scenes = (0..options.presses).map(|_| {
            let drawn = places.draw(count, &WITHIN, if count > 1 { APART } else { 0.0 })?;
            let indenters = drawn.into_iter().map(|place| Indenter {
                place,
                radius: places.number(RADII),
                depth: places.number(DEPTHS),
            });
            Ok(Scene::new(bench, indenters.collect()))
        });
        let scenes: Vec<_> = scenes.collect::<Result<_, TrustError>>()?;
        for &snr_db in &options.snr_db {
            trial.change_noise(snr_db, options.seed);
            let known: Vec<f64> =
                calibrated.iter().filter_map(|scene| Some(scene.factors(&mut trial, reach)[0]?.0)).collect();
            let factor = known.iter().sum::<f64>() / known.len() as f64;
            let seen: Vec<_> = scenes.iter().flat_map(|scene| scene.factors(&mut trial, reach)).collect();
            let found: Vec<_> = seen.iter().flatten().collect();
            let errors: Vec<f64> = found.iter().map(|(f, _)| 100.0 * (f / factor - 1.0).abs()).collect();
            let median = if errors.is_empty() { f64::NAN } else { median(errors.iter().copied()) };
            let [_, most_of, largest] = mean_95_largest(&errors);
            let right = found.iter().filter(|(f, stated)| (f / factor - 1.0).abs() <= 2.0 * stated).count();
            let name = |what: &str| format!("{words}: {what}");
            let share = Figure::share(name("with a contact"), snr_db, found.len(), seen.len());
            figures.push(share);
            let figure = Figure::new(name("error of the load, median"), "%", snr_db, median);
            figures.push(figure.at_most(most, snr_db >= 50.0));
            figures.push(Figure::new(name("error of the load, 95 %"), "%", snr_db, most_of));
            figures.push(Figure::new(name("error of the load, largest"), "%", snr_db, largest));
            let share = Figure::share(name("error within two stated deviations"), snr_db, right, found.len());
            figures.push(share.at_least(90.0, snr_db >= 50.0));
        }
    }
    Ok(figures)
}
