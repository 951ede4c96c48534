//! Pressure map (thesis 4.2.2.2): a load of 1 kg at 15 places, one after the other, on one specimen.

use super::{
    ExperimentError,
    report::{Report, largest},
    saline::draw,
    saline_map::{LINES, PLACES, Spot, panel, show_spots},
    sample::{ONE, Sample, Specimen, TWO},
    sample_rig::Artefacts,
};
use dermatome_simulate::{Footprint, Load, Press};
use rayon::prelude::*;
use serde_json::{Value, json};

/// Force of 1 kg, N.
const FORCE: f64 = 9.81;
/// Time between measurements, s.
const INTERVAL: f64 = 10.0;
/// What the thesis' places shrink by on Sample 1, so that the contact stays on it.
const SHRINK: f64 = 14.0 / 60.0;

/// A map of one sample.
struct Map {
    spots: Vec<Spot>,
    specimen: Specimen,
}

pub(super) fn run() -> Result<Report, ExperimentError> {
    let mut report =
        Report::new("pressure-map", "Pressure map of 15 places (thesis 4.2.2.2, Figs 4.11 to 4.15)");
    report.words(format!(
        "A square of 4 cm² under 1 kg (24.5 kPa) for {INTERVAL} s at each of 15 places, {INTERVAL} s of rest between, on one \
         specimen, so that the material's memory of earlier places stays. On Sample 1 the places are those of Sample 2 times \
         {SHRINK:.2}, so that the contact stays on the sheet; the thesis' own lie in its Figure 4.11. Artefacts: {}.",
        Artefacts::SHEET.words()
    ));
    let cases = [(&ONE, SHRINK), (&TWO, 1.0)];
    let maps: Vec<_> = cases.par_iter().map(|(sample, scale)| map(sample, *scale)).collect();
    let mut figures = serde_json::Map::new();
    for ((sample, _), map) in cases.into_iter().zip(maps) {
        figures.insert(sample.material.to_owned(), show(&mut report, sample, &map?)?);
    }
    report.figures = Value::Object(figures);
    Ok(report)
}

fn map(sample: &Sample, scale: f64) -> Result<Map, ExperimentError> {
    let mut specimen = sample.specimen(Artefacts::SHEET, 1)?;
    let mut spots = Vec::new();
    for (x, _) in LINES {
        for y in PLACES {
            let at = [x * scale, y * scale];
            let press = Press::new(Footprint::Square { side: 0.02 }, at, Load::Force(FORCE));
            let shown = specimen.hold(&[press], INTERVAL)?;
            spots.push(Spot::new(&specimen.rig, at, shown));
            specimen.at_rest(INTERVAL);
        }
    }
    Ok(Map { spots, specimen })
}

fn show(report: &mut Report, sample: &Sample, map: &Map) -> Result<Value, ExperimentError> {
    let rig = &map.specimen.rig;
    let errors = || map.spots.iter().map(|spot| 100.0 * spot.error);
    let mean = errors().sum::<f64>() / map.spots.len() as f64;
    let ringing = || map.spots.iter().filter_map(|spot| spot.figures).map(|figures| figures.ringing);
    // Section 4.2.2.2 has figures of Sample 2's ringing alone.
    let thesis_ringing = (sample.material == TWO.material).then_some([1.5, 7.98]);
    report.compare(format!("{}: position error, mean of 15 places", sample.name), "%", None, mean, None);
    report.compare(format!("{}: position error, largest", sample.name), "%", None, largest(errors()), None);
    let smallest = ringing().fold(f64::INFINITY, f64::min);
    for (index, what, found) in [(0, "smallest", smallest), (1, "largest", largest(ringing()))] {
        let thesis = thesis_ringing.map(|ringing| ringing[index]);
        report.compare(format!("{}: ringing, {what}", sample.name), "", thesis, found, None);
    }
    report.words(sample.acquisition());
    show_spots(report, &format!("{}: figures at each place", sample.name), &map.spots, rig.side())?;
    let panels = map.spots.iter().map(|spot| panel(spot, &spot.shown.image)).collect();
    let words = format!(
        "{}: what the board showed at the 15 places in order: lines from the centre to the edge, each from top to bottom",
        sample.name
    );
    report.picture(draw(rig, "", 5, panels)?, &words);
    Ok(json!({
        "position_error_percent": { "mean": mean, "max": largest(errors()) },
        "ringing": { "min": smallest, "max": largest(ringing()) },
        "places": map.spots.iter().map(|spot| spot.json(rig.side())).collect::<Vec<_>>(),
    }))
}
