//! `dermatome learn`: recorded presses and a skin's model -> a calibrated patch.

use super::{
    JsonReport,
    choices::Strength,
    flags::in_flags,
    frame_options::{Flags, FrameOptions},
    noise::seed,
    outputs::{Kind, Output, patch_file},
    patch_id,
    playing::{Playing, session_of_others},
    preserved::refuse_to_lose,
    progress,
    reconstruct::{WeightChoice, weigh_by_magnitude},
};
use anyhow::{Context, bail};
use dermatome_frames::{
    learn::{
        LearnReport, MOST_TEST, Request,
        judge::{Errors, ToldApart},
        learn,
        presses::Recording,
    },
    recorded::{
        diagnose::diagnose,
        read::Source,
        replay::{Replay, ReplayError, Times, Untouched},
    },
};
use dermatome_link::pose::Pose;
use dermatome_model::{
    model::Model,
    quantize::{self, FixedPointError},
    skin::Skin,
};
use dermatome_patch::{output::write_whole, write::Stored};
use dermatome_shared::{
    patch::{Difference, PatchView},
    stimulation::Step,
};
use serde::Serialize;
use std::{
    ffi::OsString,
    path::{Path, PathBuf},
};

/// Calibrate a skin's matrix from presses at known places, and write its patch.
///
/// Presses teach how measurements respond to one anywhere; what they say nothing of, the model says. Some
/// presses are kept aside and judge the patch in a board's fixed point.
#[derive(clap::Args)]
#[command(
    after_help = "FILE is an .npz or .mat archive with the arrays v_pressed [press][measurement], positions_m [press][x, y, z] \
(without z on a flat skin), v_unpressed (one frame, or one for each press) and perhaps force_n [press]; or a table (.csv, .txt, .npy, \
.mat) with one press per row: x and y in metres, on a curved skin z as well, perhaps the force in newtons, then the measurements.

Examples:
  dermatome learn skin.toml --presses presses.npz --record presses.mcap
  dermatome learn skin.toml --presses presses.csv --reference before.csv --each
  dermatome learn skin.toml --presses presses.csv --reference idle.csv -o calibrated.dermatome --json learn.json"
)]
pub(super) struct Args {
    /// Skin file.
    #[arg(value_name = "SKIN")]
    skin: PathBuf,
    /// Recorded presses.
    #[arg(long, value_name = "FILE")]
    presses: PathBuf,
    /// Frames of the untouched skin, averaged; without it, v_unpressed of the archive.
    #[arg(long, value_name = "FILE")]
    reference: Option<OsString>,
    /// Each press has a reference of its own, the one of its number.
    #[arg(long, requires = "reference")]
    each: bool,
    /// Where to write the patch [default: the skin's name with .dermatome, in this folder].
    #[arg(short, long, value_name = "PATCH", value_parser = Kind::Patch.parser())]
    output: Option<Output>,
    /// Record the presses to this file, each by itself after its reference, with what a board with the learnt patch makes of
    /// them (MCAP).
    #[arg(long, value_name = "FILE.mcap", value_parser = Kind::Recording.parser())]
    record: Option<Output>,
    /// Share of the presses kept aside to judge the result, 0 to 0.5.
    #[arg(long, value_name = "SHARE", default_value_t = 0.2, value_parser = share)]
    test: f64,
    /// Seed of the split.
    #[arg(long, value_name = "SEED", default_value_t = 1, value_parser = seed, allow_negative_numbers = true)]
    seed: u64,
    /// What a press's strength in the image follows: the size of its answer, or its force.
    #[arg(long, value_enum, default_value_t)]
    strength: Strength,
    /// How much each measurement counts in the model's matrix: as the skin file says, or in proportion to
    /// the square of the measured reference (normalised data only).
    #[arg(long, value_enum, default_value_t)]
    weights: WeightChoice,
    #[command(flatten)]
    options: FrameOptions,
    #[command(flatten)]
    json: JsonReport,
}

/// What `learn` tells; keys are documented in docs/cli.md.
#[derive(Serialize)]
struct Report {
    skin: String,
    presses_file: PathBuf,
    #[serde(flatten)]
    learnt: LearnReport,
    patch: PathBuf,
    patch_bytes: usize,
    patch_crc: String,
    fixed_point_error: FixedPointError,
    warnings: Vec<String>,
}

/// A turn of the model's places that is worth a warning, degrees.
const TURNED: f64 = 8.0;

