//! `dermatome reconstruct`: frames of other people's instruments -> images and what they show.

use super::{
    JsonReport,
    choices::Polarity,
    frame_options::{Flags, FrameOptions},
    outputs::{Kind, Output},
    stream::fingers::radius,
};
use anyhow::{Context, bail};
use dermatome_frames::recorded::{
    diagnose::{Diagnosis, diagnose},
    read::{Frames, Source},
    reconstruct::{Changes, FrameResult, Reference, evenly_spaced, reconstruct},
    statistics::median,
    weights::by_magnitude,
};
use dermatome_model::{
    model::Model,
    multi_contact::{FittedContact, MultiContactFit, Settings},
    skin::{Skin, Weights, electrodes_in_plane},
    stimulation::Stimulation,
};
use dermatome_patch::{layout::Layout, output::write_whole};
use dermatome_shared::patch::Difference;
use dermatome_view::sheet::{Panel, Scale, Sheet, reconstruction_sheet};
use serde::Serialize;
use std::{
    ffi::OsString,
    path::{Path, PathBuf},
};

/// Frames shown on screen and in the picture.
const SHOWN: usize = 20;

/// Reconstruct frames measured by another instrument.
#[derive(clap::Args)]
#[command(
    after_help = "FILE is .npy, .npz or .mat (version 7 or older; as FILE:KEY where it holds several arrays), .csv or .txt, \
with one frame per row: real or complex voltages of the skin's drive pattern, or the full square of all drives and \
all sense pairs. Or Sciospec's .eit, a frame each (a folder of them is a recording), or .get of older lung \
instruments.

Examples:
  dermatome reconstruct tank.toml --reference run.npz:empty --frames run.npz:cup --png cup.png
  dermatome reconstruct skin.toml --reference idle.csv --frames press.csv --order relative --json press.json
  dermatome reconstruct skin.toml --reference idle.csv --frames press.csv --fit 6mm"
)]
pub(super) struct Args {
    /// Skin file.
    #[arg(value_name = "SKIN")]
    skin: PathBuf,
    /// Frames of the untouched skin; several are averaged.
    #[arg(long, value_name = "FILE", required_unless_present = "differences")]
    reference: Option<OsString>,
    /// Each frame has a reference of its own, the one of its number.
    #[arg(long, requires = "reference")]
    each: bool,
    /// The frames are differences to a reference already; for a skin file without `normalised`. The image has a scale of its
    /// own then.
    #[arg(long, conflicts_with = "reference")]
    differences: bool,
    /// Also fit fingers of this radius to each frame's voltages, strongest first: such as 6mm.
    #[arg(long, alias = "resolve", value_name = "RADIUS")]
    fit: Option<String>,
    /// Frames to reconstruct.
    #[arg(long, value_name = "FILE")]
    frames: OsString,
    /// Draw the images.
    #[arg(long, value_name = "FILE", value_parser = Kind::Png.parser())]
    png: Option<Output>,
    #[command(flatten)]
    options: FrameOptions,
    /// How much each measurement counts: as the skin file says, or in proportion to the square of the
    /// measured reference, for instruments whose errors are of one size (normalised data only) [default: skin, but
    /// magnitude where ratios to nearly zero voltages would make the image].
    #[arg(long, value_enum)]
    weights: Option<WeightChoice>,
    /// Look for a conductivity that rises, that falls, or for whichever change is the strongest.
    #[arg(long, value_enum, default_value_t)]
    polarity: Polarity,
    #[command(flatten)]
    json: JsonReport,
}

/// Where the weights of measurements come from.
#[derive(Clone, Copy, Default, PartialEq, Eq, clap::ValueEnum, Serialize)]
#[serde(rename_all = "lowercase")]
pub(super) enum WeightChoice {
    /// From the skin file.
    #[default]
    Skin,
    /// From the magnitude of the measured reference.
    Magnitude,
}

