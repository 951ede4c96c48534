//! Picture of a calibration, as SVG: readings, and the curve with its uncertainty.

use super::{Curve, Trial};
use plotters::prelude::*;
use std::ops::Range;

/// Width and height, pixels.
const SIZE: (u32, u32) = (640, 440);
const FRAME: RGBColor = RGBColor(40, 40, 40);
const READINGS: RGBColor = RGBColor(136, 136, 136);
const CURVE: RGBColor = RGBColor(31, 111, 180);
const TICKS: usize = 6;

/// Strength against pressure: each trial's readings, and the curve with two standard deviations around it.
#[must_use]
pub fn svg(skin: &str, trials: &[Trial], curve: &Curve) -> String {
    let mut svg = String::new();
    draw(&mut svg, skin, trials, curve).expect("text takes text");
    svg
}

fn draw(
    svg: &mut String,
    skin: &str,
    trials: &[Trial],
    curve: &Curve,
) -> Result<(), Box<dyn std::error::Error>> {
    let readings = || trials.iter().flat_map(|trial| &trial.readings);
    let edge = |deviations: f64| {
        curve.points.iter().map(move |p| (p.pressure_kpa, p.strength + deviations * p.deviation))
    };
    let band: Vec<_> = edge(2.0).chain(edge(-2.0).rev()).collect();
    let pressures = range(readings().map(|r| r.pressure_kpa));
    let strengths = range(readings().map(|r| r.strength).chain(band.iter().map(|place| place.1)));
    let area = SVGBackend::with_string(svg, SIZE).into_drawing_area();
    area.fill(&WHITE)?;
    let mut chart = ChartBuilder::on(&area)
        .caption(format!("{skin}: calibration"), ("sans-serif", 15))
        .margin(14)
        .x_label_area_size(42)
        .y_label_area_size(66)
        .build_cartesian_2d(pressures, strengths)?;
    chart
        .configure_mesh()
        .disable_mesh()
        .x_desc("pressure, kPa")
        .y_desc("strength")
        .x_labels(TICKS)
        .y_labels(TICKS)
        .label_style(("sans-serif", 13))
        .axis_style(FRAME)
        .draw()?;
    chart.draw_series([Polygon::new(band, CURVE.mix(0.2))])?;
    for trial in trials {
        let points = trial.readings.iter().map(|reading| (reading.pressure_kpa, reading.strength));
        chart.draw_series(LineSeries::new(points, READINGS))?;
    }
    chart.draw_series(LineSeries::new(edge(0.0), CURVE.stroke_width(2)))?;
    area.present()?;
    Ok(())
}

/// From zero, or from below it where values are.
fn range(values: impl Iterator<Item = f64>) -> Range<f64> {
    let (low, high) = values.fold((0.0_f64, 0.0_f64), |(low, high), value| (low.min(value), high.max(value)));
    low..high.max(low + 1e-9)
}
