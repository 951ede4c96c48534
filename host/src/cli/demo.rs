//! `dermatome demo`: the whole chain, from a skin file to contacts, with no hardware.

use super::{JsonReport, interrupt, progress};
use crate::{
    board::simulated::{BoardOptions, SimulatedBoard},
    demo::{self, Figures, FrameRecord, Scorer},
    link::{self, Link},
    model::Model,
    output::write_whole,
    quantize,
    simulate::{Noise, SimulatedSkin, board::DEFAULT_NOISE},
    skin::Skin,
    view::live::Live,
};
use anyhow::bail;
use dermatome_shared::{
    frame::FrameFlags,
    protocol::{Event, FrameStamp, PatchInfo, Reply, Request, Selection},
    reference::DEFAULT_TARE_FRAMES,
    units::AdcCode,
};
use serde::Serialize;
use std::{
    path::{Path, PathBuf},
    time::{Duration, Instant},
};

/// Build a patch, flash a simulated board, and watch fingers press its skin.
///
/// Everything but the skin is the real thing: the board's own code runs behind a byte stream, and
/// each of its frames is a true forward solution on a finer mesh, with noise and converter.
#[derive(clap::Args)]
#[command(after_help = "Examples:
  dermatome demo
  dermatome demo --noise-db 40 --seed 3 --json demo.json")]
pub(super) struct Args {
    /// Picture to write: truth beside image at eight moments.
    #[arg(long, default_value = "demo.png", value_name = "FILE")]
    png: PathBuf,
    /// Signal-to-noise ratio of the measurements, dB.
    #[arg(long, default_value_t = DEFAULT_NOISE.snr_db, value_name = "DB")]
    noise_db: f64,
    /// Seed of the noise.
    #[arg(long, default_value_t = DEFAULT_NOISE.seed)]
    seed: u64,
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
    images_per_second: f64,
    patch_bytes: usize,
    measurements: usize,
    pixels: usize,
    simulated_elements: usize,
    #[serde(flatten)]
    figures: Figures,
}

/// A board that is silent for so long has a fault.
const SILENCE: Duration = Duration::from_secs(5);
const POLL: Duration = Duration::from_millis(100);

pub(super) fn run(args: &Args) -> anyhow::Result<()> {
    interrupt::install()?;
    if !(0.0..=200.0).contains(&args.noise_db) {
        bail!("`--noise-db` is {}; allowed: 0 to 200 dB", args.noise_db);
    }
    let skin = Skin::parse(Path::new(demo::SKIN_PATH), demo::SKIN)?;
    let spinner = progress::spinner();
    let model = Model::build(&skin, |stage| spinner.set_message(stage))?;
    let patch = quantize::patch(&skin, &model)?;
    let script = demo::script(&skin.outline, skin.drive.frame_rate)?;
    let noise = Noise { snr_db: args.noise_db, seed: args.seed };
    let source = SimulatedSkin::new(&skin, script.clone(), noise)?;
    spinner.finish_and_clear();
    println!(
        "built the patch of {}: {} elements, {} bytes",
        skin.name,
        model.mesh.elements.len(),
        patch.len()
    );

    let simulated_elements = source.elements();
    let board = SimulatedBoard::start(
        BoardOptions { electrodes: skin.electrodes.count(), ..BoardOptions::default() },
        source,
    )?;
    println!(
        "started a simulated board: its skin has {simulated_elements} elements, noise at {} dB",
        args.noise_db
    );
    let mut link = Link::to_simulated("sim:demo", board)?;
    let used = flash(&mut link, &patch)?;
    link::tare(&mut link, DEFAULT_TARE_FRAMES, link::tare_timeout(&used, DEFAULT_TARE_FRAMES))?;
    println!(
        "flashed it and averaged {DEFAULT_TARE_FRAMES} frames of the untouched skin; now watch the fingers"
    );

    let scorer = Scorer { skin: &skin, model: &model, script: &script, reference: reference(&mut link)? };
    let run = watch(&mut link, &scorer)?;
    let report = Report {
        skin: skin.name.clone(),
        noise_db: args.noise_db,
        seed: args.seed,
        frames_received: run.records.len() as u32,
        frames_lost: run.lost,
        images_per_second: run.images_per_second(),
        patch_bytes: patch.len(),
        measurements: model.jacobian.nrows(),
        pixels: model.jacobian.ncols(),
        simulated_elements,
        figures: scorer.figures(&run.records),
    };
    if report.frames_received < demo::FRAMES {
        println!("stopped after {} of {} frames", report.frames_received, demo::FRAMES);
    }
    print(&report);
    if !run.records.is_empty() {
        write_whole(&args.png, &demo::picture(&scorer, &run.records)?)?;
        println!("picture                        {}", args.png.display());
    }
    args.json.write(&report)
}

fn flash(link: &mut Link, patch: &[u8]) -> anyhow::Result<PatchInfo> {
    let bar = progress::sending(patch.len());
    let used = link::upload(link, patch, |sent| bar.inc(sent as u64))?;
    bar.finish_and_clear();
    Ok(used)
}

