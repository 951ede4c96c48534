//! Plot of the criterion by which a hyperparameter was chosen, as SVG.

use dermatome_model::{
    inverse::selection::{CurvePoint, Selection},
    skin::Criterion,
};
use std::fmt::Write;

const WIDTH: f64 = 640.0;
const HEIGHT: f64 = 440.0;
/// Room for titles and numbers: left, top, right, bottom.
const MARGIN: [f64; 4] = [80.0, 50.0, 20.0, 60.0];
const FRAME: &str = "fill=\"none\" stroke=\"#282828\"";

/// Draws the criterion over its range, both axes logarithmic, with the chosen point.
#[must_use]
pub fn criterion_svg(skin: &str, selection: &Selection) -> String {
    let points = || selection.curve.iter().chain([&selection.chosen]);
    let x = Axis::new(points().map(|point| point.abscissa), MARGIN[0], WIDTH - MARGIN[2]);
    let y = Axis::new(points().map(|point| point.ordinate), HEIGHT - MARGIN[3], MARGIN[1]);
    let mut svg = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {WIDTH} {HEIGHT}\" font-family=\"sans-serif\" \
         font-size=\"13\" fill=\"#282828\">\n<rect width=\"{WIDTH}\" height=\"{HEIGHT}\" fill=\"white\"/>\n"
    );
    let chosen = selection.chosen;
    let title =
        format!("{skin}: hyperparameter {:.4e} by {}", chosen.hyperparameter, selection.criterion.name());
    text(&mut svg, [MARGIN[0], 30.0], "start", &title);
    let [across, up] = axis_names(selection.criterion);
    text(&mut svg, [(MARGIN[0] + WIDTH - MARGIN[2]) / 2.0, HEIGHT - 15.0], "middle", across);
    let [left, top, right, bottom] = [MARGIN[0], MARGIN[1], WIDTH - MARGIN[2], HEIGHT - MARGIN[3]];
    line(
        &mut svg,
        format_args!(
            "<text transform=\"translate(22 {}) rotate(-90)\" text-anchor=\"middle\">{up}</text>",
            (top + bottom) / 2.0
        ),
    );
    line(
        &mut svg,
        format_args!(
            "<rect x=\"{left}\" y=\"{top}\" width=\"{}\" height=\"{}\" {FRAME}/>",
            right - left,
            bottom - top
        ),
    );
    for (at, name) in x.ticks() {
        line(&mut svg, format_args!("<path d=\"M{at:.1} {bottom}v-6\" {FRAME}/>"));
        text(&mut svg, [at, bottom + 18.0], "middle", &name);
    }
    for (at, name) in y.ticks() {
        line(&mut svg, format_args!("<path d=\"M{left} {at:.1}h6\" {FRAME}/>"));
        text(&mut svg, [left - 6.0, at + 4.0], "end", &name);
    }
    let place = |point: &CurvePoint| format!("{:.1},{:.1}", x.place(point.abscissa), y.place(point.ordinate));
    let curve: Vec<String> = selection.curve.iter().map(place).collect();
    line(
        &mut svg,
        format_args!(
            "<polyline points=\"{}\" fill=\"none\" stroke=\"#1f6fb4\" stroke-width=\"2\"/>",
            curve.join(" ")
        ),
    );
    line(
        &mut svg,
        format_args!(
            "<circle cx=\"{:.1}\" cy=\"{:.1}\" r=\"6\" fill=\"none\" stroke=\"#c03028\" stroke-width=\"2.5\"/>",
            x.place(chosen.abscissa),
            y.place(chosen.ordinate)
        ),
    );
    svg + "</svg>\n"
}

fn axis_names(criterion: Criterion) -> [&'static str; 2] {
    match criterion {
        Criterion::LCurve => ["size of the residual (whitened data)", "size of the image (by the prior)"],
        Criterion::CrossValidation => ["hyperparameter", "generalised cross-validation"],
        Criterion::NoiseFigure(_) => ["hyperparameter", "noise figure"],
        Criterion::BestResolution => ["hyperparameter", "blur of the standard target (share of the area)"],
    }
}

