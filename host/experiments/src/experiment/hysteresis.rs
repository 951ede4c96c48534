//! Hysteresis taken out of what the board reports: the play operators that boards run beside the Preisach network that
//! the thesis suggests (section 6.2), on loops that neither saw.
//!
//! The true sheet is a Preisach operator of pressure with a continuous density, at each element; plays and network work
//! on the strength of contacts with thresholds of their own, so neither shares a grid with it.

use super::{
    ExperimentError,
    plot::{Chart, Series, Style},
    report::{Report, Wanted, largest, mean_and_deviation, number},
    sample::{FRAME_RATE, ONE, Sample, Specimen, THREE_DUAL, THREE_SINGLE, TWO, cube},
    sample_rig::{Artefacts, FRAMES},
};
use dermatome_frames::calibrate::{
    Curve, Network, Reading, Trial, compensated, hysteresis, identify, trials,
};
use dermatome_shared::{calibration::Calibration, contact::Contact, hysteresis::PlayOperator};
use dermatome_simulate::{Press, rig::SETTLED};
use rayon::prelude::*;
use serde_json::{Value, json};

/// Steps of the cycle that all learn from, and of a loop; shares of the range.
const STEPS: u32 = 8;
const LOOP_STEPS: u32 = 6;
/// Time of a step, s.
const HOLD: f64 = 10.0;
/// Other cycles that the second network learns from: shares of the range.
const SMALLER: [f64; 2] = [0.75, 0.5];
/// Time for which a specimen rests before each loop, s; then it is tared anew.
const REST: f64 = 3600.0;
/// Specimen that is learnt from, and those that judge.
const LEARNT: u64 = 50;
const JUDGES: [u64; 4] = [1, 2, 3, 4];
/// Seed of the networks' first weights.
const NETWORK: u64 = 1;
/// What spoils the measurements, and where contacts are found then: where electrodes slip with each load, what is found in the
/// voltages does not rise with it.
const SPOILT: [Spoilt; 2] = [
    Spoilt { name: "noise", artefacts: Artefacts::MOVING, read: strength_in_voltages },
    Spoilt { name: "slips", artefacts: Artefacts::SHEET, read: strength_in_image },
];
/// Hysteresis that is wanted, % of the loop's span.
const MOST: f64 = 8.0;

/// One kind of measurements.
struct Spoilt {
    name: &'static str,
    artefacts: Artefacts,
    /// What the board reads of a press that is held for some seconds.
    read: fn(&mut Specimen, Press, f64) -> Result<f64, ExperimentError>,
}

/// A loop that nothing learnt from.
struct Loop {
    name: &'static str,
    /// s a load.
    hold: f64,
    shares: fn() -> Vec<f64>,
}

/// Times of a load of all loops, s.
const PACES: [f64; 2] = [HOLD, 30.0];
const LOOPS: [Loop; 4] = [
    Loop { name: "up to 85 %, 10 s a load", hold: HOLD, shares: || up_and_down(0.85, LOOP_STEPS) },
    Loop { name: "up to 60 %, 10 s a load", hold: HOLD, shares: || up_and_down(0.6, LOOP_STEPS) },
    Loop { name: "full, 30 s a load", hold: PACES[1], shares: || up_and_down(1.0, LOOP_STEPS) },
    Loop { name: "up to 90 % with a loop within, 10 s a load", hold: HOLD, shares: with_a_loop_within },
];

/// Ways to pressures.
const WAYS: [&str; 4] = ["curve alone", "play operators", "network, one cycle", "network, three cycles"];

/// All that was learnt of one specimen.
struct Learnt {
    calibration: Calibration,
    plays: Vec<PlayOperator>,
    networks: [Network; 2],
}

/// One loop of one specimen.
struct Judged {
    trial: Trial,
    /// kPa: `[way][reading]`.
    pressures: [Vec<f64>; 4],
    /// Of the readings, %.
    raw: f64,
}

