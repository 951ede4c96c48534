//! `dermatome view`: a page on which a skin is seen, recorded, tuned and checked.

mod calls;
mod desk;
mod look;
mod numbers;
mod prepared;

use super::{current::Current, cut, interrupt, outlets::Record, replay::read_patch};
use anyhow::{Context, ensure};
use dermatome_page::{
    Options, Server, ServerError,
    gate::{Gate, random_text},
};
use dermatome_shared::patch::PatchView;
use dermatome_simulate::port::Port;
pub(super) use desk::{Desk, Task};
pub(super) use look::Source;
use std::{net::SocketAddr, path::PathBuf};

/// Show a skin on a page in the browser: pressure in 3D, contacts, electrodes, plots, and the controls to tune it.
///
/// Serves one page at 127.0.0.1 and opens the browser. A board that is not there yet, or is lost, is waited for. On the
/// same address, other programs look on by the Foxglove WebSocket protocol: Foxglove, Lichtblick (ws://127.0.0.1:8765).
/// A recording opens in the page itself, or as a board: --port replay:FILE.mcap.
#[derive(clap::Args)]
#[command(after_help = "Examples:
  dermatome view --port /dev/ttyACM0
  dermatome view --port sim:models/hemisphere-210mm/skin.toml
  dermatome view --port COM5 --skin forearm-skin/skin.toml --link-mesh forearm.stl --unit mm
  dermatome view --port COM5 --patch smooth.dermatome --patch sharp.dermatome
  dermatome view --port replay:run.mcap")]
pub(super) struct Args {
    /// Where the board is: /dev/ttyACM0, COM5, tcp:HOST:PORT, sim:SKIN.toml or replay:FILE.mcap. Without it the page opens
    /// recordings only.
    #[arg(long)]
    port: Option<Port>,
    /// Skin file of the board's patch: show its surface, its electrodes, and by its [pose] its place on the robot's link.
    #[arg(long, value_name = "FILE")]
    skin: Option<PathBuf>,
    /// Mesh of the robot's link to show behind the skin: STL, OBJ, PLY or COLLADA.
    #[arg(long, value_name = "FILE", requires = "skin")]
    link_mesh: Option<PathBuf>,
    /// Unit of that mesh: m, cm, mm or inch.
    #[arg(long, value_name = "UNIT", requires = "link_mesh", value_parser = cut::metres)]
    unit: Option<f64>,
    /// Another patch for the same skin, such as one with another hyperparameter: the page switches between them and the
    /// board's at once. May be repeated.
    #[arg(long, value_name = "PATCH")]
    patch: Vec<PathBuf>,
    #[command(flatten)]
    record: Record,
    /// Where to serve the page; port 0 takes a free one.
    #[arg(long, default_value = "127.0.0.1:8765", value_name = "HOST:PORT")]
    listen: SocketAddr,
    /// Let other computers in: needed for an address that is not this machine's own (127.0.0.1). They need the token in the
    /// address that is printed, and whoever has it can drive the board.
    #[arg(long)]
    allow_remote: bool,
    /// The token that other computers need [default: one that nobody guesses, new each time].
    #[arg(long, value_name = "TEXT", value_parser = token)]
    token: Option<String>,
    /// Let a page of somebody else look on too, as a browser names it: https://app.foxglove.dev. May be repeated.
    #[arg(long, value_name = "ORIGIN", value_parser = origin)]
    allow_origin: Vec<String>,
    /// Do not open the browser.
    #[arg(long)]
    no_browser: bool,
    #[command(flatten)]
    current: Current,
}

fn token(text: &str) -> Result<String, &'static str> {
    let is_plain = text.len() >= 8 && text.bytes().all(|byte| byte.is_ascii_alphanumeric());
    if is_plain { Ok(text.to_owned()) } else { Err("allowed: 8 or more letters and digits") }
}

fn origin(text: &str) -> Result<String, &'static str> {
    let rest = text.strip_prefix("https://").or_else(|| text.strip_prefix("http://"));
    match rest.filter(|rest| !rest.is_empty() && !rest.contains(['/', '?', '#', '*', ' '])) {
        Some(_) => Ok(text.to_owned()),
        None => {
            Err("allowed: http:// or https:// and a name, with its port if it has one, and nothing behind")
        }
    }
}

pub(super) fn run(args: &Args) -> anyhow::Result<()> {
    interrupt::install()?;
    let patches = args.patch.iter().map(|path| read_patch(path)).collect::<anyhow::Result<Vec<_>>>()?;
    let patches = patches.iter().zip(&args.patch).map(named).collect::<anyhow::Result<Vec<_>>>()?;
    let task = Task {
        port: args.port.as_ref(),
        patches: &patches,
        look: Source::of(args)?,
        skin: args.skin.as_deref(),
        record: args.record.file(),
        current: &args.current,
    };
    let server = serve(args)?;
    Desk::new(task, server).run()
}

/// A patch with the name of its file.
fn named<'a>(
    ((bytes, name), path): (&'a (Vec<u8>, String), &PathBuf),
) -> anyhow::Result<(String, PatchView<'a>)> {
    let stem = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
    Ok((stem, PatchView::validate(bytes).with_context(|| name.clone())?))
}

/// Starts the server, prints the page's address and opens the browser.
fn serve(args: &Args) -> anyhow::Result<Server> {
    let listen = args.listen;
    let is_local = listen.ip().is_loopback();
    ensure!(
        is_local || args.allow_remote,
        "`--listen` is {listen}, which other computers may reach: if that is meant, give `--allow-remote`"
    );
    let token = match (&args.token, is_local) {
        (Some(token), _) => Some(token.clone()),
        (None, true) => None,
        (None, false) => {
            Some(random_text().context("the system has no randomness for a token; give `--token`")?)
        }
    };
    let server = start(Gate { listen, token, origins: args.allow_origin.clone() })?;
    say!("{}", server.url());
    if !is_local {
        eprintln!(
            "other computers come in with the token in this address; whoever has it can drive the board"
        );
    }
    if !args.no_browser {
        open_browser(&server);
    }
    Ok(server)
}

/// A server of the page, for those who come through the gate.
pub(super) fn start(gate: Gate) -> Result<Server, ServerError> {
    Server::start(Options { gate, name: "dermatome".to_owned(), services: &calls::SERVICES })
}

/// Shows the page in the browser, if there is one.
pub(super) fn open_browser(server: &Server) {
    if open::that_detached(server.url()).is_err() {
        eprintln!("no browser was found: open the address above");
    }
}
