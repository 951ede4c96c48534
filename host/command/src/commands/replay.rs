//! `dermatome replay`: recorded frames through a board's own pipeline -> contacts.

use super::{
    JsonReport,
    contact_lines::{contact_lines, is_read, json_line, print},
    frame_options::FrameOptions,
    link_frame, patch_id,
};
use anyhow::{Context, ensure};
use dermatome_frames::recorded::{
    read::{Frames, Source, read},
    replay::{Replay, Times, Untouched},
};
use dermatome_link::{contacts::LinkFrame, pose::Pose};
use dermatome_patch::{
    input::{self, MAX_PATCH_BYTES},
    tables::SurfaceTables,
};
use dermatome_shared::{
    contact::Contacts, device::MAX_TARE_FRAMES, patch::PatchView, pipeline::noise::LEAST_FRAMES,
    protocol::FrameStamp, reference::DEFAULT_TARE_FRAMES,
};
use serde::Serialize;
use std::{collections::BTreeMap, ffi::OsString, path::PathBuf};

/// Show the contacts that a board with this patch would find in recorded frames.
///
/// The frames go through the board's own code: reference, drift, image or voltages, contacts and their numbers. Prints
/// what `stream` prints for a pipe: one line per contact, or with --skin one line of JSON per frame, in the frame of the
/// robot's link. Frame sequences count the file's frames from 0. The summary goes to standard error.
#[derive(clap::Args)]
#[command(
    after_help = "FILE is .npy, .npz (as FILE.npz:KEY where it holds several arrays) or .csv, as `reconstruct` \
reads it: one frame per row, in any unit.

Examples:
  dermatome replay skin.dermatome --frames run.npy --rate 20
  dermatome replay learnt.dermatome --frames run.npz:touch --reference run.npz:idle --times run.npz:time_s
  dermatome replay learnt.dermatome --frames presses.npz:v_pressed --reference presses.npz:v_unpressed --each"
)]
pub(super) struct Args {
    /// Patch file, of `build` or `learn`.
    #[arg(value_name = "PATCH")]
    patch: PathBuf,
    /// Frames to replay.
    #[arg(long, value_name = "FILE")]
    frames: OsString,
    /// Frames of the untouched skin, averaged; without it, the first ones of the frames.
    #[arg(long, value_name = "FILE")]
    reference: Option<OsString>,
    /// Each frame has a reference of its own, the one of its number, and is by itself.
    #[arg(long, requires = "reference")]
    each: bool,
    /// So many first frames are of the untouched skin, and averaged.
    #[arg(long, value_name = "N", default_value_t = DEFAULT_TARE_FRAMES, conflicts_with = "reference",
          value_parser = clap::value_parser!(u16).range(1..=i64::from(MAX_TARE_FRAMES)))]
    tare: u16,
    /// When each frame was taken, s: one number per frame.
    #[arg(long, value_name = "FILE", conflicts_with = "rate")]
    times: Option<OsString>,
    /// Frames a second [default: the patch's frame rate].
    #[arg(long, value_name = "HZ")]
    rate: Option<f64>,
    /// Skin file of the patch: give contacts in the link's frame, by its [pose].
    #[arg(long, value_name = "FILE")]
    skin: Option<PathBuf>,
    #[command(flatten)]
    options: FrameOptions,
    #[command(flatten)]
    json: JsonReport,
}

/// What `replay` tells; keys are documented in docs/cli.md.
#[derive(Serialize)]
struct Report<'a> {
    patch: &'a PathBuf,
    patch_crc: String,
    skin: &'a str,
    link: Option<&'a str>,
    frames_file: String,
    reference_file: Option<String>,
    reference_frames: usize,
    measurements: usize,
    complex: bool,
    /// None where each frame has its time.
    frame_rate: Option<f64>,
    frame_rate_assumed: bool,
    #[serde(flatten)]
    tally: Tally,
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
    /// Whoever read standard output has gone.
    Pipe,
}

