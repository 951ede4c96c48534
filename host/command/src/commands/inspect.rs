//! `dermatome inspect`: what a patch file holds.

use super::{JsonReport, patch_id};
use anyhow::Context;
use dermatome_patch::input::{self, MAX_PATCH_BYTES};
use dermatome_shared::{
    image::PixelGrid,
    patch::{
        FORMAT_VERSION, PatchHeader, PatchView,
        reflexes::{Limit, ReflexRule},
    },
};
use serde::Serialize;
use std::path::PathBuf;

/// Show what a patch file holds, and check it.
#[derive(clap::Args)]
#[command(after_help = "Examples:
  dermatome inspect disc-210mm.dermatome
  dermatome inspect disc-210mm.dermatome --json patch.json")]
pub(super) struct Args {
    /// Patch file.
    #[arg(value_name = "PATCH")]
    patch: PathBuf,
    #[command(flatten)]
    json: JsonReport,
}

/// What `inspect` tells; keys are documented in docs/cli.md.
#[derive(Serialize)]
struct Report {
    format_version: u16,
    patch_bytes: usize,
    patch_crc: String,
    header: PatchHeader,
    smallest_exponent: i8,
    largest_exponent: i8,
    /// The rules by which the board acts by itself, in words.
    reflexes: Vec<String>,
}

pub(super) fn run(args: &Args) -> anyhow::Result<()> {
    let name = || format!("patch file `{}`", args.patch.display());
    let bytes =
        input::read(&args.patch, MAX_PATCH_BYTES).with_context(|| format!("cannot read {}", name()))?;
    let patch = PatchView::validate(&bytes).with_context(name)?;
    let exponents = || patch.matrix().row_exponents();
    let report = Report {
        format_version: FORMAT_VERSION,
        patch_bytes: bytes.len(),
        patch_crc: patch_id(patch.crc()),
        header: patch.header.clone(),
        smallest_exponent: exponents().min().unwrap_or(0),
        largest_exponent: exponents().max().unwrap_or(0),
        reflexes: patch.reflex_rules().map(|rule| in_words(&rule)).collect(),
    };
    print(&report);
    args.json.write(&report)
}

fn in_words(rule: &ReflexRule) -> String {
    let limit = match rule.limit {
        Limit::Strength(strength) => format!("a strength of {strength:.3}"),
        Limit::Force(newtons) => format!("{newtons:.3} N"),
        Limit::Area { area, strength } => format!("{:.1} cm2 above a strength of {strength:.3}", area * 1e4),
    };
    let ReflexRule { name, pin, frames, rows, .. } = rule;
    format!("{name}, pin {pin}: above {limit}, {frames} frames long, in {rows} cells")
}

fn print(report: &Report) {
    let header = &report.header;
    let (grid, drive) = (&header.grid, &header.drive);
    say!("skin          {}", header.skin);
    say!(
        "patch         {} bytes, format {}, id {}, CRC good",
        report.patch_bytes,
        report.format_version,
        report.patch_crc
    );
    say!("electrodes    {}", header.electrodes);
    say!(
        "measurements  {} from {} steps, {:?} difference",
        header.measurements,
        header.steps,
        header.difference
    );
    match grid {
        Some(PixelGrid { columns, rows, pitch, .. }) => say!(
            "pixels        {} on a grid of {columns} x {rows}, {:.3} mm each",
            header.pixels,
            pitch * 1e3
        ),
        None => say!("pixels        {} on a surface, each with its place and normal", header.pixels),
    }
    say!(
        "drive         {} kHz, {:.3} mA, {} frames per second",
        drive.frequency / 1e3,
        drive.amplitude * 1e3,
        drive.frame_rate
    );
    say!("contact from  {:.3} relative conductivity change", header.contact_threshold.to_f64());
    match header.calibration.points.last() {
        Some(last) => say!(
            "calibration   {} points up to {} kPa, {} play operators against hysteresis, {}",
            header.calibration.points.len(),
            last.pressure / 1e3,
            header.play_operators,
            match header.calibration.load_share {
                Some(share) => format!("the load acts on {share:.3} of a contact's area"),
                None => "no force".to_owned(),
            }
        ),
        None => say!("calibration   none"),
    }
    report.reflexes.iter().for_each(|reflex| say!("reflex        {reflex}"));
    say!("matrix        i16, row exponents {} to {}", report.smallest_exponent, report.largest_exponent);
}
