//! Plot of the criterion by which a hyperparameter was chosen, as SVG.

use dermatome_model::{
    inverse::selection::{CurvePoint, Selection},
    skin::Criterion,
};
use plotters::{
    coord::ranged1d::{DefaultFormatting, KeyPointHint, Ranged},
    prelude::*,
};
use std::ops::Range;

/// Width and height, pixels.
const SIZE: (u32, u32) = (640, 440);
const FRAME: RGBColor = RGBColor(40, 40, 40);
const CURVE: RGBColor = RGBColor(31, 111, 180);
const CHOSEN: RGBColor = RGBColor(192, 48, 40);

/// Draws the criterion over its range, both axes logarithmic, with the chosen point.
#[must_use]
pub fn criterion_svg(skin: &str, selection: &Selection) -> String {
    let mut svg = String::new();
    draw(&mut svg, skin, selection).expect("text takes text");
    svg
}

fn draw(svg: &mut String, skin: &str, selection: &Selection) -> Result<(), Box<dyn std::error::Error>> {
    let chosen = selection.chosen;
    let points = || selection.curve.iter().chain([&chosen]);
    let x = Axis::new(points().map(|point| point.abscissa));
    let y = Axis::new(points().map(|point| point.ordinate));
    let title =
        format!("{skin}: hyperparameter {:.4e} by {}", chosen.hyperparameter, selection.criterion.name());
    let [across, up] = axis_names(selection.criterion);
    let area = SVGBackend::with_string(svg, SIZE).into_drawing_area();
    area.fill(&WHITE)?;
    let mut chart = ChartBuilder::on(&area)
        .caption(title, ("sans-serif", 15))
        .margin(14)
        .x_label_area_size(42)
        .y_label_area_size(66)
        .build_cartesian_2d(x, y)?;
    chart
        .configure_mesh()
        .disable_mesh()
        .x_desc(across)
        .y_desc(up)
        .x_label_formatter(&number)
        .y_label_formatter(&number)
        .label_style(("sans-serif", 13))
        .axis_style(FRAME)
        .draw()?;
    let place = |point: &CurvePoint| (x.place(point.abscissa), y.place(point.ordinate));
    chart.draw_series(LineSeries::new(selection.curve.iter().map(place), CURVE.stroke_width(2)))?;
    chart.draw_series([Circle::new(place(&chosen), 6, CHOSEN.stroke_width(2))])?;
    area.present()?;
    Ok(())
}

fn axis_names(criterion: Criterion) -> [&'static str; 2] {
    match criterion {
        Criterion::LCurve => ["size of the residual (whitened data)", "size of the image (by the prior)"],
        Criterion::CrossValidation => ["hyperparameter", "generalised cross-validation"],
        Criterion::NoiseFigure(_) => ["hyperparameter", "noise figure"],
        Criterion::BestResolution => ["hyperparameter", "blur of the standard target (share of the area)"],
    }
}

/// A logarithmic axis; its places are logarithms to base 10.
#[derive(Clone, Copy, Debug)]
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

    fn place(&self, value: f64) -> f64 {
        value.max(f64::MIN_POSITIVE).log10().clamp(self.low, self.high)
    }

    /// Decades, no more than eight; 1, 2 and 5 where there are few.
    fn ticks(&self) -> Vec<f64> {
        let decades = self.high - self.low;
        let every = (decades / 8.0).ceil().max(1.0) as i32;
        let steps: &[f64] = if decades < 2.0 { &[1.0, 2.0, 5.0] } else { &[1.0] };
        (self.low.floor() as i32..=self.high.ceil() as i32)
            .filter(|exponent| exponent.rem_euclid(every) == 0)
            .flat_map(|exponent| steps.iter().map(move |step| f64::from(exponent) + step.log10()))
            .filter(|place| self.range().contains(place))
            .collect()
    }
}

impl Ranged for Axis {
    type FormatOption = DefaultFormatting;
    type ValueType = f64;

    fn map(&self, place: &f64, (from, to): (i32, i32)) -> i32 {
        let share = (place - self.low) / (self.high - self.low);
        from + (share * f64::from(to - from)).round() as i32
    }

    fn key_points<Hint: KeyPointHint>(&self, _: Hint) -> Vec<f64> {
        self.ticks()
    }

    fn range(&self) -> Range<f64> {
        self.low..self.high
    }
}

/// A tick's number, of one digit: in full near 1, otherwise with its power of ten.
#[allow(clippy::trivially_copy_pass_by_ref, reason = "plotters hands out references")]
fn number(place: &f64) -> String {
    let exponent = (place + 1e-9).floor() as i32;
    let value = 10_f64.powf(*place);
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
        // The ticks of the axes are lines of two points.
        let curve = svg.split("points=\"").map(|rest| rest.split('"').next().unwrap().trim());
        let curve = curve.filter(|points| points.split(' ').count() == 9).collect::<Vec<_>>();
        assert_eq!(curve.len(), 1, "{svg}");
        assert_eq!(curve[0].split(' ').nth(4), Some(chosen.as_str()));
        assert!(!svg.contains("NaN") && !svg.contains("inf"), "{svg}");
    }
    #[test]
    fn numbers_at_an_axis_are_written_in_full_near_one() {
        let names = |low: f64, high: f64| {
            let ticks = Axis::new([low, high].into_iter()).ticks();
            ticks.iter().map(number).collect::<Vec<_>>()
        };
        assert_eq!(names(0.02, 1.0), ["0.02", "0.05", "0.1", "0.2", "0.5", "1"]);
        assert_eq!(names(1e-3, 1e4), ["1e-3", "0.01", "0.1", "1", "10", "100", "1000", "1e4"]);
    }
}
