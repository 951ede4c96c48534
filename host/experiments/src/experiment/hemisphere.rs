//! One, two and three contacts on the hemisphere (thesis 5.4.4): whether the board counts them right in its image, and
//! the host from the same voltages, and where they see them.

use super::{
    ExperimentError,
    report::{Report, Wanted, largest, mean_and_deviation, number},
    sample::THREE_SINGLE,
    touches::{Booth, Touch, tabulate},
};
use crate::scenes::{Options, Scene, play};
use dermatome_model::skin::Skin;
use nalgebra::Point3;
use serde_json::json;
use std::path::Path;

/// Scenes: a third each with one, two and three contacts.
const SCENES: usize = 501;
/// Share of the scenes in which the number of contacts should be right, %.
const COUNT_RIGHT: f64 = 98.0;
/// Diameter of the hemisphere, m.
pub(super) const DIAMETER: f64 = 0.21;
/// Numbers of contacts that have a column of their own; the last one holds all above.
const COLUMNS: usize = 5;

const SKIN: &str = include_str!("../../../../models/hemisphere-210mm/skin.toml");
const FORMULA: &str = include_str!("../../../../models/hemisphere-210mm/formula.toml");
const MESH: &[u8] = include_bytes!("../../../../models/hemisphere-210mm/hemisphere.stl");

/// Places of the single touches, as in the thesis' figure four that are opposite to one another, and the pole: direction
/// as seen from above and way down from the pole, degrees.
const TOUCHES: [(&str, [f64; 2]); 5] = [
    ("top", [90.0, 50.0]),
    ("right", [0.0, 50.0]),
    ("bottom", [270.0, 50.0]),
    ("left", [180.0, 50.0]),
    ("pole", [0.0, 0.0]),
];

/// The skin from an STL file, which images are made with, and the same from its formula, which is the truth; both
/// driven as in the thesis.
pub(super) fn skins() -> Result<[Skin; 2], ExperimentError> {
    let folder = tempfile::tempdir()?;
    std::fs::write(folder.path().join("hemisphere.stl"), MESH)?;
    let skin = Skin::parse(&folder.path().join("skin.toml"), SKIN)?.made()?;
    let mut skins = [skin, Skin::parse(Path::new("models/hemisphere-210mm/formula.toml"), FORMULA)?.made()?];
    skins.iter_mut().for_each(|skin| THREE_SINGLE.drive(skin));
    Ok(skins)
}

/// Words on how the skin is driven and what is played.
pub(super) fn played_words(options: &Options) -> [String; 2] {
    let driven = format!(
        "The skin is models/hemisphere-210mm: 210 mm across, 16 electrodes on its rim, the fabric of Sample 3. {} Otherwise than in \
         Table 5.5: the matrix is GREIT's and not that of a Laplace prior with a hyperparameter of 0.15, because it counts more \
         contacts right; it takes plain differences, from which an absolute value would take the sign, so the part in phase is \
         measured; the board finds its own gain. The thesis does not say that frames were averaged here, and these are single \
         ones. The true skin is a hemisphere by its formula, the model's comes from an STL file.",
        THREE_SINGLE.drive_words()
    );
    let played = format!(
        "{} random scenes with one, two and three fingers in turn, of radius {:.1} mm as seen from above. They do not press through \
         Sample 3's material: each changes the conductivity in its middle by {:.0} %, a change that is known exactly. Centres \
         evenly over the surface, a radius from the rim, and at least {:.0} % of the diameter apart; {:.0} dB, a reference of 20 \
         frames, no other artefacts. The thesis shows pictures of one, two and three contacts and no figures.",
        options.scenes,
        options.radius * DIAMETER * 1e3,
        100.0 * options.depth,
        100.0 * options.apart,
        options.snr_db
    );
    [driven, played]
}

pub(super) fn run() -> Result<Report, ExperimentError> {
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
    let mut booth = Booth::new(truth, vec![skin.clone()])?;
    report.words(booth.words());
    let touches: Vec<Touch> = TOUCHES.iter().map(|(name, place)| booth.touch(name, &[*place])).collect();
    report.picture(
        booth.draw(0, &touches)?,
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

/// Who looks.
const LOOKERS: [(&str, Found); 2] = [
    ("the board, in its image", |scene| &scene.surface),
    ("the host, from the same voltages", |scene| &scene.resolved),
];

fn summarise(report: &mut Report, scenes: &[Scene]) {
    report.words(
        "The board finds contacts in its image. The host resolves fingers from the difference data that the board streams \
         (dermatome::resolve); it is told the noise and the size of a finger.",
    );
    let [board, host] = LOOKERS.map(|looker| summary(report, scenes, looker));
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

/// Distance of each true centre from the contact that is its own: the closest pair of both belongs together, then
/// the closest of the rest. `None` where none is left.
pub(super) fn matched(truth: &[Point3<f64>], found: &[Point3<f64>]) -> Vec<Option<f64>> {
    let pairs = (0..truth.len()).flat_map(|t| (0..found.len()).map(move |f| (t, f)));
    let mut pairs: Vec<_> = pairs.map(|(t, f)| ((truth[t] - found[f]).norm(), t, f)).collect();
    pairs.sort_by(|a, b| a.0.total_cmp(&b.0));
    let (mut distances, mut is_taken) = (vec![None; truth.len()], vec![false; found.len()]);
    for (distance, t, f) in pairs {
        if distances[t].is_none() && !is_taken[f] {
            (distances[t], is_taken[f]) = (Some(distance), true);
        }
    }
    distances
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(x: f64) -> Point3<f64> {
        Point3::new(x, 0.0, 0.0)
    }

    #[test]
    fn each_finger_has_the_contact_that_is_closest_and_no_one_elses() {
        let close = |found: Vec<Option<f64>>, expected: &[Option<f64>]| {
            assert_eq!(found.len(), expected.len());
            for (found, expected) in found.iter().zip(expected) {
                assert!((found.unwrap_or(-1.0) - expected.unwrap_or(-1.0)).abs() < 1e-12, "{found:?}");
            }
        };
        close(matched(&[at(0.0), at(1.0)], &[at(0.9), at(0.2)]), &[Some(0.2), Some(0.1)]);
        // The contact between both belongs to the closer one.
        close(matched(&[at(0.0), at(1.0)], &[at(0.6)]), &[None, Some(0.4)]);
        close(matched(&[at(0.0)], &[]), &[None]);
        close(matched(&[], &[at(0.0)]), &[]);
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
