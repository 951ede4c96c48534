//! `dermatome experiment check`: whether `check` names what is wrong with a skin, fault by fault, on simulated boards.

use super::{
    JsonReport,
    check::{Examined, examine},
    check_skin::Model,
    noise::NoiseOptions,
    progress,
    tare::patch_of,
    trust::skins,
};
use anyhow::Context;
use dermatome_link::health::State;
use dermatome_model::{model::Model as SkinModel, quantize, skin::Skin};
use dermatome_shared::protocol::Request;
use dermatome_simulate::{
    Fault, Noise, Script, SimulatedSkin, TimedFault,
    board::{BoardOptions, Pace, SimulatedBoard},
};
use rayon::prelude::*;
use serde::Serialize;
use std::{
    collections::BTreeSet,
    path::{Path, PathBuf},
};

/// Frames that each check looks at.
const FRAMES: usize = 10;
/// A worse contact adds so many times the median contact impedance.
const WORSE: f32 = 5.0;
/// Sheets that conduct so many times as well as the skin file says.
const SHEETS: [f64; 5] = [0.3, 0.5, 0.7, 2.0, 3.0];
/// How exactly that is to be told, share of it.
const SHEET_ERROR: f64 = 0.05;

/// Try `check --skin` on simulated boards: each electrode open, shorted to the next, or touching worse, wires exchanged, turned
/// and mirrored, other sheets, and the other skins.
///
/// Prints how often the cause is named, and how often an electrode is blamed that is sound. A round skin is the same however
/// its wires are turned: there no voltage tells, and `setup` asks for presses.
#[derive(clap::Args)]
#[command(after_help = "Examples:\n  dermatome experiment check\n  \
    dermatome experiment check models/square-50mm/skin.toml --amplitudes 100 --noise-db 50 --json check.json")]
pub(super) struct Args {
    /// Skin files [default: the shipped disc-210mm, square-210mm, hemisphere-210mm].
    #[arg(value_name = "SKIN")]
    skins: Vec<PathBuf>,
    /// Amplitudes, per cent of the skin file's: above 0, at most 100.
    #[arg(long, value_name = "PERCENT", value_delimiter = ',', default_value = "100,50,10", value_parser = amplitude)]
    amplitudes: Vec<f64>,
    #[command(flatten)]
    noise: NoiseOptions,
    #[command(flatten)]
    json: JsonReport,
}

fn amplitude(text: &str) -> Result<f64, String> {
    let percent = text.parse().ok().filter(|percent| *percent > 0.0 && *percent <= 100.0);
    percent.ok_or_else(|| "allowed are numbers above 0 and at most 100".to_owned())
}

/// A skin and its patch.
struct Bench {
    skin: Skin,
    patch: Vec<u8>,
}

/// What is wrong.
enum Wrong {
    Nothing,
    Electrode(Fault),
    /// Touches worse by so many times the median contact.
    Contact(u8),
    Exchanged(u8, u8),
    /// Wires in another order that the skin's shape may tell.
    Order(Vec<Fault>),
    Sheet(f64),
    Skin(usize),
}

/// What `check` said of it.
struct Said {
    is_named: bool,
    blames_sound: bool,
    /// Its findings.
    words: Vec<String>,
}

/// A trial in which something else was named, or nothing.
#[derive(Serialize)]
struct Missed {
    wrong: String,
    amplitude_percent: f64,
    findings: Vec<String>,
}

struct Trial {
    kind: &'static str,
    wrong: String,
    percent: f64,
    said: Said,
}

#[derive(Serialize)]
struct Row {
    skin: String,
    wrong: &'static str,
    tried: usize,
    named: usize,
    blamed_sound: usize,
    missed: Vec<Missed>,
}

