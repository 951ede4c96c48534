//! `dermatome stream`.

mod display;
mod fingers;
mod tally;

use super::{
    BoardReport,
    board::{advised, open},
    contact_lines::is_read,
    interrupt, link_frame,
    tare::{patch_of, tare_with_spinner},
};
use dermatome_link::{Link, LinkError, LinkErrorKind, ScanFrame, Subscription};
use dermatome_shared::{
    protocol::{PatchInfo, Selection},
    reference::DEFAULT_TARE_FRAMES,
};
use dermatome_simulate::port::Port;
use display::Display;
use fingers::Fingers;
use serde::Serialize;
use std::{
    collections::BTreeMap,
    path::PathBuf,
    time::{Duration, Instant},
};
use tally::Tally;

/// Frames that may fail to come before the board is asked whether it still streams.
const TIMEOUT_FRAMES: f64 = 5.0;

/// Show images and contacts live, or print contacts for a pipe.
///
/// On a terminal, draws the image and the contacts in place. Otherwise prints one line per contact:
/// frame sequence, time in s, x, y and z in mm, area in mm2, strength, on a calibrated skin
/// pressure in kPa and force in N, and what was wrong with the frame, separated by tabs. The summary goes to
/// standard error.
///
/// With --skin, contacts are in the frame of the robot's link that the skin lies on, and instead of such
/// lines each frame is one line of JSON with number, position in m and normal of its contacts, and what was
/// wrong with the frame (docs/cli.md). With --fit as well, it also holds fingers that this computer fits to the
/// frame's voltages, which tells apart what lies close together or far from all electrodes.
#[derive(clap::Args)]
#[command(after_help = "Examples:\n  \
    dermatome stream --port /dev/ttyACM0\n  \
    dermatome stream --port tcp:127.0.0.1:7000 --frames 500 --json stream.json\n  \
    dermatome stream --port COM5 --no-image | tee contacts.tsv\n  \
    dermatome stream --port /dev/ttyACM0 --skin forearm/skin.toml | my-robot\n  \
    dermatome stream --port /dev/ttyACM0 --skin head/skin.toml --fit '12 mm' | my-robot")]
pub(super) struct Args {
    /// Where the board is: /dev/ttyACM0, COM5, tcp:HOST:PORT or sim:SKIN.toml.
    #[arg(long)]
    port: Port,
    /// Stop after this many frames, instead of at Ctrl-C.
    #[arg(long, value_parser = clap::value_parser!(u64).range(1..))]
    frames: Option<u64>,
    /// Do not fetch and draw images.
    #[arg(long)]
    no_image: bool,
    /// Skin file of the board's patch: give contacts in the link's frame, by its [pose].
    #[arg(long, value_name = "FILE")]
    skin: Option<PathBuf>,
    /// Fit fingers of about this radius to the voltages, and print them as JSON with the contacts.
    #[arg(long, alias = "resolve", value_name = "RADIUS", requires = "skin")]
    fit: Option<String>,
    #[command(flatten)]
    json: super::JsonReport,
}

/// Why streaming ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
enum Ended {
    /// All frames asked for have come.
    Frames,
    /// The user asked for it.
    Interrupt,
    /// The board ended its stream.
    Board,
    /// Whoever read standard output has gone.
    Pipe,
    /// The link was cut, or something else failed.
    Error,
}

#[derive(Serialize)]
struct Report<'a> {
    #[serde(flatten)]
    board: BoardReport<'a>,
    link: Option<&'a str>,
    tared_first: bool,
    frames_received: u64,
    frames_lost: u64,
    frames_flagged: BTreeMap<&'static str, u64>,
    events_lost: u64,
    packets_damaged: u64,
    images_per_second: Option<f64>,
    ended: Ended,
}

pub(super) fn run(args: &Args) -> anyhow::Result<()> {
    let radius = args.fit.as_deref().map(fingers::radius).transpose()?;
    interrupt::install()?;
    let mut link = open(&args.port)?;
    let patch = patch_of(&mut link)?;
    let path = args.skin.as_deref();
    let on_link =
        path.map(|path| link_frame::skin_of(path, &patch.skin, || Ok(link.surface()?))).transpose()?;
    let pose = on_link.as_ref().map(|(_, pose)| pose);
    let tared_first = tare_if_needed(&mut link, &patch)?;
    let fingers = radius.zip(on_link.as_ref());
    let mut fingers = fingers.map(|(radius, (skin, _))| Fingers::new(skin, radius, &mut link)).transpose()?;
    let mut display = Display::new(&mut link, !args.no_image, pose, fingers.is_some())?;
    let mut tally = Tally::default();
    let (ended, error) = match follow(args, &mut link, &patch, &mut display, &mut fingers, &mut tally) {
        Ok(ended) => (ended, None),
        Err(error) => (Ended::Error, Some(error)),
    };
    if ended != Ended::Pipe {
        summarise(&tally, &link, ended);
    }
    args.json.write(&Report {
        board: BoardReport::new(&link, &patch),
        link: pose.map(|pose| pose.link.as_str()),
        tared_first,
        frames_received: tally.received(),
        frames_lost: tally.lost(),
        frames_flagged: tally.flagged().collect(),
        events_lost: link.events_lost(),
        packets_damaged: link.packets_damaged(),
        images_per_second: tally.per_second(),
        ended,
    })?;
    error.map_or(Ok(()), Err)
}

