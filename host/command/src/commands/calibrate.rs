//! `dermatome calibrate`.

use super::{
    JsonReport,
    board::{advised, open},
    outlets::{Outlets, Record, recorded_in_words},
    outputs::{Kind, Output},
    tare::{patch_of, tare_with_spinner},
};
use anyhow::{Context, bail, ensure};
use dermatome_frames::calibrate::{
    self, Compensation, CurvePoint, Field, Fit, NoField, Reading, Recording, repeatability,
};
use dermatome_link::{self as link, Link, ScanFrame, silence_timeout};
use dermatome_model::skin::quantity::{AREA, Quantity};
use dermatome_patch::{
    input::{self, MAX_PATCH_BYTES},
    output::{check_folder, write_together, write_whole},
    write::{units_crc, with_calibration, with_gains},
};
use dermatome_shared::{
    hysteresis::PlayOperator, patch::PatchView, protocol::Selection, reference::DEFAULT_TARE_FRAMES,
};
use dermatome_simulate::port::Port;
use serde::Serialize;
use std::{
    fmt::Write,
    path::{Path, PathBuf},
};

/// Calibrate a skin against known loads: contacts have kPa from then on, and newtons.
///
/// A machine presses the skin up to its largest load and back, once or more. The strength of the contact
/// against pressure becomes a monotone curve; the first trial also gives what takes hysteresis out on
/// the board. Force needs the area of the indenter, because that of a contact is another than what
/// presses. Presses at several places also give how much more or less the skin reads from place to
/// place. All goes into the patch file, and with a port onto the board.
#[derive(clap::Args)]
#[command(after_help = "Examples:
  dermatome calibrate palm.dermatome --port /dev/ttyACM0 --loads loads.csv --indenter-area 4cm2
  dermatome calibrate disc-210mm.dermatome --readings readings.csv --plot calibration.svg
  dermatome calibrate disc-210mm.dermatome --recording contacts.tsv --loads loads.csv
  dermatome calibrate disc-210mm.dermatome --port COM5 --loads loads.csv --out left-palm.dermatome")]
#[command(group(clap::ArgGroup::new("source").required(true).args(["port", "readings", "recording"])))]
pub(super) struct Args {
    /// Patch to calibrate, as `dermatome build` writes it; with --port, the one that the board uses.
    patch: PathBuf,
    /// Where the board is: /dev/ttyACM0, COM5, tcp:HOST:PORT, rs485:LINE#ADDRESS, can:BUS#ADDRESS or sim:SKIN.toml. It is
    /// tared first.
    #[arg(long, requires = "loads")]
    port: Option<Port>,
    /// What the machine does from the first streamed frame on: CSV with the columns time_s,pressure_kpa.
    #[arg(long, value_name = "FILE", conflicts_with = "readings")]
    loads: Option<PathBuf>,
    /// What `dermatome stream --no-image` printed while the machine pressed; with --loads.
    #[arg(long, value_name = "FILE", requires = "loads")]
    recording: Option<PathBuf>,
    /// The loads' time 0 by the recording's time_s [default: so that its first contact is the first load above zero].
    #[arg(long, value_name = "SECONDS", requires = "recording", value_parser = seconds, allow_negative_numbers = true)]
    start: Option<f64>,
    /// Readings taken before: CSV with the columns pressure_kpa,strength and, if known, deviation,area_mm2,x_mm,y_mm,z_mm.
    #[arg(long, value_name = "FILE")]
    readings: Option<PathBuf>,
    /// Area of the flat indenter that pressed, such as '4 cm2'; without it contacts get no newtons.
    #[arg(long, value_name = "AREA")]
    indenter_area: Option<String>,
    /// Write the calibrated patch here instead of over the old one.
    #[arg(long, value_name = "FILE", value_parser = Kind::Patch.parser())]
    out: Option<Output>,
    /// Store the curve alone: leave hysteresis in.
    #[arg(long)]
    no_compensation: bool,
    /// Take the skin to read alike everywhere, wherever it was pressed.
    #[arg(long)]
    no_field: bool,
    /// Draw readings and curve, as SVG.
    #[arg(long, value_name = "FILE", value_parser = Kind::Svg.parser())]
    plot: Option<Output>,
    /// Write the readings, as CSV that --readings takes.
    #[arg(long, value_name = "FILE", conflicts_with = "readings", value_parser = Kind::Readings.parser())]
    save: Option<Output>,
    #[command(flatten)]
    record: Record,
    #[command(flatten)]
    json: JsonReport,
}

