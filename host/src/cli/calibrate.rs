//! `dermatome calibrate`.

use super::{
    JsonReport,
    stream::long_patience,
    tare::{patch_of, tare_with_spinner},
};
use crate::{
    calibrate::{
        self, Curve, CurvePoint, Reading, Trial, compensated, hysteresis, identify, patch::with_calibration,
        repeatability,
    },
    link::{self, Link, Port},
    output::{check_folder, write_whole},
};
use anyhow::{Context, bail, ensure};
use dermatome_shared::{
    calibration::Calibration, hysteresis::Play, patch::PatchView, reference::DEFAULT_TARE_FRAMES,
};
use serde::Serialize;
use std::{
    fmt::Write,
    path::{Path, PathBuf},
};

/// Calibrate a skin against known loads: contacts have kPa and newtons from then on.
///
/// A machine presses the skin up to its largest load and back, once or more. The mean of the region of interest
/// against pressure becomes a monotone curve; the first trial also gives what takes hysteresis out on
/// the board. Both go into the patch file, and with a port onto the board.
#[derive(clap::Args)]
#[command(after_help = "Examples:
  dermatome calibrate disc-210mm.dermatome --port /dev/ttyACM0 --loads loads.csv
  dermatome calibrate disc-210mm.dermatome --readings readings.csv --plot calibration.svg
  dermatome calibrate disc-210mm.dermatome --port COM5 --loads loads.csv --out left-palm.dermatome")]
#[command(group(clap::ArgGroup::new("source").required(true).args(["port", "readings"])))]
pub(super) struct Args {
    /// Patch to calibrate, as `dermatome build` writes it; with --port, the one that the board uses.
    patch: PathBuf,
    /// Where the board is: /dev/ttyACM0, COM5, tcp:HOST:PORT or sim:SKIN.toml. It is tared first.
    #[arg(long, requires = "loads")]
    port: Option<Port>,
    /// What the machine does from the first streamed frame on: CSV with the columns time_s,pressure_kpa.
    #[arg(long, value_name = "FILE", requires = "port")]
    loads: Option<PathBuf>,
    /// Readings taken before: CSV with the columns pressure_kpa,strength and, if known, deviation.
    #[arg(long, value_name = "FILE")]
    readings: Option<PathBuf>,
    /// Write the calibrated patch here instead of over the old one.
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
    /// Store the curve alone: leave hysteresis in.
    #[arg(long)]
    no_compensation: bool,
    /// Draw readings and curve, as SVG.
    #[arg(long, value_name = "FILE")]
    plot: Option<PathBuf>,
    /// Write the readings, as CSV that --readings takes.
    #[arg(long, value_name = "FILE", conflicts_with = "readings")]
    save: Option<PathBuf>,
    #[command(flatten)]
    json: JsonReport,
}

/// Keys are documented in docs/cli.md.
#[derive(Serialize)]
struct Report {
    skin: String,
    trials: usize,
    readings: usize,
    hysteresis_percent: f64,
    repeatability_percent: Option<f64>,
    compensated_percent: Vec<f64>,
    curve: Vec<CurvePoint>,
    plays: Vec<[f64; 2]>,
    patch_crc: String,
}

pub(super) fn run(args: &Args) -> anyhow::Result<()> {
    let path = args.patch.display();
    let bytes = std::fs::read(&args.patch).with_context(|| format!("cannot read patch `{path}`"))?;
    let patch = PatchView::validate(&bytes).with_context(|| format!("`{path}`"))?;
    let out = args.out.as_ref().unwrap_or(&args.patch);
    for file in [Some(out), args.plot.as_ref(), args.save.as_ref()].into_iter().flatten() {
        check_folder(file)?;
    }
    let mut link = args.port.as_ref().map(link::open).transpose()?;
    let readings = match (&mut link, &args.loads, &args.readings) {
        (Some(link), Some(loads), _) => from_board(link, &patch, loads)?,
        (_, _, Some(file)) => calibrate::read_readings(file)?,
        _ => bail!("neither `--port` with `--loads` nor `--readings` is given; allowed: one of them"),
    };
    if let Some(file) = &args.save {
        write_whole(file, csv(&readings).as_bytes())?;
    }
    let fit = Fit::new(&readings, args.no_compensation)?;
    let calibrated = with_calibration(&bytes, &fit.calibration, &fit.plays)?;
    if let Some(file) = &args.plot {
        write_whole(file, calibrate::svg(&patch.header.skin, &fit.trials, &fit.curve).as_bytes())?;
    }
    write_whole(out, &calibrated)?;
    if let Some(link) = &mut link {
        link::upload(link, &calibrated, |_| ()).context("the calibrated patch was written, but not sent")?;
    }
    report(args, &patch, out, &fit, &calibrated)
}