/// Without a reference there are no images: makes one and says so.
fn tare_if_needed(link: &mut Link, patch: &PatchInfo) -> anyhow::Result<bool> {
    if link.info()?.tared {
        return Ok(false);
    }
    let frames = DEFAULT_TARE_FRAMES;
    eprintln!("the board has no reference yet: averaging {frames} frames, do not touch the skin");
    tare_with_spinner(link, patch, frames).map_err(advised)?;
    Ok(true)
}

/// Starts the stream, shows it until it ends, and stops it.
fn follow(
    args: &Args,
    link: &mut Link,
    patch: &PatchInfo,
    display: &mut Display,
    fingers: &mut Option<Fingers>,
    tally: &mut Tally,
) -> anyhow::Result<Ended> {
    let images = u16::from(display.wants_images());
    let measurements = u16::from(fingers.is_some());
    let selection = Selection { images, contacts: 1, measurements, ..Selection::default() };
    let mut stream = link.subscribe(selection)?;
    let ended = loop {
        if let Some(ended) = asked_to_end(args, tally) {
            break ended;
        }
        let frame = match next(&mut stream, frame_timeout(patch))? {
            Next::Frame(frame) => frame,
            Next::None(ended) => break ended,
        };
        let new = tally.count(&frame, stream.totals(), Instant::now());
        display.warn(&frame, &new);
        let fingers = match (fingers.as_mut(), &frame.measurements) {
            (Some(fingers), Some(measurements)) => fingers.of_frame(&measurements.codes, stream.link())?,
            _ => None,
        };
        if !is_read(display.show(&frame, fingers.as_deref()))? {
            break Ended::Pipe;
        }
    };
    stream.stop()?;
    Ok(ended)
}

/// A frame, or why there is none.
enum Next {
    Frame(Box<ScanFrame>),
    None(Ended),
}

/// Waits for the next frame. A board that is silent for `timeout` is asked whether it still streams.
fn next(stream: &mut Subscription<'_>, timeout: Duration) -> Result<Next, LinkError> {
    loop {
        match stream.next_while(timeout, || !interrupt::requested()) {
            Ok(Some(frame)) => return Ok(Next::Frame(Box::new(frame))),
            Ok(None) => return Ok(Next::None(Ended::Interrupt)),
            Err(LinkError { kind: LinkErrorKind::NoAnswer { .. }, .. }) => {
                if !stream.link().info()?.streaming.any() {
                    return Ok(Next::None(Ended::Board));
                }
            }
            Err(error) => return Err(error),
        }
    }
}

fn asked_to_end(args: &Args, tally: &Tally) -> Option<Ended> {
    if interrupt::requested() {
        return Some(Ended::Interrupt);
    }
    args.frames.is_some_and(|frames| tally.received() >= frames).then_some(Ended::Frames)
}

/// Longest silence before the board is asked: five frames, and at least a second.
fn frame_timeout(patch: &PatchInfo) -> Duration {
    let least = Duration::from_secs(1);
    let frames = Duration::try_from_secs_f64(TIMEOUT_FRAMES / f64::from(patch.drive.frame_rate));
    frames.unwrap_or(least).clamp(least, Duration::from_secs(3600))
}

/// Longest silence where a board must send something: five frames, and at least five seconds.
pub(super) fn silence_timeout(patch: &PatchInfo) -> Duration {
    frame_timeout(patch).max(Duration::from_secs(5))
}

fn summarise(tally: &Tally, link: &Link, ended: Ended) {
    let rate = tally.per_second().map_or(String::new(), |rate| format!(", {rate:.1} images per second"));
    let (received, lost) = (tally.received(), tally.lost());
    let damaged = link.packets_damaged();
    eprintln!("{received} frames received, {lost} lost{rate}, {damaged} packets damaged");
    for (words, frames) in tally.flagged() {
        eprintln!(
            "warning: {words} in {frames} frames: their images may not be right (see `dermatome check`)"
        );
    }
    if ended == Ended::Board {
        eprintln!("the board ended its stream");
    }
}
