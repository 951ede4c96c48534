//! Saline experiments 1 and 2 (thesis 4.1): does the method itself add hysteresis?
//!
//! The bath conducts like a sheet, because its electrodes cover its whole depth. A cube that dips in by
//! `depth` leaves `1 - depth / 60 mm` of the water beneath its footprint; that the current also spreads
//! up and down round its edges is left out.

use super::{
    ExperimentError,
    plot::{Chart, Series, Style},
    report::{Report, largest, number},
    sample_rig::{Artefacts, FRAMES, SampleRig, Shown},
};
use dermatome_model::skin::{Skin, electrodes_in_plane};
use dermatome_patch::layout::Layout;
use dermatome_simulate::{Footprint, Load, Press};
use dermatome_view::sheet::{Panel, Scale, Sheet, reconstruction_sheet};
use serde_json::json;
use std::path::Path;

/// How the bath is driven, in words.
pub(super) const DRIVEN: &str = "Driven as in section 4.1.1: 50 kHz, 4.73 frames per second, mean of 20 frames; the current of 1 mA is \
    assumed. The gain of 3 is not applied: the simulated board finds its own, and any cancels in difference data.";
/// Depth of the water, m.
pub(super) const WATER: f64 = 0.06;
/// Hysteresis of the method, % of the range: stated under experiment 2 (thesis section 4.1.2.2).
const THESIS_HYSTERESIS: f64 = 1.06;

/// The bath, looked at for falls of conductivity, tared without a cube.
pub(super) fn bath(seed: u64) -> Result<SampleRig, ExperimentError> {
    let path = Path::new("models/saline-215mm/skin.toml");
    let skin = Skin::parse(path, include_str!("../../../../models/saline-215mm/skin.toml"))?.made()?;
    let mut rig = SampleRig::new(skin, Artefacts::SALINE, FRAMES, seed)?.inverted();
    rig.tare(&vec![1.0; rig.elements()]);
    Ok(rig)
}

/// An insulating cube that takes the place of `depth` of water, m.
pub(super) fn cube(position: [f64; 2], side: f64, depth: f64) -> Press {
    Press::new(Footprint::Square { side }, position, Load::Change(-depth / WATER))
}

/// Shows cubes in the bath.
pub(super) fn dip(rig: &mut SampleRig, presses: &[Press]) -> Result<Shown, ExperimentError> {
    let conductivity = rig.truth().conductivity(presses);
    rig.show(&conductivity)
}

/// One load of a cycle.
struct Dip {
    /// Displaced water, cm^3.
    volume: f64,
    cube: Option<Press>,
}

/// Experiment 1: one cube, deeper and deeper, and back.
pub(super) fn depth() -> Result<Report, ExperimentError> {
    const SIDE: f64 = 0.0276;
    let mut report = Report::new("saline-depth", "Saline experiment 1: depth of a cube (thesis 4.1.2.1)");
    report.words(format!(
        "A cube of {:.1} mm is let down in the middle of the bath by a third of its side at a time, and drawn up \
         again. The thesis does not state the cube's size; this is the largest of its experiment 2.",
        SIDE * 1e3
    ));
    let dip = |third: u32| {
        let depth = SIDE * f64::from(third) / 3.0;
        let cube = (third > 0).then(|| cube([0.0; 2], SIDE, depth));
        Dip { volume: SIDE * SIDE * depth * 1e6, cube }
    };
    report.words("The thesis has no figure of hysteresis under experiment 1, only \"a minor difference\". Its 1.06 % stands under \
                  experiment 2, whose text there speaks of a cube that is lowered, as is done here.");
    cycle(report, None, &[0, 1, 2, 3, 2, 1, 0].map(dip))
}

/// Experiment 2: cubes of three sizes under water, up and down.
pub(super) fn volume() -> Result<Report, ExperimentError> {
    let mut report = Report::new("saline-volume", "Saline experiment 2: volume of a cube (thesis 4.1.2.2)");
    report.words("Cubes of 5, 13 and 21 cm³ are put under water in the middle of the bath, the larger ones later, then \
                  the smaller ones again.");
    let dip = |volume: f64| {
        let side = volume.cbrt() * 1e-2;
        Dip { volume, cube: (volume > 0.0).then(|| cube([0.0; 2], side, side)) }
    };
    cycle(report, Some(THESIS_HYSTERESIS), &[0.0, 5.0, 13.0, 21.0, 13.0, 5.0, 0.0].map(dip))
}

