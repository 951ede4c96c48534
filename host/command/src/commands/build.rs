//! `dermatome build`: skin file -> reconstruction matrix -> patch file.

use super::{
    JsonReport,
    outputs::{Kind, Output, patch_file},
    patch_id,
    preserved::{Preserved, refuse_to_lose},
    progress,
};
use anyhow::{Context, bail};
use dermatome_geometry::mesh::{
    Mesh,
    quality::{Quality, quality},
    soundness::{Boundary, inspect},
};
use dermatome_model::{
    inverse::figures::Blur,
    metrics::detectability::{Deaf, LEVEL, Sought},
    model::{Model, Stage, driven_error, needed_gigabytes},
    quantize::{self, FixedPointError, ReflexReport},
    skin::{FoundIn, Skin},
    stimulation,
};
use dermatome_patch::{output::write_whole, write::Stored};
use dermatome_shared::patch::{PatchView, places::MAX_PLACES};
use dermatome_view::plot::criterion_svg;
use serde::Serialize;
use std::{
    collections::BTreeMap,
    path::{Path, PathBuf},
    time::Instant,
};

/// Compute a skin's reconstruction matrix and write its patch.
#[derive(clap::Args)]
#[command(after_help = "Examples:
  dermatome build models/disc-210mm/skin.toml
  dermatome build models/square-50mm/skin.toml -o left-palm.dermatome --json build.json
  dermatome build models/hemisphere-210mm/skin.toml
  dermatome build skin.toml -o palm.dermatome --preserve-calibration palm.dermatome
  dermatome build models/hemisphere-210mm/skin.toml --flatten -o flattened.dermatome")]
pub(super) struct Args {
    /// Skin file.
    #[arg(value_name = "SKIN")]
    skin: PathBuf,
    /// Where to write the patch [default: the skin's name with .dermatome, in this folder].
    #[arg(short, long, value_name = "PATCH", value_parser = Kind::Patch.parser())]
    output: Option<Output>,
    /// Compute and report only; for skins that no board takes.
    #[arg(long, conflicts_with = "output")]
    no_patch: bool,
    /// Drop z: build the patch of the flat skin with the same rim and electrodes as seen from above, as the
    /// thesis compares surface and planar models.
    #[arg(long)]
    flatten: bool,
    /// Give the new patch curve and play operators of this one, as `calibrate` wrote them; they replace the skin file's curve.
    #[arg(long, alias = "keep-calibration", value_name = "PATCH", conflicts_with = "no_patch")]
    preserve_calibration: Option<PathBuf>,
    /// Draw the criterion by which the hyperparameter was chosen, as SVG.
    #[arg(long, value_name = "FILE", value_parser = Kind::Svg.parser())]
    hyperparameter_plot: Option<Output>,
    #[command(flatten)]
    json: JsonReport,
}

/// What `build` tells; keys are documented in docs/cli.md.
#[derive(Serialize)]
struct Report {
    skin: String,
    #[serde(flatten)]
    patch: Option<PatchReport>,
    electrodes: u8,
    steps: usize,
    measurements: usize,
    rank: usize,
    pixels: usize,
    mesh: MeshReport,
    hyperparameter: f64,
    hyperparameter_by: &'static str,
    noise_figure: f64,
    resolution: Resolution,
    image_noise_at_60_db: f64,
    deaf: Option<DeafReport>,
    contact_threshold: f64,
    warnings: Vec<String>,
    stage_seconds: BTreeMap<&'static str, f64>,
    total_seconds: f64,
}

#[derive(Serialize)]
struct PatchReport {
    #[serde(rename = "patch")]
    path: PathBuf,
    #[serde(rename = "patch_bytes")]
    bytes: usize,
    #[serde(rename = "patch_crc")]
    crc: String,
    /// Where presses are looked for.
    places: u16,
    /// How many pixels would leave room for all places.
    #[serde(skip)]
    pixels_for_all_places: Option<usize>,
    fixed_point_error: FixedPointError,
    calibration: CalibrationReport,
    reflexes: Vec<ReflexReport>,
}

