//! Static loading (thesis 4.2.2.1 and 5.4.1): one place, load up and down.

use super::{
    ExperimentError,
    plot::{Chart, Series, Style},
    report::{Assessment, Comparison, Report, Wanted, largest, mean_and_deviation, number},
    saline::{draw, hysteresis},
    sample::{Sample, cube},
    sample_rig::{Artefacts, SampleRig, Shown},
};
use dermatome_shared::contact::Contact;
use dermatome_simulate::{noise::root_mean_square, script::LoadingMachine};
use dermatome_view::sheet::Panel;
use rayon::prelude::*;
use serde_json::{Value, json};

/// Trials (thesis section 4.2.1).
const TRIALS: u64 = 3;
/// Time of a step, s.
const HOLD: f64 = 10.0;

/// One trial.
struct Trial {
    /// kPa, by reading.
    pressures: Vec<f64>,
    shown: Vec<Shown>,
    /// Mean over the region of interest, by reading.
    strengths: Vec<f64>,
    /// Relative conductivity change of the true sheet under the contact, by reading.
    true_changes: Vec<f64>,
    side: f64,
}

pub(super) fn run(sample: &Sample) -> Result<Report, ExperimentError> {
    let [name, title] = sample.loading;
    let mut report = Report::new(name, title);
    let found = sample.found;
    report.words(sample.acquisition());
    report.words(format!(
        "A square of 4 cm² in the middle, pressed by a machine in {} steps to {} kPa and back, {HOLD} s each, in {TRIALS} \
         trials on fresh specimens with artefacts of their own. Material: models/materials/{}.toml. Artefacts: {}.",
        found.readings / 2,
        found.range,
        sample.material,
        Artefacts::SHEET.words()
    ));
    let (trials, mut rigs) = trials(sample)?;
    let (plain, _) = self::trials(&sample.without_movement())?;
    let summary = Summary::new(&trials);
    summary.compare(sample, &mut report);
    report.assessment = Some(summary.assessment(sample));
    Summary::new(&plain).compare_plain(sample, &mut report);
    compare_artefacts(&mut rigs, sample, &mut report)?;
    summary.tabulate(sample, &mut report);
    report.plots(&[
        loops(&trials, "Readings from the image", "change, mean over ROI", Trial::strengths),
        loops(&trials, "Readings from the voltages", "|dV/V|, %", Trial::voltages),
        scatter(&trials),
    ])?;
    report
        .picture(pictures(&rigs[0], &trials[0])?, "What the board showed in the first trial: up, then down");
    report.figures = summary.json(&trials);
    Ok(report)
}

fn trials(sample: &Sample) -> Result<(Vec<Trial>, Vec<SampleRig>), ExperimentError> {
    let trials: Vec<_> = (1..=TRIALS).into_par_iter().map(|seed| trial(sample, seed)).collect();
    Ok(trials.into_iter().collect::<Result<Vec<_>, _>>()?.into_iter().unzip())
}

fn trial(sample: &Sample, seed: u64) -> Result<(Trial, SampleRig), ExperimentError> {
    let mut specimen = sample.specimen(Artefacts::SHEET, seed)?;
    let machine = LoadingMachine { steps: sample.found.readings / 2, hold: HOLD };
    let pressures: Vec<f64> = machine.shares().map(|share| share * sample.found.range).collect();
    let (mut shown, mut strengths, mut true_changes) = (Vec::new(), Vec::new(), Vec::new());
    for &pressure in &pressures {
        let conductivity = specimen.under(&[cube([0.0; 2], pressure)], HOLD);
        // Beyond the contact nothing rises.
        true_changes.push(largest(conductivity.iter().map(|sigma| sigma - 1.0)));
        let now = specimen.rig.show(&conductivity)?;
        strengths.push(specimen.rig.figures(&now, [0.0; 2]).map_or(0.0, |figures| figures.strength));
        shown.push(now);
    }
    let side = specimen.rig.side();
    Ok((Trial { pressures, shown, strengths, true_changes, side }, specimen.rig))
}

