//! `dermatome reconstruct`: frames of other people's instruments -> images and what they show.

use super::{
    JsonReport,
    choices::Polarity,
    frame_options::{Flags, FrameOptions},
    outputs::{Kind, Output},
};
use anyhow::{Context, bail};
use dermatome_frames::recorded::{
    diagnose::{Diagnosis, diagnose},
    read::{Frames, Source},
    reconstruct::{FrameResult, evenly_spaced, reconstruct},
    weights::by_magnitude,
};
use dermatome_model::{
    model::Model,
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
    after_help = "FILE is .npy, .npz (as FILE.npz:KEY where it holds several arrays) or .csv, with one \
frame per row: real or complex voltages of the skin's drive pattern, or the full square of all drives and \
all sense pairs.

Examples:
  dermatome reconstruct tank.toml --reference run.npz:empty --frames run.npz:cup --png cup.png
  dermatome reconstruct skin.toml --reference idle.csv --frames press.csv --order relative --json press.json"
)]
pub(super) struct Args {
    /// Skin file.
    #[arg(value_name = "SKIN")]
    skin: PathBuf,
    /// Frames of the untouched skin; several are averaged.
    #[arg(long, value_name = "FILE")]
    reference: OsString,
    /// Frames to reconstruct.
    #[arg(long, value_name = "FILE")]
    frames: OsString,
    /// Draw the images.
    #[arg(long, value_name = "FILE", value_parser = Kind::Png.parser())]
    png: Option<Output>,
    #[command(flatten)]
    options: FrameOptions,
    /// How much each measurement counts: as the skin file says, or in proportion to the square of the
    /// measured reference, for instruments whose errors are of one size (normalised data only).
    #[arg(long, value_enum, default_value_t)]
    weights: WeightChoice,
    /// Look for a conductivity that rises, that falls, or for whichever change is the strongest.
    #[arg(long, value_enum, default_value_t)]
    polarity: Polarity,
    #[command(flatten)]
    json: JsonReport,
}

/// Where the weights of measurements come from.
#[derive(Clone, Copy, Default, clap::ValueEnum)]
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
    reference_file: String,
    reference_frames: usize,
    frames_file: String,
    measurements: usize,
    complex: bool,
    diagnosis: Diagnosis,
    warnings: Vec<String>,
    picture: Option<PathBuf>,
    frames: Vec<FrameResult>,
}

pub(super) fn run(args: &Args) -> anyhow::Result<()> {
    let (reference_source, frames_source) = (Source::new(&args.reference), Source::new(&args.frames));
    let mut skin = Skin::load(&args.skin)?.made()?;
    let reference = args.options.read(&reference_source, &skin)?;
    if let WeightChoice::Magnitude = args.weights {
        weigh_by_magnitude(&mut skin, &reference, &args.options)
            .with_context(|| format!("`{reference_source}`"))?;
    }
    let frames = args.options.read(&frames_source, &skin)?;
    let model =
        Model::build(&skin, |_| ()).with_context(|| format!("skin file `{}`", args.skin.display()))?;
    let arrangement = args.options.arrangement();
    let results = reconstruct(&model, &reference, &frames, &arrangement, args.polarity.into())
        .with_context(|| format!("`{reference_source}` and `{frames_source}`"))?;
    let diagnosis =
        diagnose(&model.steps, skin.electrodes.count, &model.voltages, &reference.mean(), arrangement)?;
    let report = Report {
        skin: args.skin.clone(),
        reference_file: reference_source.to_string(),
        reference_frames: reference.frames,
        frames_file: frames_source.to_string(),
        measurements: frames.measurements,
        complex: frames.complex,
        warnings: warnings(&diagnosis, &reference, &frames),
        diagnosis,
        picture: args.png.as_deref().map(Path::to_owned),
        frames: results,
    };
    report.warnings.iter().for_each(|warning| eprintln!("warning: {warning}"));
    say!("{}", table(&report.frames).trim_end());
    if let Some(path) = &args.png {
        write_whole(path, &picture(&skin, &model, &report)?)?;
    }
    args.json.write(&report)
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
    let layout = Layout::from(&model.surface()?);
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
