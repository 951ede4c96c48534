//! One, two and three contacts on the hemisphere (thesis 5.4.4): whether the board counts them right, and
//! the host from the same voltages, and where they see them.

use super::{
    DIAMETER, played_words, skins,
    touches::{Touch, TouchRig, tabulate},
};
use crate::{
    experiment::{
        ExperimentError,
        report::{Report, Wanted, largest, mean_and_deviation, number},
    },
    scenes::{Options, Scene, matched, play},
};
use dermatome_model::skin::Skin;
use nalgebra::Point3;
use serde_json::json;

/// Scenes: a third each with one, two and three contacts.
const SCENES: usize = 501;
/// Share of the scenes in which the number of contacts should be right, %.
const COUNT_RIGHT: f64 = 98.0;
/// Numbers of contacts that have a column of their own; the last one holds all above.
const COLUMNS: usize = 5;

/// Places of the single touches, as in the thesis' figure four that are opposite to one another, and the pole: direction
/// as seen from above and way down from the pole, degrees.
const TOUCHES: [(&str, [f64; 2]); 5] = [
    ("top", [90.0, 50.0]),
    ("right", [0.0, 50.0]),
    ("bottom", [270.0, 50.0]),
    ("left", [180.0, 50.0]),
    ("pole", [0.0, 0.0]),
];

pub(in super::super) fn run() -> Result<Report, ExperimentError> {
    let mut report =
        Report::new("hemisphere", "One, two and three contacts on a hemisphere (thesis 5.4.4, Fig. 5.10)");
    let options = Options { scenes: SCENES, ..Options::default() };
    played_words(&options).into_iter().for_each(|words| report.words(words));
    let [skin, truth] = skins()?;
    summarise(&mut report, &play(&skin, &truth, &options)?);
    touch(&mut report, &skin, &truth)?;
    Ok(report)
}

/// Single touches at several places, pictured.
fn touch(report: &mut Report, skin: &Skin, truth: &Skin) -> Result<(), ExperimentError> {
    let mut rig = TouchRig::new(truth, vec![skin.clone()])?;
    report.words(rig.words());
    let touches: Vec<Touch> = TOUCHES.iter().map(|(name, place)| rig.touch(name, &[*place])).collect();
    report.picture(
        rig.draw(0, &touches)?,
        "Single touches as in Fig. 5.10, seen from above: four places opposite to one another, 50 degrees of the sphere down from \
         the pole, and the pole. Crosses and their circles: the finger; rings: what the board found.",
    );
    tabulate(report, &touches, &["surface"]);
    let (counts, errors): (Vec<usize>, Vec<_>) = touches.iter().map(|touch| touch.found(0)).unzip();
    let right = counts.iter().filter(|&&count| count == 1).count();
    report.compare(
        "single touches pictured: those with one contact on the board",
        "%",
        None,
        percent(right, counts.len()),
        None,
    );
    let errors: Vec<Option<f64>> =
        errors.concat().into_iter().map(|e| e.map(|e| 100.0 * e / DIAMETER)).collect();
    let mean = mean_and_deviation(&errors.iter().copied().flatten().collect::<Vec<_>>())[0];
    report.compare("single touches pictured: position error of those found, mean", "%", None, mean, None);
    let places = TOUCHES.iter().zip(counts.iter().zip(&errors));
    report.figures["touches"] = places
        .map(|((name, _), (found, error))| json!({ "place": name, "found": found, "error_percent": error }))
        .collect();
    Ok(())
}

/// Contacts that a scene shows.
type Found = fn(&Scene) -> &[Point3<f64>];

/// Who observes.
const OBSERVERS: [(&str, Found); 2] =
    [("the board", |scene| &scene.surface), ("the host, from the same voltages", |scene| &scene.resolved)];

fn summarise(report: &mut Report, scenes: &[Scene]) {
    report.words(
        "The board finds contacts in the voltages, in six frames. The host resolves fingers from the difference data of the \
         first (dermatome::multi_contact); it is told the noise and the size of a finger.",
    );
    let [board, host] = OBSERVERS.map(|observer| summary(report, scenes, observer));
    let share = host["count_right_percent"].as_f64().unwrap_or_default();
    report.compare("number right, all scenes", "%", None, share, Some(Wanted::AtLeast(COUNT_RIGHT)));
    report.figures = json!({ "scenes": scenes.len(), "board": board, "host": host });
}

