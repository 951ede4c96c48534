//! `dermatome simulate`: a board to try everything on, without one.

use super::{
    JsonReport,
    flags::in_flags,
    interrupt,
    noise::NoiseOptions,
    outputs::{Kind, Output},
};
use anyhow::{Context, bail};
use dermatome_geometry::outline::Outline;
use dermatome_model::skin::Skin;
use dermatome_simulate::{
    Hand, Press, Script, SimulatedSkin, TimedFault,
    board::{BoardOptions, SimulatedBoard},
    material::Material,
};
use serde::Serialize;
use std::{
    io,
    net::{SocketAddr, ToSocketAddrs},
    path::{Path, PathBuf},
    thread::{self, JoinHandle},
    time::Duration,
};

/// Run a simulated board: the board's own code, fed by a simulated skin.
///
/// It answers on a TCP port as a board does on its serial port: it takes a patch, tares, and streams
/// at the patch's frame rate. Its fingers touch the skin only while it streams, and begin their
/// script anew with every stream, so that a tare always sees the untouched skin.
#[derive(clap::Args)]
#[command(after_help = "Examples:
  dermatome simulate models/disc-210mm/skin.toml --listen tcp:127.0.0.1:7000
  dermatome simulate models/disc-210mm/skin.toml --press 0.03,-0.02,0.012,1 --noise-db 50 --seed 7
  dermatome simulate models/square-50mm/skin.toml --path fingers.csv --store board.dermatome
  python3 presses.py | dermatome simulate models/disc-210mm/skin.toml --live \\
      --material models/materials/sample-1.toml
then, in another terminal:
  dermatome flash disc-210mm.dermatome --port tcp:127.0.0.1:7000
  dermatome stream --port tcp:127.0.0.1:7000")]
pub(super) struct Args {
    /// Skin file of the simulated skin.
    #[arg(value_name = "SKIN")]
    skin: PathBuf,
    /// Where to listen; port 0 takes a free one.
    #[arg(long, default_value = "tcp:127.0.0.1:7000", value_name = "PORT")]
    listen: String,
    /// Let hosts on other machines in: needed for an address that is not this machine's own (127.0.0.1). Whoever
    /// reaches it can read the skin and replace its patch.
    #[arg(long)]
    allow_remote: bool,
    /// End the stream after this many frames, and the board when its host then leaves.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(1..))]
    frames: Option<u64>,
    #[command(flatten)]
    noise: NoiseOptions,
    /// A finger that rests: x,y,radius,depth (m, m, m, relative conductivity change); may be repeated.
    #[arg(long, value_name = "X,Y,RADIUS,DEPTH", conflicts_with = "path", allow_hyphen_values = true)]
    press: Vec<Press>,
    /// Moving indenters: CSV with the columns time_s,finger,x_m,y_m, a shape and a load (docs/cli.md).
    #[arg(long, value_name = "FILE")]
    path: Option<PathBuf>,
    /// Press as lines on standard input say, each from then on: {"presses": [{"x_m": 0.01, "y_m": 0, "radius_m": 0.008,
    /// "force_n": 2}]}, with the columns of a path file as keys. What is beside the skin presses nothing.
    #[arg(long, conflicts_with_all = ["path", "press"])]
    live: bool,
    /// Material file of the sheet, for loads in kPa and N (models/materials).
    #[arg(long, value_name = "FILE")]
    material: Option<PathBuf>,
    /// What is wrong with its wires: open:3, short:3-4, contact:3+500 (ohm) or exchanged:5-6, from the start or as many
    /// seconds into the script (open:3@8s). Electrodes count from 1. May be repeated.
    #[arg(long = "fault", value_name = "FAULT")]
    faults: Vec<TimedFault>,
    /// Keep the uploaded patch in this file, as a board keeps it in its flash.
    #[arg(long, value_name = "FILE", value_parser = Kind::Patch.parser())]
    store: Option<Output>,
    #[command(flatten)]
    json: JsonReport,
}

/// What `simulate` tells once it listens; keys are documented in docs/cli.md.
#[derive(Serialize)]
struct Report<'a> {
    port: String,
    skin: &'a str,
    electrodes: u8,
    simulated_elements: usize,
    noise_db: f64,
    seed: u64,
}

/// How often to look for Ctrl-C.
const POLL: Duration = Duration::from_millis(50);