/// What a loop comes to over all specimens: hysteresis, mean and worst, and rms error of pressure, % of the range.
struct Figures {
    raw: f64,
    /// `[way]`.
    hysteresis: [[f64; 2]; 4],
    error: [f64; 4],
}

pub(super) fn run() -> Result<Report, ExperimentError> {
    let mut report =
        Report::new("hysteresis", "Hysteresis taken out: play operators and a Preisach network (thesis 6.2)");
    words().into_iter().for_each(|words| report.words(words));
    let mut figures = Vec::new();
    for sample in [ONE, TWO, THREE_SINGLE, THREE_DUAL] {
        let judged = SPOILT.par_iter().map(|spoilt| judge(&sample, spoilt));
        let judged = judged.collect::<Result<Vec<_>, _>>()?;
        let of_spoilt: Vec<Vec<Figures>> = judged
            .iter()
            .map(|of_loops| of_loops.iter().map(|of_loop| Figures::new(of_loop, &sample)).collect())
            .collect();
        compare(&mut report, &sample, &of_spoilt);
        tabulate(&mut report, &sample, &of_spoilt);
        report.plots(&[
            chart("Noise, a loop within", &judged[0][3][0]),
            chart("Slips, a loop within", &judged[1][3][0]),
        ])?;
        figures.push(json!({
            "sample": sample.name, "noise": loops_json(&of_spoilt[0]), "slips": loops_json(&of_spoilt[1]),
        }));
    }
    report.figures = json!(figures);
    Ok(report)
}

fn words() -> [String; 2] {
    [
        format!(
            "A square of 4 cm² in the middle of each sample, under a machine. Curve, play operators and network learn from one \
             cycle of one specimen ({STEPS} steps up and down, {HOLD} s each); a second network also from cycles up to three quarters \
             and half. All are judged on {} other specimens, on loops that none of them saw, after an hour's rest and a \
             new tare each. Noise: {}; a reading is the strength of all contacts that the board finds in the voltages, together, \
             mean of the frames of a load behind the first {SETTLED}. Slips: {}; what is found in the voltages \
             does not rise with the load there, so a reading is the strength of the strongest contact in the mean image of \
             {FRAMES} frames.",
            JUDGES.len(),
            Artefacts::MOVING.words(),
            Artefacts::SHEET.words()
        ),
        "Both work on readings, in shares of the largest: six plays whose weights follow from the cycle, as the board runs them in \
         fixed point; ten tanh units on seven play operators of other thresholds, trained on the host. The true sheet is a \
         Preisach operator of pressure at each element, which neither shares a threshold with. What no compensation can \
         know is the gain of a press, which differs each time; it is in the error of pressure, not in the hysteresis."
            .to_owned(),
    ]
}

/// Shares of the range.
fn up_and_down(top: f64, steps: u32) -> Vec<f64> {
    let up = (0..=steps).map(|step| top * f64::from(step) / f64::from(steps));
    up.clone().chain(up.rev().skip(1)).collect()
}

fn with_a_loop_within() -> Vec<f64> {
    let sixth = |n: i32| 0.9 * f64::from(n) / 6.0;
    let there = (0..=6).chain([5, 4, 3, 2]);
    there.chain([3, 4, 5, 4, 3, 2, 1, 0]).map(sixth).collect()
}

/// All loops, by specimen: `[loop][specimen]`.
fn judge(sample: &Sample, spoilt: &Spoilt) -> Result<Vec<Vec<Judged>>, ExperimentError> {
    let learnt = Learnt::of(sample, spoilt)?;
    let of_specimen = |seed: &u64| {
        let mut specimen = sample.specimen(spoilt.artefacts, *seed)?;
        let mut load = |one: &Loop| spoilt.load(&mut specimen, sample, &(one.shares)(), one.hold);
        LOOPS.iter().map(|one| learnt.judge(load(one)?)).collect()
    };
    let by_specimen: Vec<_> = JUDGES.par_iter().map(of_specimen).collect();
    let by_specimen: Vec<Vec<Judged>> = by_specimen.into_iter().collect::<Result<_, ExperimentError>>()?;
    let mut by_loop: Vec<Vec<Judged>> = LOOPS.iter().map(|_| Vec::new()).collect();
    for of_loops in by_specimen {
        by_loop.iter_mut().zip(of_loops).for_each(|(all, one)| all.push(one));
    }
    Ok(by_loop)
}

