//! The demo's picture: truth beside image at eight moments.

use super::{FrameRecord, Scorer};
use dermatome_frames::recorded::reconstruct::evenly_spaced;
use dermatome_model::skin::electrodes_in_plane;
use dermatome_simulate::Press;
use dermatome_view::sheet::{Panel, Scale, Sheet, reconstruction_sheet};

use nalgebra::Point3;

/// Moments shown.
const MOMENTS: usize = 8;
/// Pairs of truth and image in a row.
const PAIRS: usize = 4;

/// Draws the picture as a PNG file.
pub(crate) fn picture(scorer: &Scorer<'_>, records: &[FrameRecord]) -> Result<Vec<u8>, png::EncodingError> {
    let pressed: Vec<_> = records.iter().filter(|record| !record.presses.is_empty()).collect();
    let shown: Vec<_> =
        evenly_spaced(pressed.len(), MOMENTS).into_iter().map(|index| pressed[index]).collect();
    let truths: Vec<_> = shown.iter().map(|record| true_image(scorer, &record.presses)).collect();
    let panels = shown
        .iter()
        .zip(&truths)
        .flat_map(|(record, truth)| [true_panel(record, truth), image_panel(record)]);
    let title = format!(
        "{}: true change of conductivity beside the board's image, at eight moments",
        scorer.skin.name
    );
    let rim = electrodes_in_plane(&scorer.skin.shape);
    let sheet = Sheet {
        title: &title,
        layout: scorer.layout,
        electrodes: &rim,
        scale: Scale::RELATIVE,
        columns: 2 * PAIRS,
        panels: panels.collect(),
    };
    reconstruction_sheet(&sheet).encode()
}

/// Change under the fingers at the centre of each pixel: `[pixel]`.
fn true_image(scorer: &Scorer<'_>, presses: &[Press]) -> Vec<f64> {
    let change =
        |centre: &Point3<f64>| presses.iter().map(|press| press.change_at([centre.x, centre.y])).sum();
    scorer.model.pixels.centres.iter().map(change).collect()
}

fn true_panel<'a>(record: &FrameRecord, truth: &'a [f64]) -> Panel<'a> {
    let depth = record.presses.iter().fold(0.0, |max: f64, press| max.max(press.load.value().abs()));
    let places = record.presses.iter().map(|press| place(press.position));
    Panel {
        caption: vec![format!("frame {}: truth", record.index), places.collect::<Vec<_>>().join(" ")],
        values: truth,
        maximum: Some(depth),
        ..Panel::default()
    }
}

fn image_panel(record: &FrameRecord) -> Panel<'_> {
    let found: Vec<[f64; 2]> = record
        .contacts
        .iter()
        .map(|contact| [contact.position[0], contact.position[1]].map(f64::from))
        .collect();
    let places = found.iter().map(|&position| place(position));
    Panel {
        caption: vec!["image".into(), places.collect::<Vec<_>>().join(" ")],
        values: &record.image,
        found: found.clone(),
        truth: record.presses.iter().map(|press| (press.position, press.footprint.reach())).collect(),
        ..Panel::default()
    }
}

fn place([x, y]: [f64; 2]) -> String {
    format!("({:.0}, {:.0}) mm", x * 1e3, y * 1e3)
}