pub(super) fn run(args: &Args) -> anyhow::Result<()> {
    interrupt::install()?;
    let listen = Listen::new(&args.listen, args.allow_remote).address()?;
    let skin = Skin::load(&args.skin)?.made()?;
    let outline = skin.shape.from_above()?.into_owned();
    let script = script(args, &outline)?;
    let in_file = || format!("skin file `{}`", args.skin.display());
    let noise = args.noise.noise();
    anyhow::ensure!(
        args.material.is_some() || !script.needs_material(),
        "the path presses with pressures or forces, which say nothing without a material: give `--material`"
    );
    let mut source = SimulatedSkin::new(&skin, script, noise).with_context(in_file)?;
    if let Some(path) = &args.material {
        source = source.of_material(Material::load(path)?);
    }
    let hand = Hand::default();
    source = source.pressed_by(hand.clone());
    check_faults(&args.faults, skin.electrodes.count)?;
    source = source.with_faults(args.faults.clone());
    let simulated_elements = source.elements();
    let options = BoardOptions {
        listen,
        electrodes: skin.electrodes.count,
        store: args.store.as_deref().map(Path::to_owned),
        max_frames: args.frames,
        ..BoardOptions::default()
    };
    let board = SimulatedBoard::start(options, source)?;
    let report = Report {
        port: format!("tcp:{}", board.address()),
        skin: &skin.name,
        electrodes: skin.electrodes.count,
        simulated_elements,
        noise_db: noise.snr_db,
        seed: noise.seed,
    };
    say!(
        "simulated board with skin {} ({simulated_elements} elements) listens at {}",
        skin.name,
        report.port
    );
    args.json.write(&report)?;
    let mut told = args.live.then(|| follow(hand, outline, args.material.is_some()));
    keep_running_while(board, || match told.take_if(|told| told.is_finished()) {
        Some(told) => told.join().unwrap_or(Ok(())),
        None => Ok(()),
    })
}

/// Presses as standard input tells, to its end; then nothing presses any more.
fn follow(hand: Hand, outline: Outline, has_material: bool) -> JoinHandle<anyhow::Result<()>> {
    thread::spawn(move || {
        for (number, line) in (1..).zip(io::stdin().lines()) {
            let line = line.context("cannot read standard input")?;
            let followed = match line.trim() {
                "" => Ok(()),
                line => hand.follow(line, &outline, has_material),
            };
            followed
                .map_err(|error| in_flags(error, &FLAGS))
                .with_context(|| format!("standard input, line {number}"))?;
        }
        hand.press(Vec::new());
        Ok(())
    })
}

/// What sets the parameters that the library's errors name.
const FLAGS: [(&str, &str); 1] = [("`material`", "`--material`")];

/// Until the board has ended, or the user asks for it.
pub(super) fn keep_running(board: SimulatedBoard) -> anyhow::Result<()> {
    keep_running_while(board, || Ok(()))
}

/// The same, or until something goes wrong.
fn keep_running_while(
    board: SimulatedBoard,
    mut is_well: impl FnMut() -> anyhow::Result<()>,
) -> anyhow::Result<()> {
    while !interrupt::requested() && !board.is_finished() {
        thread::sleep(POLL);
        is_well()?;
    }
    Ok(board.stop()?)
}

fn script(args: &Args, outline: &Outline) -> anyhow::Result<Script> {
    match &args.path {
        Some(path) => Ok(Script::load(path, outline)?),
        None if args.live => Ok(Script::nobody()),
        None if args.press.is_empty() => Ok(Script::round(outline)),
        None => Script::still(&args.press, outline).context("`--press`"),
    }
}

/// Faults are of electrodes that the skin has.
fn check_faults(faults: &[TimedFault], electrodes: u8) -> anyhow::Result<()> {
    for fault in faults.iter().map(|timed| timed.fault) {
        let beyond = fault.electrodes().into_iter().find(|&electrode| electrode >= electrodes);
        if let Some(electrode) = beyond {
            bail!("`--fault` is {fault}: there is no electrode {}, the skin has {electrodes}", electrode + 1);
        }
    }
    Ok(())
}

/// Where a board is to answer, as people write it.
pub(super) struct Listen<'a> {
    text: &'a str,
    allow_remote: bool,
}

impl<'a> Listen<'a> {
    pub(super) fn new(text: &'a str, allow_remote: bool) -> Self {
        Self { text, allow_remote }
    }

    /// The address; one that other machines reach must be meant. Unlike the ports of other commands, it may be 0.
    pub(super) fn address(&self) -> anyhow::Result<SocketAddr> {
        let text = self.text;
        let Some(address) = text.strip_prefix("tcp:") else {
            bail!("`--listen` is {text:?}; allowed: tcp:HOST:PORT");
        };
        let mut found = address.to_socket_addrs().with_context(|| format!("cannot find `{text}`"))?;
        let address = found.next().with_context(|| format!("cannot find `{text}`"))?;
        if address.ip().is_loopback() {
            return Ok(address);
        }
        anyhow::ensure!(
            self.allow_remote,
            "`--listen` is {text}, which other machines may reach, and whoever does so can replace the board's patch: if that \
             is meant, give `--allow-remote`"
        );
        eprintln!("warning: other machines may reach this board at {address}, and replace its patch");
        Ok(address)
    }
}