/// Shows a cycle of loads and looks for hysteresis.
fn cycle(mut report: Report, thesis: Option<f64>, dips: &[Dip]) -> Result<Report, ExperimentError> {
    let mut rig = bath(1)?;
    report.words(format!("{DRIVEN} Artefacts: {}.", Artefacts::SALINE.words()));
    let shown = dips
        .iter()
        .map(|step| dip(&mut rig, step.cube.as_slice()))
        .collect::<Result<Vec<_>, ExperimentError>>()?;
    // Where nothing is above the threshold, there is no region of interest.
    let strength = |shown: &Shown| f64::from(shown.contacts.first().map_or(0.0, |contact| contact.strength));
    let strengths: Vec<f64> = shown.iter().map(strength).collect();
    let voltages: Vec<f64> = shown.iter().map(|shown| shown.voltage_change).collect();
    let [image, raw] = [&strengths, &voltages].map(|readings| hysteresis(readings));
    report.compare("hysteresis of the method, image", "%", thesis, image, None);
    report.compare("hysteresis of the method, voltages", "%", None, raw, None);
    report.words("Nothing in the simulation remembers, so what hysteresis there is, is noise.");
    let rows = dips.iter().zip(&strengths).zip(&voltages);
    let rows = rows.map(|((dip, strength), voltage)| {
        vec![number(dip.volume), number(-strength), number(100.0 * voltage)]
    });
    report.table(
        "Readings in order",
        &["displaced water, cm³", "change, mean over ROI", "dV/V, %"],
        rows.collect(),
    );
    report.plots(&[
        chart("Image", "change of conductivity", dips, &strengths, -1.0),
        chart("Voltages", "dV/V, %", dips, &voltages, 100.0),
    ])?;
    report.picture(pictures(&rig, dips, &shown)?, "What the board showed, in order");
    report.figures = json!({
        "volumes_cm3": dips.iter().map(|dip| dip.volume).collect::<Vec<_>>(),
        "changes": strengths.iter().map(|strength| -strength).collect::<Vec<_>>(),
        "voltage_changes": voltages,
        "hysteresis_percent": image,
        "hysteresis_of_voltages_percent": raw,
    });
    Ok(report)
}

/// Thesis equation 3.6: largest difference of two readings of one load, up and down, % of the range.
pub(super) fn hysteresis(readings: &[f64]) -> f64 {
    let pairs = readings.iter().zip(readings.iter().rev()).take(readings.len() / 2);
    let gap = largest(pairs.map(|(up, down)| (down - up).abs()));
    let (low, high) = readings.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), &reading| {
        (low.min(reading), high.max(reading))
    });
    100.0 * gap / (high - low).max(f64::MIN_POSITIVE)
}

fn chart<'a>(title: &'a str, y: &'a str, dips: &[Dip], readings: &[f64], scale: f64) -> Chart<'a> {
    let points: Vec<_> =
        dips.iter().zip(readings).map(|(dip, reading)| [dip.volume, scale * reading]).collect();
    let half = points.len() / 2;
    let series = vec![
        Series::new("more water displaced", points[..=half].to_vec(), Style::MarkedLine),
        Series::new("less", points[half..].to_vec(), Style::MarkedLine),
    ];
    Chart { title, x: "displaced water, cm³", y, series, square: None }
}

fn pictures(rig: &SampleRig, dips: &[Dip], shown: &[Shown]) -> Result<Vec<u8>, ExperimentError> {
    let images: Vec<Vec<f64>> =
        shown.iter().map(|shown| shown.image.iter().map(|value| -value).collect()).collect();
    let panels = dips.iter().zip(&images).map(|(dip, image)| Panel {
        caption: vec![format!("{:.1} cm3", dip.volume)],
        values: image,
        truth: dip.cube.iter().map(|cube| (cube.position, 0.0)).collect(),
        ..Panel::default()
    });
    draw(rig, "", 4, panels.collect())
}

/// A sheet of images of a rig's skin, in mS per square as in the thesis, PNG.
pub(super) fn draw(
    rig: &SampleRig,
    title: &str,
    columns: usize,
    panels: Vec<Panel<'_>>,
) -> Result<Vec<u8>, ExperimentError> {
    let failed = |error: &dyn std::fmt::Display| ExperimentError::Draw(error.to_string());
    let layout = &Layout::from(&rig.model().surface().map_err(|error| failed(&error))?);
    let electrodes = &electrodes_in_plane(&rig.skin.shape);
    let scale = Scale::millisiemens(rig.skin.material.sheet_conductivity);
    let sheet = Sheet { title, layout, electrodes, scale, columns, panels };
    reconstruction_sheet(&sheet).encode().map_err(|error| failed(&error))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn hysteresis_is_the_widest_gap_over_the_range() {
        assert!((hysteresis(&[0.0, 1.0, 2.0, 4.0, 3.0, 1.5, 0.2]) - 25.0).abs() < 1e-12);
        assert_eq!(hysteresis(&[0.0, 2.0, 0.0]), 0.0);
        assert_eq!(hysteresis(&[]), 0.0);
    }
}
