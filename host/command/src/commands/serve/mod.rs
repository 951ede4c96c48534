//! `dermatome serve`: all boards of a robot at once.

pub(super) mod lines;
mod onlookers;
mod record;
mod robot;
#[cfg_attr(not(feature = "ros"), path = "without_ros.rs")]
mod ros;
pub(super) mod table;
#[cfg_attr(not(feature = "zenoh"), path = "without_zenoh.rs")]
mod zenoh;

use super::{
    contact_lines::is_read,
    doors::Doors,
    interrupt,
    lines::Lines,
    network::Network,
    outputs::{Kind, Output},
    view::look_of,
};
use anyhow::{Context, bail};
use dermatome_body::{
    Body, Sense,
    file::{BodyFile, Patch},
    keeper::{Asked, Keeper, Phase, Told},
    surface,
};
use dermatome_link::tables::SurfaceTables;
use dermatome_model::skin::Skin;
use dermatome_shared::{pipeline::reflex::Reflexes, protocol::Selection};
use dermatome_urdf::urdf::tree::Joint;
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
/// Each board is kept for itself: one that is lost, or was never there, is tried again until it answers. It gets back the
/// drive that it had and, if it has lost its reference, a new one, but never while something presses. Times are by this
/// computer's clock.
///
/// Prints one line of JSON for each frame and for each change of a board (docs/serve.md); on a terminal a table instead.
#[derive(clap::Args)]
#[command(after_help = "Examples:
  dermatome serve robot.toml
  dermatome serve robot.toml | python3 controller.py
  dermatome serve robot.toml --duration 60 --json report.json > contacts.jsonl
  dermatome serve robot.toml --record run.mcap
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
    /// Record what all boards send to this file: raw frames, images and contacts, with patches and settings (MCAP). Each skin
    /// begins with a new reference once nothing presses, so that `replay` makes the same of it bit for bit.
    #[arg(long, value_name = "FILE.mcap", value_parser = Kind::Recording.parser())]
    record: Option<Output>,
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
    /// Let other computers tare skins and change how they are driven (`dermatome body --tare`). Whoever is let into the network
    /// can: see docs/zenoh.md on strangers.
    #[arg(long)]
    zenoh_orders: bool,
    #[command(flatten)]
    network: Network,
    /// Also serve the page, and the Foxglove WebSocket protocol for other programs, at this address: 127.0.0.1:8765. The page
    /// shows one skin at a time, or, where the body file names a URDF, the whole robot.
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

/// What became of a body.
#[derive(Serialize)]
pub(super) struct Report<'a> {
    body: &'a str,
    seconds: f64,
    patches: Vec<PatchTotals<'a>>,
    /// Of what came from boards, more than could be taken.
    frames_dropped: u64,
    /// Of lines that nobody read in time.
    lines_dropped: u64,
}

/// How a body is served.
pub(super) struct Manner<'a> {
    /// Images come with the contacts.
    pub(super) images: bool,
    /// New references come first.
    pub(super) tare: bool,
    /// It is a node of ROS, in this domain or that of the environment.
    pub(super) ros: Option<Option<u16>>,
    /// It tells other computers, by these settings.
    pub(super) zenoh: Option<&'a Network>,
    /// Those may tare and drive it.
    pub(super) zenoh_orders: bool,
    /// The page is there.
    pub(super) page: Option<(SocketAddr, &'a Doors)>,
    /// It is recorded to this file.
    pub(super) record: Option<&'a Output>,
    /// Its lines go to standard output, unless that is a terminal, and a summary to standard error. A terminal has a table in any
    /// case.
    pub(super) prints: bool,
}

/// Who follows a body that is served, beside those who look on.
pub(super) trait Follower {
    /// Takes what a keeper told of a patch, by its place in the body file, after the body has.
    fn took(&mut self, index: usize, told: &Told, sense: &Sense);

