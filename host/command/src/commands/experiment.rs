//! `dermatome experiment`: the thesis' experiments on simulated samples, as a page.

use super::{check_data_trial, check_trial, outputs::Folder, presses, progress, trust};
use anyhow::Context;
use dermatome_experiments::experiment::{EXPERIMENTS, Experiment, Report, json, named, page, run as run_all};
use dermatome_patch::output::{OutputFolder, WriteError};
use std::time::Instant;

/// Do the thesis' experiments on simulated samples, as a page beside its figures.
///
/// The page, report.html, needs no other file; report.json holds the same figures for scripts. Every run gives
/// the same.
#[derive(clap::Args)]
#[command(
    after_help = help(),
    args_conflicts_with_subcommands = true,
    subcommand_negates_reqs = true,
    disable_help_subcommand = true
)]
pub(super) struct Args {
    #[command(subcommand)]
    other: Option<Other>,
    /// Name of an experiment, or all.
    #[arg(value_name = "NAME", value_parser = chosen, required = true)]
    name: Option<Chosen>,
    /// Folder for report.html and report.json; made if it is not there.
    #[arg(
        long,
        default_value = "experiments",
        value_name = "DIR",
        value_parser = Folder::parser(|name| [PAGE, FIGURES].contains(&name), Some(FIGURES))
    )]
    out: Folder,
}

/// What is written: the page, and its figures.
const PAGE: &str = "report.html";
const FIGURES: &str = "report.json";

/// Experiments that are Dermatome's own.
#[derive(clap::Subcommand)]
enum Other {
    Trust(trust::Args),
    Check(check_trial::Args),
    CheckData(check_data_trial::Args),
    Presses(presses::Args),
}

/// The experiments of a name.
#[derive(Clone)]
struct Chosen(Vec<Experiment>);

fn chosen(name: &str) -> Result<Chosen, String> {
    let names = || EXPERIMENTS.map(|experiment| experiment.name).join(", ");
    named(name).map(Chosen).ok_or_else(|| format!("there is no such experiment; allowed: all, {}", names()))
}

/// Names with what they show.
fn help() -> String {
    let width = EXPERIMENTS.iter().map(|experiment| experiment.name.len()).max().unwrap_or(0);
    let lines = EXPERIMENTS.iter().map(|e| format!("  {:width$}  {}\n", e.name, e.about));
    format!(
        "Experiments:\n{}\nExamples:\n  dermatome experiment saline-map\n  dermatome experiment all --out report",
        lines.collect::<String>()
    )
}

pub(super) fn run(args: &Args) -> anyhow::Result<()> {
    match &args.other {
        Some(Other::Trust(args)) => return trust::run(args),
        Some(Other::Check(args)) => return check_trial::run(args),
        Some(Other::CheckData(args)) => return check_data_trial::run(args),
        Some(Other::Presses(args)) => return presses::run(args),
        None => {}
    }
    let start = Instant::now();
    // The name is required without a subcommand.
    let Some(Chosen(experiments)) = &args.name else { return Ok(()) };
    let folder = OutputFolder::prepare(&args.out)?;
    let bar = progress::counting();
    bar.set_message("experiments");
    bar.set_length(experiments.len() as u64);
    let reports = run_all(experiments, |_| bar.inc(1))?;
    bar.finish_and_clear();
    reports.iter().for_each(print);
    write(folder, &reports).with_context(|| format!("cannot write to `{}`", args.out.display()))?;
    say!("page: {}", args.out.join(PAGE).display());
    let plural = if reports.len() == 1 { "" } else { "s" };
    say!("{} experiment{plural} in {:.1} s", reports.len(), start.elapsed().as_secs_f64());
    Ok(())
}

fn write(folder: OutputFolder, reports: &[Report]) -> Result<(), WriteError> {
    let mut figures = format!("{:#}", json(reports));
    figures.push('\n');
    folder.write_all(&[(PAGE, page(reports).as_bytes()), (FIGURES, figures.as_bytes())])
}

fn print(report: &Report) {
    say!("{}", report.title);
    for comparison in &report.comparisons {
        let unit = comparison.unit;
        let thesis = comparison.thesis.map_or(String::new(), |thesis| format!(", thesis {thesis:.4} {unit}"));
        let verdict = match comparison.met() {
            Some(true) => ", met",
            Some(false) => ", NOT MET",
            None => "",
        };
        say!("  {}: {:.4} {unit}{thesis}{verdict}", comparison.what, comparison.found);
    }
}
