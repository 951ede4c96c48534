//! `dermatome demo`: the whole chain, from a skin file to contacts, with no hardware.

use super::{
    JsonReport,
    current::Current,
    demo_robot,
    doors::open_browser,
    interrupt,
    noise::NoiseOptions,
    outlets::{Outlets, Record, recorded_in_words, session},
    outputs::{Kind, Output},
    progress,
    tare::tare_with_spinner,
    view::{Desk, Source, Task, start},
};
use crate::demo::{self, Figures, FrameRecord, Scorer, Watched};
use dermatome_link::{self as link, Link, LinkError, LinkErrorKind, ScanFrame};
use dermatome_model::{model::Model, quantize, skin::Skin};
use dermatome_page::{Server, ServerError, gate::Gate};
use dermatome_patch::{layout::Layout, output::write_whole};
use dermatome_shared::{
    patch::PatchView,
    protocol::{PatchInfo, Selection},
    reference::DEFAULT_TARE_FRAMES,
};
use dermatome_simulate::{
    Noise, Script, SimulatedSkin,
    board::{BoardOptions, SimulatedBoard},
};
use dermatome_view::live::{Live, Shown};
use serde::Serialize;
use std::{
    net::{Ipv4Addr, SocketAddr},
    path::Path,
    time::Duration,
};

/// Build a patch, flash a simulated board, and watch fingers press its skin.
///
/// Everything but the skin is the real thing: the board's own code runs behind a byte stream, and
/// each of its frames is a true forward solution on a finer mesh, with noise and converter.
#[derive(clap::Args)]
#[command(after_help = "Examples:
  dermatome demo
  dermatome demo --robot --view
  dermatome demo --noise-db 40 --seed 3 --json demo.json")]
pub(super) struct Args {
    /// Picture to write: truth beside image at eight moments.
    #[arg(long, default_value = "demo.png", value_name = "FILE", value_parser = Kind::Png.parser())]
    png: Output,
    /// Show the demo on the page of `view` as well, and keep the page open with a finger going round until Ctrl-C.
    #[arg(long)]
    view: bool,
    /// With --view: do not open the browser.
    #[arg(long, requires = "view")]
    no_browser: bool,
    /// Show an arm with three skins instead (models/arm), each on a simulated board, served as `serve` does: touched at
    /// several links at once, and stroked. Fails if a touch is not felt, as happens with much noise. Not with --png, nor
    /// with --record: `serve --record` records the same arm.
    #[arg(long, conflicts_with_all = ["png", "record"])]
    robot: bool,
    /// With --robot: serve the page at this address of this computer while the script is played: 127.0.0.1:8765.
    #[arg(long, value_name = "HOST:PORT", requires = "robot", conflicts_with = "view", value_parser = local_address)]
    listen: Option<SocketAddr>,
    /// With --robot: be a node of ROS 2 too (docs/ros.md), in a program built with `--features ros`.
    #[arg(long, requires = "robot")]
    ros: bool,
    /// With --robot: stop after so many seconds, instead of when the script has been played once, or, with --view, at Ctrl-C.
    #[arg(long, value_name = "SECONDS", requires = "robot", value_parser = super::stream::seconds)]
    duration: Option<Duration>,
    #[command(flatten)]
    record: Record,
    #[command(flatten)]
    noise: NoiseOptions,
    #[command(flatten)]
    json: JsonReport,
}

/// What the demo tells; keys are documented in docs/cli.md.
#[derive(Serialize)]
struct Report {
    skin: String,
    noise_db: f64,
    seed: u64,
    frames_received: u32,
    frames_lost: u64,
    images_per_second: Option<f64>,
    patch_bytes: usize,
    measurements: usize,
    pixels: usize,
    simulated_elements: usize,
    /// Fixed-point images of random presses against f64, per cent of the image's peak.
    fixed_point_error_percent: Max,
    #[serde(flatten)]
    figures: Figures,
    /// The same fingers at more noise; none where Ctrl-C came before.
    noisier: Option<Noisier>,
}

/// Largest value.
#[derive(Serialize)]
struct Max {
    max: f64,
}