pub(super) fn run(args: &Args) -> anyhow::Result<()> {
    let mut skin = Skin::load(&args.skin)?.made()?;
    let in_presses = || format!("presses `{}`", args.presses.display());
    let in_both = || format!("presses `{}` on skin file `{}`", args.presses.display(), args.skin.display());
    let recording = read(args, &skin).with_context(in_presses)?;
    let path = patch_file(args.output.as_ref(), &skin.name)?;
    let of_new = Stored::curve(skin.calibration.clone());
    refuse_to_lose(&path, &of_new, "another `--output`, or remove the file and calibrate after learning")?;
    if let WeightChoice::Magnitude = args.weights {
        weigh_by_magnitude(&mut skin, &recording.unpressed, &args.options).with_context(in_presses)?;
    }
    if args.record.is_some() {
        check_signs(&recording, skin.inverse.difference).context("`--record`").with_context(in_presses)?;
    }
    let spinner = progress::spinner();
    let in_skin = || format!("skin file `{}`", args.skin.display());
    let model = Model::build(&skin, |stage| spinner.set_message(stage)).with_context(in_skin)?;
    spinner.set_message("learning");
    let arrangement = args.options.arrangement();
    let presses = recording.on(&model, &arrangement).with_context(in_presses)?;
    let request = Request { test_share: args.test, seed: args.seed, strength: args.strength.into() };
    let learnt = learn(&skin, &model, &presses, &request).with_context(in_both)?;
    let view = PatchView::validate(&learnt.patch)?;
    let fixed_point_error =
        quantize::fixed_point_error(&learnt.model, &view, quantize::TRIALS).with_context(in_both)?;
    let electrodes = skin.electrodes.count;
    let diagnosis =
        diagnose(&model.steps, electrodes, &model.voltages, &presses.mean_reference, arrangement)?;
    write_whole(&path, &learnt.patch)?;
    spinner.finish_and_clear();
    if let Some(file) = &args.record {
        record(args, file, &recording, &view, skin.pose.as_ref()).context("`--record`")?;
    }
    let mut warnings = diagnosis.warnings(&Flags);
    warnings.extend(doubts(&skin, &learnt.report));
    let report = Report {
        skin: skin.name.clone(),
        presses_file: args.presses.clone(),
        patch: path,
        patch_bytes: learnt.patch.len(),
        patch_crc: patch_id(view.crc()),
        fixed_point_error,
        learnt: learnt.report,
        warnings,
    };
    print(&report);
    report.warnings.iter().for_each(|warning| eprintln!("warning: {warning}"));
    args.json.write(&report)
}

fn read(args: &Args, skin: &Skin) -> anyhow::Result<Recording> {
    let source = args.reference.as_ref().map(|name| Source::new(name));
    let reference = source
        .as_ref()
        .map(|source| args.options.read(source, &skin.steps(), skin.electrodes.count))
        .transpose()?;
    let reference = reference.map(|frames| if args.each { frames } else { frames.averaged() });
    let recording = Recording::read(&args.presses, reference, &args.options.layout(), skin)
        .map_err(|error| in_flags(error, &[("as a reference of their own", "with --reference")]))?;
    let (presses, references) = (recording.pressed.frames, recording.unpressed.frames);
    if let Some(source) = source.filter(|_| args.each && references != presses) {
        bail!(
            "`{source}` holds {references} references for {presses} presses; allowed with --each: one for each"
        );
    }
    Ok(recording)
}

/// Whether frames tell a patch all signs that it needs.
fn check_signs(recording: &Recording, difference: Difference) -> Result<(), ReplayError> {
    let is_complex = recording.pressed.complex || recording.unpressed.complex;
    if is_complex && difference == Difference::Plain { Err(ReplayError::Signs) } else { Ok(()) }
}

/// Records presses as a board with the learnt patch would have sent them.
fn record(
    args: &Args,
    file: &Path,
    recording: &Recording,
    patch: &PatchView<'_>,
    pose: Option<&Pose>,
) -> anyhow::Result<()> {
    let Recording { pressed, unpressed, .. } = recording;
    let before = unpressed.for_each_of(pressed.frames);
    let times = Times::Rate(patch.header.drive.frame_rate.into());
    let replay = Replay::new(patch, pressed, Untouched::Each(&before), &args.options.arrangement(), &times)?;
    let steps: Vec<Step> = patch.steps().collect();
    let mut playing = Playing::new(patch, &steps)?;
    let session = session_of_others(patch, args.presses.display().to_string(), Some(&args.skin))?;
    playing.record(file, &session, pose, replay.begun())?;
    for item in replay {
        playing.take(&item?)?;
    }
    playing.finish()
}

