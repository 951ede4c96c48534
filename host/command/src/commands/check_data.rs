//! `dermatome check-data`: what is wrong with a file of measured frames.

use super::{
    JsonReport,
    frame_options::{Flags, FrameOptions},
};
use anyhow::{Context, bail};
use dermatome_frames::recorded::{
    check::{
        Check, Expected, check,
        findings::{About, Finding, Level},
    },
    fit::{Fit, fit},
    read::{Frames, Source},
    wording::Wording,
};
use dermatome_model::{skin::Skin, stimulation::patterns_of_length};
use serde::Serialize;
use std::{ffi::OsString, path::PathBuf};

/// Find out what is wrong with measured frames, and what to change.
///
/// Compares a file of frames with what the skin should measure: order of the measurements, polarity,
/// rotation and mirroring of the electrodes, exchanged, dead or noisy electrodes, reciprocity, noise,
/// clipped values, offset and repeated frames. Best with frames of the untouched skin.
#[derive(clap::Args)]
#[command(after_help = "Examples:
  dermatome check-data tank.toml run.npz:empty
  dermatome check-data skin.toml idle.csv --order relative --json check.json --strict
  dermatome check-data skin.toml idle.csv --fit
  dermatome check-data skin.toml today.npy --good yesterday.npy")]
pub(super) struct Args {
    /// Skin file.
    #[arg(value_name = "SKIN")]
    skin: PathBuf,
    /// Frames, as `reconstruct` reads them.
    #[arg(value_name = "FILE")]
    file: OsString,
    #[command(flatten)]
    options: FrameOptions,
    /// Frames of the same skin and instrument from when all was well, read with the same options. What they say stands
    /// in the model's place, so that causes are found on instruments and skins that no model fits.
    #[arg(long, value_name = "FILE")]
    good: Option<OsString>,
    /// Fit contact impedances and conductivity to the mean of the frames, which must be of the untouched
    /// skin.
    #[arg(long)]
    fit: bool,
    /// Exit with code 1 if there is a fault.
    #[arg(long)]
    strict: bool,
    #[command(flatten)]
    json: JsonReport,
}

/// What `check-data` tells; keys are documented in docs/cli.md.
#[derive(Serialize)]
struct Report {
    skin: PathBuf,
    file: String,
    faults: usize,
    #[serde(flatten)]
    check: Check,
    findings: Vec<Told>,
    fit: Option<Fit>,
}

/// A finding in the words of this command.
#[derive(Serialize)]
struct Told {
    level: Level,
    about: About,
    found: String,
    advice: String,
}

impl Told {
    fn new(finding: &Finding) -> Self {
        let Finding { level, about, found, advice } = finding;
        Self { level: *level, about: *about, found: found.clone(), advice: advice.told(&Flags) }
    }

    fn print(&self) {
        let level = match self.level {
            Level::Fault => "fault",
            Level::Note => "note",
        };
        say!("{level:<13} {}\n{:13} -> {}", self.found, "", self.advice);
    }
}

/// What a fit leaves over that is worth a warning, %.
const MUCH_LEFT_PERCENT: f64 = 10.0;

pub(super) fn run(args: &Args) -> anyhow::Result<()> {
    let skin = Skin::load(&args.skin)?.made()?;
    let source = Source::new(&args.file);
    let frames = args.options.read(&source, &skin.steps(), skin.electrodes.count)?;
    let model = Expected::of(&skin).with_context(|| format!("skin file `{}`", args.skin.display()))?;
    let expected = args.options.expected(model, args.good.as_ref())?;
    let check = check(&expected, &frames, args.options.arrangement())
        .with_context(|| format!("`{source}`{}", hint(&skin, &frames)))?;
    let fitted = args.fit.then(|| fit(&skin, &frames.mean(), &args.options.arrangement()));
    let fit = fitted.transpose().with_context(|| format!("--fit of `{source}`"))?;
    let report = Report {
        skin: args.skin.clone(),
        file: source.to_string(),
        faults: check.findings.iter().filter(|finding| finding.level == Level::Fault).count(),
        findings: check.findings.iter().map(Told::new).collect(),
        check,
        fit,
    };
    print(&report.check);
    match report.findings.len() {
        0 => say!("nothing looks wrong"),
        _ => report.findings.iter().for_each(Told::print),
    }
    report.fit.iter().for_each(print_fit);
    args.json.write(&report)?;
    if args.strict && report.faults > 0 {
        bail!("`{source}` has faults: {}", report.faults);
    }
    Ok(())
}

