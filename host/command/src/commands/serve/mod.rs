//! `dermatome serve`: all boards of a robot at once.

pub(super) mod lines;
mod onlookers;
#[cfg_attr(not(feature = "ros"), path = "without_ros.rs")]
mod ros;
pub(super) mod table;
#[cfg_attr(not(feature = "zenoh"), path = "without_zenoh.rs")]
mod zenoh;

use super::{contact_lines::is_read, doors::Doors, interrupt, lines::Lines, network::Network, view::look_of};
use anyhow::{Context, bail};
use dermatome_body::{
    Body, Sense,
    file::{BodyFile, Patch},
    keeper::{Keeper, Phase, Told},
    surface,
};
use dermatome_link::tables::SurfaceTables;
use dermatome_model::skin::Skin;
use dermatome_shared::protocol::Selection;
use dermatome_view::terminal::Screen;
use onlookers::Onlookers;
use ros::Ros;
use serde::Serialize;
use std::{
    collections::HashMap,
    net::SocketAddr,
    path::PathBuf,
    sync::{
        Arc,
        atomic::{AtomicU64, Ordering},
        mpsc::{Receiver, RecvTimeoutError, SyncSender, TrySendError, sync_channel},
    },
    time::{Duration, Instant},
};
use zenoh::Zenoh;

/// Most that waits to be taken, a quarter of a second of 32 boards at 400 frames/s.
const MOST_WAITING: usize = 4096;
/// Longest wait without looking for Ctrl-C.
const LOOK: Duration = Duration::from_millis(20);
/// Of so many frames one tells the board's health, where somebody is told.
const HEALTH_EVERY: u16 = 25;
/// How often the table is drawn.
const DRAWN: Duration = Duration::from_millis(500);

/// Run all boards of a robot: contacts of every skin in its link's frame, and what presses on each link.
///
/// Each board is kept for itself: one that is lost, or was never there, is tried again until it answers, and gets back the
/// drive and the reference that it had. It never gets a new reference while something presses. Times are by this
/// computer's clock.
///
/// Prints one line of JSON for each frame and for each change of a board (docs/serve.md); on a terminal a table instead.
#[derive(clap::Args)]
#[command(after_help = "Examples:
  dermatome serve robot.toml
  dermatome serve robot.toml | python3 controller.py
  dermatome serve robot.toml --duration 60 --json report.json > contacts.jsonl
  ROS_DOMAIN_ID=7 dermatome serve robot.toml --ros
  dermatome serve left-arm.toml --zenoh --zenoh-connect tcp/192.168.0.10:7447

The body file (docs/serve.md) names the skins:
  name = \"arm\"
  [[patches]]
  skin = \"forearm-skin/skin.toml\"
  port = \"/dev/ttyACM0\"")]
pub(super) struct Args {
    /// Body file: robot.toml.
    #[arg(value_name = "BODY")]
    body: PathBuf,
    /// Do not fetch images: contacts come without active pixels, moments and geometric centres.
    #[arg(long)]
    no_images: bool,
    /// Stop after so many seconds, instead of at Ctrl-C.
    #[arg(long, value_name = "SECONDS", value_parser = super::stream::seconds)]
    duration: Option<Duration>,
    /// Make new references first, once nothing presses; else only boards without one get one.
    #[arg(long)]
    tare: bool,
    /// Be a node of ROS 2 too (docs/ros.md), in a program built with `--features ros`.
    #[arg(long)]
    ros: bool,
    /// Domain of ROS 2: 0 to 232, instead of what ROS_DOMAIN_ID says.
    #[arg(long, value_name = "N", requires = "ros", value_parser = clap::value_parser!(u16).range(0..=232))]
    domain: Option<u16>,
    /// Also tell other computers, which `dermatome body` joins (docs/zenoh.md), in a program built with `--features zenoh`.
    #[arg(long)]
    zenoh: bool,
    #[command(flatten)]
    network: Network,
    /// Also serve the page, and the Foxglove WebSocket protocol for other programs, at this address: 127.0.0.1:8765. The page
    /// shows one skin at a time.
    #[arg(long, value_name = "HOST:PORT")]
    listen: Option<SocketAddr>,
    #[command(flatten)]
    doors: Doors,
    #[command(flatten)]
    json: super::JsonReport,
}

/// What became of one skin.
#[derive(Serialize)]
struct PatchTotals<'a> {
    patch: &'a str,
    link: &'a str,
    state: Phase,
    text: &'a str,
    frames: u64,
    frames_missing: u64,
    losses: u64,
    jitter_median_ms: Option<f64>,
    jitter_largest_ms: Option<f64>,
    clock_skew_ppm: Option<f64>,
}