/// How far slips and stretch alone move the voltages, with nothing pressed.
fn compare_artefacts(
    rigs: &mut [SampleRig],
    sample: &Sample,
    report: &mut Report,
) -> Result<(), ExperimentError> {
    let shares = rigs.iter_mut().map(SampleRig::artefacts_alone).collect::<Result<Vec<_>, _>>()?;
    let what = format!("{}: what the artefacts of a load alone do to the voltages, rms", sample.name);
    report.compare(what, "%", None, 100.0 * root_mean_square(shares.into_iter()), None);
    Ok(())
}

impl Trial {
    fn strengths(&self) -> Vec<f64> {
        self.strengths.clone()
    }

    /// %.
    fn voltages(&self) -> Vec<f64> {
        self.shown.iter().map(|shown| 100.0 * shown.voltage_change.abs()).collect()
    }

    /// Offsets of the contact under load, share of the side.
    fn offsets(&self) -> impl Iterator<Item = [f64; 2]> + '_ {
        let loaded = self.pressures.iter().zip(&self.shown).filter(|(pressure, _)| **pressure > 0.0);
        loaded.filter_map(|(_, shown)| shown.offset([0.0; 2])).map(|offset| offset.map(|by| by / self.side))
    }

    fn loaded(&self) -> usize {
        self.pressures.iter().filter(|pressure| **pressure > 0.0).count()
    }
}

/// What all trials come to.
struct Summary {
    /// Mean over the trials, of the image and of the true sheet, %.
    hysteresis: f64,
    true_hysteresis: f64,
    /// Largest difference of a reading between trials, % of the rated output.
    repeatability: f64,
    /// Pressure up to which the mean reading rises with every step, kPa.
    range: f64,
    /// Mean and standard deviation of the contact's offset in x and y, share of the side.
    centre: [[f64; 2]; 2],
    /// Mean and largest distance, share of the side.
    distance: [f64; 2],
    /// Readings under load, and those without a contact.
    readings: [usize; 2],
}

impl Summary {
    fn new(trials: &[Trial]) -> Self {
        let readings: Vec<Vec<f64>> = trials.iter().map(Trial::strengths).collect();
        let mean = |of: &dyn Fn(&Trial) -> f64| trials.iter().map(of).sum::<f64>() / trials.len() as f64;
        let offsets: Vec<[f64; 2]> = trials.iter().flat_map(Trial::offsets).collect();
        let along = |axis: usize| mean_and_deviation(&offsets.iter().map(|by| by[axis]).collect::<Vec<_>>());
        let distances: Vec<f64> = offsets.iter().map(|[x, y]| x.hypot(*y)).collect();
        let loaded = trials.iter().map(Trial::loaded).sum();
        Self {
            hysteresis: mean(&|trial| hysteresis(&trial.strengths)),
            true_hysteresis: mean(&|trial| hysteresis(&trial.true_changes)),
            repeatability: repeatability(&readings),
            range: range(&trials[0].pressures, &readings),
            centre: [along(0), along(1)],
            distance: [mean_and_deviation(&distances)[0], largest(distances)],
            readings: [loaded, loaded - offsets.len()],
        }
    }

    fn compare(&self, sample: &Sample, report: &mut Report) {
        let found = sample.found;
        let means = self.centre.map(|[mean, _]| mean.abs());
        report.compare(
            format!("{}: CoP error, larger mean of x and y", sample.name),
            "%",
            Some(100.0 * found.position_error),
            100.0 * means[0].max(means[1]),
            Some(Wanted::AtMost(100.0 * found.position_error)),
        );
        report.compare(
            format!("{}: CoP error, mean distance", sample.name),
            "%",
            None,
            100.0 * self.distance[0],
            Some(Wanted::AtMost(100.0 * found.position_error)),
        );
        report.compare(
            format!("{}: hysteresis of the image", sample.name),
            "%",
            Some(found.hysteresis),
            self.hysteresis,
            None,
        );
        report.compare(
            format!("{}: hysteresis of the simulated sheet itself", sample.name),
            "%",
            Some(found.hysteresis),
            self.true_hysteresis,
            None,
        );
        report.compare(
            format!("{}: repeatability", sample.name),
            "%",
            found.repeatability,
            self.repeatability,
            None,
        );
    }