#[derive(Serialize)]
struct Noisier {
    noise_db: f64,
    #[serde(flatten)]
    figures: Figures,
}

/// By so much, dB.
const NOISIER_DB: f64 = 10.0;

pub(super) fn run(args: &Args) -> anyhow::Result<()> {
    interrupt::install()?;
    let noise = args.noise.noise();
    if args.robot {
        return demo_robot::run(&args.wishes(noise));
    }
    let skin = Skin::parse(Path::new(demo::SKIN_PATH), demo::SKIN)?.made()?;
    let spinner = progress::spinner();
    let model = Model::build(&skin, |stage| spinner.set_message(stage))?;
    let patch = quantize::patch(&skin, &model)?;
    let fixed_point = quantize::fixed_point_error(&model, &PatchView::validate(&patch)?, quantize::TRIALS)?;
    spinner.finish_and_clear();
    say!("built the patch of {}: {} elements, {} bytes", skin.name, model.mesh.elements.len(), patch.len());

    let outline = &*skin.shape.from_above()?;
    let script = demo::script(outline, skin.drive.frame_rate)?;
    let source = SimulatedSkin::new(&skin, script.clone(), noise)?;
    let simulated_elements = source.elements();
    let options = BoardOptions { electrodes: skin.electrodes.count, ..BoardOptions::default() };
    let mut link = SimulatedBoard::start(options, source)?.connect("sim:demo")?;
    say!(
        "started a simulated board: its skin has {simulated_elements} elements, noise at {} dB",
        noise.snr_db
    );

    let used = flash(&mut link, &patch)?;
    let server = args.view.then(|| serve(args)).transpose()?;
    let mut outlets = outlets(args, &mut link, &skin, server.as_ref())?;
    if outlets.is_none() {
        tare_with_spinner(&mut link, &used, DEFAULT_TARE_FRAMES).map_err(|error| advised(error, noise))?;
    }
    say!("flashed it and averaged {DEFAULT_TARE_FRAMES} frames of the untouched skin; now watch the fingers");

    let layout = &Layout::from(&model.surface()?);
    let scorer = Scorer { skin: &skin, outline, model: &model, layout, script: &script };
    let watched = show(&mut link, &scorer, outlets.as_mut()).map_err(|error| advise(error, noise))?;
    drop(link);
    let recorded = outlets.as_mut().map_or(Ok(None), Outlets::finish_recording)?;
    recorded.iter().for_each(|(file, recorded)| say!("{}", recorded_in_words(file, recorded)));
    let noisier = if interrupt::requested() { None } else { noisier(&scorer, noise)? };
    let report = Report {
        skin: skin.name.clone(),
        noise_db: noise.snr_db,
        seed: noise.seed,
        frames_received: watched.records.len() as u32,
        frames_lost: watched.lost,
        images_per_second: watched.images_per_second(),
        patch_bytes: patch.len(),
        measurements: model.jacobian.nrows(),
        pixels: model.jacobian.ncols(),
        simulated_elements,
        fixed_point_error_percent: Max { max: fixed_point.measured_percent },
        figures: scorer.figures(&watched.records),
        noisier,
    };
    print(&report);
    if !watched.records.is_empty() {
        write_whole(&args.png, &demo::picture(&scorer, &watched.records)?)?;
        say!("picture                        {}", args.png.display());
    }
    args.json.write(&report)?;
    match server {
        Some(server) => stay(server, &skin, patch, noise),
        None => {
            say!("see it in 3D                   dermatome demo --view");
            Ok(())
        }
    }
}

impl Args {
    fn wishes(&self, noise: Noise) -> demo_robot::Wishes<'_> {
        let usual = || demo_robot::free_address(USUAL_PORT);
        demo_robot::Wishes {
            noise,
            page: self.listen.or_else(|| self.view.then(usual)),
            no_browser: self.no_browser || !self.view,
            ros: self.ros,
            duration: self.duration,
            stays: self.view,
            json: &self.json,
        }
    }
}

