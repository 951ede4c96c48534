//! The command line: arguments in, library calls, words and reports out.

use anyhow::Context;
use clap::{CommandFactory, FromArgMatches, Parser, Subcommand};
use dermatome_link::{Link, words::escaped_lines};
use dermatome_patch::output::write_whole;
use dermatome_shared::protocol::{Identity, PatchInfo};
use outputs::{Kind, Output};
use serde::Serialize;
use std::{
    io::{self, Write},
    path::Path,
    process::ExitCode,
};

/// Prints a line on standard output; see [`say`].
macro_rules! say {
    ($($words:tt)*) => {
        $crate::commands::say(format_args!($($words)*))
    };
}

mod board;
mod body;
mod build;
mod calibrate;
mod check;
mod check_data;
mod check_data_trial;
mod check_skin;
mod check_trial;
mod choices;
mod completions;
mod contact_lines;
mod current;
mod cut;
mod cut_picture;
mod demo;
mod demo_robot;
mod design;
mod devices;
mod doors;
mod drive;
mod evaluate;
mod experiment;
mod export;
mod finding;
mod firmware;
mod flags;
mod flash;
mod forward;
mod frame_options;
mod inspect;
pub(crate) mod interrupt;
mod learn;
mod lines;
mod link_frame;
mod man;
mod mjcf;
mod mount;
mod network;
mod noise;
mod outlets;
mod outputs;
mod playing;
mod preserved;
mod presses;
mod progress;
mod reconstruct;
mod replay;
mod scope;
mod serve;
mod setup;
mod simulate;
mod skin_of_cutout;
mod skin_of_design;
mod stream;
mod tare;
mod trim;
mod trust;
mod urdf;
mod verbose;
mod view;

/// Pressure-sensing robot skin by electrical impedance tomography.
#[derive(Parser)]
#[command(name = "dermatome", version, propagate_version = true, arg_required_else_help = true)]
struct Cli {
    /// Replace files that are there, whatever they hold, but never one that the command reads.
    #[arg(long, global = true, alias = "overwrite", display_order = 900)]
    force: bool,
    /// Tell step by step what is done, on standard error: files, stages, and what the board is asked.
    #[arg(short, long, global = true, display_order = 901)]
    verbose: bool,
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    Demo(demo::Args),
    Build(build::Args),
    Evaluate(evaluate::Args),
    Experiment(experiment::Args),
    Inspect(inspect::Args),
    Flash(flash::Args),
    Tare(tare::Args),
    Stream(stream::Args),
    View(view::Args),
    Serve(serve::Args),
    Body(body::Args),
    Calibrate(calibrate::Args),
    Setup(setup::Args),
    Check(check::Args),
    Scope(scope::Args),
    Drive(drive::Args),
    Trim(trim::Args),
    Simulate(simulate::Args),
    Devices(devices::Args),
    Firmware(firmware::Args),
    Reconstruct(reconstruct::Args),
    Replay(replay::Args),
    CheckData(check_data::Args),
    Cut(cut::Args),
    Urdf(urdf::Args),
    Mjcf(mjcf::Args),
    Design(design::Args),
    Learn(learn::Args),
    Export(export::Args),
    Forward(forward::Args),
    Completions(completions::Args),
    Man(man::Args),
}

/// The command line as clap knows it: for its help, completions and manual pages.
#[must_use]
pub fn command() -> clap::Command {
    Cli::command()
}

/// Runs the command line; errors go to standard error in full, with exit code 1.
pub fn main() -> ExitCode {
    let matches = command().get_matches();
    let Cli { command: chosen, verbose, .. } =
        Cli::from_arg_matches(&matches).unwrap_or_else(|error| error.exit());
    if verbose {
        verbose::begin();
    }
    match outputs::check(&command(), &matches).and_then(|()| run(chosen)) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {}", escaped_lines(&format!("{error:#}")));
            ExitCode::FAILURE
        }
    }
}