/// Keys are documented in docs/cli.md.
#[derive(Serialize)]
struct Report {
    skin: String,
    trials: usize,
    readings: usize,
    hysteresis_percent: Option<f64>,
    repeatability_percent: Option<f64>,
    compensated_percent: Vec<Option<f64>>,
    curve: Vec<CurvePoint>,
    plays: Vec<[f64; 2]>,
    load_share: Option<f32>,
    field: Option<FieldReport>,
    patch_crc: String,
}

/// How much more or less a skin reads from place to place.
#[derive(Serialize)]
struct FieldReport {
    places: usize,
    odd_places: usize,
    least: f64,
    largest: f64,
    left_out_percent: f64,
    left_out_without_percent: f64,
}

pub(super) fn run(args: &Args) -> anyhow::Result<()> {
    let path = args.patch.display();
    let bytes =
        input::read(&args.patch, MAX_PATCH_BYTES).with_context(|| format!("cannot read patch `{path}`"))?;
    let patch = PatchView::validate(&bytes).with_context(|| format!("`{path}`"))?;
    let indenter_mm2 = args.indenter_area.as_deref().map(|text| indenter_mm2(text, &patch)).transpose()?;
    let out = args.out.as_deref().unwrap_or(&args.patch);
    check_folder(out)?;
    let mut link = args.port.as_ref().map(open).transpose()?;
    let readings = readings(args, link.as_mut(), &patch)?;
    if let Some(file) = &args.save {
        // Even if they make no calibration: the machine has done its work.
        write_whole(file, csv(&readings, &patch).as_bytes())?;
    }
    let (field, readings) = field(args, &readings, &patch).with_context(|| args.source())?;
    let fit = Fit::new(&readings, indenter_mm2, !args.no_compensation).with_context(|| args.source())?;
    let gains = field.as_ref().map(|field| field.gains(&patch));
    let even = gains.as_ref().map(|gains| with_gains(&bytes, gains)).transpose()?;
    let calibrated = with_calibration(even.as_ref().unwrap_or(&bytes), &fit.stored())?;
    let field = field.as_ref().zip(gains).map(|(field, gains)| FieldReport::new(field, &gains));
    let report = Report::new(&patch, &fit, field, &calibrated)?;
    write_all(args, out, &calibrated, &fit, &report)?;
    if let Some(link) = &mut link {
        link::upload(link, &calibrated, |_| ()).context("the calibrated patch was written, but not sent")?;
    }
    print(args, out, &fit, &report);
    Ok(())
}

/// The field of gain, and the readings without it.
fn field(
    args: &Args,
    readings: &[Reading],
    patch: &PatchView<'_>,
) -> anyhow::Result<(Option<Field>, Vec<Reading>)> {
    if args.no_field {
        let nowhere = |reading: &Reading| Reading { place: None, ..*reading };
        return Ok((None, readings.iter().map(nowhere).collect()));
    }
    let readings = calibrate::at_places(readings, patch)?;
    match Field::fit(&readings, patch) {
        Ok(field) => {
            let corrected = field.corrected(&readings);
            Ok((Some(field), corrected))
        }
        Err(NoField::NoPlaces) => Ok((None, readings)),
        Err(why) => {
            say!("no field of gain: {why}");
            Ok((None, readings))
        }
    }
}

/// The patch, and with it picture and report: all of them, or none.
fn write_all(args: &Args, out: &Path, calibrated: &[u8], fit: &Fit, report: &Report) -> anyhow::Result<()> {
    let plot = args.plot.as_deref().map(|file| (file, calibrate::svg(&report.skin, &fit.trials, &fit.curve)));
    let json = args.json.text(report)?;
    let texts = plot.iter().chain(&json).map(|(file, text)| (*file, text.as_bytes()));
    let files: Vec<_> = texts.chain([(out, calibrated)]).collect();
    Ok(write_together(&files)?)
}

/// The area as somebody states it, mm^2.
fn indenter_mm2(text: &str, patch: &PatchView<'_>) -> anyhow::Result<f64> {
    let surface = patch.surface();
    let units: f64 = surface.pixels().map(|pixel| f64::from(pixel.area)).sum();
    let skin_mm2 = units * f64::from(surface.scale.area) * 1e6;
    let quantity = text.trim().parse().map_or_else(|_| Quantity::Text(text.to_owned()), Quantity::Number);
    let read = AREA.read(&quantity).map(|area| area * 1e6);
    read.filter(|area| *area > 0.0 && *area <= skin_mm2).with_context(|| {
        format!(
            "`--indenter-area` is {text:?}; allowed: a number above zero (m2), or a number with {}, up to the skin's {:.1} cm2",
            AREA.units(),
            skin_mm2 / 100.0
        )
    })
}

