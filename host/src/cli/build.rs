//! `dermatome build`: skin file -> patch file.

use super::{JsonReport, patch_id, progress};
use crate::{
    mesh::quality::{Quality, quality},
    model::{Model, Stage},
    output::write_whole,
    quantize::{self, FixedPointError},
    skin::Skin,
};
use anyhow::Context;
use dermatome_shared::patch::PatchView;
use serde::Serialize;
use std::{collections::BTreeMap, path::PathBuf, time::Instant};

/// Compute a skin's reconstruction matrix and write its patch.
#[derive(clap::Args)]
#[command(after_help = "Examples:
  dermatome build models/disc-210mm/skin.toml
  dermatome build models/square-50mm/skin.toml -o left-palm.dermatome --json build.json")]
pub(super) struct Args {
    /// Skin file.
    #[arg(value_name = "SKIN")]
    skin: PathBuf,
    /// Where to write the patch [default: the skin's name with .dermatome, in this folder].
    #[arg(short, long, value_name = "PATCH")]
    output: Option<PathBuf>,
    #[command(flatten)]
    json: JsonReport,
}

/// What `build` tells; keys are documented in docs/cli.md.
#[derive(Serialize)]
struct Report {
    skin: String,
    patch: PathBuf,
    patch_bytes: usize,
    patch_crc: String,
    electrodes: u8,
    steps: usize,
    measurements: usize,
    pixels: usize,
    mesh: Quality,
    fixed_point_error: FixedPointError,
    image_noise_at_60_db: f64,
    contact_threshold: f64,
    warnings: Vec<String>,
    stage_seconds: BTreeMap<&'static str, f64>,
    total_seconds: f64,
}

/// Random presses on which the fixed-point error is measured.
const TRIALS: usize = 32;
/// The threshold should be this many standard deviations above the noise.
const NOISE_MARGIN: f64 = 3.0;
/// Error of fixed point that is worth a warning.
const WORST_ERROR_PERCENT: f64 = 0.5;
/// Angle of a triangle that is worth a warning.
const SHARP_ANGLE_DEGREES: f64 = 10.0;

pub(super) fn run(args: &Args) -> anyhow::Result<()> {
    let start = Instant::now();
    let skin = Skin::load(&args.skin)?;
    let path = args.output.clone().unwrap_or_else(|| PathBuf::from(format!("{}.dermatome", skin.name)));
    let in_file = || format!("skin file `{}`", args.skin.display());
    let spinner = progress::spinner();
    let mut model = Model::build(&skin, |stage| spinner.set_message(stage)).with_context(in_file)?;
    let quantizing = Instant::now();
    spinner.set_message("quantize");
    let patch = quantize::patch(&skin, &model).with_context(in_file)?;
    let view = PatchView::validate(&patch)?;
    let fixed_point_error = quantize::fixed_point_error(&model, &view, TRIALS).with_context(in_file)?;
    model.stages.push(Stage { name: "quantize", time: quantizing.elapsed() });
    let writing = Instant::now();
    write_whole(&path, &patch)?;
    model.stages.push(Stage { name: "write", time: writing.elapsed() });
    spinner.finish_and_clear();
    let mesh = quality(&model.mesh);
    let noise = model.image_noise(60.0);
    let report = Report {
        skin: skin.name.clone(),
        patch: path,
        patch_bytes: patch.len(),
        patch_crc: patch_id(view.crc()),
        electrodes: skin.electrodes.count(),
        steps: model.steps.len(),
        measurements: model.jacobian.nrows(),
        pixels: model.jacobian.ncols(),
        warnings: warnings(&skin, &mesh, &fixed_point_error, noise),
        mesh,
        fixed_point_error,
        image_noise_at_60_db: noise,
        contact_threshold: skin.contact_threshold,
        stage_seconds: model.stages.iter().map(|stage| (stage.name, stage.time.as_secs_f64())).collect(),
        total_seconds: start.elapsed().as_secs_f64(),
    };
    print(&report, &model.stages);
    report.warnings.iter().for_each(|warning| eprintln!("warning: {warning}"));
    args.json.write(&report)
}

/// What is allowed, but seldom meant.
fn warnings(skin: &Skin, mesh: &Quality, error: &FixedPointError, noise: f64) -> Vec<String> {
    let mut warnings = Vec::new();
    if noise > skin.contact_threshold / NOISE_MARGIN {
        warnings.push(format!(
            "measured at 60 dB, noise in the image reaches {noise:.3} (standard deviation), too close to \
             `contact.threshold` {}: expect contacts where nobody presses; raise the threshold or \
             `inverse.hyperparameter`, or set `inverse.normalised` = false",
            skin.contact_threshold
        ));
    }
    if error.measured_percent > WORST_ERROR_PERCENT {
        warnings.push(format!("fixed point costs {:.2} % of the image's peak", error.measured_percent));
    }
    if mesh.smallest_angle_degrees < SHARP_ANGLE_DEGREES {
        warnings.push(format!(
            "the mesh has an angle of {:.1} degrees: an electrode's end lies very close to another or to a corner",
            mesh.smallest_angle_degrees
        ));
    }
    warnings
}

fn print(report: &Report, stages: &[Stage]) {
    let mesh = &report.mesh;
    say!("skin          {}", report.skin);
    say!(
        "mesh          {} elements, {} nodes, smallest angle {:.1} degrees",
        mesh.elements,
        mesh.nodes,
        mesh.smallest_angle_degrees
    );
    say!(
        "measurements  {} from {} steps, {} electrodes",
        report.measurements,
        report.steps,
        report.electrodes
    );
    say!("pixels        {}", report.pixels);
    say!(
        "fixed point   error {:.4} % of the image's peak on {TRIALS} simulated presses (bound {:.3} %)",
        report.fixed_point_error.measured_percent,
        report.fixed_point_error.bound_percent
    );
    say!(
        "image noise   {:.4} at 60 dB, worst pixel (contacts count from {})",
        report.image_noise_at_60_db,
        report.contact_threshold
    );
    for stage in stages {
        say!("{:<12}  {:>8.1} ms", stage.name, stage.time.as_secs_f64() * 1e3);
    }
    say!("{:<12}  {:>8.1} ms", "total", report.total_seconds * 1e3);
    say!("patch         {} ({} bytes, id {})", report.patch.display(), report.patch_bytes, report.patch_crc);
}
