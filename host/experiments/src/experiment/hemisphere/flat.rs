//! Surface against planar image on the hemisphere (thesis 5.4.4, Fig. 5.11): the same frames through the surface's
//! model and through that of the skin without its third dimension.

use super::{
    played_words, skins,
    touches::{TouchRig, tabulate},
};
use crate::{
    experiment::{
        ExperimentError,
        plot::{Chart, Series, Style},
        report::{Report, Wanted, mean_and_deviation},
    },
    scenes::{Options, Scene, matched, play},
};
use nalgebra::Point3;
use serde_json::json;

/// Scenes: a third each with one, two and three contacts.
const SCENES: usize = 150;
/// How much better the surface's model should be.
const BETTER: f64 = 2.0;
/// Contacts closer to the pole than this, degrees of the sphere, hardly differ: the sheet is level there.
const POLE: f64 = 20.0;
/// The pictures' fingers: direction seen from above, degrees.
const PICTURES: [&[f64]; 2] = [&[20.0, 200.0], &[90.0, 210.0, 330.0]];
/// How far down from the pole they are, degrees of the sphere.
const DOWN: f64 = 50.0;

pub(in super::super) fn run() -> Result<Report, ExperimentError> {
    let mut report = Report::new(
        "hemisphere-flat",
        "Surface against planar image on a hemisphere (thesis 5.4.4, Fig. 5.11)",
    );
    let options = Options { scenes: SCENES, ..Options::default() };
    played_words(&options).into_iter().for_each(|words| report.words(words));
    report.words(
        "Each frame is imaged twice: with the surface's model, and with the model of a flat disc with the same rim and electrodes \
         as seen from above. What the flat model finds is laid back onto the hemisphere from above.",
    );
    let [skin, truth] = skins()?;
    compare(&mut report, &play(&skin, &truth, &options)?)?;
    let flat = skin.flattened().map_err(dermatome_model::model::ModelError::from)?;
    let mut rig = TouchRig::new(&truth, vec![skin, flat])?;
    report.words(rig.words());
    let touches = PICTURES.map(|directions| {
        let places: Vec<_> = directions.iter().map(|&direction| [direction, DOWN]).collect();
        rig.touch(&format!("{} contacts", directions.len()), &places)
    });
    report.picture(
        rig.draw(0, &touches)?,
        "Two and three contacts through the surface's model, seen from above",
    );
    report.picture(rig.draw(1, &touches)?, "The same frames through the planar model");
    report.words(format!(
        "The pictures' fingers are {DOWN:.0} degrees of the sphere down from the pole. Crosses: where they truly are; rings: what the \
         board found. Areas of the planar model are areas of its disc."
    ));
    tabulate(&mut report, &touches, &["surface", "planar"]);
    Ok(report)
}

/// How far from the pole, degrees of the sphere.
fn way_down(centre: &Point3<f64>) -> f64 {
    centre.x.hypot(centre.y).atan2(centre.z).to_degrees()
}

/// Errors of both models, contact by contact: way from the pole in degrees, surface and planar in mm. Contacts that
/// either does not find are left out, and counted.
fn errors(scenes: &[Scene]) -> (Vec<[f64; 3]>, [usize; 2]) {
    let (mut errors, mut missed) = (Vec::new(), [0; 2]);
    for scene in scenes {
        let of = [&scene.surface, &scene.flattened].map(|found| matched(&scene.truth, found));
        for (index, centre) in scene.truth.iter().enumerate() {
            let [surface, flat] = [0, 1].map(|observer| of[observer][index]);
            missed[0] += usize::from(surface.is_none());
            missed[1] += usize::from(flat.is_none());
            errors.extend(surface.zip(flat).map(|(a, b)| [way_down(centre), a * 1e3, b * 1e3]));
        }
    }
    (errors, missed)
}

fn compare(report: &mut Report, scenes: &[Scene]) -> Result<(), ExperimentError> {
    let single: Vec<Scene> = scenes.iter().filter(|scene| scene.truth.len() == 1).cloned().collect();
    let mut figures = Vec::new();
    for (what, scenes) in [("single contacts", &single[..]), ("all contacts", scenes)] {
        let (errors, missed) = errors(scenes);
        let away: Vec<_> = errors.iter().filter(|[down, ..]| *down > POLE).collect();
        let mean = |model: usize| mean_and_deviation(&away.iter().map(|e| e[model]).collect::<Vec<_>>())[0];
        let [surface, flat] = [mean(1), mean(2)];
        let wanted = (what == "single contacts").then_some(Wanted::AtLeast(BETTER));
        report.compare(format!("{what} away from the pole: surface, mean error"), "mm", None, surface, None);
        report.compare(format!("{what} away from the pole: planar, mean error"), "mm", None, flat, None);
        report.compare(
            format!("{what} away from the pole: planar over surface"),
            "",
            None,
            flat / surface,
            wanted,
        );
        figures.push(json!({
            "of": what, "contacts": errors.len(), "away_from_pole": away.len(), "not_found": { "surface": missed[0], "planar": missed[1] },
            "mean_error_mm": { "surface": surface, "planar": flat },
        }));
    }
    let (errors, missed) = errors(&single);
    report.words(format!(
        "Away from the pole: more than {POLE:.0} degrees of the sphere. Contacts that one of the models does not find are left out: of \
         the single ones {} and {}.",
        missed[0], missed[1]
    ));
    let series = |name, model: usize| {
        Series::new(name, errors.iter().map(|error| [error[0], error[model]]).collect(), Style::Marks)
    };
    report.plots(&[Chart {
        title: "Single contacts",
        x: "way from the pole, degrees",
        y: "position error, mm",
        series: vec![series("surface", 1), series("planar", 2)],
        ..Chart::default()
    }])?;
    report.figures = json!({ "scenes": scenes.len(), "pole_degrees": POLE, "errors": figures });
    Ok(())
}