#[derive(Serialize)]
struct Report<'a> {
    body: &'a str,
    seconds: f64,
    patches: Vec<PatchTotals<'a>>,
    /// Of what came from boards, more than could be taken.
    frames_dropped: u64,
    /// Of lines that nobody read in time.
    lines_dropped: u64,
}

pub(super) fn run(args: &Args) -> anyhow::Result<()> {
    interrupt::install()?;
    let file = BodyFile::load(&args.body)?;
    let ros = args.ros.then(|| Ros::start(&file, args.domain)).transpose()?;
    let zenoh = args.is_on_network().then(|| Zenoh::start(&file, &args.network)).transpose()?;
    let skins = skins(&file.patches)?;
    let onlookers = args.listen.map(|listen| {
        let looks = of_each(&skins, look_of)?;
        let looks = file.patches.iter().map(|patch| looks[&patch.path].clone()).collect();
        Onlookers::open(&args.doors, listen, &file, looks)
    });
    let surfaces = of_each(&skins, surface_of)?;
    let (sender, told) = sync_channel(MOST_WAITING);
    let dropped = Arc::<AtomicU64>::default();
    let keepers = file.patches.iter().enumerate().map(|(index, patch)| {
        let surface = surfaces[&patch.path].clone();
        let keeper =
            Keeper::start(patch, surface, selection(args), teller(index, sender.clone(), dropped.clone()));
        keeper.with_context(|| format!("cannot start a thread for `{}`", patch.name))
    });
    let keepers = keepers.collect::<anyhow::Result<Vec<_>>>()?;
    drop(sender);
    if args.tare {
        keepers.iter().for_each(Keeper::tare);
    }
    let mut served = Served::new(&file, &keepers, onlookers.transpose()?, ros, zenoh)?;
    let begun = Instant::now();
    let ended = served.serve(&told, || {
        interrupt::requested() || args.duration.is_some_and(|duration| begun.elapsed() >= duration)
    });
    let seconds = begun.elapsed().as_secs_f64();
    // Nobody takes what they tell any more.
    drop(told);
    keepers.iter().for_each(Keeper::stop);
    let written = served.end();
    let senses = served.body.senses();
    senses.iter().for_each(|sense| eprintln!("{}", table::summary(sense)));
    args.json.write(&Report {
        body: &file.name,
        seconds,
        patches: senses.iter().map(totals).collect(),
        frames_dropped: dropped.load(Ordering::Relaxed),
        lines_dropped: served.lines.as_ref().map_or(0, Lines::dropped),
    })?;
    ended?;
    written
}

impl Args {
    fn is_on_network(&self) -> bool {
        self.zenoh || self.network.is_given()
    }
}

fn selection(args: &Args) -> Selection {
    let images = u16::from(!args.no_images);
    let is_told = args.ros || args.is_on_network() || args.listen.is_some();
    let health = if is_told { HEALTH_EVERY } else { 0 };
    Selection { images, contacts: 1, health, ..Selection::default() }
}

/// Something of each skin file.
type OfSkins<T> = HashMap<PathBuf, T>;

/// The skin of each file.
fn skins(patches: &[Patch]) -> anyhow::Result<OfSkins<Skin>> {
    let mut skins = HashMap::new();
    for Patch { path, skin, .. } in patches {
        if !skins.contains_key(path) {
            skins.insert(path.clone(), skin.clone().made()?);
        }
    }
    Ok(skins)
}

fn of_each<T>(
    skins: &OfSkins<Skin>,
    make: impl Fn(&Skin) -> anyhow::Result<T>,
) -> anyhow::Result<OfSkins<T>> {
    let made = skins.iter().map(|(path, skin)| {
        let made = make(skin).with_context(|| format!("skin file `{}`", path.display()));
        Ok((path.clone(), made?))
    });
    made.collect()
}

/// Where the pixels of a skin lie.
fn surface_of(skin: &Skin) -> anyhow::Result<SurfaceTables> {
    surface::of_skin(skin)?.context("its image has more pixels than a board takes")
}

/// Passes on what a keeper tells; a frame that finds no room is dropped and counted.
fn teller(
    index: usize,
    sender: SyncSender<(usize, Told)>,
    dropped: Arc<AtomicU64>,
) -> impl FnMut(Told) + Send + 'static {
    move |told| {
        let is_frame = matches!(told, Told::Frame { .. });
        let sent = if is_frame {
            sender.try_send((index, told))
        } else {
            sender.send((index, told)).map_err(|error| TrySendError::Disconnected(error.0))
        };
        if let Err(TrySendError::Full(_)) = sent {
            dropped.fetch_add(1, Ordering::Relaxed);
        }
    }
}

