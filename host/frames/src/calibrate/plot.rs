//! Picture of a calibration, as SVG: readings, the curve with its uncertainty, the loop without hysteresis.

use super::{Curve, Trial};
use std::fmt::Write;

const WIDTH: f64 = 640.0;
const HEIGHT: f64 = 440.0;
/// Room for titles and numbers: left, top, right, bottom.
const MARGIN: [f64; 4] = [80.0, 50.0, 20.0, 60.0];
const TICKS: u32 = 5;

/// Strength against pressure: each trial's readings, and the curve with two standard deviations around it.
#[must_use]
pub fn svg(skin: &str, trials: &[Trial], curve: &Curve) -> String {
    let readings = || trials.iter().flat_map(|trial| &trial.readings);
    let band = || curve.points.iter().flat_map(|p| [-2.0, 2.0].map(|k| p.strength + k * p.deviation));
    let x = Axis::new(readings().map(|r| r.pressure_kpa), MARGIN[0], WIDTH - MARGIN[2]);
    let y = Axis::new(readings().map(|r| r.strength).chain(band()), HEIGHT - MARGIN[3], MARGIN[1]);
    let mut svg = frame(skin, &x, &y);
    let above = curve.points.iter().map(|p| [p.pressure_kpa, p.strength + 2.0 * p.deviation]);
    let below = curve.points.iter().rev().map(|p| [p.pressure_kpa, p.strength - 2.0 * p.deviation]);
    path(&mut svg, "polygon", "fill=\"#1f6fb4\" fill-opacity=\"0.2\"", above.chain(below), [&x, &y]);
    for trial in trials {
        let points = trial.readings.iter().map(|r| [r.pressure_kpa, r.strength]);
        path(&mut svg, "polyline", "fill=\"none\" stroke=\"#888888\"", points, [&x, &y]);
    }
    let points = curve.points.iter().map(|p| [p.pressure_kpa, p.strength]);
    path(&mut svg, "polyline", "fill=\"none\" stroke=\"#1f6fb4\" stroke-width=\"2\"", points, [&x, &y]);
    svg.push_str("</svg>\n");
    svg
}

fn path(svg: &mut String, kind: &str, style: &str, points: impl Iterator<Item = [f64; 2]>, axes: [&Axis; 2]) {
    let places: Vec<String> = points
        .map(|point| format!("{:.1},{:.1}", axes[0].place(point[0]), axes[1].place(point[1])))
        .collect();
    let _ = writeln!(svg, "<{kind} points=\"{}\" {style}/>", places.join(" "));
}

fn frame(skin: &str, x: &Axis, y: &Axis) -> String {
    let [left, top, right, bottom] = [MARGIN[0], MARGIN[1], WIDTH - MARGIN[2], HEIGHT - MARGIN[3]];
    let mut svg = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {WIDTH} {HEIGHT}\" font-family=\"sans-serif\" \
         font-size=\"13\" fill=\"#282828\">\n<rect width=\"{WIDTH}\" height=\"{HEIGHT}\" fill=\"white\"/>\n\
         <rect x=\"{left}\" y=\"{top}\" width=\"{}\" height=\"{}\" fill=\"none\" stroke=\"#282828\"/>\n\
         <text x=\"{left}\" y=\"30\">{skin}: calibration</text>\n\
         <text x=\"{}\" y=\"{}\" text-anchor=\"middle\">pressure, kPa</text>\n\
         <text transform=\"translate(22 {}) rotate(-90)\" text-anchor=\"middle\">strength</text>\n",
        right - left,
        bottom - top,
        0.5 * (left + right),
        HEIGHT - 15.0,
        0.5 * (top + bottom),
    );
    for (value, at) in x.ticks() {
        let _ = writeln!(
            svg,
            "<text x=\"{at:.1}\" y=\"{}\" text-anchor=\"middle\">{value:.1}</text>",
            bottom + 18.0
        );
    }
    for (value, at) in y.ticks() {
        let _ =
            writeln!(svg, "<text x=\"{}\" y=\"{at:.1}\" text-anchor=\"end\">{value:.3}</text>", left - 6.0);
    }
    svg
}

struct Axis {
    low: f64,
    high: f64,
    from: f64,
    to: f64,
}

impl Axis {
    fn new(values: impl Iterator<Item = f64>, from: f64, to: f64) -> Self {
        let (low, high) =
            values.fold((0.0_f64, 0.0_f64), |(low, high), value| (low.min(value), high.max(value)));
        Self { low, high: high.max(low + 1e-9), from, to }
    }

    fn place(&self, value: f64) -> f64 {
        self.from + (value - self.low) / (self.high - self.low) * (self.to - self.from)
    }

    fn ticks(&self) -> impl Iterator<Item = (f64, f64)> {
        (0..=TICKS).map(|tick| {
            let value = self.low + (self.high - self.low) * f64::from(tick) / f64::from(TICKS);
            (value, self.place(value))
        })
    }
}