impl Spoilt {
    /// Loads a rested specimen, and reads it.
    fn load(
        &self,
        specimen: &mut Specimen,
        sample: &Sample,
        shares: &[f64],
        hold: f64,
    ) -> Result<Trial, ExperimentError> {
        specimen.at_rest(REST);
        specimen.tare();
        let read = |share: &f64| {
            let pressure_kpa = share * sample.found.range;
            let strength = (self.read)(specimen, cube([0.0; 2], pressure_kpa), hold)?;
            Ok(Reading { pressure_kpa, strength, deviation: 0.0, area_mm2: None, place: None })
        };
        let readings: Vec<Reading> = shares.iter().map(read).collect::<Result<_, ExperimentError>>()?;
        trials(&readings).into_iter().next().ok_or(ExperimentError::Readings { sample: sample.name })
    }
}

/// A press may be several contacts, whose strengths together are its load.
fn strength_in_voltages(specimen: &mut Specimen, press: Press, hold: f64) -> Result<f64, ExperimentError> {
    let frames = specimen.watch(&[press], hold, (hold * FRAME_RATE) as u16);
    let strength = |contacts: &Vec<Contact>| contacts.iter().map(|contact| f64::from(contact.strength)).sum();
    let strengths: Vec<f64> = frames.iter().skip(SETTLED.into()).map(strength).collect();
    Ok(mean_and_deviation(&strengths)[0])
}

fn strength_in_image(specimen: &mut Specimen, press: Press, hold: f64) -> Result<f64, ExperimentError> {
    let shown = specimen.hold(&[press], hold)?;
    Ok(shown.contacts.first().map_or(0.0, |contact| f64::from(contact.strength)))
}

impl Learnt {
    fn of(sample: &Sample, spoilt: &Spoilt) -> Result<Self, ExperimentError> {
        let mut specimen = sample.specimen(spoilt.artefacts, LEARNT)?;
        let mut cycle = |top: f64, steps| spoilt.load(&mut specimen, sample, &up_and_down(top, steps), HOLD);
        let full = cycle(1.0, STEPS)?;
        let smaller = SMALLER.iter().map(|&top| cycle(top, LOOP_STEPS)).collect::<Result<Vec<_>, _>>()?;
        let curve = Curve::of_loading(std::slice::from_ref(&full));
        let calibration = curve.calibration().ok_or(ExperimentError::Readings { sample: sample.name })?;
        let all: Vec<&[Reading]> =
            std::iter::once(&full).chain(&smaller).map(|trial| &trial.readings[..]).collect();
        Ok(Self {
            plays: identify(&full, &calibration),
            networks: [Network::train(&all[..1], NETWORK), Network::train(&all, NETWORK)],
            calibration,
        })
    }

    fn judge(&self, trial: Trial) -> Result<Judged, ExperimentError> {
        let strengths: Vec<f64> = trial.readings.iter().map(|reading| reading.strength).collect();
        let [one, three] = &self.networks;
        let pressures = [
            compensated(&strengths, &[], &self.calibration, 0.0),
            compensated(&strengths, &self.plays, &self.calibration, 0.0),
            one.pressures(&strengths),
            three.pressures(&strengths),
        ];
        Ok(Judged { raw: hysteresis(&trial), trial, pressures })
    }
}

impl Judged {
    fn hysteresis(&self, way: usize) -> f64 {
        hysteresis(&self.trial.with_strengths(&self.pressures[way]))
    }