/// The body and where its contacts go.
struct Served<'a> {
    file: &'a BodyFile,
    keepers: &'a [Keeper],
    body: Body,
    onlookers: Option<Onlookers>,
    /// Standard output, unless it is a terminal.
    lines: Option<Lines>,
    screen: Screen,
    drawn: Instant,
    ros: Option<Ros>,
    zenoh: Option<Zenoh>,
}

impl<'a> Served<'a> {
    fn new(
        file: &'a BodyFile,
        keepers: &'a [Keeper],
        onlookers: Option<Onlookers>,
        ros: Option<Ros>,
        zenoh: Option<Zenoh>,
    ) -> anyhow::Result<Self> {
        let screen = Screen::default();
        let lines = if screen.is_visible() { None } else { Some(Lines::start(lines::dropped)?) };
        let drawn = Instant::now();
        let body = Body::new(&file.patches);
        Ok(Self { file, keepers, body, onlookers, lines, screen, drawn, ros, zenoh })
    }

    /// Takes what keepers tell until it is to stop, or nobody reads any more.
    fn serve(&mut self, told: &Receiver<(usize, Told)>, is_over: impl Fn() -> bool) -> anyhow::Result<()> {
        while !is_over() {
            let update = match told.recv_timeout(LOOK) {
                Ok(update) => Some(update),
                Err(RecvTimeoutError::Timeout) => None,
                Err(RecvTimeoutError::Disconnected) => bail!("no board can be tried again"),
            };
            if let Some(update) = update
                && !self.take(update)?
            {
                return Ok(());
            }
            if let Some(ros) = &mut self.ros {
                ros.attend(&self.body, self.keepers);
            }
            if let Some(zenoh) = &mut self.zenoh {
                zenoh.attend(&self.body);
            }
            if let Some(onlookers) = &mut self.onlookers {
                onlookers.answer(self.keepers, self.body.senses());
                onlookers.tell_states(self.body.senses());
            }
            if self.lines.is_none() && self.drawn.elapsed() >= DRAWN {
                self.drawn = Instant::now();
                self.screen.draw(&table::table(&self.file.name, self.body.senses()))?;
            }
        }
        Ok(())
    }

    /// Takes what a keeper told; false if nobody reads any more.
    fn take(&mut self, (index, told): (usize, Told)) -> anyhow::Result<bool> {
        let before = self.body.senses()[index].state.clone();
        let has_frame = self.body.take(index, &told).is_some();
        let sense = &self.body.senses()[index];
        if let Some(onlookers) = &mut self.onlookers {
            onlookers.tell(index, &self.file.patches[index], &told);
        }
        if let Some(ros) = &mut self.ros {
            ros.tell(&self.body, index, &told);
        }
        if let Some(zenoh) = &mut self.zenoh {
            zenoh.tell(&self.body, index, &told);
        }
        let Some(lines) = &mut self.lines else { return Ok(true) };
        let line = if sense.state != before {
            lines.remark(&lines::state(sense)?);
            String::new()
        } else if has_frame {
            lines::frame(sense, self.body.wrench(&sense.link))?
        } else {
            return Ok(true);
        };
        Ok(is_read(lines.frame(line))?)
    }

    fn end(&mut self) -> anyhow::Result<()> {
        if let Some(ros) = &mut self.ros {
            ros.end(&self.body);
        }
        if let Some(zenoh) = self.zenoh.take() {
            zenoh.end();
        }
        if let Some(lines) = &mut self.lines {
            is_read(lines.end())?;
        }
        Ok(())
    }
}

fn totals(sense: &Sense) -> PatchTotals<'_> {
    let jitter = sense.jitter();
    let ms = |ns: u64| ns as f64 * 1e-6;
    PatchTotals {
        patch: &sense.name,
        link: &sense.link,
        state: sense.state.phase,
        text: &sense.state.text,
        frames: sense.frames,
        frames_missing: sense.missing,
        losses: sense.losses,
        jitter_median_ms: jitter.map(|jitter| ms(jitter.median_ns)),
        jitter_largest_ms: jitter.map(|jitter| ms(jitter.largest_ns)),
        clock_skew_ppm: jitter.map(|jitter| jitter.skew * 1e6),
    }
}