/// What the patch knows of pressure.
#[derive(Serialize)]
struct CalibrationReport {
    points: usize,
    plays: usize,
    #[serde(rename = "kept_from")]
    preserved_from: Option<PathBuf>,
    /// Whether it may not suit the new patch.
    #[serde(skip)]
    is_doubtful: bool,
}

/// How good the mesh is, and what is strange about it.
#[derive(Serialize)]
struct MeshReport {
    #[serde(flatten)]
    quality: Quality,
    holes: Vec<Boundary>,
    closed: bool,
    non_manifold_edges: usize,
    degenerate: usize,
    flipped: usize,
    one_sided: bool,
    open_seams: usize,
    notes: Vec<String>,
}

impl MeshReport {
    fn of(mesh: &Mesh) -> Self {
        let found = inspect(&mesh.nodes, &mesh.elements);
        Self {
            quality: quality(mesh),
            holes: found.holes().to_vec(),
            closed: found.boundaries.is_empty(),
            non_manifold_edges: found.non_manifold.len(),
            degenerate: found.degenerate.len(),
            flipped: found.flipped,
            one_sided: found.one_sided,
            open_seams: found.seams.len(),
            notes: found.notes(),
        }
    }
}

/// How widely images spread a point.
#[derive(Serialize)]
struct Resolution {
    mean_res: f64,
    median_radius_mm: f64,
    worst_radius_mm: f64,
}

impl From<Blur> for Resolution {
    fn from(blur: Blur) -> Self {
        Self {
            mean_res: blur.resolution,
            median_radius_mm: blur.median_radius * 1e3,
            worst_radius_mm: blur.worst_radius * 1e3,
        }
    }
}

/// Where a finger is not detected.
#[derive(Serialize)]
struct DeafReport {
    share_percent: f64,
    worst_place_mm: [f64; 3],
    significance: f64,
    finger_radius_mm: f64,
}

impl DeafReport {
    fn new(deaf: &Deaf, finger: &Sought) -> Self {
        Self {
            share_percent: 100.0 * deaf.share,
            worst_place_mm: (deaf.worst.position.coords * 1e3).into(),
            significance: deaf.worst.significance,
            finger_radius_mm: finger.radius * 1e3,
        }
    }
}

/// The threshold should be this many standard deviations above the noise.
const NOISE_MARGIN: f64 = 3.0;
/// A reflex' limit should be this many standard deviations above the noise.
const LEAST_LIMIT: f64 = 5.0;
/// Error of fixed point that is worth a warning.
const WORST_ERROR_PERCENT: f64 = 0.5;
/// Angle of a triangle that is worth a warning.
const SHARP_ANGLE_DEGREES: f64 = 10.0;

fn load(args: &Args) -> anyhow::Result<Skin> {
    let skin = Skin::load(&args.skin)?.made()?;
    if !args.flatten {
        return Ok(skin);
    }
    skin.flattened().with_context(|| format!("skin file `{}`", args.skin.display()))
}

