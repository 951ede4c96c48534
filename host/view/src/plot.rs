//! Plot of the criterion by which a hyperparameter was chosen, as SVG.

use dermatome_model::{inverse::selection::Selection, skin::Criterion};
use plotters::{
    coord::ranged1d::{DefaultFormatting, KeyPointHint, Ranged},
    drawing::DrawingAreaErrorKind,
    prelude::*,
};
use std::{io, ops::Range};

const SIZE: (u32, u32) = (640, 440);
const CURVE: RGBColor = RGBColor(0x1f, 0x6f, 0xb4);
const CHOSEN: RGBColor = RGBColor(0xc0, 0x30, 0x28);

/// Draws the criterion over its range, both axes logarithmic, with the chosen point.
#[must_use]
pub fn criterion_svg(skin: &str, selection: &Selection) -> String {
    let mut text = String::new();
    draw(&mut text, skin, selection).expect("text takes every drawing");
    text
}

fn draw(text: &mut String, skin: &str, selection: &Selection) -> Result<(), DrawingAreaErrorKind<io::Error>> {
    let area = SVGBackend::with_string(text, SIZE).into_drawing_area();
    area.fill(&WHITE)?;
    let points = || selection.curve.iter().chain([&selection.chosen]);
    let chosen = selection.chosen;
    let title =
        format!("{skin}: hyperparameter {:.4e} by {}", chosen.hyperparameter, selection.criterion.name());
    let mut chart = ChartBuilder::on(&area)
        .caption(title, ("sans-serif", 16))
        .margin(10)
        .margin_right(24)
        .x_label_area_size(40)
        .y_label_area_size(66)
        .build_cartesian_2d(
            Axis::new(points().map(|point| point.abscissa)),
            Axis::new(points().map(|point| point.ordinate)),
        )?;
    let [across, up] = axis_names(selection.criterion);
    chart
        .configure_mesh()
        .x_desc(across)
        .y_desc(up)
        .x_label_formatter(&|value| name(*value))
        .y_label_formatter(&|value| name(*value))
        .light_line_style(WHITE)
        .bold_line_style(RGBColor(225, 225, 225))
        .label_style(("sans-serif", 13))
        .draw()?;
    let curve = selection.curve.iter().map(|point| (point.abscissa, point.ordinate));
    chart.draw_series(LineSeries::new(curve, CURVE.stroke_width(2)))?;
    chart.draw_series([Circle::new((chosen.abscissa, chosen.ordinate), 6, CHOSEN.stroke_width(2))])?;
    area.present()
}

fn axis_names(criterion: Criterion) -> [&'static str; 2] {
    match criterion {
        Criterion::LCurve => ["size of the residual (whitened data)", "size of the image (by the prior)"],
        Criterion::CrossValidation => ["hyperparameter", "generalised cross-validation"],
        Criterion::NoiseFigure(_) => ["hyperparameter", "noise figure"],
        Criterion::BestResolution => ["hyperparameter", "blur of the standard target (share of the area)"],
    }
}

/// A logarithmic axis: its ends are decimal logarithms.
struct Axis {
    low: f64,
    high: f64,
}

impl Axis {
    fn new(values: impl Iterator<Item = f64>) -> Self {
        let logs = values.filter(|value| *value > 0.0 && value.is_finite()).map(f64::log10);
        let (low, high) =
            logs.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), log| (low.min(log), high.max(log)));
        let (low, high) = if low <= high { (low, high) } else { (0.0, 0.0) };
        let spare = 0.05 * (high - low).max(0.1);
        Self { low: low - spare, high: high + spare }
    }

    /// Decades, no more than eight; 1, 2 and 5 where there are few.
    fn ticks(&self) -> Vec<f64> {
        let decades = self.high - self.low;
        let every = (decades / 8.0).ceil().max(1.0) as i32;
        let steps: &[f64] = if decades < 2.0 { &[1.0, 2.0, 5.0] } else { &[1.0] };
        (self.low.floor() as i32..=self.high.ceil() as i32)
            .filter(|exponent| exponent.rem_euclid(every) == 0)
            .flat_map(|exponent| steps.iter().map(move |step| step * 10_f64.powi(exponent)))
            .filter(|value| (self.low..=self.high).contains(&value.log10()))
            .collect()
    }
}

impl Ranged for Axis {
    type FormatOption = DefaultFormatting;
    type ValueType = f64;

    fn map(&self, value: &f64, (from, to): (i32, i32)) -> i32 {
        let share = (value.max(f64::MIN_POSITIVE).log10() - self.low) / (self.high - self.low);
        from + (share.clamp(0.0, 1.0) * f64::from(to - from)).round() as i32
    }

    fn key_points<Hint: KeyPointHint>(&self, _: Hint) -> Vec<f64> {
        self.ticks()
    }

    fn range(&self) -> Range<f64> {
        10_f64.powf(self.low)..10_f64.powf(self.high)
    }
}

/// A tick's number.
fn name(value: f64) -> String {
    number(value, (value.log10() + 1e-9).floor() as i32)
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
    use dermatome_model::inverse::selection::CurvePoint;

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
        let of =
            |text: &str, key: &str| text.split(key).nth(1).unwrap().split('"').next().unwrap().to_owned();
        let curve = svg.lines().find(|line| line.contains("<polyline") && line.contains("#1F6FB4")).unwrap();
        let chosen = format!("{},{}", of(&svg, "cx=\""), of(&svg, "cy=\""));
        assert_eq!(of(curve, "points=\"").split(' ').nth(4), Some(chosen.as_str()));
        assert!(!svg.contains("NaN") && !svg.contains("inf"), "{svg}");
    }
    #[test]
    fn numbers_at_an_axis_are_written_in_full_near_one() {
        let names = |low: f64, high: f64| {
            let ticks = Axis::new([low, high].into_iter()).ticks();
            ticks.into_iter().map(name).collect::<Vec<_>>()
        };
        assert_eq!(names(0.02, 1.0), ["0.02", "0.05", "0.1", "0.2", "0.5", "1"]);
        assert_eq!(names(1e-3, 1e4), ["1e-3", "0.01", "0.1", "1", "10", "100", "1000", "1e4"]);
    }
}