fn run(command: Command) -> anyhow::Result<()> {
    match command {
        Command::Demo(args) => demo::run(&args),
        Command::Build(args) => build::run(&args),
        Command::Evaluate(args) => evaluate::run(&args),
        Command::Experiment(args) => experiment::run(&args),
        Command::Inspect(args) => inspect::run(&args),
        Command::Flash(args) => flash::run(&args),
        Command::Tare(args) => tare::run(&args),
        Command::Stream(args) => stream::run(&args),
        Command::View(args) => view::run(&args),
        Command::Serve(args) => serve::run(&args),
        Command::Body(args) => body::run(&args),
        Command::Calibrate(args) => calibrate::run(&args),
        Command::Setup(args) => setup::run(&args),
        Command::Check(args) => check::run(&args),
        Command::Scope(args) => scope::run(&args),
        Command::Drive(args) => drive::run(&args),
        Command::Trim(args) => trim::run(&args),
        Command::Simulate(args) => simulate::run(&args),
        Command::Devices(args) => devices::run(&args),
        Command::Firmware(args) => firmware::run(&args),
        Command::Reconstruct(args) => reconstruct::run(&args),
        Command::Replay(args) => replay::run(&args),
        Command::CheckData(args) => check_data::run(&args),
        Command::Cut(args) => cut::run(&args),
        Command::Urdf(args) => urdf::run(&args),
        Command::Mjcf(args) => mjcf::run(&args),
        Command::Design(args) => design::run(&args),
        Command::Learn(args) => learn::run(&args),
        Command::Export(args) => export::run(&args),
        Command::Forward(args) => forward::run(&args),
        Command::Completions(args) => completions::run(&args),
        Command::Man(args) => man::run(&args),
    }
}

/// Where to write the report for scripts.
#[derive(clap::Args)]
struct JsonReport {
    /// Also write the report as JSON (keys: docs/cli.md).
    #[arg(long, value_name = "FILE", value_parser = Kind::Json.parser())]
    json: Option<Output>,
}

impl JsonReport {
    /// Writes `report` if it was asked for.
    fn write(&self, report: &impl Serialize) -> anyhow::Result<()> {
        match self.text(report)? {
            Some((path, text)) => Ok(write_whole(path, text.as_bytes())?),
            None => Ok(()),
        }
    }

    /// The file and its text, if it was asked for: to be written with others.
    fn text(&self, report: &impl Serialize) -> anyhow::Result<Option<(&Path, String)>> {
        let Some(path) = &self.json else { return Ok(None) };
        let mut text = serde_json::to_string_pretty(report).context("cannot express the report as JSON")?;
        text.push('\n');
        Ok(Some((path, text)))
    }
}

/// Which board a report is about, and the skin of the patch it uses.
#[derive(Serialize)]
struct BoardReport<'a> {
    port: &'a str,
    board: &'a str,
    firmware: &'a str,
    skin: &'a str,
}

impl<'a> BoardReport<'a> {
    fn new(link: &'a Link, patch: &'a PatchInfo) -> Self {
        Self::of(link.port(), link.identity(), patch)
    }

    fn of(port: &'a str, identity: &'a Identity, patch: &'a PatchInfo) -> Self {
        Self { port, board: &identity.board, firmware: &identity.firmware, skin: &patch.skin }
    }
}

/// Prints a line; names in it that others gave are only words. Where nobody reads any more (`dermatome ... | head -1`) the command goes on quietly,
/// for it may have files to write; where the line cannot be written for another reason, it ends with
/// an error.
fn say(words: std::fmt::Arguments<'_>) {
    print_line(&escaped_lines(&words.to_string()));
}

/// The same of words that hold only what they may.
fn print_line(words: &str) {
    let Err(error) = writeln!(io::stdout(), "{words}") else { return };
    if error.kind() != io::ErrorKind::BrokenPipe {
        eprintln!("error: cannot write to standard output: {error}");
        std::process::exit(1);
    }
}

/// A patch's checksum, which identifies it, as reports and screens show it.
fn patch_id(crc: u32) -> String {
    format!("{crc:#010x}")
}