    /// Where a joint is: rad or m.
    fn position(&self, joint: &Joint) -> f64 {
        joint.at_rest()
    }

    /// Whether it has seen all that it wanted to.
    fn is_done(&self) -> bool {
        false
    }
}

/// Nobody does.
struct Nobody;

impl Follower for Nobody {
    fn took(&mut self, _: usize, _: &Told, _: &Sense) {}
}

pub(super) fn run(args: &Args) -> anyhow::Result<()> {
    interrupt::install()?;
    let file = BodyFile::load(&args.body)?;
    warn(&file);
    let manner = Manner {
        images: !args.no_images,
        tare: args.tare || args.record.is_some(),
        ros: args.ros.then_some(args.domain),
        zenoh: args.is_on_network().then_some(&args.network),
        zenoh_orders: args.zenoh_orders,
        page: args.listen.map(|listen| (listen, &args.doors)),
        record: args.record.as_ref(),
        prints: true,
    };
    let is_over = |served| args.duration.is_some_and(|duration| served >= duration);
    serve(&file, &manner, &mut Nobody, is_over, |report| args.json.write(report))
}

/// Says what of the robot is worth a look.
fn warn(file: &BodyFile) {
    let Some(urdf) = &file.urdf else { return };
    urdf.robot.warnings.iter().for_each(|warning| eprintln!("warning: `{}`: {warning}", urdf.path.display()));
}

