//! `dermatome experiment check-data`: whether `check-data` names what is wrong with frames, cause by cause.

mod bodies;
mod corrupt;
mod judge;

use super::{JsonReport, frame_options::FrameOptions, noise::seed, progress};
use anyhow::{Context, ensure};
use bodies::bodies;
use corrupt::corruptions;
use dermatome_frames::recorded::{
    check::{
        Check, Expected, check,
        findings::{About, Level},
    },
    order::Arrangement,
    read::{Frames, Source},
};
use dermatome_model::skin::Skin;
use judge::Wrong;
use rand::SeedableRng;
use rand_pcg::Pcg64Mcg;
use rayon::prelude::*;
use serde::Serialize;
use std::{
    ffi::OsString,
    path::{Path, PathBuf},
};

/// Try `check-data` on frames that are spoilt on purpose, each in one way.
///
/// Values begin late, rows, wires or columns are exchanged, squares are transposed or count their pairs from the
/// driven one, an offset is added, potentials are recorded, pairs have another gain or direction, electrodes are open,
/// values are clipped. Without files, frames of simulated bodies are spoilt: each of another size, shape and contacts
/// than its skin file says, at 30 to 60 dB.
///
/// Prints how often the cause is named and nothing else is called a fault, and how often a fault is found in the
/// frames as they are.
#[derive(clap::Args)]
#[command(after_help = "Examples:
  dermatome experiment check-data --seed 7
  dermatome experiment check-data tank.toml run.npz:empty other.csv --json check.json")]
pub(super) struct Args {
    /// Skin file of the files.
    #[arg(value_name = "SKIN", requires = "files")]
    skin: Option<PathBuf>,
    /// Good frames, as `check-data` reads them.
    #[arg(value_name = "FILE")]
    files: Vec<OsString>,
    /// Seed of what is spoilt, and of simulated bodies.
    #[arg(long, default_value_t = 1, value_parser = seed, allow_negative_numbers = true)]
    seed: u64,
    /// Check against these frames, of the same skin and instrument, instead of the model, as `check-data --good` does.
    #[arg(long, value_name = "FILE", requires = "skin")]
    good: Option<OsString>,
    #[command(flatten)]
    options: FrameOptions,
    #[command(flatten)]
    json: JsonReport,
}

/// Good frames of a skin.
struct Set {
    name: String,
    /// What spoils them where they say nothing.
    model: Expected,
    /// What they are checked against.
    expected: Expected,
    frames: Frames,
    arrangement: Arrangement,
}

/// One trial.
#[derive(Serialize)]
struct Trial {
    set: String,
    kind: &'static str,
    wrong: String,
    named: bool,
    /// What else, or instead, was called a fault.
    findings: Vec<String>,
}

/// Trials of one kind.
#[derive(Serialize)]
struct Row {
    kind: &'static str,
    tried: usize,
    named: usize,
}

/// What the experiment tells; keys are documented in docs/cli.md.
#[derive(Serialize)]
struct Report {
    seed: u64,
    tried: usize,
    named: usize,
    good_frames: usize,
    false_alarms: usize,
    rows: Vec<Row>,
    missed: Vec<Trial>,
}

/// Kind of frames as they are.
const GOOD: &str = "nothing";

pub(super) fn run(args: &Args) -> anyhow::Result<()> {
    let sets = match &args.skin {
        Some(skin) => recorded(args, skin)?,
        None => bodies(args.seed)?,
    };
    let bar = progress::counting();
    bar.set_message("checks");
    let trials: Vec<Trial> = sets
        .iter()
        .map(|set| tried(set, args.seed, &bar))
        .collect::<anyhow::Result<Vec<_>>>()?
        .into_iter()
        .flatten()
        .collect();
    bar.finish_and_clear();
    let report = Report::new(args.seed, trials);
    print(&report);
    args.json.write(&report)
}