pub(super) fn run(args: &Args) -> anyhow::Result<()> {
    let start = Instant::now();
    let skin = load(args)?;
    if !args.no_patch {
        check_drive(args, &skin)?;
    }
    let preserved = preserved(args, &skin)?;
    let in_file = || format!("skin file `{}`", args.skin.display());
    let spinner = progress::spinner();
    let mut mesh = None;
    let mut model =
        Model::build_beside(&skin, &mut |stage| spinner.set_message(stage), &mut drop, &mut |made| {
            mesh = Some(MeshReport::of(made));
        })
        .with_context(in_file)?;
    let mesh = mesh.expect("a model that is built has a mesh");
    let plot = args.hyperparameter_plot.as_deref();
    plot.map_or(Ok(()), |path| write_plot(&skin, &model, path))?;
    spinner.set_message("patch");
    let patch =
        if args.no_patch { None } else { Some(write_patch(args, &skin, &mut model, preserved.as_ref())?) };
    spinner.finish_and_clear();
    let (blur, (noise, noise_figure)) =
        rayon::join(|| model.blur(), || (model.image_noise(60.0), model.noise_figure()));
    let mut warnings = warnings(&skin, &mesh.quality, patch.as_ref(), noise);
    warnings.extend(driven_error(&skin, &model.mesh)?.and_then(warning_of_driven));
    let finger = Sought::finger(model.pixels.larger_side(), 60.0);
    let report = Report {
        skin: skin.name.clone(),
        electrodes: skin.electrodes.count,
        steps: model.steps.len(),
        measurements: model.jacobian.nrows(),
        rank: stimulation::report(&model.steps, skin.electrodes.count).rank,
        pixels: model.jacobian.ncols(),
        warnings,
        mesh,
        patch,
        hyperparameter: model.hyperparameter,
        hyperparameter_by: model.selection.as_ref().map_or("fixed", |selection| selection.criterion.name()),
        noise_figure,
        resolution: blur.into(),
        image_noise_at_60_db: noise,
        deaf: model.detectability(&finger).deaf().map(|deaf| DeafReport::new(&deaf, &finger)),
        contact_threshold: skin.contact_threshold,
        stage_seconds: model.stages.iter().map(|stage| (stage.name, stage.time.as_secs_f64())).collect(),
        total_seconds: start.elapsed().as_secs_f64(),
    };
    print(&report, &model.stages);
    report.warnings.iter().for_each(|warning| eprintln!("warning: {warning}"));
    args.json.write(&report)
}

/// Fails before the work if no board takes the skin.
fn check_drive(args: &Args, skin: &Skin) -> anyhow::Result<()> {
    let gigabytes = needed_gigabytes(skin);
    let memory = if gigabytes < 0.1 { String::new() } else { format!(", in {gigabytes:.1} GB of memory") };
    let allowed = format!("allowed: `--no-patch`, to compute only{memory}");
    quantize::check_drive(skin)
        .map_err(|error| anyhow::anyhow!("skin file `{}`: {error}; {allowed}", args.skin.display()))
}

fn write_plot(skin: &Skin, model: &Model, path: &Path) -> anyhow::Result<()> {
    let Some(selection) = &model.selection else {
        bail!(
            "--hyperparameter-plot has nothing to draw: `inverse.hyperparameter` is a number; allowed here: \
             \"l-curve\", \"gcv\", \"noise-figure\" or \"best-resolution\""
        );
    };
    Ok(write_whole(path, criterion_svg(&skin.name, selection).as_bytes())?)
}

/// The calibration to keep, if one is asked for. None may get lost.
fn preserved(args: &Args, skin: &Skin) -> anyhow::Result<Option<Preserved>> {
    if args.no_patch {
        return Ok(None);
    }
    let from = args.preserve_calibration.as_deref();
    let preserved = from.map(|path| Preserved::read(path, &skin.name)).transpose()?;
    let of_file = || Stored::curve(skin.calibration.clone());
    let of_new = preserved.as_ref().map_or_else(of_file, |preserved| preserved.stored.clone());
    let path = patch_file(args.output.as_ref(), &skin.name)?;
    let file = path.display();
    let allowed = format!("`--preserve-calibration {file}`, another `--output`, or remove the file");
    refuse_to_lose(&path, &of_new, &allowed)?;
    Ok(preserved)
}

fn write_patch(
    args: &Args,
    skin: &Skin,
    model: &mut Model,
    preserved: Option<&Preserved>,
) -> anyhow::Result<PatchReport> {
    let path = patch_file(args.output.as_ref(), &skin.name)?;
    let quantizing = Instant::now();
    let (patch, is_doubtful) =
        patch_of(skin, model, preserved).with_context(|| format!("skin file `{}`", args.skin.display()))?;
    let view = PatchView::validate(&patch)?;
    let fixed_point_error = quantize::fixed_point_error(model, &view, quantize::TRIALS)?;
    model.stages.push(Stage { name: "quantize", time: quantizing.elapsed() });
    let writing = Instant::now();
    write_whole(&path, &patch)?;
    model.stages.push(Stage { name: "write", time: writing.elapsed() });
    let calibration = CalibrationReport {
        points: view.header.calibration.points.len(),
        plays: usize::from(view.header.play_operators),
        preserved_from: args.preserve_calibration.clone(),
        is_doubtful,
    };
    Ok(PatchReport {
        path,
        bytes: patch.len(),
        crc: patch_id(view.crc()),
        places: view.header.detection.places,
        pixels_for_all_places: quantize::pixels_for_all_places(&view),
        fixed_point_error,
        calibration,
        reflexes: quantize::reflex_reports(skin, model, &view),
    })
}

