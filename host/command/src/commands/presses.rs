//! `dermatome experiment presses`: an archive of simulated presses, to learn from.

use super::{
    JsonReport,
    noise::NoiseOptions,
    outputs::{Kind, Output},
    progress,
};
use anyhow::{Context, ensure};
use dermatome_experiments::presses::{RecordedPresses, of_odd_skin};
use dermatome_frames::{
    array::{Array, npz},
    learn::presses::{POSITIONS, PRESSED, Positions, UNPRESSED},
    recorded::read::Frames,
};
use dermatome_model::skin::Skin;
use dermatome_patch::output::write_whole;
use serde::Serialize;
use std::path::{Path, PathBuf};

/// Array of the frames of the untouched skin, whose mean the reference is.
const IDLE: &str = "idle";

/// Record presses on a simulated skin that its model does not know, to learn from.
///
/// Its sheet conducts up to three times better or worse from place to place, contacts and gains of measurements are all
/// different, and places are recorded up to 3 mm off the skin. A finger of 8 % of half the skin's larger side presses at random
/// places.
#[derive(clap::Args)]
#[command(
    after_help = "The archive holds v_pressed, positions_m and v_unpressed, as `learn` reads them, and idle: frames \
of the untouched skin.

Examples:
  dermatome experiment presses models/disc-210mm/skin.toml -o presses.npz
  dermatome learn models/disc-210mm/skin.toml --presses presses.npz -o learnt.dermatome
  dermatome replay learnt.dermatome --frames presses.npz:v_pressed --reference presses.npz:idle --rate 5"
)]
pub(super) struct Args {
    /// Skin file.
    #[arg(value_name = "SKIN")]
    skin: PathBuf,
    /// Where to write the presses, as an .npz archive.
    #[arg(short, long, value_name = "FILE", default_value = "presses.npz", value_parser = Kind::Presses.parser())]
    output: Output,
    /// Presses: 1 to 10,000.
    #[arg(long, value_name = "N", default_value_t = 100, value_parser = clap::value_parser!(u16).range(1..=10_000))]
    count: u16,
    #[command(flatten)]
    noise: NoiseOptions,
    #[command(flatten)]
    json: JsonReport,
}

/// What was recorded; keys are documented in docs/cli.md.
#[derive(Serialize)]
struct Report<'a> {
    skin: &'a str,
    presses: u16,
    measurements: usize,
    untouched_frames: usize,
    noise_db: f64,
    seed: u64,
    file: &'a Path,
}

/// Values of all presses together, at most.
const MOST_VALUES: usize = 1 << 24;

pub(super) fn run(args: &Args) -> anyhow::Result<()> {
    let is_archive = args.output.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("npz"));
    ensure!(is_archive, "`--output` is `{}`; its name must end in .npz", args.output.display());
    let skin = Skin::load(&args.skin)?.made()?;
    let (steps, count) = (skin.steps().len(), usize::from(args.count));
    ensure!(
        count * steps <= MOST_VALUES,
        "`--count` is {count}; allowed: at most {} for the {steps} measurements of `{}`",
        MOST_VALUES / steps.max(1),
        skin.name
    );
    let noise = args.noise.noise();
    let spinner = progress::spinner();
    spinner.set_message("pressing");
    let presses =
        of_odd_skin(&skin, count, noise).with_context(|| format!("skin file `{}`", args.skin.display()))?;
    write_whole(&args.output, &archive(&presses)?)?;
    spinner.finish_and_clear();
    say!("presses   {count} on a skin like `{}`, and unlike its model", skin.name);
    say!("written   {}", args.output.display());
    args.json.write(&Report {
        skin: &skin.name,
        presses: args.count,
        measurements: steps,
        untouched_frames: presses.untouched.frames,
        noise_db: noise.snr_db,
        seed: noise.seed,
        file: &args.output,
    })
}

fn archive(presses: &RecordedPresses) -> anyhow::Result<Vec<u8>> {
    let RecordedPresses { recording, untouched } = presses;
    let table = |frames: &Frames| {
        let (values, columns) = (frames.values.clone(), frames.measurements);
        Array::table(frames.frames, columns, move |row, column| values[row * columns + column].re)
    };
    let positions = match &recording.positions {
        Positions::InSpace(places) => Array::table(places.len(), 3, |press, axis| places[press][axis]),
        Positions::FromAbove(places) => Array::table(places.len(), 2, |press, axis| places[press][axis]),
    };
    let arrays = [
        (PRESSED, table(&recording.pressed)),
        (UNPRESSED, table(&recording.unpressed)),
        (POSITIONS, positions),
        (IDLE, table(untouched)),
    ];
    npz::archive(&arrays).context("cannot make the archive")
}