/// Serves a body until it is over, by the time that it has been served for, or Ctrl-C comes; then has a report written.
pub(super) fn serve(
    file: &BodyFile,
    manner: &Manner<'_>,
    follower: &mut dyn Follower,
    is_over: impl Fn(Duration) -> bool,
    write: impl FnOnce(&Report<'_>) -> anyhow::Result<()>,
) -> anyhow::Result<()> {
    let ros = manner.ros.map(|domain| Ros::start(file, domain)).transpose()?;
    let skins = skins(&file.patches)?;
    let has_onlookers = manner.page.is_some() || manner.record.is_some();
    let onlookers = has_onlookers.then(|| {
        let looks = of_each(&skins, look_of)?;
        let looks = file.patches.iter().map(|patch| looks[&patch.path].clone()).collect();
        Onlookers::open(manner.page, manner.record, file, looks)
    });
    let (sender, told) = sync_channel(MOST_WAITING);
    let dropped = Arc::<AtomicU64>::default();
    let keepers = keepers(file, &skins, selection(manner), &sender, &dropped)?;
    drop(sender);
    if manner.tare {
        keepers.iter().for_each(|keeper| keeper.ask(Asked::Tare));
    }
    // Last, as others know it from here on.
    let zenoh = manner.zenoh.map(|network| Zenoh::start(file, network, manner.zenoh_orders)).transpose()?;
    let mut served =
        Served::new(file, &keepers, onlookers.transpose()?, ros, zenoh, manner.prints, follower)?;
    let begun = Instant::now();
    let ended = served.serve(&told, || interrupt::requested() || is_over(begun.elapsed()));
    let seconds = begun.elapsed().as_secs_f64();
    // Nobody takes what they tell any more.
    drop(told);
    keepers.iter().for_each(Keeper::stop);
    let recorded = served.onlookers.as_mut().map_or(Ok(()), Onlookers::end);
    let written = served.end();
    let senses = served.body.senses();
    if manner.prints {
        senses.iter().for_each(|sense| eprintln!("{}", table::summary(sense)));
    }
    write(&Report {
        body: &file.name,
        seconds,
        patches: senses.iter().map(totals).collect(),
        frames_dropped: dropped.load(Ordering::Relaxed),
        lines_dropped: served.lines.as_ref().map_or(0, Lines::dropped),
    })?;
    ended?;
    recorded?;
    written
}

impl Args {
    fn is_on_network(&self) -> bool {
        self.zenoh || self.zenoh_orders || self.network.is_given()
    }
}

fn keepers(
    file: &BodyFile,
    skins: &OfSkins<Skin>,
    selection: Selection,
    sender: &SyncSender<(usize, Told)>,
    dropped: &Arc<AtomicU64>,
) -> anyhow::Result<Vec<Keeper>> {
    let surfaces = of_each(skins, surface_of)?;
    let keeper = |(index, patch): (usize, &Patch)| {
        let surface = surfaces[&patch.path].clone();
        let keeper = Keeper::start(patch, surface, selection, teller(index, sender.clone(), dropped.clone()));
        keeper.with_context(|| format!("cannot start a thread for `{}`", patch.name))
    };
    file.patches.iter().enumerate().map(keeper).collect()
}

fn selection(manner: &Manner<'_>) -> Selection {
    let images = u16::from(manner.images);
    let is_told = manner.ros.is_some() || manner.zenoh.is_some() || manner.page.is_some();
    let measurements = u16::from(manner.record.is_some());
    // A replay needs that of each frame.
    let health = if measurements > 0 { 1 } else { u16::from(is_told) * HEALTH_EVERY };
    Selection { images, contacts: 1, measurements, health, ..Selection::default() }
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
    follower: &'a mut dyn Follower,
}

impl<'a> Served<'a> {
    fn new(
        file: &'a BodyFile,
        keepers: &'a [Keeper],
        onlookers: Option<Onlookers>,
        ros: Option<Ros>,
        zenoh: Option<Zenoh>,
        prints: bool,
        follower: &'a mut dyn Follower,
    ) -> anyhow::Result<Self> {
        let screen = Screen::default();
        let has_lines = prints && !screen.is_visible();
        let lines = if has_lines { Some(Lines::start(lines::dropped)?) } else { None };
        let drawn = Instant::now();
        let body = Body::new(&file.patches);
        Ok(Self { file, keepers, body, onlookers, lines, screen, drawn, ros, zenoh, follower })
    }

    /// Takes what keepers tell until it is to stop, or nobody reads any more.
    fn serve(&mut self, told: &Receiver<(usize, Told)>, is_over: impl Fn() -> bool) -> anyhow::Result<()> {
        while !is_over() && !self.follower.is_done() {
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
            let by_ros = self.ros.as_mut().map(|ros| ros.attend(&self.body)).unwrap_or_default();
            let by_zenoh = self.zenoh.as_mut().map(|zenoh| zenoh.attend(&self.body)).unwrap_or_default();
            for (index, asked) in by_ros.into_iter().chain(by_zenoh) {
                self.keepers[index].ask(asked);
            }
            if let Some(onlookers) = &mut self.onlookers {
                onlookers.answer(self.keepers, self.body.senses());
                onlookers.tell_states(self.body.senses());
                onlookers.tell_joints(|joint| self.follower.position(joint));
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
        let sense = &self.body.senses()[index];
        let (before, said) = (sense.state.clone(), sense.reflexes.as_ref().map(Reflexes::state));
        let has_frame = self.body.take(index, &told).is_some();
        let sense = &self.body.senses()[index];
        if let Some(onlookers) = &mut self.onlookers {
            onlookers.tell(index, &self.file.patches[index], &told, sense);
        }
        if let Some(ros) = &mut self.ros {
            ros.tell(&self.body, index, &told);
        }
        if let Some(zenoh) = &mut self.zenoh {
            zenoh.tell(&self.body, index, &told);
        }
        self.follower.took(index, &told, sense);
        let Some(lines) = &mut self.lines else { return Ok(true) };
        let has_reflexes = sense.reflexes.as_ref().map(Reflexes::state) != said;
        if let Some(line) = lines::reflexes(sense)?.filter(|_| has_reflexes) {
            lines.remark(&line);
        }
        let line = if sense.state != before {
            lines.remark(&lines::state(sense)?);
            String::new()
        } else if has_frame {
            lines::frame(sense, self.body.wrench(&sense.link))?
        } else if has_reflexes {
            String::new()
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