    /// Its row of Table 6.1.
    fn assessment(&self, sample: &Sample) -> Assessment {
        let found = sample.found;
        let means = self.centre.map(|[mean, _]| mean.abs());
        let figure = |what: &str, unit, thesis, found, wanted: fn(f64) -> Wanted| Comparison {
            what: what.to_owned(),
            unit,
            thesis: Some(thesis),
            found,
            wanted: Some(wanted(thesis)),
        };
        Assessment {
            sample: sample.name,
            figures: [
                figure("range: readings rise up to", "kPa", found.range, self.range, Wanted::AtLeast),
                figure("hysteresis", "% of R.O.", found.hysteresis, self.hysteresis, Wanted::AtMost),
                figure(
                    "position error, larger of x and y, share of the length",
                    "",
                    found.position_error,
                    means[0].max(means[1]),
                    Wanted::AtMost,
                ),
            ],
        }
    }

    /// What becomes of it if the matrix does not know that electrodes move.
    fn compare_plain(&self, sample: &Sample, report: &mut Report) {
        let limit = 100.0 * sample.found.position_error;
        report.compare(
            format!("{}: without electrode movement in the matrix: CoP error, mean distance", sample.name),
            "%",
            None,
            100.0 * self.distance[0],
            Some(Wanted::AtMost(limit)),
        );
        report.compare(
            format!("{}: without it: hysteresis of the image", sample.name),
            "%",
            Some(sample.found.hysteresis),
            self.hysteresis,
            None,
        );
    }

    /// Tables 4.2 and 5.3.
    fn tabulate(&self, sample: &Sample, report: &mut Report) {
        let found = sample.found;
        let row = |who: &str, centre: [[f64; 2]; 2], hysteresis, repeatability: Option<f64>| {
            let centre = centre.into_iter().flatten().map(|share| format!("{share:.4}"));
            let rest = [number(found.range), number(hysteresis)];
            let last = repeatability.map_or("-".to_owned(), number);
            std::iter::once(who.to_owned()).chain(rest).chain(centre).chain([last]).collect()
        };
        let rows = vec![
            row("thesis", found.centre, found.hysteresis, found.repeatability),
            row("here, simulated", self.centre, self.hysteresis, Some(self.repeatability)),
        ];
        let columns = [
            "",
            "range, kPa",
            "hysteresis, %",
            "CoP x, mean",
            "s.d.",
            "CoP y, mean",
            "s.d.",
            "repeatability, %",
        ];
        report.table("As in tables 4.2 and 5.3; CoP errors as shares of the sample's length", &columns, rows);
        let [readings, without] = self.readings;
        report.words(format!(
            "{readings} readings under load, {without} of them without a contact above the board's threshold. The range is \
             the material model's, so the thesis' own. Reference for the CoP error at the stated artefacts: mean distance \
             {:.2} %, largest {:.2} % of the length. The sheet itself has {:.1} % of hysteresis, to which its model is fitted; the image reads \
             large changes as smaller than they are, as every linear image does, and so shows more or less of it.",
            100.0 * self.distance[0],
            100.0 * self.distance[1],
            self.true_hysteresis
        ));
    }

    fn json(&self, trials: &[Trial]) -> Value {
        let [[x, x_deviation], [y, y_deviation]] = self.centre;
        json!({
            "hysteresis_percent": self.hysteresis,
            "hysteresis_of_sheet_percent": self.true_hysteresis,
            "repeatability_percent": self.repeatability,
            "range_kpa": self.range,
            "cop_x": { "mean": x, "sd": x_deviation },
            "cop_y": { "mean": y, "sd": y_deviation },
            "cop_distance": { "mean": self.distance[0], "max": self.distance[1] },
            "readings_under_load": self.readings[0],
            "readings_without_contact": self.readings[1],
            "pressures_kpa": trials[0].pressures,
            "changes": trials.iter().map(Trial::strengths).collect::<Vec<_>>(),
            "changes_of_sheet": trials.iter().map(|trial| &trial.true_changes).collect::<Vec<_>>(),
            "voltage_changes_percent": trials.iter().map(Trial::voltages).collect::<Vec<_>>(),
        })
    }
}

