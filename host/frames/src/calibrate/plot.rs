//! Picture of a calibration, as SVG: readings, and the curve with its uncertainty.

use super::{Curve, Trial};
use plotters::{drawing::DrawingAreaErrorKind, prelude::*};
use std::{io, ops::Range};

const SIZE: (u32, u32) = (640, 440);
const CURVE: RGBColor = RGBColor(0x1f, 0x6f, 0xb4);
const READINGS: RGBColor = RGBColor(0x88, 0x88, 0x88);
const TICKS: usize = 6;

/// Strength against pressure: each trial's readings, and the curve with two standard deviations around it.
#[must_use]
pub fn svg(skin: &str, trials: &[Trial], curve: &Curve) -> String {
    let mut text = String::new();
    draw(&mut text, skin, trials, curve).expect("text takes every drawing");
    text
}

fn draw(
    text: &mut String,
    skin: &str,
    trials: &[Trial],
    curve: &Curve,
) -> Result<(), DrawingAreaErrorKind<io::Error>> {
    let area = SVGBackend::with_string(text, SIZE).into_drawing_area();
    area.fill(&WHITE)?;
    let readings = || trials.iter().flat_map(|trial| &trial.readings);
    let band = band(curve);
    let x = range(readings().map(|reading| reading.pressure_kpa));
    let y = range(readings().map(|reading| reading.strength).chain(band.iter().map(|point| point.1)));
    let mut chart = ChartBuilder::on(&area)
        .caption(format!("{skin}: calibration"), ("sans-serif", 16))
        .margin(10)
        .margin_right(24)
        .x_label_area_size(40)
        .y_label_area_size(66)
        .build_cartesian_2d(x, y)?;
    chart
        .configure_mesh()
        .x_desc("pressure, kPa")
        .y_desc("strength")
        .x_labels(TICKS)
        .y_labels(TICKS)
        .x_label_formatter(&|value| format!("{value:.1}"))
        .y_label_formatter(&|value| format!("{value:.3}"))
        .light_line_style(WHITE)
        .bold_line_style(RGBColor(225, 225, 225))
        .label_style(("sans-serif", 13))
        .draw()?;
    chart.draw_series([Polygon::new(band, CURVE.mix(0.2))])?;
    for trial in trials {
        let points = trial.readings.iter().map(|reading| (reading.pressure_kpa, reading.strength));
        chart.draw_series(LineSeries::new(points, READINGS))?;
    }
    let points = curve.points.iter().map(|point| (point.pressure_kpa, point.strength));
    chart.draw_series(LineSeries::new(points, CURVE.stroke_width(2)))?;
    area.present()
}

/// Two standard deviations above the curve, and back below it.
fn band(curve: &Curve) -> Vec<(f64, f64)> {
    let above = curve.points.iter().map(|point| (point.pressure_kpa, point.strength + 2.0 * point.deviation));
    let below = curve.points.iter().map(|point| (point.pressure_kpa, point.strength - 2.0 * point.deviation));
    above.chain(below.rev()).collect()
}

/// All values, and zero.
fn range(values: impl Iterator<Item = f64>) -> Range<f64> {
    let (low, high) = values.fold((0.0_f64, 0.0_f64), |(low, high), value| (low.min(value), high.max(value)));
    low..high.max(low + 1e-9)
}
