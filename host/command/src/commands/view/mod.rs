//! `dermatome view`: a page on which a skin is seen, recorded, tuned and checked.

pub(super) mod calls;
mod desk;
mod look;
mod numbers;
mod prepared;

use super::{current::Current, cut, doors::Doors, interrupt, outlets::Record, replay::read_patch};
use anyhow::Context;
use dermatome_page::{Options, Server, ServerError, gate::Gate};
use dermatome_shared::patch::PatchView;
use dermatome_simulate::port::Port;
pub(super) use desk::{Desk, Task};
pub(super) use look::{Source, look_of};
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
    /// Where the board is: /dev/ttyACM0, COM5, tcp:HOST:PORT, rs485:LINE#ADDRESS, can:BUS#ADDRESS, sim:SKIN.toml or
    /// replay:FILE.mcap. Without it the page opens recordings only.
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
    #[command(flatten)]
    doors: Doors,
    #[command(flatten)]
    current: Current,
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
    let spaces = vec!["dermatome".to_owned()];
    let server = args.doors.open(args.listen, &calls::SERVICES, spaces, false, |url| say!("{url}"))?;
    Desk::new(task, server).run()
}

/// A patch with the name of its file.
fn named<'a>(
    ((bytes, name), path): (&'a (Vec<u8>, String), &PathBuf),
) -> anyhow::Result<(String, PatchView<'a>)> {
    let stem = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
    Ok((stem, PatchView::validate(bytes).with_context(|| name.clone())?))
}

/// A server of the page, for those who come through the gate.
pub(super) fn start(gate: Gate) -> Result<Server, ServerError> {
    let (name, spaces) = ("dermatome".to_owned(), vec!["dermatome".to_owned()]);
    Server::start(Options { gate, name, services: &calls::SERVICES, spaces, is_robot: false })
}