/// Pressure up to which the mean of all trials rises with every step of the loading branch.
fn range(pressures: &[f64], trials: &[Vec<f64>]) -> f64 {
    let top = pressures.len() / 2;
    let mean = |index: usize| trials.iter().map(|trial| trial[index]).sum::<f64>();
    let risen = (1..=top).take_while(|&index| mean(index) > mean(index - 1)).count();
    pressures.get(risen).copied().unwrap_or(0.0)
}

/// Largest difference of one reading between trials, % of the range of all.
fn repeatability(trials: &[Vec<f64>]) -> f64 {
    let readings = trials.first().map_or(0, Vec::len);
    let ends = |values: &mut dyn Iterator<Item = f64>| {
        values.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), v| (low.min(v), high.max(v)))
    };
    let gap = largest((0..readings).map(|index| {
        let (low, high) = ends(&mut trials.iter().map(|trial| trial[index]));
        high - low
    }));
    let (low, high) = ends(&mut trials.iter().flatten().copied());
    100.0 * gap / (high - low).max(f64::MIN_POSITIVE)
}

fn loops<'a>(trials: &[Trial], title: &'a str, y: &'a str, readings: fn(&Trial) -> Vec<f64>) -> Chart<'a> {
    let series = (1..).zip(trials).map(|(number, trial)| {
        let points = trial.pressures.iter().zip(readings(trial)).map(|(&p, reading)| [p, reading]).collect();
        Series::new(format!("trial {number}"), points, Style::MarkedLine)
    });
    Chart { title, x: "pressure, kPa", y, series: series.collect(), square: None }
}

fn scatter(trials: &[Trial]) -> Chart<'static> {
    let series: Vec<_> = (1..)
        .zip(trials)
        .map(|(number, trial)| {
            let points = trial.offsets().map(|offset| offset.map(|by| 100.0 * by)).collect();
            Series::new(format!("trial {number}"), points, Style::Marks)
        })
        .collect();
    let reach = largest(series.iter().flat_map(|s| &s.points).flatten().map(|by| by.abs()));
    let square = Some((1.2 * reach).max(0.5));
    Chart { title: "CoP under load", x: "x, % of the length", y: "y, % of the length", series, square }
}

fn pictures(rig: &SampleRig, trial: &Trial) -> Result<Vec<u8>, ExperimentError> {
    let count = trial.shown.len();
    let shown = dermatome_frames::recorded::reconstruct::evenly_spaced(count, 10);
    let panels = shown.into_iter().map(|index| {
        let shown = &trial.shown[index];
        Panel {
            caption: vec![format!(
                "{:.1} kPa, {}",
                trial.pressures[index],
                if index <= count / 2 { "up" } else { "down" }
            )],
            values: &shown.image,
            found: shown.contacts.first().map(Contact::from_above).into_iter().collect(),
            truth: vec![([0.0; 2], 0.0)],
            maximum: None,
        }
    });
    draw(rig, "", 5, panels.collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn repeatability_is_the_widest_gap_between_trials_over_the_range() {
        let trials = [vec![0.0, 1.0, 2.0, 1.0], vec![0.0, 1.2, 2.0, 1.5]];
        assert!((repeatability(&trials) - 25.0).abs() < 1e-12);
        assert_eq!(repeatability(&trials[..1]), 0.0);
    }

    #[test]
    fn the_range_ends_where_the_mean_reading_no_longer_rises() {
        let pressures = [0.0, 10.0, 20.0, 30.0, 20.0, 10.0, 0.0];
        let rising = [0.0, 1.0, 2.0, 3.0, 2.5, 1.5, 0.2];
        let stuck = [0.0, 1.0, 2.0, 0.9, 2.5, 1.5, 0.2];
        assert_eq!(range(&pressures, &[rising.to_vec()]), 30.0);
        assert_eq!(range(&pressures, &[stuck.to_vec()]), 20.0);
        // The mean of both: 1, 2, 1.95.
        assert_eq!(range(&pressures, &[rising.to_vec(), stuck.to_vec()]), 20.0);
        assert_eq!(range(&pressures, &[vec![0.0; 7]]), 0.0);
    }
}