/// What `reconstruct` tells; keys are documented in docs/cli.md.
#[derive(Serialize)]
struct Report {
    skin: PathBuf,
    reference_file: Option<String>,
    reference_frames: usize,
    weights: WeightChoice,
    frames_file: String,
    measurements: usize,
    complex: bool,
    diagnosis: Option<Diagnosis>,
    warnings: Vec<String>,
    picture: Option<PathBuf>,
    frames: Vec<FrameResult>,
    /// Fingers in each frame, if they were asked for.
    #[serde(skip_serializing_if = "Option::is_none")]
    fingers: Option<Vec<Vec<Finger>>>,
}

/// A finger fitted to a frame's voltages.
#[derive(Serialize)]
struct Finger {
    x_mm: f64,
    y_mm: f64,
    z_mm: f64,
    strength: f64,
}

pub(super) fn run(args: &Args) -> anyhow::Result<()> {
    let frames_source = Source::new(&args.frames);
    let reference_source = args.reference.as_deref().map(Source::new);
    let mut skin = Skin::load(&args.skin)?.made()?;
    let radius = args.fit.as_deref().map(radius).transpose()?;
    let reference = reference_source
        .as_ref()
        .map(|source| args.options.read(source, &skin.steps(), skin.electrodes.count))
        .transpose()?;
    let frames = args.options.read(&frames_source, &skin.steps(), skin.electrodes.count)?;
    let arrangement = args.options.arrangement();
    let chosen = match (&reference, args.weights) {
        (_, Some(chosen)) => chosen,
        (Some(reference), None) if has_ratios_to_nothing(&skin, reference, &args.options) => {
            WeightChoice::Magnitude
        }
        _ => WeightChoice::Skin,
    };
    if let (WeightChoice::Magnitude, Some(reference)) = (chosen, &reference) {
        let in_reference = || reference_source.as_ref().map_or(String::new(), |source| format!("`{source}`"));
        weigh_by_magnitude(&mut skin, reference, &args.options).with_context(in_reference)?;
    } else if chosen == WeightChoice::Magnitude {
        bail!(
            "--weights is `magnitude`, and with --differences there is no reference; allowed: --weights skin"
        );
    }
    let model =
        Model::build(&skin, |_| ()).with_context(|| format!("skin file `{}`", args.skin.display()))?;
    let against = match &reference {
        None => Reference::Subtracted,
        Some(reference) if args.each => Reference::Each(reference),
        Some(reference) => Reference::Mean(reference),
    };
    let in_files = || {
        let reference = reference_source.as_ref().map_or(String::new(), |source| format!("`{source}` and "));
        format!("{reference}`{frames_source}`")
    };
    let results =
        reconstruct(&model, against, &frames, &arrangement, args.polarity.into()).with_context(in_files)?;
    let fingers = radius.map(|radius| -> anyhow::Result<_> {
        let changes = Changes::of(&model, against, &frames, &arrangement).with_context(in_files)?;
        fingers(&skin, &model, &changes, radius)
    });
    let diagnosis = reference.as_ref().map(|reference| {
        diagnose(&model.steps, skin.electrodes.count, &model.voltages, &reference.mean(), arrangement)
    });
    let diagnosis = diagnosis.transpose()?;
    let mut warnings = match (&diagnosis, &reference) {
        (Some(diagnosis), Some(reference)) => warnings(diagnosis, reference, &frames),
        _ => Vec::new(),
    };
    if args.weights.is_none() && chosen == WeightChoice::Magnitude {
        warnings.push(
            "some voltages of the reference are nearly zero, and ratios to them would make the image: measurements \
             count by the square of their magnitude (--weights skin: as the skin file says)"
                .to_owned(),
        );
    }
    let report = Report {
        skin: args.skin.clone(),
        reference_file: reference_source.as_ref().map(ToString::to_string),
        reference_frames: reference.as_ref().map_or(0, |reference| reference.frames),
        weights: chosen,
        frames_file: frames_source.to_string(),
        measurements: frames.measurements,
        complex: frames.complex,
        warnings,
        diagnosis,
        picture: args.png.as_deref().map(Path::to_owned),
        frames: results,
        fingers: fingers.transpose()?,
    };
    report.warnings.iter().for_each(|warning| eprintln!("warning: {warning}"));
    say!("{}", table(&report.frames).trim_end());
    report.fingers.iter().for_each(|fingers| print_fingers(fingers));
    if let Some(path) = &args.png {
        write_whole(path, &picture(&skin, &model, &report)?)?;
    }
    args.json.write(&report)
}

