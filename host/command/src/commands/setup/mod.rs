//! `dermatome setup`: a board and its skin, from the first connection to a skin that tells where it is pressed.
//!
//! Each step measures one thing, says what came out and what to do if it is wrong, and mends what a program can. What a
//! step measures is measured by the command that is there for it: `check`, `drive`, `tare`, `build`, `flash`.

mod bench;
mod order;
mod person;
mod presses;
mod steps;

use super::{
    JsonReport, interrupt,
    outputs::{Kind, Output},
};
use anyhow::bail;
use bench::Bench;
use dermatome_link::health::Finding;
use dermatome_patch::output::write_together;
use dermatome_simulate::port::Port;
use person::Person;
use serde::Serialize;
use std::{
    path::{Path, PathBuf},
    time::Duration,
};

/// Take a board and its skin into use, step by step.
///
/// Looks for the board, its patch, the current, the electrodes, whether the skin measures what its file says, noise,
/// and, by two presses, whether wires and electrodes go together; tares in between. Says what it measured and what to do.
/// Offers to mend what it can: a patch that is missing or another skin's, a current that is too large, wires in another
/// order. Leave the skin untouched until it asks for a press. Exits with code 1 if something is wrong that it did not mend.
#[derive(clap::Args)]
#[command(after_help = "Examples:
  dermatome setup --port /dev/ttyACM0 --skin skin.toml
  dermatome setup --port COM5 --skin skin.toml -o palm.dermatome --corrected palm.toml
  dermatome setup --port tcp:127.0.0.1:7000 --skin skin.toml --yes --json setup.json")]
pub(super) struct Args {
    /// Where the board is: /dev/ttyACM0, COM5, tcp:HOST:PORT, rs485:LINE#ADDRESS, can:BUS#ADDRESS or sim:SKIN.toml.
    #[arg(long)]
    port: Port,
    /// Skin file of the skin on it.
    #[arg(long, value_name = "FILE")]
    skin: PathBuf,
    /// Answer every question with yes: where nobody is there. Presses are skipped, unless `--press-within` is given.
    #[arg(long)]
    yes: bool,
    /// Wait so many seconds for each press, 0 to skip them [default: 60, with `--yes` 0].
    #[arg(long, value_name = "SECONDS", value_parser = clap::value_parser!(u16).range(0..=3600))]
    press_within: Option<u16>,
    /// Frames to look at in each step.
    #[arg(long, value_name = "N", default_value_t = 20, value_parser = clap::value_parser!(u16).range(3..))]
    frames: u16,
    /// Write the patch that the board then uses, for `calibrate`.
    #[arg(short, long, value_name = "PATCH", value_parser = Kind::Patch.parser())]
    output: Option<Output>,
    /// Write the skin file with what was corrected.
    #[arg(long, value_name = "FILE", value_parser = Kind::Skin.parser())]
    corrected: Option<Output>,
    #[command(flatten)]
    json: JsonReport,
}

impl Args {
    /// How long to wait for a press; none where they are skipped.
    fn press_within(&self) -> Option<Duration> {
        let seconds = self.press_within.unwrap_or(if self.yes { 0 } else { 60 });
        (seconds > 0).then(|| Duration::from_secs(seconds.into()))
    }
}

/// How a step ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
enum State {
    /// Nothing is wrong.
    Ok,
    /// Something was, and is not any more.
    Mended,
    /// Something is wrong.
    Wrong,
    /// It was not done.
    Skipped,
}

/// What a step measured.
#[derive(Debug, Serialize)]
struct Step {
    step: &'static str,
    state: State,
    measured: String,
    findings: Vec<Finding>,
}

impl Step {
    fn new(step: &'static str, state: State, measured: impl Into<String>) -> Self {
        Self { step, state, measured: measured.into(), findings: Vec::new() }
    }

    /// A step in which these are wrong; fine if there are none.
    fn found(step: &'static str, measured: impl Into<String>, findings: Vec<Finding>) -> Self {
        let state = if findings.is_empty() { State::Ok } else { State::Wrong };
        Self { findings, ..Self::new(step, state, measured) }
    }