/// Tares, then reads while the machine loads the skin.
fn from_board(link: &mut Link, patch: &PatchView<'_>, loads: &Path) -> anyhow::Result<Vec<Reading>> {
    let loads = calibrate::read_loads(loads)?;
    let used = patch_of(link)?;
    ensure!(
        used.crc == patch.crc(),
        "the board at `{}` uses patch {}, the file is {}; allowed: the patch that the board uses (see `dermatome flash`)",
        link.port(),
        super::patch_id(used.crc),
        super::patch_id(patch.crc())
    );
    tare_with_spinner(link, &used, DEFAULT_TARE_FRAMES)?;
    eprintln!("reading {} loads: start the machine now", loads.len());
    let show = |reading: &Reading| {
        eprintln!("{:8.3} kPa  strength {:.5}", reading.pressure_kpa, reading.strength);
    };
    Ok(calibrate::measure(link, &loads, long_patience(&used), show)?)
}

/// What the readings say.
struct Fit {
    trials: Vec<Trial>,
    curve: Curve,
    calibration: Calibration,
    plays: Vec<Play>,
    /// Hysteresis of each trial without and with compensation, per cent.
    loops: Vec<[f64; 2]>,
}

impl Fit {
    fn new(readings: &[Reading], no_compensation: bool) -> anyhow::Result<Self> {
        let trials = calibrate::trials(readings);
        ensure!(!trials.is_empty(), "no reading has a pressure above zero; allowed: loads up and down again");
        let curve = Curve::of_loading(&trials);
        let calibration = curve.calibration().with_context(|| {
            "strength does not rise with the load; allowed: readings of a skin that conducts better under load"
        })?;
        let plays = if no_compensation { Vec::new() } else { identify(&trials[0], &calibration) };
        let loops = trials.iter().map(|trial| loops(trial, &plays, &calibration)).collect();
        Ok(Self { trials, curve, calibration, plays, loops })
    }
}

fn loops(trial: &Trial, plays: &[Play], calibration: &Calibration) -> [f64; 2] {
    let strengths: Vec<f64> = trial.readings.iter().map(|reading| reading.strength).collect();
    let pressures = compensated(&strengths, plays, calibration, 0.0);
    [hysteresis(trial), hysteresis(&trial.with_strengths(&pressures))]
}

fn csv(readings: &[Reading]) -> String {
    let mut text = String::from("pressure_kpa,strength,deviation\n");
    for Reading { pressure_kpa, strength, deviation } in readings {
        let _ = writeln!(text, "{pressure_kpa},{strength},{deviation}");
    }
    text
}

fn report(
    args: &Args,
    patch: &PatchView<'_>,
    out: &Path,
    fit: &Fit,
    calibrated: &[u8],
) -> anyhow::Result<()> {
    let readings = fit.trials.iter().map(|trial| trial.readings.len()).sum();
    let count = fit.loops.len() as f64;
    let hysteresis_percent = fit.loops.iter().map(|pair| pair[0]).sum::<f64>() / count;
    let repeatability_percent = repeatability(&fit.trials);
    say!(
        "{}: {} trials, {readings} readings, {} points of the curve",
        patch.header.skin,
        fit.trials.len(),
        fit.calibration.0.len()
    );
    say!("hysteresis {hysteresis_percent:.1} % of rated output");
    if let Some(percent) = repeatability_percent {
        say!("repeatability {percent:.1} % of rated output");
    }
    for (trial, [_, after]) in fit.loops.iter().enumerate().filter(|_| !fit.plays.is_empty()) {
        let used = if trial == 0 { "used to fit it" } else { "not used to fit it" };
        say!("hysteresis after compensation, trial {} ({used}): {after:.1} %", trial + 1);
    }
    let on_board =
        args.port.as_ref().map_or(String::new(), |port| format!(", and is on the board at {port}"));
    say!("wrote {}{on_board}", out.display());
    let crc = PatchView::validate(calibrated)?.crc();
    args.json.write(&Report {
        skin: patch.header.skin.as_str().to_owned(),
        trials: fit.trials.len(),
        readings,
        hysteresis_percent,
        repeatability_percent,
        compensated_percent: fit.loops.iter().map(|pair| pair[1]).collect(),
        curve: fit.curve.points.clone(),
        plays: fit.plays.iter().map(plain).collect(),
        patch_crc: super::patch_id(crc),
    })
}

/// Reach and weight as plain numbers.
fn plain(play: &Play) -> [f64; 2] {
    [f64::from(play.reach) / 4096.0, f64::from(play.weight) / 2048.0]
}