/// Share of the median magnitude below which a voltage is nearly zero, and the share of all that must be.
const NEARLY_ZERO: f64 = 0.1;
const SOME: f64 = 0.02;

/// Whether some voltages of a reference are nearly zero, where ratios to them are taken and count as much as others.
fn has_ratios_to_nothing(skin: &Skin, reference: &Frames, options: &FrameOptions) -> bool {
    let steps = skin.steps();
    let map = options.arrangement().index_map(&steps, skin.electrodes.count, reference.measurements);
    let Ok(map) = map else { return false };
    let mean = reference.mean();
    let sizes: Vec<f64> = map.iter().map(|place| mean[place.index].norm()).collect();
    let limit = NEARLY_ZERO * median(sizes.iter().copied());
    let small = sizes.iter().filter(|&&size| size < limit).count();
    skin.inverse.difference == Difference::Normalised
        && matches!(skin.inverse.weights, Weights::Steps)
        && small as f64 > SOME * sizes.len() as f64
}

/// Fingers of one radius, m, in each frame.
fn fingers(skin: &Skin, model: &Model, changes: &Changes, radius: f64) -> anyhow::Result<Vec<Vec<Finger>>> {
    let settings = Settings { radius, snr_db: skin.inverse.noise_db };
    let fit = MultiContactFit::new(skin, model, settings)?;
    let of_frame = |difference: Vec<f64>| {
        let finger = |it: FittedContact| {
            let [x_mm, y_mm, z_mm] = [it.position.x, it.position.y, it.position.z].map(|side| side * 1e3);
            Finger { x_mm, y_mm, z_mm, strength: it.strength }
        };
        fit.contacts(&difference).into_iter().map(finger).collect()
    };
    Ok(changes.difference_data(model).map(of_frame).collect())
}

fn print_fingers(frames: &[Vec<Finger>]) {
    for frame in evenly_spaced(frames.len(), SHOWN) {
        let of_frame = frames[frame].iter().map(|it| {
            format!("({:.1}, {:.1}, {:.1}) mm strength {:+.3}", it.x_mm, it.y_mm, it.z_mm, it.strength)
        });
        let words: Vec<String> = of_frame.collect();
        say!("fingers {frame:>6}  {}", if words.is_empty() { "none".to_owned() } else { words.join(", ") });
    }
}

pub(super) fn weigh_by_magnitude(
    skin: &mut Skin,
    reference: &Frames,
    options: &FrameOptions,
) -> anyhow::Result<()> {
    if skin.inverse.difference != Difference::Normalised {
        bail!(
            "--weights is `magnitude`, which is for normalised data; `inverse.normalised` is false, allowed here: \
             --weights skin"
        );
    }
    let Stimulation { steps, combination } = skin.stimulation();
    let map = options.arrangement().index_map(&steps, skin.electrodes.count, reference.measurements)?;
    skin.inverse.weights = Weights::Each(by_magnitude(&reference.mean(), &map, &combination));
    Ok(())
}

fn warnings(diagnosis: &Diagnosis, reference: &Frames, frames: &Frames) -> Vec<String> {
    let mut warnings = diagnosis.warnings(&Flags);
    if reference.complex != frames.complex {
        let kind = |complex| if complex { "complex" } else { "real" };
        warnings.push(format!(
            "the reference is {}, the frames are {}: the difference between them means little",
            kind(reference.complex),
            kind(frames.complex)
        ));
    }
    warnings
}

/// One line per frame, at most [`SHOWN`] of them.
fn table(frames: &[FrameResult]) -> String {
    let mut text = format!(
        "{:>7} {:>10} {:>8} {:>8} {:>8} {:>8} {:>9}\n",
        "frame", "peak", "x/mm", "y/mm", "angle", "radius", "area/mm2"
    );
    let shown = evenly_spaced(frames.len(), SHOWN);
    for &index in &shown {
        text += &row(&frames[index]);
    }
    if shown.len() < frames.len() {
        text +=
            &format!("{} of {} frames shown, evenly spaced; --json writes all\n", shown.len(), frames.len());
    }
    text
}

