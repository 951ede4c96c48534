//! `dermatome demo --robot`: an arm with three skins, served as `serve` does, and touched by a script.

use super::{
    JsonReport,
    doors::Doors,
    interrupt, progress,
    serve::{self, Follower, Manner},
};
use crate::demo::arm::{self, Felt, SECONDS, Scores, TouchScore, Trail};
use anyhow::{Context, bail};
use dermatome_body::{
    Sense,
    file::{BodyFile, Patch},
    keeper::{Phase, State, Told},
};
use dermatome_model::{metrics::mean_and_max, model::Model, quantize};
use dermatome_simulate::{
    Noise, SimulatedSkin,
    board::{BoardOptions, SimulatedBoard},
};
use dermatome_urdf::urdf::tree::Joint;
use serde::Serialize;
use std::{
    f64::consts::TAU,
    net::{Ipv4Addr, SocketAddr, TcpListener},
    time::{Duration, Instant},
};

/// Longest that boards may need until they have played the script, beyond its own length: they are slower where the machine is.
const PATIENCE: Duration = Duration::from_secs(90);
/// Longest until the first of their frames.
const FIRST_FRAME: Duration = Duration::from_secs(20);
/// How far the arm's joints sway to each side, rad, and how long that takes, s.
const SWAY: (f64, f64) = (0.12, 8.0);

/// How the arm is shown.
pub(super) struct Wishes<'a> {
    pub(super) noise: Noise,
    /// Where the page is.
    pub(super) page: Option<SocketAddr>,
    pub(super) no_browser: bool,
    pub(super) ros: bool,
    /// For how long; else until the script has been played, or, with `stays`, until Ctrl-C.
    pub(super) duration: Option<Duration>,
    pub(super) stays: bool,
    pub(super) json: &'a JsonReport,
}

/// What the demo tells; keys are documented in docs/cli.md.
#[derive(Serialize)]
struct Report {
    robot: String,
    noise_db: f64,
    seed: u64,
    build_seconds: f64,
    seconds: f64,
    frames: u64,
    frames_missing: u64,
    #[serde(flatten)]
    scores: Scores,
}

pub(super) fn run(wishes: &Wishes<'_>) -> anyhow::Result<()> {
    let begun = Instant::now();
    let folder = tempfile::tempdir().context("cannot make a temporary folder")?;
    let mut file = BodyFile::load(&arm::unpack(folder.path()).context("cannot write the arm's files")?)?;
    let (boards, felt) = boards(&mut file, wishes.noise)?;
    let build_seconds = begun.elapsed().as_secs_f64();
    let count = boards.len();
    say!(
        "built the patches of {count} skins, each on a simulated board, noise at {} dB",
        wishes.noise.snr_db
    );
    say!("touching them now, for {SECONDS} s of the boards' time");
    let mut audience = Audience::new(felt, wishes.stays || wishes.duration.is_some());
    play(&file, wishes, &mut audience)?;
    let report = Report {
        robot: file.name.clone(),
        noise_db: wishes.noise.snr_db,
        seed: wishes.noise.seed,
        build_seconds,
        seconds: audience.begun.elapsed().as_secs_f64(),
        frames: audience.felt.iter().map(Felt::frames).sum(),
        frames_missing: audience.missing.iter().sum(),
        scores: audience.scores(&file),
    };
    print(&report);
    wishes.json.write(&report)?;
    judge(&report, wishes.duration.is_none() && !interrupt::requested(), &audience.trouble)
}

/// Serves the arm until it is over.
fn play(file: &BodyFile, wishes: &Wishes<'_>, audience: &mut Audience) -> anyhow::Result<()> {
    let doors = Doors::of_this_computer(wishes.no_browser);
    let manner = Manner {
        images: true,
        tare: false,
        ros: wishes.ros.then_some(None),
        zenoh: None,
        zenoh_orders: false,
        page: wishes.page.map(|listen| (listen, &doors)),
        record: None,
        prints: false,
    };
    let limit = wishes.duration.or((!wishes.stays).then_some(PATIENCE + Duration::from_secs_f64(SECONDS)));
    let is_over = |served| limit.is_some_and(|limit| served >= limit);
    serve::serve(file, &manner, audience, is_over, |_| Ok(()))
}

/// An error where touches were not felt; those that never were played are none unless all of the script was to be seen.
fn judge(report: &Report, is_whole: bool, trouble: &str) -> anyhow::Result<()> {
    let touches = report.scores.touches.len();
    match report.scores.missed(is_whole) {
        _ if report.frames == 0 && !interrupt::requested() => {
            bail!(
                "no frame came from the simulated boards: {trouble}; `--noise-db` is {}, allowed: from about 20 on",
                report.noise_db
            )
        }
        0 => Ok(()),
        missed => bail!("{missed} of {touches} touches were not felt: see above"),
    }
}

/// A board for each patch, which gets its port, and what each should feel.
fn boards(file: &mut BodyFile, noise: Noise) -> anyhow::Result<(Vec<SimulatedBoard>, Vec<Felt>)> {
    let made = file.patches.iter_mut().map(|patch| {
        let (board, felt) = board(patch, noise)?;
        patch.port = format!("tcp:{}", board.address()).parse()?;
        Ok((board, felt))
    });
    made.collect()
}