fn readings(args: &Args, link: Option<&mut Link>, patch: &PatchView<'_>) -> anyhow::Result<Vec<Reading>> {
    match (link, &args.loads, &args.recording, &args.readings) {
        (Some(link), Some(loads), ..) => from_board(args, link, patch, loads),
        (_, Some(loads), Some(recording), _) => {
            let (loads, recording) = (calibrate::read_loads(loads)?, Recording::read(recording)?);
            Ok(recording.readings(&loads, args.start)?)
        }
        (.., Some(file)) => {
            check_units(file, patch)?;
            Ok(calibrate::read_readings(file)?)
        }
        _ => bail!(
            "neither `--port` with `--loads`, `--recording` with `--loads`, nor `--readings` is given; allowed: one of them"
        ),
    }
}

/// Refuses readings of a patch with other units of strength, such as this one before it got a field of gain.
fn check_units(file: &Path, patch: &PatchView<'_>) -> anyhow::Result<()> {
    let own = super::patch_id(units_crc(patch));
    if let Some(other) = calibrate::units_of(file).filter(|other| *other != own) {
        bail!(
            "readings `{}` were taken in units {other}, the patch has {own}; allowed: the patch that they were taken with, as it \
             was then",
            file.display()
        );
    }
    Ok(())
}

fn seconds(text: &str) -> Result<f64, String> {
    let seconds = text.parse().ok().filter(|seconds: &f64| seconds.is_finite());
    seconds.ok_or_else(|| "allowed: seconds".to_owned())
}

/// Tares, then reads while the machine loads the skin.
fn from_board(
    args: &Args,
    link: &mut Link,
    patch: &PatchView<'_>,
    loads: &Path,
) -> anyhow::Result<Vec<Reading>> {
    let loads = calibrate::read_loads(loads)?;
    let used = patch_of(link)?;
    ensure!(
        used.crc == patch.crc(),
        "the board at `{}` uses patch {}, the file is {}; allowed: the patch that the board uses (see `dermatome flash`)",
        link.port(),
        super::patch_id(used.crc),
        super::patch_id(patch.crc())
    );
    tare_with_spinner(link, &used, DEFAULT_TARE_FRAMES).map_err(advised)?;
    let show = |reading: &Reading| {
        eprintln!("{:8.3} kPa  strength {:.5}", reading.pressure_kpa, reading.strength);
    };
    let mut outlets = args.record.begin(link, None, None)?;
    let is_raw = u16::from(outlets.is_some());
    let (images, measurements, health) = (is_raw, is_raw, is_raw);
    let mut stream =
        link.subscribe(Selection { images, contacts: 1, measurements, health, ..Selection::default() })?;
    if let Some(outlets) = &mut outlets {
        outlets.drive(&used.drive, None);
        outlets.tare(stream.link())?;
    }
    let mut has_begun = false;
    let counts = |frame: &ScanFrame| {
        let counts = outlets.as_mut().is_none_or(|outlets| {
            outlets.frame(frame, None);
            !outlets.is_taring()
        });
        if counts && !std::mem::replace(&mut has_begun, true) {
            eprintln!("reading {} loads: start the machine now", loads.len());
        }
        counts
    };
    let readings = calibrate::measure(stream, &loads, silence_timeout(&used), counts, show);
    let recorded = outlets.as_mut().map_or(Ok(None), Outlets::finish_recording)?;
    recorded.iter().for_each(|(file, recorded)| eprintln!("{}", recorded_in_words(file, recorded)));
    Ok(readings?)
}

fn csv(readings: &[Reading], patch: &PatchView<'_>) -> String {
    let mut text = format!("{}{}\n", calibrate::TAKEN_IN, super::patch_id(units_crc(patch)));
    text += "pressure_kpa,strength,deviation,area_mm2,x_mm,y_mm,z_mm\n";
    for Reading { pressure_kpa, strength, deviation, area_mm2, place } in readings {
        let area = area_mm2.map_or(String::new(), |area| area.to_string());
        let [x, y, z] = [0, 1, 2].map(|axis| place.map_or(String::new(), |at| (1e3 * at[axis]).to_string()));
        let _ = writeln!(text, "{pressure_kpa},{strength},{deviation},{area},{x},{y},{z}");
    }
    text
}

