//! `dermatome replay`: recorded frames through a board's own pipeline -> contacts.

mod others;
mod recorded;

use super::{
    JsonReport,
    contact_lines::{contact_lines, is_read, json_line, print},
    frame_options::FrameOptions,
    interrupt, link_frame,
    outlets::Record,
    progress,
    simulate::{Listen, keep_running},
};
use anyhow::{Context, bail};
use dermatome_frames::recorded::read::Source;
use dermatome_link::{contacts::LinkFrame, pose::Pose};
use dermatome_model::{model::Model, quantize, skin::Skin};
use dermatome_patch::{
    input::{self, MAX_PATCH_BYTES},
    tables::SurfaceTables,
};
use dermatome_recording::read::Recording;
use dermatome_shared::{
    contact::Contacts, device::MAX_TARE_FRAMES, patch::PatchView, protocol::FrameStamp,
    reference::DEFAULT_TARE_FRAMES,
};
use dermatome_simulate::board::{SimulatedBoard, board_for_recording};
use serde::Serialize;
use std::{
    collections::BTreeMap,
    ffi::OsString,
    net::SocketAddr,
    path::{Path, PathBuf},
};

/// Run recorded frames through a board's pipeline again: with the patch that they were recorded with, or another one.
///
/// A recording (`--record` of stream, view, demo and calibrate) goes through the board's own code: reference, drift,
/// image or voltages, contacts and their numbers. With its own patch the same comes out as the board sent, bit for bit, and
/// the summary says so; with --patch or --skin what a board with that one would have sent.
///
/// Frames of other instruments (.npy, .npz, .csv and others, as `reconstruct` reads them) need --patch or --skin. Where they
/// are recorded, or a board plays them, untouched frames of another file count as frames before those that are compared with
/// them.
/// Prints what `stream` prints for a pipe: one line per contact, or where a skin file with a [pose] is given one line of
/// JSON per frame, in the frame of the robot's link. The summary goes to standard error.
#[derive(clap::Args)]
#[command(after_help = "Examples:
  dermatome replay run.mcap
  dermatome replay run.mcap --patch learnt.dermatome --record learnt.mcap
  dermatome replay robot.mcap:palm
  dermatome replay run.mcap --listen tcp:127.0.0.1:7000
  dermatome replay run.npy --patch skin.dermatome --rate 20
  dermatome replay run.npy --skin skin.toml --rate 20 --listen tcp:127.0.0.1:7000
  dermatome replay run.npz:touch --patch learnt.dermatome --reference run.npz:idle --times run.npz:time_s
  dermatome replay presses.npz:v_pressed --patch learnt.dermatome --reference presses.npz:v_unpressed --each
A recording is also a port of every other command: dermatome stream --port replay:run.mcap")]
pub(super) struct Args {
    /// Recording (FILE.mcap:PATCH where `serve` has recorded several skins), or frames of another instrument (FILE.npz:KEY
    /// where it holds several arrays).
    #[arg(value_name = "FILE")]
    file: OsString,
    /// Patch file, of `build` or `learn` [default: the recording's own].
    #[arg(long, value_name = "PATCH")]
    patch: Option<PathBuf>,
    /// Skin file of the patch: give contacts in the link's frame, by its [pose]. Without --patch its patch is built.
    #[arg(long, value_name = "FILE")]
    skin: Option<PathBuf>,
    #[command(flatten)]
    listen: ListenInstead,
    #[command(flatten)]
    record: Record,
    /// Frames of the untouched skin, averaged; without it, the first ones of the frames.
    #[arg(long, value_name = "FILE", help_heading = OTHERS)]
    reference: Option<OsString>,
    /// Each frame has a reference of its own, the one of its number, and is by itself.
    #[arg(long, requires = "reference", help_heading = OTHERS)]
    each: bool,
    /// So many first frames are of the untouched skin, and averaged.
    #[arg(long, value_name = "N", default_value_t = DEFAULT_TARE_FRAMES, conflicts_with = "reference",
          value_parser = clap::value_parser!(u16).range(1..=i64::from(MAX_TARE_FRAMES)), help_heading = OTHERS)]
    tare: u16,
    /// When each frame was taken, s: one number per frame.
    #[arg(long, value_name = "FILE", conflicts_with = "rate", help_heading = OTHERS)]
    times: Option<OsString>,
    /// Frames a second [default: the patch's frame rate].
    #[arg(long, value_name = "HZ", help_heading = OTHERS)]
    rate: Option<f64>,
    #[command(flatten, next_help_heading = OTHERS)]
    options: FrameOptions,
    #[command(flatten)]
    json: JsonReport,
}

/// Heading of what only frames of others need.
const OTHERS: &str = "Frames of other instruments";

/// Where to answer as a board.
#[derive(clap::Args)]
struct ListenInstead {
    /// Instead of printing, answer there as a board that plays the frames, over and over: tcp:HOST:PORT; port 0 takes a free
    /// one.
    #[arg(long, value_name = "PORT", conflicts_with_all = ["record", "json"])]
    listen: Option<String>,
    /// Let hosts on other machines in: needed for an address that is not this machine's own (127.0.0.1).
    #[arg(long, requires = "listen")]
    allow_remote: bool,
}

impl ListenInstead {
    fn address(&self) -> anyhow::Result<Option<SocketAddr>> {
        self.listen.as_deref().map(|text| Listen::new(text, self.allow_remote).address()).transpose()
    }
}