/// The page's usual address on this computer, or, where that is taken, another.
pub(super) fn free_address(usual: u16) -> SocketAddr {
    let usual = SocketAddr::from((Ipv4Addr::LOCALHOST, usual));
    if TcpListener::bind(usual).is_ok() { usual } else { (Ipv4Addr::LOCALHOST, 0).into() }
}

/// A simulated board with a patch's skin and the script of its touches, and what it should feel.
fn board(patch: &Patch, noise: Noise) -> anyhow::Result<(SimulatedBoard, Felt)> {
    let skin = patch.skin.clone().made()?;
    let spinner = progress::spinner();
    let model = Model::build(&skin, |stage| spinner.set_message(format!("{}: {stage}", patch.name)))?;
    let bytes = quantize::patch(&skin, &model)?;
    let outline = &*skin.shape.from_above()?;
    let mut trail = Trail::of(&patch.name, outline);
    let simulated = SimulatedSkin::new(&skin, trail.script(outline)?, noise)?;
    trail.lay(&patch.pose, |at| simulated.truth().lay(at));
    let options =
        BoardOptions { electrodes: skin.electrodes.count, patch: Some(bytes), ..BoardOptions::default() };
    let board = SimulatedBoard::start(options, simulated)?;
    spinner.finish_and_clear();
    Ok((board, Felt::new(trail, skin.drive.frame_rate)))
}

/// Compares what comes with what touches the arm, and lets it sway.
struct Audience {
    /// `[patch]`
    felt: Vec<Felt>,
    begun: Instant,
    /// Whether it goes on when the script has been played.
    stays: bool,
    /// Frames that have not come: `[patch]`.
    missing: Vec<u64>,
    /// Why a board was lost last.
    trouble: String,
}

impl Follower for Audience {
    fn took(&mut self, index: usize, told: &Told, sense: &Sense) {
        match told {
            // A stream begins, and with it the script.
            Told::Reference(_) => self.felt[index].begin(),
            Told::State(State { phase: Phase::Lost, text }) => self.trouble.clone_from(text),
            Told::Frame { frame, .. } if frame.contacts.is_some() => {
                sense.report.iter().for_each(|report| self.felt[index].take(report));
                self.missing[index] = sense.missing;
            }
            _ => {}
        }
    }

    fn position(&self, joint: &Joint) -> f64 {
        let (far, seconds) = SWAY;
        joint.at_rest() + far * (TAU * self.begun.elapsed().as_secs_f64() / seconds).sin()
    }

    fn is_done(&self) -> bool {
        let is_mute =
            || self.begun.elapsed() > FIRST_FRAME && self.felt.iter().all(|felt| felt.frames() == 0);
        !self.stays && (self.felt.iter().all(|felt| felt.seen() >= SECONDS) || is_mute())
    }
}

impl Audience {
    fn new(felt: Vec<Felt>, stays: bool) -> Self {
        let missing = vec![0; felt.len()];
        Self { felt, begun: Instant::now(), stays, missing, trouble: String::new() }
    }

    fn scores(&self, file: &BodyFile) -> Scores {
        let mut scores = Scores::default();
        for (patch, felt) in file.patches.iter().zip(&self.felt) {
            felt.score_into(&mut scores, &patch.name, &patch.pose.link);
        }
        scores
    }
}

fn print(report: &Report) {
    let Scores { touches, contacts_of_nothing } = &report.scores;
    let Report { build_seconds, seconds, frames, frames_missing, .. } = report;
    say!(
        "touched them for {seconds:.1} s, after {build_seconds:.1} s of building; {frames} frames, {frames_missing} missing"
    );
    say!("");
    say!("{:10} {:10} {:>22}   {:>12}   error, mm", "skin", "link", "place on the link, mm", "frames felt");
    touches.iter().for_each(|touch| say!("{}", line(touch)));
    say!("");
    say!(
        "touches felt            {} of {}",
        touches.iter().filter(|touch| touch.is_felt()).count(),
        touches.len()
    );
    let mean = mean_and_max(touches.iter().filter_map(|touch| touch.error_mm_mean));
    let worst = mean_and_max(touches.iter().filter_map(|touch| touch.error_mm_max));
    if let (Some((mean, _)), Some((_, worst))) = (mean, worst) {
        say!("place error             mean {mean:.2} mm, worst {worst:.2} mm, in the links' frames");
    }
    say!("contacts of nothing     {contacts_of_nothing}");
    say!("forces                  none: the skins are not calibrated");
}

fn line(touch: &TouchScore) -> String {
    let [from, to] =
        touch.place_mm.map(|place| place.map(|mm| format!("{:.0}", mm.round() + 0.0)).join(", "));
    let stroke = if from == to { String::new() } else { format!("  stroke to {to}") };
    let error = match (touch.error_mm_mean, touch.error_mm_max) {
        (Some(mean), Some(worst)) => format!("mean {mean:.2}, worst {worst:.2}"),
        _ if touch.frames == 0 => "not played".to_owned(),
        _ => "not felt".to_owned(),
    };
    let felt = format!("{} of {}", touch.frames_felt, touch.frames);
    format!("{:10} {:10} {from:>22}   {felt:>12}   {error}{stroke}", touch.patch, touch.link)
}