    fn wrong(
        step: &'static str,
        measured: impl Into<String>,
        what: impl Into<String>,
        advice: impl Into<String>,
    ) -> Self {
        Self::found(step, measured, vec![Finding { what: what.into(), advice: advice.into() }])
    }

    fn print(&self) {
        let state = match self.state {
            State::Ok => "ok",
            State::Mended => "mended",
            State::Wrong => "WRONG",
            State::Skipped => "skipped",
        };
        say!("{:<11} {state:<8} {}", self.step, self.measured);
        self.findings.iter().for_each(|found| say!("{:20} {}: {}", "", found.what, found.advice));
    }
}

/// The smallest press that one frame shows.
#[derive(Clone, Copy, Debug, Serialize)]
struct SmallestPress {
    /// Its radius.
    radius_mm: f64,
    /// By how much it changes the conductivity, at the median place and at the worst; none where no change is enough.
    median_change_percent: Option<f64>,
    worst_change_percent: Option<f64>,
}

/// What came out; keys are documented in docs/cli.md.
#[derive(Serialize)]
struct Report<'a> {
    port: &'a str,
    board: &'a str,
    firmware: &'a str,
    skin: &'a str,
    /// `done`, `stopped` by Ctrl-C, or `wrong`.
    ended: &'static str,
    patch_crc: Option<String>,
    amplitude_a: Option<f32>,
    snr_db: Option<f64>,
    smallest_press: Option<SmallestPress>,
    corrected: bool,
    steps: &'a [Step],
}

pub(super) fn run(args: &Args) -> anyhow::Result<()> {
    interrupt::install()?;
    let person = Person::at_input(args.yes)?;
    let mut bench = Bench::new(args, person)?;
    let went = steps::all(&mut bench);
    // What was measured is told, whatever then went wrong.
    let wrong = bench.steps.iter().filter(|step| step.state == State::Wrong).count();
    let ended = match (&went, wrong) {
        (Ok(()), _) if interrupt::requested() => "stopped",
        (Ok(()), 0) => "done",
        _ => "wrong",
    };
    let identity = bench.link.identity().clone();
    args.json.write(&Report {
        port: bench.link.port(),
        board: &identity.board,
        firmware: &identity.firmware,
        skin: &bench.skin.name,
        ended,
        patch_crc: bench.on_board.map(super::patch_id),
        amplitude_a: bench.amplitude,
        snr_db: bench.snr_db,
        smallest_press: bench.smallest_press,
        corrected: bench.is_corrected(),
        steps: &bench.steps,
    })?;
    went?;
    write(args, &bench)?;
    match (wrong, ended) {
        (_, "stopped") => say!("stopped"),
        (0, _) => say!("done: dermatome stream --port {}", bench.link.port()),
        (1, _) => bail!("one step found something wrong: see above"),
        (many, _) => bail!("{many} steps found something wrong: see above"),
    }
    Ok(())
}

/// The files that were asked for, and what a skin file should say that does not.
fn write(args: &Args, bench: &Bench<'_>) -> anyhow::Result<()> {
    let patch = bench.patch_on_board();
    let mut files: Vec<(&Path, &[u8])> = Vec::new();
    match (args.output.as_deref(), patch) {
        (Some(file), Some(patch)) => files.push((file, patch)),
        (Some(file), None) => {
            eprintln!("`{}` is not written: the board keeps a patch that was not built here", file.display());
        }
        (None, _) => {}
    }
    if let Some(file) = args.corrected.as_deref().filter(|_| bench.is_corrected()) {
        files.push((file, bench.text.as_bytes()));
    }
    write_together(&files)?;
    files.iter().for_each(|(file, _)| say!("wrote {}", file.display()));
    if bench.is_corrected() && args.corrected.is_none() {
        let fields = bench.corrected_fields();
        say!(
            "the patch on the board is corrected, skin file `{}` is not: set {} there, or give `--corrected FILE`",
            args.skin.display(),
            fields.join(", ")
        );
    }
    Ok(())
}
