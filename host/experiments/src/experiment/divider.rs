//! Voltage divider (thesis 3.2): resistance of Samples 1 and 2 between two electrodes, under load.
//!
//! Pieces of 50 mm with two electrodes 30 mm apart. The resistance is that of the true skin's transfer
//! impedances; the divider has a fixed resistor as large as the untouched sample, and a 12-bit converter.

use super::{
    ExperimentError,
    plot::{Chart, Series, Style},
    report::{Report, number},
    saline::hysteresis,
};
use dermatome_model::skin::Skin;
use dermatome_simulate::{
    Footprint, Load, Press, Sheet, TrueSkin, material::Material, script::LoadingMachine,
};
use num_complex::Complex64;
use rand::SeedableRng;
use rand_distr::{Distribution, StandardNormal};
use rand_pcg::Pcg64Mcg;
use rayon::prelude::*;
use serde_json::{Value, json};
use std::path::Path;

/// Largest load, N (thesis section 3.2.1), on 4.44 cm^2: 225 kPa.
const FORCE: f64 = 100.0;
const SIDE: f64 = 0.0211;
/// Weight of the apparatus, N (section 3.2.2).
const PRELOAD: f64 = 2.69;
const STEPS: u32 = 30;
const HOLD: f64 = 2.0;
const TRIALS: u64 = 3;
/// Steps of the converter, and noise of one reading after the filter of 10 rad/s, in steps.
const CONVERTER: f64 = 4096.0;
const NOISE: f64 = 0.5;

/// One sample in the divider.
struct Piece {
    name: &'static str,
    material: &'static str,
    skin: &'static str,
    /// The thesis': resistance under the preload, its change, ohm; range, kPa; hysteresis, %.
    found: [f64; 4],
}

/// Strips of copper right across, 30 mm apart: what lies under them is shorted, so the piece is 30 mm long.
/// The two small electrodes carry no current.
const STRIPS: &str = r#"
name = "divider-strips"
[shape]
kind = "rectangle"
width = "30 mm"
height = "50 mm"
[mesh]
edge_length = "1.5 mm"
[material]
sheet_conductivity = "10 uS"
[electrodes]
count = 4
placement = "points"
positions = [["15 mm", "0 mm"], ["0 mm", "-25 mm"], ["-15 mm", "0 mm"], ["0 mm", "25 mm"]]
model = "complete"
width = ["49 mm", "1 mm", "49 mm", "1 mm"]
contact_impedance = "25 ohm m"
[drive]
pattern = "adjacent"
reciprocal = "combined"
frequency = "12.5 kHz"
amplitude = "0.1 mA"
frame_rate = "50 Hz"
[inverse]
prior = "laplace"
hyperparameter = 0.03
normalised = true
[image]
columns = 10
[contact]
threshold = 0.05
"#;

/// Buttons pierced through a piece of 50 mm, 30 mm apart.
const BUTTONS: &str = r#"
name = "divider-buttons"
[shape]
kind = "rectangle"
width = "50 mm"
height = "50 mm"
[mesh]
edge_length = "1.5 mm"
[material]
sheet_conductivity = "0.5 mS"
[electrodes]
count = 4
placement = "points"
positions = [["20.5 mm", "0 mm"], ["0 mm", "-25 mm"], ["-20.5 mm", "0 mm"], ["0 mm", "25 mm"]]
model = "complete"
width = ["8 mm", "1 mm", "8 mm", "1 mm"]
contact_impedance = "0.5 ohm m"
[drive]
pattern = "adjacent"
reciprocal = "combined"
frequency = "50 kHz"
amplitude = "1 mA"
frame_rate = "50 Hz"
[inverse]
prior = "laplace"
hyperparameter = 0.03
normalised = true
[image]
columns = 10
[contact]
threshold = 0.05
"#;

const PIECES: [Piece; 2] = [
    Piece { name: "Sample 1", material: "sample-1", skin: STRIPS, found: [13.4e3, 5.9e3, 100.0, 20.2] },
    Piece { name: "Sample 2", material: "sample-2", skin: BUTTONS, found: [2075.0, 63.0, 225.0, 28.0] },
];

/// Readings of one trial: load, N, and resistance, ohm.
type Trial = Vec<[f64; 2]>;

pub(super) fn run() -> Result<Report, ExperimentError> {
    let mut report = Report::new("divider", "Voltage divider characterisation (thesis 3.2)");
    report.words(format!(
        "Pieces of 50 by 50 mm with electrodes 30 mm apart, loaded to {FORCE} N on 4.4 cm² in {STEPS} steps of {HOLD} s and \
         back, {TRIALS} times on fresh pieces, after a preload of {PRELOAD} N. Sample 1 lies on strips of copper, Sample 2 has two \
         buttons of 8 mm (assumed). The divider's resistor equals the preloaded sample, its converter has 12 bits."
    ));
    report.words(
        "The material files are fitted to what the thesis found with electrical impedance tomography, where ranges and hysteresis \
         were others than in this first circuit; the thesis itself calls the divider \"not an accurate representation of the final \
         transducer\". So this experiment shows by how much the two disagree, and nothing here was fitted to it.",
    );
    let all: Vec<Result<Vec<Trial>, ExperimentError>> = PIECES.par_iter().map(trials).collect();
    let mut figures = serde_json::Map::new();
    let mut charts = Vec::new();
    let mut rows = Vec::new();
    for (piece, trials) in PIECES.iter().zip(all) {
        let trials = trials?;
        figures.insert(piece.material.to_owned(), piece.show(&trials, &mut report, &mut rows));
        charts.push(chart(piece, &trials));
    }
    let columns = ["", "R preloaded, ohm", "its change, ohm", "change, %", "range, kPa", "hysteresis, %"];
    report.table("As in table 3.2 and section 3.2.2", &columns, rows);
    report.plots(&charts)?;
    report.figures = Value::Object(figures);
    Ok(report)
}