pub(super) fn run(args: &Args) -> anyhow::Result<()> {
    let name = || format!("patch file `{}`", args.patch.display());
    let bytes =
        input::read(&args.patch, MAX_PATCH_BYTES).with_context(|| format!("cannot read {}", name()))?;
    let patch = PatchView::validate(&bytes).with_context(name)?;
    let header = &patch.header;
    let surface = || Ok(SurfaceTables::read(&patch));
    let on_link =
        args.skin.as_deref().map(|path| link_frame::skin_of(path, &header.skin, surface)).transpose()?;
    let pose = on_link.as_ref().map(|(_, pose)| pose);
    let source = Source::new(&args.frames);
    let read_frames = |source: &Source| args.options.read_of(source, header.electrodes, header.steps.into());
    let frames = read_frames(&source)?;
    let reference_source = args.reference.as_ref().map(|name| Source::new(name));
    let reference = reference_source.as_ref().map(read_frames).transpose()?;
    let untouched = match &reference {
        None => Untouched::First(args.tare.into()),
        Some(reference) if args.each => Untouched::Each(reference),
        Some(reference) => Untouched::Apart(reference),
    };
    let times = times(args, header.drive.frame_rate)?;
    let in_files = || {
        let reference = reference_source.iter().map(|source| format!(" after `{source}`"));
        let times = args.times.iter().map(|name| format!(" at times `{}`", Source::new(name)));
        let more: String = reference.chain(times).collect();
        format!("`{source}`{more} on {}", name())
    };
    let replay = Replay::new(&patch, &frames, untouched, &args.options.arrangement(), &times);
    let replay = replay.with_context(in_files)?;
    let reference_frames = reference_frames(args, untouched);
    let frame_rate_assumed = args.times.is_none() && args.rate.is_none();
    if frame_rate_assumed && !args.each {
        let rate = header.drive.frame_rate;
        eprintln!(
            "the frames come without times: taken as {rate} a second, as the patch says (--times, --rate)"
        );
    }
    if header.has_places() && reference_frames < LEAST_FRAMES.into() {
        eprintln!(
            "warning: {reference_frames} frames of the untouched skin; this patch finds contacts by the noise of \
             {LEAST_FRAMES} or more, and none before it has them"
        );
    }
    let mut tally = Tally::default();
    for frame in replay {
        let (at, contacts) = frame.with_context(in_files)?;
        tally.count(at, &contacts);
        if !is_read(show(pose, at, &contacts))? {
            tally.ended = Ended::Pipe;
            break;
        }
    }
    if tally.ended != Ended::Pipe {
        summarise(&tally);
    }
    args.json.write(&Report {
        patch: &args.patch,
        patch_crc: patch_id(patch.crc()),
        skin: &header.skin,
        link: pose.map(|pose| pose.link.as_str()),
        frames_file: source.to_string(),
        reference_file: reference_source.as_ref().map(ToString::to_string),
        reference_frames,
        measurements: frames.measurements,
        complex: frames.complex,
        frame_rate: match times {
            Times::Rate(rate) => Some(rate),
            Times::Each(_) => None,
        },
        frame_rate_assumed,
        tally,
    })
}

fn times(args: &Args, of_patch: f32) -> anyhow::Result<Times> {
    let Some(name) = &args.times else {
        return Ok(Times::Rate(args.rate.unwrap_or_else(|| of_patch.into())));
    };
    let source = Source::new(name);
    let Frames { values, .. } = read(&source)?;
    let complex = values.iter().position(|time| time.im != 0.0);
    ensure!(complex.is_none(), "times `{source}` are complex; allowed: one real number per frame, s");
    Ok(Times::Each(values.iter().map(|time| time.re).collect()))
}

/// Frames that a reference is averaged from.
fn reference_frames(args: &Args, untouched: Untouched<'_>) -> usize {
    match untouched {
        Untouched::First(_) => args.tare.into(),
        Untouched::Apart(frames) => frames.frames.min(MAX_TARE_FRAMES.into()),
        Untouched::Each(_) => 1,
    }
}

fn show(pose: Option<&Pose>, at: FrameStamp, contacts: &Contacts) -> std::io::Result<()> {
    match pose {
        Some(pose) => print(&json_line(&LinkFrame::new(pose, at, contacts), None)?),
        None => print(&contact_lines(at, contacts, None)),
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