    /// Squares of the errors of pressure, kPa^2.
    fn squares(&self, way: usize) -> impl Iterator<Item = f64> + '_ {
        let pairs = self.trial.readings.iter().zip(&self.pressures[way]);
        pairs.map(|(reading, found)| (found - reading.pressure_kpa).powi(2))
    }
}

impl Figures {
    fn new(judged: &[Judged], sample: &Sample) -> Self {
        let mean = |values: Vec<f64>| mean_and_deviation(&values)[0];
        let of_way = |way: usize| {
            let all: Vec<f64> = judged.iter().map(|one| one.hysteresis(way)).collect();
            [mean(all.clone()), largest(all)]
        };
        let error = |way: usize| {
            let squares = judged.iter().flat_map(|one| one.squares(way)).collect();
            100.0 * mean(squares).sqrt() / sample.found.range
        };
        let ways = [0, 1, 2, 3];
        Self {
            raw: mean(judged.iter().map(|one| one.raw).collect()),
            hysteresis: ways.map(of_way),
            error: ways.map(error),
        }
    }

    fn row(&self, name: String) -> Vec<String> {
        let pair = |way: usize| {
            let [mean, worst] = self.hysteresis[way];
            format!("{} ({})", number(mean), number(worst))
        };
        let hysteresis = std::iter::once(number(self.raw)).chain((1..WAYS.len()).map(pair));
        std::iter::once(name).chain(hysteresis).chain(self.error.map(number)).collect()
    }

    fn json(&self) -> Value {
        let way = |(way, name): (usize, &str)| {
            let [mean, worst] = self.hysteresis[way];
            json!({
                "way": name, "hysteresis_percent": { "mean": mean, "worst": worst },
                "rms_error_percent_of_range": self.error[way],
            })
        };
        let ways: Vec<_> = WAYS.into_iter().enumerate().map(way).collect();
        json!({ "hysteresis_of_readings_percent": self.raw, "ways": ways })
    }
}

fn loops_json(of_loops: &[Figures]) -> Vec<Value> {
    let pairs = LOOPS.iter().zip(of_loops);
    pairs.map(|(one, figures)| json!({ "loop": one.name, "figures": figures.json() })).collect()
}

/// Hysteresis of loops at one pace, mean, beside what is wanted.
fn compare(report: &mut Report, sample: &Sample, of_spoilt: &[Vec<Figures>]) {
    for (spoilt, of_loops) in SPOILT.iter().zip(of_spoilt) {
        for hold in PACES {
            for (way, name) in WAYS.iter().enumerate().skip(1) {
                let at_this_pace = LOOPS.iter().zip(of_loops).filter(|(one, _)| one.hold == hold);
                let all: Vec<f64> = at_this_pace.map(|(_, figures)| figures.hysteresis[way][0]).collect();
                report.compare(
                    format!("{}, {}, {hold} s a load: hysteresis after {name}", sample.name, spoilt.name),
                    "%",
                    None,
                    mean_and_deviation(&all)[0],
                    Some(Wanted::AtMost(MOST)),
                );
            }
        }
    }
}

fn tabulate(report: &mut Report, sample: &Sample, of_spoilt: &[Vec<Figures>]) {
    let mut rows = Vec::new();
    for (spoilt, of_loops) in SPOILT.iter().zip(of_spoilt) {
        let named = LOOPS.iter().zip(of_loops);
        rows.extend(named.map(|(one, figures)| figures.row(format!("{}: {}", spoilt.name, one.name))));
    }
    let columns = [
        "",
        "readings",
        "plays",
        "network, 1",
        "network, 3",
        "error: curve",
        "plays",
        "network, 1",
        "network, 3",
    ];
    let caption = format!(
        "{}: hysteresis, mean (worst) of the specimens, % of the loop's span; rms error of pressure, % of {} kPa",
        sample.name, sample.found.range
    );
    report.table(&caption, &columns, rows);
}