/// What one of them sees.
fn summary(report: &mut Report, scenes: &[Scene], (who, found): (&str, Found)) -> serde_json::Value {
    let right = |scene: &&Scene| found(scene).len() == scene.truth.len();
    let errors =
        |scene: &Scene| matched(&scene.truth, found(scene)).into_iter().flatten().collect::<Vec<f64>>();
    let (mut counts, mut rows, mut figures) = (Vec::new(), Vec::new(), Vec::new());
    for (contacts, name) in (1..).zip(["one contact", "two contacts", "three contacts"]) {
        let here: Vec<&Scene> = scenes.iter().filter(|scene| scene.truth.len() == contacts).collect();
        let share = percent(here.iter().copied().filter(right).count(), here.len());
        report.compare(format!("{who}, {name}: number right"), "%", None, share, None);
        let numbers = numbers_found(&here, found);
        let errors: Vec<f64> = here.iter().copied().filter(right).flat_map(errors).collect();
        let [mean, deviation] = mean_and_deviation(&errors);
        let errors = [mean, deviation, largest(errors)].map(|error| 100.0 * error / DIAMETER);
        counts.push(row(name, numbers.iter().map(ToString::to_string)));
        rows.push(row(name, errors.map(number)));
        figures.push(json!({
            "contacts": contacts, "scenes": here.len(), "count_right_percent": share, "found": numbers,
            "error_percent": { "mean": errors[0], "sd": errors[1], "max": errors[2] },
        }));
    }
    let share = percent(scenes.iter().filter(right).count(), scenes.len());
    report.compare(format!("{who}: number right"), "%", None, share, None);
    let all: Vec<f64> = scenes.iter().filter(right).flat_map(errors).collect();
    let mean = 100.0 * mean_and_deviation(&all)[0] / DIAMETER;
    report.compare(format!("{who}: position error where the number is right, mean"), "%", None, mean, None);
    report.table(
        &format!("Scenes by the number of contacts found by {who}"),
        &["true", "0", "1", "2", "3", "4 or more"],
        counts,
    );
    report.table(
        &format!("Distance of a contact from its finger, per cent of the diameter, where the number is right: {who}"),
        &["", "mean", "s.d.", "largest"],
        rows,
    );
    json!({ "count_right_percent": share, "error_percent": mean, "by_contacts": figures })
}

fn row(name: &str, cells: impl IntoIterator<Item = String>) -> Vec<String> {
    std::iter::once(name.to_owned()).chain(cells).collect()
}

fn percent(part: usize, whole: usize) -> f64 {
    100.0 * part as f64 / whole.max(1) as f64
}

/// How many of these scenes show how many contacts.
fn numbers_found(scenes: &[&Scene], found: Found) -> [usize; COLUMNS] {
    let mut counts = [0; COLUMNS];
    scenes.iter().for_each(|scene| counts[found(scene).len().min(COLUMNS - 1)] += 1);
    counts
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(x: f64) -> Point3<f64> {
        Point3::new(x, 0.0, 0.0)
    }

    #[test]
    fn a_wrong_number_counts_against_the_share_and_not_into_the_errors() {
        let scene = |truth: &[f64], surface: &[f64]| Scene {
            truth: truth.iter().copied().map(at).collect(),
            surface: surface.iter().copied().map(at).collect(),
            flattened: Vec::new(),
            resolved: truth.iter().copied().map(at).collect(),
        };
        let scenes = [
            scene(&[0.0], &[0.021]),
            scene(&[0.0], &[]),
            scene(&[0.0, 0.1], &[0.0, 0.1]),
            scene(&[0.0, 0.1, 0.2], &[0.0; 9]),
        ];
        let mut report = Report::new("x", "x");
        summarise(&mut report, &scenes);
        let found: Vec<f64> = report.comparisons.iter().map(|comparison| comparison.found).collect();
        assert_eq!(found[..4], [50.0, 100.0, 0.0, 50.0]);
        // Errors of 10 %, 0 and 0 of the diameter.
        assert!((found[4] - 10.0 / 3.0).abs() < 1e-9, "{found:?}");
        assert_eq!(found[5..], [100.0, 100.0, 100.0, 100.0, 0.0, 100.0]);
        assert_eq!(report.comparisons[10].met(), Some(true));
        assert_eq!(report.figures["board"]["by_contacts"][0]["found"], json!([1, 1, 0, 0, 0]));
        assert_eq!(report.figures["board"]["by_contacts"][2]["found"], json!([0, 0, 0, 0, 1]));
    }
}