pub(super) fn run(args: &Args) -> anyhow::Result<()> {
    let benches = benches(args)?;
    let noise = args.noise.noise();
    // Boards solve on threads of the global pool: those that wait for them are of another.
    let pool = rayon::ThreadPoolBuilder::new().build().context("cannot start threads")?;
    let mut rows = Vec::new();
    let bar = progress::counting();
    bar.set_message("checks");
    for bench in &benches {
        let cases = cases(bench, &benches);
        let trials: Vec<_> = cases
            .iter()
            .flat_map(|case| args.amplitudes.iter().map(move |percent| (case, *percent)))
            .collect();
        bar.inc_length(trials.len() as u64);
        let try_one = |((kind, wrong), percent): &(&(&'static str, Wrong), f64)| {
            let said = check(bench, &benches, wrong, percent / 100.0, noise)?;
            bar.inc(1);
            Ok(Trial { kind, wrong: words(wrong, &benches), percent: *percent, said })
        };
        let trials: anyhow::Result<Vec<_>> = pool.install(|| trials.par_iter().map(try_one).collect());
        rows.extend(counted(&bench.skin.name, trials?));
    }
    bar.finish_and_clear();
    say!("{:24} {:30} {:>6} {:>9} {:>22}", "skin", "wrong", "tried", "named", "sound electrode blamed");
    for row in &rows {
        let percent = |count: usize| format!("{:.1} %", 100.0 * count as f64 / row.tried as f64);
        let (named, blamed) = (percent(row.named), percent(row.blamed_sound));
        say!("{:24} {:30} {:>6} {named:>9} {blamed:>22}", row.skin, row.wrong, row.tried);
    }
    args.json.write(&rows)
}

fn benches(args: &Args) -> anyhow::Result<Vec<Bench>> {
    let bench = |(words, skin): (String, Skin)| {
        let model = SkinModel::build(&skin, |_| ()).with_context(|| words.clone())?;
        let patch = quantize::patch(&skin, &model).context(words)?;
        Ok(Bench { skin, patch })
    };
    skins(&args.skins)?.into_iter().map(bench).collect()
}

/// What is tried on a skin, by kind.
fn cases(bench: &Bench, benches: &[Bench]) -> Vec<(&'static str, Wrong)> {
    let count = bench.skin.electrodes.count;
    let next = |electrode: u8| (electrode + 1) % count;
    let mut cases = vec![("nothing", Wrong::Nothing)];
    for electrode in 0..count {
        cases.push(("an electrode open", Wrong::Electrode(Fault::Open(electrode))));
        cases.push(("neighbours shorted", Wrong::Electrode(Fault::Shorted(electrode, next(electrode)))));
        cases.push(("a contact five times worse", Wrong::Contact(electrode)));
        cases.push(("neighbouring wires exchanged", Wrong::Exchanged(electrode, next(electrode))));
    }
    let turned = (0..count - 1).map(|electrode| Fault::Exchanged(electrode, electrode + 1)).collect();
    let mirrored =
        (0..count / 2).map(|electrode| Fault::Exchanged(electrode, count - 1 - electrode)).collect();
    cases.push(("wires turned by one", Wrong::Order(turned)));
    cases.push(("wires mirrored", Wrong::Order(mirrored)));
    cases.extend(SHEETS.map(|ratio| ("another sheet", Wrong::Sheet(ratio))));
    let others = benches
        .iter()
        .enumerate()
        .filter(|(_, other)| other.skin.name != bench.skin.name && other.skin.steps() == bench.skin.steps());
    cases.extend(others.map(|(other, _)| ("the patch of another skin", Wrong::Skin(other))));
    cases
}

fn counted(skin: &str, trials: Vec<Trial>) -> Vec<Row> {
    let mut rows: Vec<Row> = Vec::new();
    for Trial { kind, wrong, percent, said } in trials {
        let at = rows.iter().position(|row| row.wrong == kind).unwrap_or_else(|| {
            let skin = skin.to_owned();
            rows.push(Row { skin, wrong: kind, tried: 0, named: 0, blamed_sound: 0, missed: Vec::new() });
            rows.len() - 1
        });
        let row = &mut rows[at];
        row.tried += 1;
        row.named += usize::from(said.is_named);
        row.blamed_sound += usize::from(said.blames_sound);
        if !said.is_named || said.blames_sound {
            row.missed.push(Missed { wrong, amplitude_percent: percent, findings: said.words });
        }
    }
    rows
}

fn words(wrong: &Wrong, benches: &[Bench]) -> String {
    match wrong {
        Wrong::Nothing => "nothing".to_owned(),
        Wrong::Electrode(fault) => {
            let electrodes: Vec<String> =
                fault.electrodes().iter().map(|electrode| (electrode + 1).to_string()).collect();
            format!("electrode {}", electrodes.join(" and "))
        }
        Wrong::Contact(electrode) => format!("electrode {}", electrode + 1),
        Wrong::Exchanged(a, b) => format!("wires {} and {}", a + 1, b + 1),
        Wrong::Order(_) => "all wires".to_owned(),
        Wrong::Sheet(ratio) => format!("conducts {ratio} times as well"),
        Wrong::Skin(other) => benches[*other].skin.name.clone(),
    }
}

/// Checks one board with one thing wrong, at this share of the skin's current.
fn check(bench: &Bench, benches: &[Bench], wrong: &Wrong, share: f64, noise: Noise) -> anyhow::Result<Said> {
    let mut skin = match wrong {
        Wrong::Skin(other) => benches[*other].skin.clone(),
        _ => bench.skin.clone(),
    };
    let faults = match wrong {
        Wrong::Electrode(fault) => vec![*fault],
        Wrong::Exchanged(a, b) => vec![Fault::Exchanged(*a, *b)],
        Wrong::Order(faults) => faults.clone(),
        Wrong::Contact(electrode) => {
            let sound = examined(bench, &bench.skin, Vec::new(), share, noise)?;
            let median = sound.diagnosis.median_contact_ohm();
            vec![Fault::Contact(*electrode, f64::from(WORSE * median))]
        }
        Wrong::Nothing | Wrong::Skin(_) => Vec::new(),
        Wrong::Sheet(ratio) => {
            skin.material.sheet_conductivity *= ratio;
            Vec::new()
        }
    };
    Ok(judged(wrong, &faults, &examined(bench, &skin, faults.clone(), share, noise)?))
}

/// What `check --skin` finds on a board with a bench's patch and this skin.
fn examined(
    bench: &Bench,
    skin: &Skin,
    faults: Vec<Fault>,
    share: f64,
    noise: Noise,
) -> anyhow::Result<Examined> {
    let timed = faults.into_iter().map(|fault| TimedFault { fault, from: None }).collect();
    let source = SimulatedSkin::new(skin, Script::nobody(), noise)?.with_faults(timed);
    let options = BoardOptions {
        electrodes: skin.electrodes.count,
        patch: Some(bench.patch.clone()),
        pace: Pace::Unpaced,
        ..BoardOptions::default()
    };
    let mut link = SimulatedBoard::start(options, source)?.connect("simulated")?;
    let patch = patch_of(&mut link)?;
    let mut drive = patch.drive;
    drive.amplitude *= share as f32;
    link.request(&Request::Drive(Some(drive)))?;
    let model = Model::of_skin(Path::new(&bench.skin.name), bench.skin.clone())?;
    examine(&mut link, &patch, Some(&model), FRAMES)?.context("stopped")
}

/// Whether the cause is named, and whether a sound electrode is blamed.
fn judged(wrong: &Wrong, faults: &[Fault], examined: &Examined) -> Said {
    let Examined { diagnosis, model, .. } = examined;
    let in_state = |states: &[State]| -> BTreeSet<u8> {
        let blamed = diagnosis.electrodes.iter().filter(|electrode| states.contains(&electrode.state));
        blamed.map(|electrode| electrode.electrode as u8).collect()
    };
    let blamed = in_state(&[State::Open, State::Shorted, State::High, State::Worse]);
    let bad: BTreeSet<u8> = match wrong {
        Wrong::Electrode(_) | Wrong::Contact(_) => faults.iter().flat_map(Fault::electrodes).collect(),
        _ => BTreeSet::new(),
    };
    let says = |words: &str| diagnosis.findings.iter().any(|finding| finding.what.contains(words));
    let is_named = match wrong {
        // Noise is none of the skin's faults, and may well be worth a word.
        Wrong::Nothing => diagnosis.findings.iter().all(|finding| finding.what.starts_with("noise")),
        Wrong::Electrode(Fault::Open(_)) => in_state(&[State::Open]) == bad,
        Wrong::Electrode(_) => in_state(&[State::Shorted]) == bad,
        Wrong::Contact(_) => in_state(&[State::High, State::Open]) == bad,
        Wrong::Exchanged(a, b) => {
            let [low, high] = [a.min(b) + 1, a.max(b) + 1];
            says(&format!(" {low} and {high} seem exchanged"))
        }
        // Which order it is, a symmetric skin does not tell.
        Wrong::Order(_) => {
            model.as_ref().is_some_and(|compared| compared.wires_are_wrong) && !says("seem exchanged")
        }
        Wrong::Sheet(ratio) => {
            let told = diagnosis.findings.iter().find_map(|finding| {
                finding.what.strip_prefix("the sheet conducts ")?.split(' ').next()?.parse::<f64>().ok()
            });
            told.is_some_and(|told| (told / ratio - 1.0).abs() < SHEET_ERROR)
        }
        Wrong::Skin(_) => model.as_ref().is_some_and(|compared| !compared.findings.is_empty()),
    };
    let words = diagnosis.findings.iter().map(|finding| finding.what.clone()).collect();
    Said { is_named, blames_sound: !blamed.is_subset(&bad), words }
}