/// One loop of one specimen, as the curve alone and as each compensation has it.
fn chart(title: &'static str, judged: &Judged) -> Chart<'static> {
    let series = [0, 1, 3].map(|way| {
        let readings = judged.trial.readings.iter().zip(&judged.pressures[way]);
        let points = readings.map(|(reading, &found)| [reading.pressure_kpa, found]).collect();
        Series::new(WAYS[way], points, Style::MarkedLine)
    });
    Chart { title, x: "pressure, kPa", y: "found, kPa", series: series.into(), square: None }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn loops_are_none_that_anything_learnt_from() {
        let learnt: Vec<Vec<f64>> = [1.0, SMALLER[0], SMALLER[1]].map(|top| up_and_down(top, STEPS)).into();
        for one in &LOOPS {
            let shares = (one.shares)();
            let top = largest(shares.iter().copied());
            let saw = |cycle: &Vec<f64>| largest(cycle.iter().copied()) == top && one.hold == HOLD;
            assert!(!learnt.iter().any(saw), "{}", one.name);
            assert!(shares[0] == 0.0 && shares[shares.len() - 1] == 0.0 && top <= 1.0);
        }
        let turns = with_a_loop_within().windows(3).filter(|w| (w[1] - w[0]) * (w[2] - w[1]) < 0.0).count();
        assert_eq!(turns, 3, "up, down, up again, down");
    }

    #[test]
    fn each_way_is_judged_by_one_limit_on_the_mean_of_its_loops_at_each_pace() {
        let figures = |plays: f64| Figures {
            raw: 30.0,
            hysteresis: [[25.0, 26.0], [plays, 20.0], [9.0, 9.5], [7.5, 12.0]],
            error: [20.0, 8.0, 6.0, 5.0],
        };
        let mut report = Report::new("x", "x");
        let slow = |one: &Loop| one.hold == PACES[1];
        let noise = LOOPS.iter().map(|one| figures(if slow(one) { 10.0 } else { 6.0 })).collect();
        let mut slips: Vec<Figures> = LOOPS.iter().map(|_| figures(9.0)).collect();
        slips[0] = figures(3.0);
        let of_spoilt = [noise, slips];
        compare(&mut report, &TWO, &of_spoilt);
        let plays = report.comparisons.iter().step_by(WAYS.len() - 1);
        let found: Vec<_> = plays.map(|one| (one.found, one.met().unwrap())).collect();
        assert_eq!(found, [(6.0, true), (10.0, false), (7.0, true), (9.0, false)]);
        let of_networks = report.comparisons.iter().filter(|one| one.what.contains("network"));
        assert!(of_networks.clone().all(|one| [9.0, 7.5].contains(&one.found)));
        assert_eq!(of_networks.count(), SPOILT.len() * PACES.len() * 2);
        assert!(
            report.comparisons[6].what.starts_with("Sample 2, slips, 10 s a load: hysteresis after play")
        );
        assert_eq!(
            of_spoilt[0][0].row("a loop".into()).len(),
            9,
            "a name, readings, three ways, four errors"
        );
    }

    #[test]
    fn plays_and_network_close_a_loop_of_sample_2_that_neither_saw() {
        let [noise, _] = &SPOILT;
        let learnt = Learnt::of(&TWO, noise).unwrap();
        let mut specimen = TWO.specimen(noise.artefacts, 7).unwrap();
        let trial = noise.load(&mut specimen, &TWO, &up_and_down(0.85, LOOP_STEPS), HOLD).unwrap();
        assert_eq!(trial.readings.len(), 13);
        let judged = learnt.judge(trial).unwrap();
        let figures = Figures::new(&[judged], &TWO);
        assert!(figures.raw > 10.0, "{}", figures.raw);
        for (way, name) in WAYS.iter().enumerate().skip(1) {
            assert!(figures.hysteresis[way][0] < figures.hysteresis[0][0], "{name}");
            assert!(figures.error[way] < figures.error[0], "{name}");
        }
    }
}