/// Mean codes of the untouched skin, as the board has them: `[measurement]`.
fn reference(link: &mut Link) -> anyhow::Result<Vec<f64>> {
    let Reply::Reference { frames, sums } = link.request(&Request::Reference)? else {
        bail!("the board gave no reference");
    };
    Ok(sums.iter().map(|&sum| sum as f64 / f64::from(frames)).collect())
}

/// All that came over the link.
struct Run {
    records: Vec<FrameRecord>,
    lost: u64,
    first: Option<Instant>,
    last: Option<Instant>,
}

impl Run {
    fn images_per_second(&self) -> f64 {
        match (self.first, self.last) {
            (Some(first), Some(last)) if last > first => {
                (self.records.len() - 1) as f64 / (last - first).as_secs_f64()
            }
            _ => 0.0,
        }
    }
}

/// Parts of the frame that is arriving.
#[derive(Default)]
struct Arriving {
    codes: Option<(u32, Vec<AdcCode>)>,
    image: Option<(u32, Vec<f64>)>,
}

/// Streams until the demo's last frame has come, or Ctrl-C.
fn watch(link: &mut Link, scorer: &Scorer<'_>) -> anyhow::Result<Run> {
    let mut live = Live::new(Some(scorer.model.geometry.clone()));
    let selection = Selection { images: true, contacts: true, measurements: true };
    let first_sequence = link::stream(link, selection)?;
    let mut run = Run { records: Vec::new(), lost: 0, first: None, last: None };
    let mut arriving = Arriving::default();
    let mut heard = Instant::now();
    let mut next = 0;
    while next < demo::FRAMES && !interrupt::requested() {
        let Some(event) = link.next_event(POLL)? else {
            if heard.elapsed() > SILENCE {
                bail!("the board has been silent for {} s", SILENCE.as_secs());
            }
            continue;
        };
        heard = Instant::now();
        let Some(record) = arriving.take(event, first_sequence, scorer) else { continue };
        run.first.get_or_insert(heard);
        run.last = Some(heard);
        next = record.index + 1;
        let at = FrameStamp {
            sequence: record.index,
            timestamp_us: (f64::from(record.index) / scorer.skin.drive.frame_rate * 1e6) as u64,
            flags: FrameFlags::default(),
        };
        live.keep_image(record.image.clone());
        live.draw_if_due(at, &record.contacts)?;
        run.records.push(record);
    }
    link::stream(link, Selection::default())?;
    run.lost = u64::from(next) - run.records.len() as u64;
    Ok(run)
}

impl Arriving {
    /// Takes one event; contacts come last and complete a frame of which everything has arrived.
    fn take(&mut self, event: Event, first_sequence: u32, scorer: &Scorer<'_>) -> Option<FrameRecord> {
        match event {
            Event::Measurements { at, codes } => self.codes = Some((at.sequence, codes.to_vec())),
            Event::Image { at, image } => self.image = Some((at.sequence, image.values().collect())),
            Event::Contacts { at, contacts } => {
                let (_, codes) = self.codes.take().filter(|(sequence, _)| *sequence == at.sequence)?;
                let (_, image) = self.image.take().filter(|(sequence, _)| *sequence == at.sequence)?;
                return Some(scorer.record(
                    at.sequence.wrapping_sub(first_sequence),
                    image,
                    contacts,
                    &codes,
                ));
            }
            Event::Tared { .. } => {}
        }
        None
    }
}

fn print(report: &Report) {
    let figures = &report.figures;
    println!();
    println!("simulated board, noise at {} dB, seed {}", report.noise_db, report.seed);
    println!("frames received / lost         {} / {}", report.frames_received, report.frames_lost);
    println!(
        "images per second              {:.1} (paced by the skin's frame rate)",
        report.images_per_second
    );
    println!(
        "position error, one finger     mean {:.2} mm = {:.2} % of the diameter, max {:.2} mm = {:.2} %",
        figures.position_error_mm.mean,
        figures.position_error_percent.mean,
        figures.position_error_mm.max,
        figures.position_error_percent.max
    );
    for band in &figures.position_error_by_radius {
        let (from, to) = (band.from, band.to);
        println!(
            "  at {from:.1} to {to:.1} of the radius    mean {:.2} %, max {:.2} % ({} frames)",
            band.mean_percent, band.max_percent, band.frames
        );
    }
    println!(
        "one finger seen as one         {} of {} frames",
        figures.single_press_frames_with_one_contact, figures.single_press_frames
    );
    println!(
        "two fingers seen as two        {} of {} frames",
        figures.two_press_frames_with_two_contacts, figures.two_press_frames
    );
    println!("RES, mean                      {:.3}", figures.resolution_mean);
    println!("RNG, mean                      {:.3}", figures.ringing_mean);
    println!(
        "fixed point against f64        max {:.4} % of the image's peak",
        figures.fixed_point_error_percent.max
    );
    println!(
        "patch                          {} bytes, {} measurements x {} pixels",
        report.patch_bytes, report.measurements, report.pixels
    );
}