/// What the figures say against the result.
fn doubts(skin: &Skin, report: &LearnReport) -> Vec<String> {
    let mut doubts = Vec::new();
    let turn = report.turn;
    if turn.is_some_and(|turn| turn.mirrored) {
        doubts.push(
            "the presses fit the model better mirrored: check --mirror and `electrodes.direction`, and which way x \
             and y of the presses run"
                .to_owned(),
        );
    } else if let Some(turn) = turn.filter(|turn| turn.degrees.abs() > TURNED) {
        doubts.push(format!(
            "the presses fit the model best if its places are turned by {:+.1} degrees: the prior is better with \
             electrodes (`electrodes.first`, --rotation) turned by as much",
            turn.degrees
        ));
    }
    if report.validation.mean_mm >= report.model_training.mean_mm {
        doubts.push(format!(
            "in cross-validation the learnt matrix is no better than the model's (mean error {:.1} and {:.1} mm): \
             record more presses, or keep the patch of `build`",
            report.validation.mean_mm, report.model_training.mean_mm
        ));
    }
    if report.contact_threshold < skin.contact_threshold {
        doubts.push(format!(
            "the patch has a contact threshold of {:.3e} instead of `contact.threshold` {}, which would hide weak \
             presses",
            report.contact_threshold, skin.contact_threshold
        ));
    }
    if report.test.is_none() {
        doubts.push("no presses were kept for a test: --test is 0".to_owned());
    }
    doubts
}

fn print(report: &Report) {
    let learnt = &report.learnt;
    say!("skin          {}", report.skin);
    say!(
        "presses       {}: {} to learn from, {} for the test (seed {})",
        learnt.presses,
        learnt.training_presses,
        learnt.test_presses,
        learnt.seed
    );
    if let Some(off) = learnt.off_skin {
        say!(
            "laid          on the skin, {:.2} mm away at most, {:.2} in the median (allowed: {:.1})",
            off.farthest_mm,
            off.median_mm,
            off.allowed_mm
        );
    }
    let direction = if learnt.conductivity_falls { "falls" } else { "rises" };
    say!("polarity      conductivity {direction} where pressed, by the model; it rises in the learnt images");
    say!(
        "chosen        misfit allowed for {} times, radius of a spot {} of half the skin",
        learnt.settings.misfit,
        learnt.settings.radius
    );
    say!("error, mm                       median    mean    90 %   worst  missed  second");
    let optional =
        |name, errors: &Option<Errors>| errors.iter().for_each(|errors| print_errors(name, errors));
    print_errors("training, model", &learnt.model_training);
    print_errors("training, learnt", &learnt.training);
    print_errors("cross-validation", &learnt.validation);
    optional("test, model, fixed point", &learnt.model_test);
    optional("test, learnt, fixed point", &learnt.test);
    let ToldApart { pairs, told_apart } = learnt.validation_pairs;
    say!("two at once   {told_apart} of {pairs} pairs told apart in cross-validation");
    say!("fixed point   moves a contact by {:.3} mm at most", learnt.fixed_point_mm);
    say!("noise         {:.2} times the model's in the image", learnt.noise_amplification);
    let model = if learnt.process.from_model { "with" } else { "without" };
    say!(
        "responses     {:.2} told by presses at other places, within {} of half the skin, {model} the model",
        learnt.foretold,
        learnt.process.reach
    );
    if let Some(correlation) = learnt.force_correlation {
        say!("force         correlates with strength by {correlation:.3}");
    }
    say!("patch         {} ({} bytes, id {})", report.patch.display(), report.patch_bytes, report.patch_crc);
}

fn print_errors(name: &str, errors: &Errors) {
    say!(
        "  {name:<28} {:>7.1} {:>7.1} {:>7.1} {:>7.1} {:>7} {:>7}",
        errors.median_mm,
        errors.mean_mm,
        errors.ninth_decile_mm,
        errors.worst_mm,
        errors.missed,
        errors.seconds
    );
}

fn share(text: &str) -> Result<f64, String> {
    let share = text.parse().ok().filter(|share| (0.0..=MOST_TEST).contains(share));
    share.ok_or_else(|| format!("allowed are 0 to {MOST_TEST}"))
}