/// What frames of an unexpected length may be.
fn hint(skin: &Skin, frames: &Frames) -> String {
    let (electrodes, steps) = (skin.electrodes.count, skin.steps().len());
    let fits = |length: usize| length == steps || length == usize::from(electrodes).pow(2);
    if fits(frames.measurements) {
        return String::new();
    }
    if fits(frames.frames) {
        return format!(" ({} columns of {}: --transpose)", frames.measurements, frames.frames);
    }
    match &patterns_of_length(electrodes, frames.measurements)[..] {
        [] => String::new(),
        patterns => format!(" (as many as with {})", patterns.join(" or ")),
    }
}

fn print(check: &Check) {
    let kind = if check.complex { "complex" } else { "real" };
    let square = if check.square { ", full square" } else { "" };
    say!("frames        {} of {} measurements, {kind}{square}", check.frames, check.measurements);
    let numbering = &check.numbering;
    let options = match Flags.arrangement(&numbering.used) {
        none if none.is_empty() => "as the skin file says".to_owned(),
        options => options,
    };
    let known_by = check.compared_with;
    say!("order         {options}: correlation with {known_by} {:.3}", numbering.correlation);
    for (name, agreement) in [("reciprocity", &check.reciprocity), ("reversal", &check.reversal)] {
        if let Some(agreement) = agreement {
            say!(
                "{name:<12}  {:.2} % middle error, {:.2} % root mean square, {} pairs of steps",
                agreement.median_percent,
                agreement.rms_percent,
                agreement.pairs.len()
            );
        }
    }
    if let Some(steadiness) = &check.steadiness {
        let noise = steadiness.snr_db.map_or("no noise".to_owned(), |snr| format!("{snr:.1} dB"));
        say!(
            "signal        {noise} over noise, {:.2} % change from first to last",
            steadiness.change_percent
        );
    }
}

/// Electrodes from 1, as people count them.
fn print_fit(fit: &Fit) {
    say!(
        "fit           {:.3} % of the frame left over with the skin file's contact impedances, {:.3} % with these",
        fit.residual_before_percent,
        fit.residual_percent
    );
    say!(
        "scale         {:.6e} for each volt at 1 A and 1 S: {:.4e} S per square, if the file is in volts",
        fit.scale,
        fit.sheet_conductivity_s
    );
    if let Some(grain) = &fit.grain {
        let deviation = grain.across_deviation_percent.map_or("unknown".into(), |it| format!("{it:.1} %"));
        say!(
            "grain         {:.3} times the conductivity across it (skin file {:.3}; deviation {deviation}), at {:.1} deg \
             (skin file {:.1})",
            grain.across,
            grain.across_before,
            grain.angle_degrees,
            grain.angle_before_degrees
        );
    }
    say!("{:>9} {:>12} {:>12} {:>10}", "electrode", "skin file", "fitted/ohm m", "deviation");
    for contact in &fit.contacts {
        let deviation =
            contact.deviation_percent.map_or("unknown".into(), |percent| format!("{percent:.1} %"));
        let (before, fitted) = (contact.before, contact.contact_impedance);
        say!("{:>9} {before:>12.4e} {fitted:>12.4e} {deviation:>10}", contact.electrode + 1);
    }
    if fit.residual_percent > MUCH_LEFT_PERCENT {
        eprintln!(
            "warning: the fit leaves over {:.0} % of the frame: the model does not explain it, and these \
             impedances mean little",
            fit.residual_percent
        );
    }
}