/// An address of this computer: a demo is for nobody else.
fn local_address(text: &str) -> Result<SocketAddr, String> {
    let address: SocketAddr = text.parse().map_err(|_| "allowed: 127.0.0.1:PORT".to_owned())?;
    if address.ip().is_loopback() {
        return Ok(address);
    }
    Err("allowed: an address of this computer, 127.0.0.1:PORT (for others: `serve models/arm/robot.toml --listen HOST:PORT --allow-remote`)".to_owned())
}

/// Where frames go beside the terminal: to the page, and into a recording.
fn outlets(
    args: &Args,
    link: &mut Link,
    skin: &Skin,
    server: Option<&Server>,
) -> anyhow::Result<Option<Outlets>> {
    if server.is_none() && args.record.file().is_none() {
        return Ok(None);
    }
    let session = session(link, Some(demo::SKIN.to_owned()))?;
    let look = Source::of_skin(Path::new(demo::SKIN_PATH), skin.clone());
    let (pose, look) = look.on(&session)?;
    let mut outlets = Outlets::new(&session, pose.as_ref(), &look)?;
    if let Some(file) = args.record.file() {
        outlets.record(file, &session)?;
    }
    if let Some(server) = server {
        outlets.tell(server.speaker(0));
    }
    Ok(Some(outlets))
}

/// A server of the page at the usual address, or at a free one where another program has that.
fn serve(args: &Args) -> anyhow::Result<Server> {
    let at = |port| Gate { listen: (Ipv4Addr::LOCALHOST, port).into(), token: None, origins: Vec::new() };
    let server = match start(at(USUAL_PORT)) {
        Err(ServerError::PortInUse(_)) => start(at(0))?,
        started => started?,
    };
    say!("the page is at {}", server.url());
    if !args.no_browser {
        open_browser(&server);
    }
    Ok(server)
}

/// Keeps the page open with another board, on whose skin a finger goes round.
fn stay(server: Server, skin: &Skin, patch: Vec<u8>, noise: Noise) -> anyhow::Result<()> {
    say!("the page stays open with a finger going round, until Ctrl-C: {}", server.url());
    let script = Script::round(&*skin.shape.from_above()?);
    let source = SimulatedSkin::new(skin, script, noise)?;
    let options =
        BoardOptions { electrodes: skin.electrodes.count, patch: Some(patch), ..BoardOptions::default() };
    let board = SimulatedBoard::start(options, source)?;
    let port = format!("tcp:{}", board.address()).parse()?;
    let look = Source::of_skin(Path::new(demo::SKIN_PATH), skin.clone());
    let current = Current::default();
    let task = Task { port: Some(&port), patches: &[], look, skin: None, record: None, current: &current };
    Desk::new(task, server).run()
}

/// As [`advised`], for what may be the error of a link.
fn advise(error: anyhow::Error, noise: Noise) -> anyhow::Error {
    error.downcast().map_or_else(|error| error, |error| advised(error, noise))
}

/// Where the page is, unless another program is.
const USUAL_PORT: u16 = 8765;

/// The error of a link to a board that ends with this command, so that no other can ask it.
fn advised(error: LinkError, noise: Noise) -> anyhow::Error {
    match error.kind {
        LinkErrorKind::NoTare { .. } => anyhow::anyhow!(
            "{error}: `--noise-db` is {}, so much noise that its frames look like faults; allowed: less, from about 20 on",
            noise.snr_db
        ),
        _ => error.into(),
    }
}

/// The same fingers at more noise, unless Ctrl-C comes.
fn noisier(scorer: &Scorer<'_>, noise: Noise) -> anyhow::Result<Option<Noisier>> {
    let noise = Noise { snr_db: (noise.snr_db - NOISIER_DB).max(0.0), ..noise };
    let spinner = progress::spinner();
    spinner.set_message("the same fingers at more noise");
    let records = demo::noisier(scorer, noise, || !interrupt::requested())?;
    spinner.finish_and_clear();
    let figures = scorer.figures(&records);
    Ok((!interrupt::requested()).then_some(Noisier { noise_db: noise.snr_db, figures }))
}

