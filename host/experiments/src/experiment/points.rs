//! Point contact tracking (thesis 5.4.3): one point under 2 kg at five places of Sample 3.

use super::{
    ExperimentError,
    report::{Report, Wanted, largest, mean_and_deviation},
    saline::draw,
    sample::{Sample, THREE_SINGLE},
    sample_rig::{Artefacts, Shown},
};
use dermatome_shared::contact::Contact;
use dermatome_simulate::{Footprint, Load, Press};
use dermatome_view::sheet::Panel;
use rayon::prelude::*;
use serde_json::json;

/// Force of 2 kg, N.
const FORCE: f64 = 19.62;
/// Trials at each place.
const TRIALS: u64 = 3;
/// Places with the thesis' names, m, and its errors, mean and standard deviation. Its table has two of the
/// places' coordinates exchanged; the names say what is meant.
const PLACES: [(&str, [f64; 2], [f64; 2]); 5] = [
    ("centre", [0.0, 0.0], [-0.05, 0.015]),
    ("top", [0.0, 0.05], [0.07, 0.004]),
    ("bottom", [0.0, -0.05], [0.19, 0.017]),
    ("left", [-0.05, 0.0], [0.05, 0.006]),
    ("right", [0.05, 0.0], [0.11, 0.030]),
];
/// Mean of the thesis' errors (section 5.4.3).
const THESIS_MEAN: f64 = 9.3;

pub(super) fn run() -> Result<Report, ExperimentError> {
    let mut report = Report::new("points", "Point contact at five places (thesis 5.4.3, Table 5.4)");
    report.words(THREE_SINGLE.acquisition());
    report.words(format!(
        "A cube of 4 cm² under 2 kg (49 kPa, beyond the 20 kPa at which the fabric saturates) for 10 s at each place, in \
         {TRIALS} trials on fresh specimens. Artefacts: {}.",
        Artefacts::SHEET.words()
    ));
    let trials = trials(&THREE_SINGLE)?;
    let plain = self::trials(&THREE_SINGLE.without_movement())?;
    let mut rows = Vec::new();
    let mut of_places = Vec::new();
    for (index, (name, at, thesis)) in PLACES.into_iter().enumerate() {
        let errors: Vec<f64> = trials.iter().map(|trial| trial.errors[index]).collect();
        let [mean, deviation] = mean_and_deviation(&errors);
        rows.push(vec![
            format!("{name} ({:.0}, {:.0}) cm", at[0] * 100.0, at[1] * 100.0),
            format!("{:.3}", thesis[0]),
            format!("{:.3}", thesis[1]),
            format!("{mean:.4}"),
            format!("{deviation:.4}"),
        ]);
        of_places.push(json!({ "place": name, "position_m": at, "mean": mean, "sd": deviation }));
    }
    let [mean, max] = mean_and_largest(&trials);
    report.compare("position error, mean", "%", Some(THESIS_MEAN), mean, Some(Wanted::AtMost(THESIS_MEAN)));
    report.compare("position error, largest", "%", Some(19.0), max, Some(Wanted::AtMost(19.0)));
    report.compare(
        "without electrode movement in the matrix: position error, mean",
        "%",
        Some(THESIS_MEAN),
        mean_and_largest(&plain)[0],
        Some(Wanted::AtMost(THESIS_MEAN)),
    );
    report.table(
        "Normalised position error; here the distance of the board's contact, which is never negative",
        &["place", "thesis, mean", "s.d.", "here, mean", "s.d."],
        rows,
    );
    let first = &trials[0];
    let panels = PLACES.iter().zip(&first.shown).map(|((name, at, _), shown)| Panel {
        caption: vec![(*name).to_owned()],
        values: &shown.image,
        found: shown.contacts.iter().take(1).map(Contact::from_above).collect(),
        truth: vec![(*at, 0.0)],
        maximum: None,
    });
    report.picture(draw(&first.rig, "", 5, panels.collect())?, "What the board showed in the first trial");
    report.figures = json!({ "position_error_percent": { "mean": mean, "max": max }, "places": of_places });
    Ok(report)
}

struct Trial {
    /// Share of the diameter, by place; 1 where there is no contact.
    errors: Vec<f64>,
    shown: Vec<Shown>,
    rig: super::sample_rig::SampleRig,
}

/// Of the errors of some trials, %.
fn mean_and_largest(trials: &[Trial]) -> [f64; 2] {
    let all: Vec<f64> = trials.iter().flat_map(|trial| trial.errors.clone()).collect();
    [100.0 * mean_and_deviation(&all)[0], 100.0 * largest(all)]
}

fn trials(sample: &Sample) -> Result<Vec<Trial>, ExperimentError> {
    let trials: Vec<_> = (1..=TRIALS).into_par_iter().map(|seed| trial(sample, seed)).collect();
    trials.into_iter().collect()
}

fn trial(sample: &Sample, seed: u64) -> Result<Trial, ExperimentError> {
    let mut specimen = sample.specimen(Artefacts::SHEET, seed)?;
    let (mut errors, mut all) = (Vec::new(), Vec::new());
    for (_, at, _) in PLACES {
        let press = Press::new(Footprint::Square { side: 0.02 }, at, Load::Force(FORCE));
        let shown = specimen.hold(&[press], 10.0)?;
        errors.push(shown.offset(at).map_or(1.0, |[x, y]| x.hypot(y) / specimen.rig.side()));
        all.push(shown);
        // The cube is put elsewhere by hand.
        specimen.at_rest(30.0);
    }
    Ok(Trial { errors, shown: all, rig: specimen.rig })
}