/// The patch, and whether the calibration that it keeps is doubtful on it.
fn patch_of(skin: &Skin, model: &Model, preserved: Option<&Preserved>) -> anyhow::Result<(Vec<u8>, bool)> {
    let Some(preserved) = preserved else { return Ok((quantize::patch(skin, model)?, false)) };
    let plain = quantize::patch_with(skin, model, &preserved.stored)?;
    let with_field = preserved.with_field(&plain)?;
    let is_doubtful = with_field.is_none();
    Ok((with_field.unwrap_or(plain), is_doubtful))
}

/// Fewer places than these, nine tenths of all, are worth a warning: with 185 one finger was two in 2 of 100.
const FEW_PLACES: usize = MAX_PLACES * 9 / 10;
/// Error of voltages on driven electrodes that is worth a warning, %.
const DRIVEN_ERROR_PERCENT: f64 = 1.0;

/// For an error as [`driven_error`] estimates it.
pub(super) fn warning_of_driven(error: f64) -> Option<String> {
    let percent = 100.0 * error;
    (percent > DRIVEN_ERROR_PERCENT).then(|| {
        format!(
            "the model's voltages on driven electrodes are off by up to about {percent:.0} % on this mesh: shorten \
             `mesh.electrode_edge_length` (an imported mesh needs shorter edges at electrodes)"
        )
    })
}

/// What a reflex does that nobody wants.
fn warning_of_reflex(reflex: &ReflexReport) -> Option<String> {
    let ReflexReport { name, limit, noise, largest_cell, .. } = reflex;
    if reflex.is_area {
        let (limit, cell) = (limit * 1e4, largest_cell * 1e4);
        return (limit <= cell).then(|| {
            format!(
                "the reflex {name:?} trips by one touch: its limit is {limit:.1} cm2, and areas are counted in whole cells of up \
                 to {cell:.1} cm2; raise the limit, or have fewer rules or a smaller region"
            )
        });
    }
    (*limit < LEAST_LIMIT * noise).then(|| {
        format!(
            "the reflex {name:?} trips by noise: its limit is {limit:.2}, and a frame's noise at 60 dB {noise:.3} (standard \
             deviation); raise the limit, ask for more `frames`, or have fewer rules or a smaller region"
        )
    })
}

/// What is allowed, but seldom meant.
fn warnings(skin: &Skin, mesh: &Quality, patch: Option<&PatchReport>, noise: f64) -> Vec<String> {
    let mut warnings = Vec::new();
    if skin.contacts_found_in == FoundIn::Image && noise > skin.contact_threshold / NOISE_MARGIN {
        warnings.push(format!(
            "measured at 60 dB, noise in the image reaches {noise:.3} (standard deviation), too close to \
             `contact.threshold` {}: expect contacts where nobody presses; raise the threshold or \
             `inverse.hyperparameter`, or set `inverse.normalised` = false",
            skin.contact_threshold
        ));
    }
    let fixed_point = patch.map_or(0.0, |patch| patch.fixed_point_error.measured_percent);
    if fixed_point > WORST_ERROR_PERCENT {
        warnings.push(format!("fixed point costs {fixed_point:.2} % of the image's peak"));
    }
    if let Some(&PatchReport { places, pixels_for_all_places: Some(pixels), .. }) = patch
        && usize::from(places) < FEW_PLACES
    {
        warnings.push(format!(
            "the image leaves the patch room for {places} places where presses are looked for, {MAX_PLACES} tell better where \
             they are, and how many: about {pixels} pixels leave room for them (`image.pixels` or `image.columns`)"
        ));
    }
    if patch.is_some_and(|patch| patch.calibration.is_doubtful) {
        warnings.push(
            "the calibration was made with another reconstruction matrix or other places, whose contacts may be stronger or \
             weaker, and a field of gain is lost: check it with a known load, or calibrate anew"
                .to_owned(),
        );
    }
    warnings.extend(patch.iter().flat_map(|patch| &patch.reflexes).filter_map(warning_of_reflex));
    if mesh.smallest_angle_degrees < SHARP_ANGLE_DEGREES {
        warnings.push(format!(
            "the mesh has an angle of {:.1} degrees: an electrode's end lies very close to another or to a corner",
            mesh.smallest_angle_degrees
        ));
    }
    warnings
}

