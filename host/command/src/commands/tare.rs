//! `dermatome tare`.

use super::{
    BoardReport,
    board::{advised, open},
    current::Current,
};
use anyhow::Context;
use dermatome_link::{self as link, Link, LinkError};
use dermatome_shared::{
    device::MAX_TARE_FRAMES,
    protocol::{FrameSource, PatchInfo, Refusal},
    reference::DEFAULT_TARE_FRAMES,
};
use dermatome_simulate::port::Port;
use serde::Serialize;
use std::time::{Duration, Instant};

/// Make the skin, as it is now, the reference: nothing may touch it.
///
/// Where the current is too large for the skin or its contacts, so that voltages or the electrodes' tests clip, it is
/// halved until they do not (`--amplitude auto`); that lasts until the next patch or restart.
#[derive(clap::Args)]
#[command(after_help = "Examples:\n  \
    dermatome tare --port /dev/ttyACM0\n  \
    dermatome tare --port COM5 --frames 100 --amplitude keep")]
pub(super) struct Args {
    /// Where the board is: /dev/ttyACM0, COM5, tcp:HOST:PORT, rs485:LINE#ADDRESS, can:BUS#ADDRESS or sim:SKIN.toml.
    #[arg(long)]
    port: Port,
    /// Frames to average.
    #[arg(
        long,
        default_value_t = DEFAULT_TARE_FRAMES,
        value_parser = clap::value_parser!(u16).range(1..=i64::from(MAX_TARE_FRAMES))
    )]
    frames: u16,
    #[command(flatten)]
    current: Current,
    #[command(flatten)]
    json: super::JsonReport,
}

#[derive(Serialize)]
struct Report<'a> {
    #[serde(flatten)]
    board: BoardReport<'a>,
    frames: u16,
    amplitude_a: f32,
    duration_s: f64,
}

pub(super) fn run(args: &Args) -> anyhow::Result<()> {
    let mut link = open(&args.port)?;
    let mut patch = patch_of(&mut link)?;
    let started = Instant::now();
    args.current.fit(&mut link, &mut patch, || true)?;
    tare_with_spinner(&mut link, &patch, args.frames).map_err(advised)?;
    let duration_s = started.elapsed().as_secs_f64();
    say!("averaged {} frames of `{}` as its reference", args.frames, patch.skin);
    let (board, amplitude_a) = (BoardReport::new(&link, &patch), patch.drive.amplitude);
    args.json.write(&Report { board, frames: args.frames, amplitude_a, duration_s })
}

/// A long tare takes as long as its frames.
pub(super) fn tare_with_spinner(link: &mut Link, patch: &PatchInfo, frames: u16) -> Result<(), LinkError> {
    tare_within(link, frames, link::tare_timeout(patch, frames))
}

/// A tare of a board that may be slower than its frame rate says.
pub(super) fn tare_within(link: &mut Link, frames: u16, timeout: Duration) -> Result<(), LinkError> {
    let spinner = super::progress::spinner();
    spinner.set_message(format!("averaging {frames} frames of the untouched skin"));
    let tared = link::tare(link, frames, timeout);
    spinner.finish_and_clear();
    tared
}

/// The patch on the board, which it must hold, with the drive in effect. Says so if the board's frames
/// mean nothing.
pub(super) fn patch_of(link: &mut Link) -> anyhow::Result<PatchInfo> {
    let info = link.info()?;
    if info.frame_source == FrameSource::Synthetic {
        eprintln!("this board cannot measure yet: its frames are synthetic, numbers without meaning");
    }
    let in_effect = |patch: PatchInfo| PatchInfo { drive: info.drive.unwrap_or(patch.drive), ..patch };
    info.patch
        .map(in_effect)
        .ok_or(Refusal::NoPatch)
        .with_context(|| format!("nothing to measure with at `{}`", link.port()))
}
