//! `dermatome experiment presses`: an archive of simulated presses, to learn from.

use super::{
    noise::NoiseOptions,
    outputs::{Kind, Output},
    progress,
};
use anyhow::Context;
use dermatome_experiments::presses::{RecordedPresses, of_odd_skin};
use dermatome_frames::{
    array::{Array, npz},
    learn::presses::{POSITIONS, PRESSED, Positions, UNPRESSED},
    recorded::read::Frames,
};
use dermatome_model::skin::Skin;
use dermatome_patch::output::write_whole;
use std::path::PathBuf;

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
}

pub(super) fn run(args: &Args) -> anyhow::Result<()> {
    let skin = Skin::load(&args.skin)?.made()?;
    let spinner = progress::spinner();
    spinner.set_message("pressing");
    let presses = of_odd_skin(&skin, usize::from(args.count), args.noise.noise())
        .with_context(|| format!("skin file `{}`", args.skin.display()))?;
    write_whole(&args.output, &archive(&presses)?)?;
    spinner.finish_and_clear();
    say!("presses   {} on a skin like `{}`, and unlike its model", args.count, skin.name);
    say!("written   {}", args.output.display());
    Ok(())
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