fn line(svg: &mut String, words: std::fmt::Arguments<'_>) {
    writeln!(svg, "{words}").expect("text takes text");
}

fn text(svg: &mut String, [x, y]: [f64; 2], anchor: &str, words: &str) {
    line(svg, format_args!("<text x=\"{x:.1}\" y=\"{y:.1}\" text-anchor=\"{anchor}\">{words}</text>"));
}

/// A logarithmic axis between two places of the picture.
struct Axis {
    low: f64,
    high: f64,
    from: f64,
    to: f64,
}

impl Axis {
    fn new(values: impl Iterator<Item = f64>, from: f64, to: f64) -> Self {
        let logs = values.filter(|value| *value > 0.0 && value.is_finite()).map(f64::log10);
        let (low, high) =
            logs.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), log| (low.min(log), high.max(log)));
        let (low, high) = if low <= high { (low, high) } else { (0.0, 0.0) };
        let spare = 0.05 * (high - low).max(0.1);
        Self { low: low - spare, high: high + spare, from, to }
    }

    fn place(&self, value: f64) -> f64 {
        let share = (value.max(f64::MIN_POSITIVE).log10() - self.low) / (self.high - self.low);
        self.from + share.clamp(0.0, 1.0) * (self.to - self.from)
    }

    /// Decades, no more than eight; 1, 2 and 5 where there are few.
    fn ticks(&self) -> Vec<(f64, String)> {
        let decades = self.high - self.low;
        let every = (decades / 8.0).ceil().max(1.0) as i32;
        let steps: &[f64] = if decades < 2.0 { &[1.0, 2.0, 5.0] } else { &[1.0] };
        (self.low.floor() as i32..=self.high.ceil() as i32)
            .filter(|exponent| exponent.rem_euclid(every) == 0)
            .flat_map(|exponent| steps.iter().map(move |step| (exponent, step * 10_f64.powi(exponent))))
            .filter(|(_, value)| (self.low..=self.high).contains(&value.log10()))
            .map(|(exponent, value)| (self.place(value), number(value, exponent)))
            .collect()
    }
}

/// A number of one digit: in full near 1, otherwise with its power of ten.
fn number(value: f64, exponent: i32) -> String {
    match exponent {
        -2..=3 => format!("{value:.*}", usize::try_from(-exponent).unwrap_or(0)),
        _ => format!("{value:.0e}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_chosen_point_lies_on_the_curve_and_every_number_is_finite() {
        let point = |i: i32| CurvePoint {
            hyperparameter: 10_f64.powi(i),
            abscissa: 10_f64.powi(i),
            ordinate: f64::from(i * i) + 1.0,
        };
        let selection = Selection {
            criterion: Criterion::CrossValidation,
            chosen: point(0),
            curve: (-4..=4).map(point).collect(),
        };
        let svg = criterion_svg("disc", &selection);
        let place = |key: &str| svg.split(key).nth(1).unwrap().split('"').next().unwrap().to_owned();
        let chosen = format!("{},{}", place("cx=\""), place("cy=\""));
        assert_eq!(place("points=\"").split(' ').nth(4), Some(chosen.as_str()));
        assert!(!svg.contains("NaN") && !svg.contains("inf"), "{svg}");
    }
    #[test]
    fn numbers_at_an_axis_are_written_in_full_near_one() {
        let names = |low: f64, high: f64| {
            let ticks = Axis::new([low, high].into_iter(), 0.0, 1.0).ticks();
            ticks.into_iter().map(|(_, name)| name).collect::<Vec<_>>()
        };
        assert_eq!(names(0.02, 1.0), ["0.02", "0.05", "0.1", "0.2", "0.5", "1"]);
        assert_eq!(names(1e-3, 1e4), ["1e-3", "0.01", "0.1", "1", "10", "100", "1000", "1e4"]);
    }
}
