//! `dermatome experiment trust`: what a board says, row by row beside what is asked of it.

use super::{
    JsonReport,
    finding::Finding,
    noise::{seed, snr},
    progress,
};
use anyhow::Context;
use dermatome_experiments::{
    experiment::{Wanted, shipped_skins},
    trust::{Bench, Figure, Options, ROWS, Row, RowFigures, Verdict, json, run as run_rows},
};
use dermatome_model::skin::{FoundIn, Skin};
use serde_json::{Value, json as value};
use std::{num::NonZeroUsize, path::PathBuf, time::Instant};

/// Try what a board says on simulated skins: false contacts, detection, places, several fingers, drift, identities.
///
/// The board's own code sees frames of a true skin on a mesh of its own. Each row stands beside what is asked of it: met,
/// not met, or open where too little was tried.
#[derive(clap::Args)]
#[command(after_help = help())]
pub(super) struct Args {
    /// Skin files [default: the shipped disc-210mm, square-210mm, hemisphere-210mm].
    #[arg(value_name = "SKIN")]
    skins: Vec<PathBuf>,
    /// Seed of places and noise.
    #[arg(long, default_value_t = 1, value_parser = seed, allow_negative_numbers = true)]
    seed: u64,
    /// Signal-to-noise ratios, dB: 0 to 200; rows in time take the first.
    #[arg(long, value_name = "DB", value_delimiter = ',', default_value = "60,50,40", value_parser = snr)]
    snr: Vec<f64>,
    /// Presses of a row at one noise; rows in which each takes long try a part of them.
    #[arg(long, value_name = "N", default_value = "100")]
    presses: NonZeroUsize,
    /// Frames of the untouched skin at one noise.
    #[arg(long, value_name = "N", default_value = "5000")]
    frames: NonZeroUsize,
    /// Rows to try [default: all].
    #[arg(long, value_name = "ROW", value_delimiter = ',', value_parser = row)]
    rows: Vec<Row>,
    /// What contacts are found in; both may be compared [default: as each skin file says].
    #[arg(long, value_name = "WHAT", value_delimiter = ',')]
    found_in: Vec<Finding>,
    #[command(flatten)]
    json: JsonReport,
}

fn row(name: &str) -> Result<Row, String> {
    let names = || ROWS.map(|row| row.name).join(", ");
    let found = ROWS.into_iter().find(|row| row.name == name);
    found.ok_or_else(|| format!("there is no such row; allowed: {}", names()))
}

/// Rows with what they try.
fn help() -> String {
    let lines = ROWS.iter().map(|row| format!("  {:10} {}\n", row.name, row.about));
    format!(
        "Rows:\n{}\nExamples:\n  dermatome experiment trust --presses 10\n  dermatome experiment trust skin.toml --seed 7 \
         --snr 60,55 --rows one,pairs\n  dermatome experiment trust models/disc-210mm/skin.toml --found-in \
         image,voltages --json trust.json",
        lines.collect::<String>()
    )
}

pub(super) fn run(args: &Args) -> anyhow::Result<()> {
    let start = Instant::now();
    let rows = if args.rows.is_empty() { ROWS.to_vec() } else { args.rows.clone() };
    let options = Options {
        seed: args.seed,
        snr_db: args.snr.clone(),
        presses: args.presses.get(),
        frames: args.frames.get(),
    };
    let benches = benches(args)?;
    let bar = progress::counting();
    bar.set_message("rows");
    bar.set_length((rows.len() * benches.len()) as u64);
    let found = run_rows(&benches, &rows, &options, || bar.inc(1));
    bar.finish_and_clear();
    benches.iter().zip(&found).for_each(|(bench, rows)| print(bench, rows));
    let seconds = start.elapsed().as_secs_f64();
    say!("{} ({seconds:.0} s)", summary(&found));
    args.json.write(&report(args, &benches, &found, seconds))
}