impl Args {
    /// Where the readings come from, for errors.
    fn source(&self) -> String {
        let file = |name: &str, path: &Path| format!("{name} `{}`", path.display());
        match (&self.readings, &self.recording, &self.loads) {
            (Some(readings), ..) => file("readings", readings),
            (_, Some(recording), Some(loads)) => {
                format!("{} under {}", file("recording", recording), file("loads", loads))
            }
            (.., Some(loads)) => file("loads", loads),
            _ => "readings".to_owned(),
        }
    }
}

impl FieldReport {
    fn new(field: &Field, gains: &[f64]) -> Self {
        let [without, with] = field.left_out.map(|deviation| 100.0 * deviation);
        Self {
            places: field.places(),
            odd_places: field.odd,
            least: gains.iter().copied().fold(f64::INFINITY, f64::min),
            largest: gains.iter().copied().fold(0.0, f64::max),
            left_out_percent: with,
            left_out_without_percent: without,
        }
    }
}

impl Report {
    fn new(
        patch: &PatchView<'_>,
        fit: &Fit,
        field: Option<FieldReport>,
        calibrated: &[u8],
    ) -> anyhow::Result<Self> {
        Ok(Self {
            skin: patch.header.skin.as_str().to_owned(),
            trials: fit.trials.len(),
            readings: fit.trials.iter().map(|trial| trial.readings.len()).sum(),
            hysteresis_percent: fit.hysteresis(),
            repeatability_percent: repeatability(&fit.trials),
            compensated_percent: fit.loops.iter().map(|one| one.compensated).collect(),
            curve: fit.curve.points.clone(),
            plays: fit.play_operators.iter().map(plain).collect(),
            load_share: fit.calibration.load_share,
            field,
            patch_crc: super::patch_id(PatchView::validate(calibrated)?.crc()),
        })
    }
}

fn print(args: &Args, out: &Path, fit: &Fit, report: &Report) {
    let trials = if report.trials == 1 { "trial" } else { "trials" };
    let points = fit.calibration.points.len();
    let (count, readings) = (report.trials, report.readings);
    say!("{}: {count} {trials}, {readings} readings, {points} points of the curve", report.skin);
    match report.hysteresis_percent {
        Some(percent) => say!("hysteresis {percent:.1} % of rated output"),
        None => say!("hysteresis unknown: no trial comes back from its largest load"),
    }
    if let Some(percent) = report.repeatability_percent {
        say!("repeatability {percent:.1} % of rated output");
    }
    print_compensation(fit);
    report.field.iter().for_each(print_field);
    match report.load_share {
        Some(share) => say!("force: pressure times {share:.3} of a contact's area"),
        None => say!("no force: the indenter's area is not known (--indenter-area)"),
    }
    let on_board =
        args.port.as_ref().map_or(String::new(), |port| format!(", and is on the board at {port}"));
    say!("wrote {}{on_board}", out.display());
}

fn print_field(field: &FieldReport) {
    let FieldReport { places, odd_places, least, largest, left_out_percent, left_out_without_percent } =
        field;
    say!(
        "field of gain {least:.2} to {largest:.2} over the skin, from {places} places; one that is left out is {left_out_percent:.1} % \
         off, {left_out_without_percent:.1} % without"
    );
    if *odd_places > 0 {
        say!("places whose strengths no smooth field explains, left out of it: {odd_places}");
    }
}

fn print_compensation(fit: &Fit) {
    match fit.compensation {
        Compensation::Off => {}
        Compensation::NoWayBack => say!("no compensation: nothing is known of the way back"),
        Compensation::Useless { trial, percent } => say!(
            "no compensation: it makes trial {}, which it was fitted to, no better ({percent:.1} %)",
            trial + 1
        ),
        Compensation::On { trial } => {
            for (index, one) in fit.loops.iter().enumerate() {
                let used = if index == trial { "used to fit it" } else { "not used to fit it" };
                let after = one.compensated.map_or("unknown".to_owned(), |after| format!("{after:.1} %"));
                say!("hysteresis after compensation, trial {} ({used}): {after}", index + 1);
            }
        }
    }
}

/// Reach and weight as plain numbers.
fn plain(play: &PlayOperator) -> [f64; 2] {
    [f64::from(play.threshold) / 4096.0, f64::from(play.weight) / 2048.0]
}
