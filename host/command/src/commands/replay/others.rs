//! Frames of other instruments, through the pipeline of a patch.

use super::{Args, Counted, Tally, show};
use crate::commands::{link_frame, patch_id};
use anyhow::{Context, ensure};
use dermatome_frames::recorded::{
    read::{Frames, Source, read},
    replay::{Replay, Times, Untouched},
};
use dermatome_patch::tables::SurfaceTables;
use dermatome_shared::{device::MAX_TARE_FRAMES, patch::PatchView, pipeline::noise::LEAST_FRAMES};
use serde::Serialize;
use std::path::Path;

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

/// Replays them with the patch in `bytes`, which is called so.
pub(super) fn run(args: &Args, bytes: &[u8], name: &str) -> anyhow::Result<()> {
    let patch = PatchView::validate(bytes).with_context(|| name.to_owned())?;
    let header = &patch.header;
    let surface = || Ok(SurfaceTables::read(&patch));
    let skin_file = args.skin.as_deref().filter(|_| args.patch.is_some());
    let on_link = skin_file.map(|path| link_frame::skin_of(path, &header.skin, surface)).transpose()?;
    let pose = on_link.as_ref().map(|(_, pose)| pose);
    let source = Source::new(&args.file);
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
        format!("`{source}`{more} on {name}")
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
    let mut counted = Counted::default();
    for frame in replay {
        let (at, contacts) = frame.with_context(in_files)?;
        if !counted.show(at, &contacts, |at, contacts| show(pose, at, contacts))? {
            break;
        }
    }
    let tally = counted.end();
    args.json.write(&Report {
        patch: args.patch.as_deref(),
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