/// Each skin with each of what its contacts are found in.
fn benches(args: &Args) -> anyhow::Result<Vec<Bench>> {
    let mut benches = Vec::new();
    for (words, skin) in skins(&args.skins)? {
        let in_file = || words.clone();
        let bench = Bench::new(&skin).with_context(in_file)?;
        if args.found_in.is_empty() {
            benches.push(bench);
            continue;
        }
        for &finding in &args.found_in {
            benches.push(bench.found_in(finding.into()).with_context(in_file)?);
        }
    }
    Ok(benches)
}

/// The skins of these files, or the shipped ones, each with which it is.
pub(super) fn skins(files: &[PathBuf]) -> anyhow::Result<Vec<(String, Skin)>> {
    if files.is_empty() {
        return Ok(shipped_skins()?.map(|skin| (format!("the shipped {}", skin.name), skin)).into());
    }
    let load = |file: &PathBuf| Ok((format!("skin file `{}`", file.display()), Skin::load(file)?.made()?));
    files.iter().map(load).collect()
}

fn words(found_in: FoundIn) -> &'static str {
    match found_in {
        FoundIn::Image => "image",
        FoundIn::Voltages => "voltages",
    }
}

fn print(bench: &Bench, rows: &[RowFigures]) {
    let skin = bench.skin();
    let found_in = words(skin.contacts_found_in);
    say!("{}, {:.0} mm, contacts found in the {found_in}", skin.name, 1e3 * bench.size());
    say!("    {:WHAT$} {:>5} {:>8} {:>9}", "", "dB", "asked", "measured");
    for row in rows {
        say!("  {}: {}", row.name, row.about);
        match &row.figures {
            Ok(figures) => figures.iter().for_each(|figure| say!("{}", line(figure))),
            Err(why) => say!("    not run: {why}"),
        }
    }
    say!("");
}

/// Width of what a figure is.
const WHAT: usize = 76;

fn line(figure: &Figure) -> String {
    let asked = match figure.wanted {
        Some(Wanted::AtMost(most)) => format!("<= {most}"),
        Some(Wanted::AtLeast(least)) => format!(">= {least}"),
        None => String::new(),
    };
    let found = figure.found.map_or("-".to_owned(), number);
    let verdict = figure.verdict().map_or("", Verdict::words);
    let of = figure.of.map_or(String::new(), |of| format!("of {of}"));
    let note = figure.note.as_ref().map_or(String::new(), |note| format!(" ({note})"));
    let Figure { what, unit, snr_db, .. } = figure;
    let words = format!("    {what:WHAT$} {snr_db:5} {asked:>8} {found:>9} {unit:9} {of:8} {verdict}{note}");
    words.trim_end().to_owned()
}

fn number(value: f64) -> String {
    match value.abs() {
        size if size >= 100.0 => format!("{value:.0}"),
        size if size >= 10.0 => format!("{value:.1}"),
        _ => format!("{value:.2}"),
    }
}

/// How many figures are met, not met, and open.
fn count(rows: &[Vec<RowFigures>]) -> [usize; 3] {
    let figures = || rows.iter().flatten().flat_map(|row| row.figures.iter().flatten());
    [Verdict::Met, Verdict::NotMet, Verdict::Open]
        .map(|verdict| figures().filter(|figure| figure.verdict() == Some(verdict)).count())
}

fn summary(rows: &[Vec<RowFigures>]) -> String {
    let [met, not_met, open] = count(rows);
    format!("{met} figures met, {not_met} not met, {open} open")
}

/// What it tells; keys are documented in docs/cli.md.
fn report(args: &Args, benches: &[Bench], found: &[Vec<RowFigures>], seconds: f64) -> Value {
    let [met, not_met, open] = count(found);
    let skin = |(bench, rows): (&Bench, &Vec<RowFigures>)| {
        value!({
            "skin": bench.skin().name,
            "found_in": words(bench.skin().contacts_found_in),
            "size_mm": 1e3 * bench.size(),
            "frame_rate": bench.frame_rate(),
            "rows": json(rows),
        })
    };
    value!({
        "seed": args.seed,
        "noise_db": args.snr,
        "presses": args.presses,
        "frames": args.frames,
        "seconds": seconds,
        "met": met,
        "not_met": not_met,
        "open": open,
        "skins": benches.iter().zip(found).map(skin).collect::<Vec<_>>(),
    })
}