/// Draws the frames as they come, until the last one or Ctrl-C.
fn show(link: &mut Link, scorer: &Scorer<'_>, mut outlets: Option<&mut Outlets>) -> anyhow::Result<Watched> {
    let centres = scorer.skin.shape.electrode_centres();
    let mut live = Live::new(Some(Shown {
        layout: scorer.layout.clone(),
        threshold: scorer.skin.contact_threshold,
        electrodes: centres.iter().map(|centre| [centre.x, centre.y]).collect(),
    }));
    let draw = |record: &FrameRecord| {
        live.keep_image(record.image.clone());
        // A terminal that cannot be drawn on does not end the demo.
        let _ = live.draw_if_due(record.at, &record.contacts, &record.contacts, "");
    };
    let raw = u16::from(outlets.is_some());
    let selection =
        Selection { images: 1, contacts: 1, measurements: raw, health: raw, ..Selection::default() };
    let mut stream = link.subscribe(selection)?;
    if let Some(outlets) = &mut outlets {
        // The board has no reference yet: it makes one in the stream, before the fingers come.
        outlets.tare(stream.link())?;
    }
    let counts = |frame: &ScanFrame| {
        outlets.as_mut().is_none_or(|outlets| {
            outlets.frame(frame, None);
            !outlets.is_taring()
        })
    };
    let watched = demo::watch(stream, scorer, counts, draw, || !interrupt::requested())?;
    let received = watched.records.len();
    if received < demo::FRAMES as usize {
        say!("stopped after {received} of {} frames", demo::FRAMES);
    }
    Ok(watched)
}

fn flash(link: &mut Link, patch: &[u8]) -> anyhow::Result<PatchInfo> {
    let bar = progress::sending(patch.len());
    let used = link::upload(link, patch, |sent| bar.inc(sent as u64))?;
    bar.finish_and_clear();
    Ok(used)
}

fn print(report: &Report) {
    let figures = &report.figures;
    say!("");
    say!("simulated board, noise at {} dB, seed {}", report.noise_db, report.seed);
    say!("frames received / lost         {} / {}", report.frames_received, report.frames_lost);
    if let Some(rate) = report.images_per_second {
        say!("images per second              {rate:.1} (paced by the skin's frame rate)");
    }
    print_position(figures);
    for band in &figures.position_error_by_radius {
        let (from, to) = (band.from, band.to);
        say!(
            "  at {from:.1} to {to:.1} of the radius    mean {:.2} %, max {:.2} % ({} frames)",
            band.mean_percent,
            band.max_percent,
            band.frames
        );
    }
    print_counts(figures);
    if let (Some(resolution), Some(ringing)) = (figures.resolution_mean, figures.ringing_mean) {
        say!("RES, mean                      {resolution:.3}");
        say!("RNG, mean                      {ringing:.3}");
    }
    say!(
        "fixed point against f64        max {:.4} % of the image's peak",
        report.fixed_point_error_percent.max
    );
    say!(
        "patch                          {} bytes, {} measurements x {} pixels",
        report.patch_bytes,
        report.measurements,
        report.pixels
    );
    if let Some(noisier) = &report.noisier {
        say!("");
        say!("the same fingers at {} dB, by the board's code without the link", noisier.noise_db);
        print_position(&noisier.figures);
        print_counts(&noisier.figures);
    }
}

fn print_position(figures: &Figures) {
    let (Some(mm), Some(percent)) = (figures.position_error_mm, figures.position_error_percent) else {
        return;
    };
    say!(
        "position error, one finger     mean {:.2} mm = {:.2} % of the diameter, max {:.2} mm = {:.2} %",
        mm.mean,
        percent.mean,
        mm.max,
        percent.max
    );
}

fn print_counts(figures: &Figures) {
    say!(
        "one finger seen as one         {} of {} frames",
        figures.single_press_frames_with_one_contact,
        figures.single_press_frames
    );
    say!(
        "two fingers seen as two        {} of {} frames",
        figures.two_press_frames_with_two_contacts,
        figures.two_press_frames
    );
    if let Some(found) = figures.significance {
        say!(
            "contacts above the noise by    mean {:.0}, least {:.0} standard deviations",
            found.mean,
            found.least
        );
    }
}