fn row(result: &FrameResult) -> String {
    let FrameResult { frame, peak, objects, .. } = result;
    match objects.first() {
        Some(object) => format!(
            "{frame:>7} {peak:>+10.3e} {:>8.1} {:>8.1} {:>+7.1}° {:>7.1}% {:>9.0}\n",
            object.x_mm, object.y_mm, object.angle_degrees, object.radius_percent, object.area_mm2
        ),
        None => format!("{frame:>7} {peak:>+10.3e}  no change\n"),
    }
}

fn picture(skin: &Skin, model: &Model, report: &Report) -> anyhow::Result<Vec<u8>> {
    let shown = evenly_spaced(report.frames.len(), SHOWN);
    let panels = shown.iter().map(|&index| panel(&report.frames[index])).collect();
    let rim = electrodes_in_plane(&skin.shape);
    let surface = model.surface();
    let grid = model.pixels.grid.as_ref();
    let layout = match (&surface, grid) {
        (Ok(surface), _) => Layout::from(surface),
        (Err(_), Some(grid)) => Layout::from(grid),
        (Err(error), None) => return Err(*error).context("--png"),
    };
    let scale = Scale::RELATIVE;
    let sheet =
        Sheet { title: &report.frames_file, layout: &layout, electrodes: &rim, scale, columns: 5, panels };
    reconstruction_sheet(&sheet).encode().context("cannot encode the picture")
}

fn panel(result: &FrameResult) -> Panel<'_> {
    let object = result.objects.first();
    let position = object.map_or("no change".into(), |object| {
        format!("peak {:+.2e} at ({:.1}, {:.1}) mm", result.peak, object.x_mm, object.y_mm)
    });
    Panel {
        caption: vec![format!("frame {}", result.frame), position],
        values: &result.image,
        found: object.map(|object| [object.x_mm / 1e3, object.y_mm / 1e3]).into_iter().collect(),
        ..Panel::default()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use dermatome_frames::recorded::reconstruct::Object;

    fn result(frame: usize) -> FrameResult {
        let object = Object {
            x_mm: 12.34,
            y_mm: -5.0,
            angle_degrees: -22.06,
            radius_percent: 26.6,
            area_mm2: 310.0,
            peak: 0.125,
        };
        let objects = if frame == 1 { vec![] } else { vec![object] };
        let peak = if frame == 1 { 0.0 } else { 0.125 };
        FrameResult { frame, peak, polarity: Polarity::Up.into(), objects, image: vec![0.0] }
    }

    #[test]
    fn few_frames_are_all_shown() {
        let frames: Vec<_> = (0..2).map(result).collect();
        let lines = [
            "  frame       peak     x/mm     y/mm    angle   radius  area/mm2",
            "      0  +1.250e-1     12.3     -5.0   -22.1°    26.6%       310",
            "      1   +0.000e0  no change",
        ];
        assert_eq!(table(&frames).lines().collect::<Vec<_>>(), lines);
    }

    #[test]
    fn of_many_frames_some_are_shown_and_it_says_so() {
        let frames: Vec<_> = (0..400).map(result).collect();
        let text = table(&frames);
        assert_eq!(text.lines().count(), 1 + SHOWN + 1);
        assert!(text.ends_with("20 of 400 frames shown, evenly spaced; --json writes all\n"), "{text}");
    }

    #[test]
    fn the_json_of_a_frame_leaves_the_image_out() {
        let json = serde_json::to_value(result(3)).unwrap();
        let keys: Vec<_> = json.as_object().unwrap().keys().cloned().collect();
        assert_eq!(keys, ["frame", "objects", "peak", "polarity"]);
        assert_eq!(json["polarity"], "up");
        assert_eq!(json["objects"][0]["x_mm"], 12.34);
    }
}
