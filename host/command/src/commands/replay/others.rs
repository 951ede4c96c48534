//! Frames of other instruments, through the pipeline of a patch.

use super::{Args, Counted, Tally, pose, show};
use crate::commands::{
    patch_id,
    playing::{Playing, session_of_others},
};
use anyhow::{Context, ensure};
use dermatome_frames::recorded::{
    read::{Frames, Source, read},
    replay::{Replay, ReplayError, Times, Untouched},
};
use dermatome_shared::{
    device::MAX_TARE_FRAMES, patch::PatchView, pipeline::noise::LEAST_FRAMES, stimulation::Step,
};
use dermatome_simulate::board::{SimulatedBoard, board_for_items};
use serde::Serialize;
use std::{net::SocketAddr, path::Path};

/// What `replay` tells of them; keys are documented in docs/cli.md.
#[derive(Serialize)]
struct Report<'a> {
    /// None where it was built of the skin file.
    patch: Option<&'a Path>,
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

/// Frames of others, and what is said of them.
struct Others {
    source: Source,
    frames: Frames,
    reference: Option<(Source, Frames)>,
    times: Times,
}

impl Others {
    fn read(args: &Args, patch: &PatchView<'_>) -> anyhow::Result<Self> {
        let steps: Vec<Step> = patch.steps().collect();
        let read = |source: &Source| args.options.read(source, &steps, patch.header.electrodes);
        let source = Source::new(&args.file);
        let frames = read(&source)?;
        let reference = args.reference.as_ref().map(|name| Source::new(name));
        let reference = reference.map(|source| read(&source).map(|frames| (source, frames))).transpose()?;
        Ok(Self { source, frames, reference, times: times(args, patch.header.drive.frame_rate)? })
    }

    fn untouched(&self, args: &Args) -> Untouched<'_> {
        match &self.reference {
            None => Untouched::First(args.tare.into()),
            Some((_, reference)) if args.each => Untouched::Each(reference),
            Some((_, reference)) => Untouched::Apart(reference),
        }
    }

    /// As a board with a patch would have recorded them.
    fn replay<'a>(&'a self, args: &Args, patch: &'a PatchView<'a>) -> Result<Replay<'a>, ReplayError> {
        Replay::new(patch, &self.frames, self.untouched(args), &args.options.arrangement(), &self.times)
    }

    /// Frames that a reference is averaged from.
    fn reference_frames(&self, args: &Args) -> usize {
        match self.untouched(args) {
            Untouched::First(frames) => frames,
            Untouched::Apart(frames) => frames.frames.min(MAX_TARE_FRAMES.into()),
            Untouched::Each(_) => 1,
        }
    }

    /// Says what was taken for granted, and what a patch lacks.
    fn tell(&self, args: &Args, patch: &PatchView<'_>) {
        if is_rate_assumed(args) && !args.each {
            eprintln!(
                "the frames come without times: taken as {} a second, as the patch says (--times, --rate)",
                patch.header.drive.frame_rate
            );
        }
        let reference_frames = self.reference_frames(args);
        if patch.header.has_places() && reference_frames < LEAST_FRAMES.into() {
            eprintln!(
                "warning: {reference_frames} frames of the untouched skin; this patch finds contacts by the noise of \
                 {LEAST_FRAMES} or more, and none before it has them"
            );
        }
    }

    /// Which files they are of, on a patch that is called so.
    fn in_words(&self, args: &Args, patch: &str) -> String {
        let reference = self.reference.iter().map(|(source, _)| format!(" after `{source}`"));
        let times = args.times.iter().map(|name| format!(" at times `{}`", Source::new(name)));
        let more: String = reference.chain(times).collect();
        format!("`{}`{more} on {patch}", self.source)
    }
}

/// A board that plays them with the patch in `bytes`, which is called so.
pub(super) fn board(
    args: &Args,
    bytes: Vec<u8>,
    name: &str,
    listen: SocketAddr,
) -> anyhow::Result<SimulatedBoard> {
    let patch = PatchView::validate(&bytes).with_context(|| name.to_owned())?;
    let others = Others::read(args, &patch)?;
    let replay = others.replay(args, &patch).and_then(|replay| {
        let drive = replay.drive();
        Ok((replay.collect::<Result<_, _>>()?, drive))
    });
    let (items, drive) = replay.with_context(|| others.in_words(args, name))?;
    others.tell(args, &patch);
    Ok(board_for_items(items, bytes, drive, listen)?)
}

/// Replays them with the patch in `bytes`, which is called so.
pub(super) fn run(args: &Args, bytes: &[u8], name: &str) -> anyhow::Result<()> {
    let patch = PatchView::validate(bytes).with_context(|| name.to_owned())?;
    let header = &patch.header;
    let pose = pose(args, &patch)?;
    let others = Others::read(args, &patch)?;
    let in_files = || others.in_words(args, name);
    let mut replay = others.replay(args, &patch).with_context(in_files)?;
    others.tell(args, &patch);
    let steps: Vec<Step> = patch.steps().collect();
    let mut playing = Playing::new(&patch, &steps)?;
    if let Some(file) = args.record.file() {
        let session = session_of_others(&patch, others.source.to_string(), args.skin.as_deref())?;
        playing.record(file, &session, pose.as_ref(), replay.begun())?;
    }
    let mut counted = Counted::default();
    while let Some(item) = replay.next() {
        let Some(played) = playing.take(&item.with_context(in_files)?).with_context(in_files)? else {
            continue;
        };
        let at = replay.in_file(played.at);
        if !counted.show(at, &played.contacts, |at, contacts| show(pose.as_ref(), at, contacts))? {
            break;
        }
    }
    let tally = counted.end();
    playing.finish()?;
    args.json.write(&Report {
        patch: args.patch.as_deref(),
        patch_crc: patch_id(patch.crc()),
        skin: &header.skin,
        link: pose.as_ref().map(|pose| pose.link.as_str()),
        frames_file: others.source.to_string(),
        reference_file: others.reference.as_ref().map(|(source, _)| source.to_string()),
        reference_frames: others.reference_frames(args),
        measurements: others.frames.measurements,
        complex: others.frames.complex,
        frame_rate: match others.times {
            Times::Rate(rate) => Some(rate),
            Times::Each(_) => None,
        },
        frame_rate_assumed: is_rate_assumed(args),
        tally,
    })
}

fn is_rate_assumed(args: &Args) -> bool {
    args.times.is_none() && args.rate.is_none()
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