/// What became of the frames.
#[derive(Default, Serialize)]
struct Tally {
    frames_replayed: u64,
    frames_with_contacts: u64,
    most_contacts: usize,
    frames_flagged: BTreeMap<&'static str, u64>,
    ended: Ended,
}

/// Why it ended.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
enum Ended {
    /// All frames are done.
    #[default]
    Frames,
    /// The user asked for it.
    Interrupt,
    /// Whoever read standard output has gone.
    Pipe,
}

pub(super) fn run(args: &Args) -> anyhow::Result<()> {
    interrupt::install()?;
    let path = PathBuf::from(&args.file);
    let is_recording = Recording::is_one(&path);
    let patch = match (&args.patch, &args.skin) {
        (Some(path), _) => Some(read_patch(path)?),
        (None, Some(path)) => Some((build_patch(path)?, format!("skin file `{}`", path.display()))),
        (None, None) if is_recording => None,
        (None, None) => {
            let source = Source::new(&args.file);
            bail!(
                "`{source}` is no recording of `--record`, so that there is no patch in it; allowed: `--patch` or `--skin`, with \
                 frames as `reconstruct` reads them"
            )
        }
    };
    let listen = args.listen.address()?;
    match (patch, listen) {
        (Some((bytes, name)), None) if !is_recording => others::run(args, &bytes, &name),
        (Some((bytes, name)), Some(listen)) if !is_recording => {
            keep_listening(&path, others::board(args, bytes, &name, listen)?)
        }
        (patch, None) => recorded::run(args, &path, patch.as_ref()),
        (patch, Some(listen)) => {
            keep_listening(&path, board_for_recording(&path, patch.map(|(bytes, _)| bytes), listen)?)
        }
    }
}

fn keep_listening(path: &Path, board: SimulatedBoard) -> anyhow::Result<()> {
    say!("`{}` listens at tcp:{}", path.display(), board.address());
    keep_running(board)
}

pub(in crate::commands) fn read_patch(path: &Path) -> anyhow::Result<(Vec<u8>, String)> {
    let name = format!("patch file `{}`", path.display());
    let bytes = input::read(path, MAX_PATCH_BYTES).with_context(|| format!("cannot read {name}"))?;
    Ok((bytes, name))
}

/// The patch of a skin file.
fn build_patch(path: &Path) -> anyhow::Result<Vec<u8>> {
    let skin = Skin::load(path)?.made()?;
    let spinner = progress::spinner();
    let model = Model::build(&skin, |stage| spinner.set_message(stage));
    spinner.finish_and_clear();
    let in_file = || format!("skin file `{}`", path.display());
    quantize::patch(&skin, &model.with_context(in_file)?).with_context(in_file)
}

/// The pose by which contacts are shown.
fn pose(args: &Args, patch: &PatchView<'_>) -> anyhow::Result<Option<Pose>> {
    match &args.skin {
        None => Ok(None),
        Some(path) if args.patch.is_some() => {
            let surface = || Ok(SurfaceTables::read(patch));
            Ok(Some(link_frame::skin_of(path, &patch.header.skin, surface)?.1))
        }
        Some(path) => Ok(Skin::load(path)?.pose),
    }
}

fn show(pose: Option<&Pose>, at: FrameStamp, contacts: &Contacts) -> std::io::Result<()> {
    match pose {
        Some(pose) => print(&json_line(&LinkFrame::new(pose, at, contacts), None)?),
        None => print(&contact_lines(at, contacts, None)),
    }
}

/// Counts frames as they are shown.
#[derive(Default)]
struct Counted(Tally);

impl Counted {
    /// Counts and shows a frame; false if nobody reads any more, or the user asks to stop.
    fn show(
        &mut self,
        at: FrameStamp,
        contacts: &Contacts,
        show: impl FnOnce(FrameStamp, &Contacts) -> std::io::Result<()>,
    ) -> std::io::Result<bool> {
        let tally = &mut self.0;
        tally.count(at, contacts);
        if !is_read(show(at, contacts))? {
            tally.ended = Ended::Pipe;
        } else if interrupt::requested() {
            tally.ended = Ended::Interrupt;
        }
        Ok(tally.ended == Ended::Frames)
    }

    /// Tells what came of them.
    fn end(self) -> Tally {
        if self.0.ended != Ended::Pipe {
            summarise(&self.0);
        }
        self.0
    }
}

impl Tally {
    fn count(&mut self, at: FrameStamp, contacts: &Contacts) {
        self.frames_replayed += 1;
        self.frames_with_contacts += u64::from(!contacts.is_empty());
        self.most_contacts = self.most_contacts.max(contacts.len());
        let is_new = |words: &&str| !self.frames_flagged.contains_key(words);
        let new = at.flags.words().filter(is_new).collect::<Vec<_>>().join(", ");
        if !new.is_empty() {
            eprintln!("warning: frame {} has flags not seen before: {new}", at.sequence);
        }
        at.flags.words().for_each(|words| *self.frames_flagged.entry(words).or_default() += 1);
    }
}

fn summarise(tally: &Tally) {
    let Tally { frames_replayed: frames, frames_with_contacts: with, most_contacts: most, .. } = tally;
    eprintln!("{frames} frames replayed, {with} with contacts, at most {most} at once");
    for (words, frames) in &tally.frames_flagged {
        eprintln!("warning: {words} in {frames} frames: their contacts may not be right");
    }
}