fn recorded(args: &Args, path: &Path) -> anyhow::Result<Vec<Set>> {
    ensure!(!args.files.is_empty(), "a skin file is given and no FILE; allowed: at least one");
    let skin = Skin::load(path)?.made()?;
    let model = Expected::of(&skin).with_context(|| format!("skin file `{}`", path.display()))?;
    let expected = args.options.expected(model.clone(), args.good.as_ref())?;
    let set = |file: &OsString| {
        let source = Source::new(file);
        let frames = args.options.read(&source, &skin.steps(), skin.electrodes.count)?;
        let arrangement = args.options.arrangement();
        arrangement
            .index_map(&expected.steps, expected.electrodes(), frames.measurements)
            .with_context(|| format!("`{source}`"))?;
        Ok(Set {
            name: source.to_string(),
            model: model.clone(),
            expected: expected.clone(),
            frames,
            arrangement,
        })
    };
    args.files.iter().map(set).collect()
}

fn tried(set: &Set, seed: u64, bar: &indicatif::ProgressBar) -> anyhow::Result<Vec<Trial>> {
    let mut random = Pcg64Mcg::seed_from_u64(seed);
    let good = check(&set.expected, &set.frames, set.arrangement)?;
    let mut trials = vec![trial(set, GOOD, &Wrong::Nothing, &good, &[])];
    // Faults of the frames as they are stay when more is wrong with them.
    let known: Vec<_> =
        good.findings.iter().filter(|it| it.level == Level::Fault).map(|it| it.about).collect();
    let spoilt = corruptions(&set.model, &set.frames, set.arrangement, &mut random);
    bar.inc_length(spoilt.len() as u64);
    let try_one = |(kind, wrong, frames): &(&'static str, Wrong, Frames)| {
        let check = check(&set.expected, frames, set.arrangement)?;
        bar.inc(1);
        Ok(trial(set, kind, wrong, &check, &known))
    };
    trials.extend(spoilt.par_iter().map(try_one).collect::<anyhow::Result<Vec<_>>>()?);
    Ok(trials)
}

fn trial(set: &Set, kind: &'static str, wrong: &Wrong, check: &Check, known: &[About]) -> Trial {
    let others = judge::others(wrong, check, known);
    Trial {
        set: set.name.clone(),
        kind,
        wrong: wrong.to_string(),
        named: judge::is_named(wrong, check, &set.expected) && others.is_empty(),
        findings: check.findings.iter().map(|finding| finding.found.clone()).collect(),
    }
}

impl Report {
    fn new(seed: u64, trials: Vec<Trial>) -> Self {
        let (good, spoilt): (Vec<_>, Vec<_>) = trials.into_iter().partition(|trial| trial.kind == GOOD);
        let mut rows: Vec<Row> = Vec::new();
        for trial in &spoilt {
            let at = rows.iter().position(|row| row.kind == trial.kind).unwrap_or_else(|| {
                rows.push(Row { kind: trial.kind, tried: 0, named: 0 });
                rows.len() - 1
            });
            rows[at].tried += 1;
            rows[at].named += usize::from(trial.named);
        }
        Self {
            seed,
            tried: spoilt.len(),
            named: spoilt.iter().filter(|trial| trial.named).count(),
            good_frames: good.len(),
            false_alarms: good.iter().filter(|trial| !trial.named).count(),
            rows,
            missed: good.into_iter().chain(spoilt).filter(|trial| !trial.named).collect(),
        }
    }
}

fn print(report: &Report) {
    say!("{:44} {:>6} {:>9}", "wrong", "tried", "named");
    let percent = |named: usize, tried: usize| format!("{:.1} %", 100.0 * named as f64 / tried.max(1) as f64);
    for Row { kind, tried, named } in &report.rows {
        say!("{kind:44} {tried:>6} {:>9}", percent(*named, *tried));
    }
    say!("{:44} {:>6} {:>9}", "all", report.tried, percent(report.named, report.tried));
    say!("faults found in good frames: {} of {} files", report.false_alarms, report.good_frames);
    for missed in &report.missed {
        say!("{}: {}\n  {}", missed.set, missed.wrong, missed.findings.join("\n  "));
    }
}