fn trials(piece: &Piece) -> Result<Vec<Trial>, ExperimentError> {
    let skin = Skin::parse(Path::new("divider"), piece.skin)?.made()?;
    let truth = TrueSkin::new(&skin)?;
    let material = Material::named(piece.material)?;
    Ok((1..=TRIALS).map(|seed| trial(&truth, &material, skin.material.sheet_conductivity, seed)).collect())
}

fn trial(truth: &TrueSkin, material: &Material, sheet_conductivity: f64, seed: u64) -> Trial {
    let mut sheet = Sheet::new(material, seed);
    let mut random = Pcg64Mcg::seed_from_u64(seed);
    let mut held = |force: f64, seconds: f64| {
        let press = Press::new(Footprint::Square { side: SIDE }, [0.0; 2], Load::Force(force));
        let conductivity = sheet.respond(&truth.pressure(&[press]), seconds);
        resistance(&truth.transfer(&conductivity), sheet_conductivity)
    };
    let resistor = held(PRELOAD, HOLD);
    let machine = LoadingMachine { steps: STEPS, hold: HOLD };
    machine
        .shares()
        .map(|share| {
            let force = PRELOAD + share * (FORCE - PRELOAD);
            let resistance = held(force, HOLD);
            let noise: f64 = StandardNormal.sample(&mut random);
            [force, measured(resistance, resistor, NOISE * noise)]
        })
        .collect()
}

/// Between the first and the third electrode, ohm.
fn resistance(transfer: &[Vec<Complex64>], sheet_conductivity: f64) -> f64 {
    let [a, b] = [0, 2];
    (transfer[a][a] - transfer[a][b] - transfer[b][a] + transfer[b][b]).re / sheet_conductivity
}

/// What the divider makes of a resistance, ohm.
fn measured(resistance: f64, resistor: f64, noise: f64) -> f64 {
    let share = resistance / (resistance + resistor);
    let code = (share * CONVERTER + noise).round().clamp(1.0, CONVERTER - 1.0);
    resistor * code / (CONVERTER - code)
}

impl Piece {
    fn show(&self, trials: &[Trial], report: &mut Report, rows: &mut Vec<Vec<String>>) -> Value {
        let of = |trial: &Trial| trial.iter().map(|[_, resistance]| *resistance).collect::<Vec<_>>();
        let mean =
            |value: &dyn Fn(&Trial) -> f64| trials.iter().map(value).sum::<f64>() / trials.len() as f64;
        let start = mean(&|trial| trial[0][1]);
        let change = mean(&|trial| trial[0][1] - of(trial).into_iter().fold(f64::INFINITY, f64::min));
        let range = mean(&range);
        let hysteresis = mean(&|trial| hysteresis(&of(trial)));
        let found = [start, change, range, hysteresis];
        for (who, [start, change, range, hysteresis]) in [("thesis", self.found), ("here, simulated", found)]
        {
            let share = 100.0 * change / start;
            let cells = [start, change, share, range, hysteresis].map(number);
            rows.push(std::iter::once(format!("{}, {who}", self.name)).chain(cells).collect());
        }
        let what = [("hysteresis", "%", 3), ("range", "kPa", 2)];
        for (what, unit, index) in what {
            report.compare(
                format!("{}: {what}", self.name),
                unit,
                Some(self.found[index]),
                found[index],
                None,
            );
        }
        json!({
            "resistance_ohm": start, "change_ohm": change, "range_kpa": range, "hysteresis_percent": hysteresis,
            "trials": trials,
        })
    }
}

/// Pressure at which nine tenths of the change are reached, kPa.
fn range(trial: &Trial) -> f64 {
    let start = trial[0][1];
    let least = trial.iter().map(|[_, resistance]| *resistance).fold(f64::INFINITY, f64::min);
    let reached = trial.iter().find(|[_, resistance]| start - resistance >= 0.9 * (start - least));
    reached.map_or(0.0, |[force, _]| force / (SIDE * SIDE) / 1e3)
}

fn chart(piece: &Piece, trials: &[Trial]) -> Chart<'static> {
    let series = (1..).zip(trials).map(|(number, trial)| {
        let points = trial.iter().map(|[force, resistance]| [force / (SIDE * SIDE) / 1e3, resistance / 1e3]);
        Series::new(format!("trial {number}"), points.collect(), Style::Line)
    });
    let title = if piece.name == "Sample 1" { "Sample 1 (Fig. 3.5)" } else { "Sample 2 (Fig. 3.6)" };
    Chart { title, x: "pressure, kPa", y: "resistance, kohm", series: series.collect(), square: None }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_strip_has_the_resistance_of_its_squares_and_contacts() {
        let skin = Skin::parse(Path::new("divider"), STRIPS).unwrap().made().unwrap();
        let truth = TrueSkin::new(&skin).unwrap();
        let untouched = truth.transfer(&vec![1.0; truth.mesh().elements.len()]);
        // 30 by 50 mm of 100 kohm per square, and two contacts of 25 ohm m over 49 mm.
        let expected = 100e3 * 30.0 / 50.0 + 2.0 * 25.0 / 0.049;
        let found = resistance(&untouched, skin.material.sheet_conductivity);
        assert!((found / expected - 1.0).abs() < 0.01, "{found} {expected}");
    }

    #[test]
    fn the_divider_reads_a_resistance_to_its_steps() {
        for resistance in [500.0, 1000.0, 3000.0] {
            assert!((measured(resistance, 1000.0, 0.0) / resistance - 1.0).abs() < 2e-3);
        }
    }
}