fn print(report: &Report, stages: &[Stage]) {
    say!("skin          {}", report.skin);
    print_mesh(&report.mesh);
    say!(
        "measurements  {} from {} steps, {} electrodes, rank {}",
        report.measurements,
        report.steps,
        report.electrodes,
        report.rank
    );
    say!("pixels        {}", report.pixels);
    say!(
        "lambda        {:.4e} ({}), noise figure {:.2}",
        report.hyperparameter,
        report.hyperparameter_by,
        report.noise_figure
    );
    let blur = &report.resolution;
    say!(
        "resolution    RES {:.3} of the skin, a point spreads to a radius of {:.1} mm (median), {:.1} mm (worst)",
        blur.mean_res,
        blur.median_radius_mm,
        blur.worst_radius_mm
    );
    say!(
        "image noise   {:.4} at 60 dB, worst pixel (contacts count from {})",
        report.image_noise_at_60_db,
        report.contact_threshold
    );
    report.deaf.iter().for_each(print_deaf);
    for stage in stages {
        say!("{:<12}  {:>8.1} ms", stage.name, stage.time.as_secs_f64() * 1e3);
    }
    say!("{:<12}  {:>8.1} ms", "total", report.total_seconds * 1e3);
    let Some(patch) = &report.patch else {
        say!("patch         none, as asked");
        return;
    };
    say!(
        "fixed point   error {:.3} % of the image's peak on {} simulated presses",
        patch.fixed_point_error.measured_percent,
        quantize::TRIALS
    );
    let CalibrationReport { points, plays, preserved_from, .. } = &patch.calibration;
    if let Some(from) = preserved_from {
        say!("calibration   {points} points and {plays} play operators, preserved from {}", from.display());
    }
    patch.reflexes.iter().for_each(print_reflex);
    say!("patch         {} ({} bytes, id {})", patch.path.display(), patch.bytes, patch.crc);
}

fn print_reflex(reflex: &ReflexReport) {
    let ReflexReport { name, pin, cells, inside: [least, most], outside, noise, limit, .. } = reflex;
    if reflex.is_area {
        say!(
            "reflex        {name}, pin {pin}: {cells} cells of up to {:.1} cm2; noise {noise:.3} at 60 dB; limit {:.1} cm2",
            reflex.largest_cell * 1e4,
            limit * 1e4
        );
        return;
    }
    say!(
        "reflex        {name}, pin {pin}: in {cells} cells a load of 1 reads {least:.2} to {most:.2}, one outside at most \
         {outside:.2}; noise {noise:.3} at 60 dB; limit {limit:.2}"
    );
}

fn print_deaf(deaf: &DeafReport) {
    let [x, y, z] = deaf.worst_place_mm;
    say!(
        "deaf          on {:.1} % of the skin a finger of {:.1} mm radius at full depth and 60 dB is not detected; worst at \
         x {x:.0}, y {y:.0}, z {z:.0} mm: it stands out by {:.1} of the {LEVEL} standard deviations it needs",
        deaf.share_percent,
        deaf.finger_radius_mm,
        deaf.significance
    );
}

/// One line, and one more for each thing that is strange.
fn print_mesh(MeshReport { quality, notes, .. }: &MeshReport) {
    say!(
        "mesh          {} elements, {} nodes, smallest angle {:.1} degrees",
        quality.elements,
        quality.nodes,
        quality.smallest_angle_degrees
    );
    notes.iter().for_each(|note| say!("{:14}{note}", ""));
}
