//! `dermatome stream`.

mod display;
pub(super) mod fingers;
mod follow;
mod gap;
mod patience;
pub(super) mod session;
mod tally;

use super::{
    BoardReport,
    board::advise,
    contact_lines::is_read,
    current::Current,
    interrupt, link_frame,
    outlets::{Outlets, Record, recorded_in_words},
};
use dermatome_simulate::port::Port;
use display::Display;
use fingers::Fingers;
use follow::{Follower, Received};
use gap::Gap;
use serde::Serialize;
use session::Session;
use std::{collections::BTreeMap, path::PathBuf, time::Duration};
use tally::Tally;

/// Show images and contacts live, or print contacts for a pipe.
///
/// On a terminal, draws the image and the contacts in place. Otherwise prints one line per contact:
/// frame sequence, time in s, x, y and z in mm, area in mm2, strength, on a calibrated skin
/// pressure in kPa and force in N, what was wrong with the frame, and when it came (Unix time in s), separated by
/// tabs. The summary goes to standard error.
///
/// With --skin, contacts are in the frame of the robot's link that the skin lies on, and instead of such
/// lines each frame is one line of JSON with number, position in m and normal of its contacts, and what was
/// wrong with the frame (docs/cli.md). With --fit as well, it also holds fingers that this computer fits to the
/// frame's voltages, which tells apart what lies close together or far from all electrodes.
///
/// A board without a reference makes one first; a current that clips is lowered for it.
///
/// If the board is lost on the way, because it restarts or its cable is pulled, this tries to reach it until it is
/// back, restores drive and stream, and makes a new reference if the board has none. Then it says how long that took
/// and about how many frames were missed, also in its output (docs/cli.md).
#[derive(clap::Args)]
#[command(after_help = "Examples:\n  \
    dermatome stream --port /dev/ttyACM0\n  \
    dermatome stream --port tcp:127.0.0.1:7000 --frames 500 --json stream.json\n  \
    dermatome stream --port COM5 --no-image | tee contacts.tsv\n  \
    dermatome stream --port COM5 --record run.mcap\n  \
    dermatome stream --port /dev/ttyACM0 --skin forearm/skin.toml | my-robot\n  \
    dermatome stream --port /dev/ttyACM0 --skin head/skin.toml --fit '12 mm' | my-robot")]
pub(super) struct Args {
    /// Where the board is: /dev/ttyACM0, COM5, tcp:HOST:PORT, rs485:LINE#ADDRESS, can:BUS#ADDRESS or sim:SKIN.toml.
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
    /// If the board is lost, give up after this time without a frame, with an error; 0 gives up at once.
    #[arg(long, value_name = "SECONDS", value_parser = seconds)]
    give_up_after: Option<Duration>,
    #[command(flatten)]
    current: Current,
    #[command(flatten)]
    record: Record,
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
    frames_dropped: u64,
    frames_flagged: BTreeMap<&'static str, u64>,
    events_lost: u64,
    packets_damaged: u64,
    images_per_second: Option<f64>,
    gaps: &'a [Gap],
    ended: Ended,
}

pub(super) fn run(args: &Args) -> anyhow::Result<()> {
    let radius = args.fit.as_deref().map(fingers::radius).transpose()?;
    interrupt::install()?;
    let mut session = Session::open(&args.port)?;
    let skin = session.patch.skin.clone();
    let link = session.link()?;
    let path = args.skin.as_deref();
    let on_link = path.map(|path| link_frame::skin_of(path, &skin, || Ok(link.surface()?))).transpose()?;
    let pose = on_link.as_ref().map(|(_, pose)| pose);
    let tared_first = session.tare_first(&args.current).map_err(advise)?;
    let link = session.link()?;
    let outlets = args.record.begin(link, path, pose)?;
    let fingers = radius.zip(on_link.as_ref());
    let fingers = fingers.map(|(radius, (skin, _))| Fingers::new(skin, radius, link)).transpose()?;
    let display = Display::new(link, !args.no_image, on_link.as_ref(), fingers.is_some())?;
    let mut follower = Follower::new(args, session, display, fingers, outlets);
    let followed = follower.run();
    let written = is_read(follower.received.display.end());
    let outcome = followed.and_then(|ended| Ok(if written? { ended } else { Ended::Pipe }));
    let (ended, mut error) = match outcome {
        Ok(ended) => (ended, None),
        Err(error) => (Ended::Error, Some(error)),
    };
    let recorded = follower.received.outlets.as_mut().map_or(Ok(None), Outlets::finish_recording);
    match recorded {
        Ok(recorded) => {
            recorded.iter().for_each(|(file, recorded)| eprintln!("{}", recorded_in_words(file, recorded)));
        }
        Err(failed) => error = error.or(Some(failed)),
    }
    let port = args.port.to_string();
    let Follower { session, received: Received { display, tally, gaps, .. }, .. } = &follower;
    if ended != Ended::Pipe {
        summarise(tally, session, gaps, ended);
        let dropped = display.dropped();
        if dropped > 0 {
            eprintln!("{dropped} frames dropped: standard output was not read in time");
        }
    }
    args.json.write(&Report {
        board: session.report(&port),
        link: pose.map(|pose| pose.link.as_str()),
        tared_first,
        frames_received: tally.received(),
        frames_lost: tally.lost(),
        frames_dropped: display.dropped(),
        frames_flagged: tally.flagged().collect(),
        events_lost: session.events_lost(),
        packets_damaged: session.packets_damaged(),
        images_per_second: tally.per_second(),
        gaps,
        ended,
    })?;
    error.map_or(Ok(()), Err)
}

/// A time as somebody states it, s.
pub(super) fn seconds(text: &str) -> Result<Duration, String> {
    let seconds = text.trim().parse().map_err(|_| "allowed: a number of seconds, 0 or more".to_owned())?;
    Duration::try_from_secs_f64(seconds).map_err(|_| "allowed: a number of seconds, 0 or more".to_owned())
}

fn summarise(tally: &Tally, session: &Session<'_>, gaps: &[Gap], ended: Ended) {
    let rate = tally.per_second().map_or(String::new(), |rate| format!(", {rate:.1} images per second"));
    let (received, lost) = (tally.received(), tally.lost());
    let damaged = session.packets_damaged();
    eprintln!("{received} frames received, {lost} lost{rate}, {damaged} packets damaged");
    if !gaps.is_empty() {
        let seconds: f64 = gaps.iter().map(|gap| gap.seconds).sum();
        let missed: u64 = gaps.iter().map(|gap| gap.frames_missed).sum();
        let times = gaps.len();
        eprintln!("the board was lost {times} time(s), for {seconds:.1} s: about {missed} frames missed");
    }
    for (words, frames) in tally.flagged() {
        eprintln!(
            "warning: {words} in {frames} frames: their images may not be right (see `dermatome check`)"
        );
    }
    if ended == Ended::Board {
        eprintln!("the board ended its stream");
    }
}
