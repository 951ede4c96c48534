//! Diagrams: lines and marks as SVG.

use super::ExperimentError;
use plotters::prelude::*;
use std::ops::Range;

/// Size of a diagram.
const SIZE: (u32, u32) = (460, 340);
/// Colours that colour-blind people can tell apart (Okabe and Ito).
const COLOURS: [RGBColor; 6] = [
    RGBColor(0, 114, 178),
    RGBColor(213, 94, 0),
    RGBColor(0, 158, 115),
    RGBColor(204, 121, 167),
    RGBColor(230, 159, 0),
    RGBColor(86, 180, 233),
];

/// A diagram.
#[derive(Clone, Debug, Default)]
pub(super) struct Chart<'a> {
    pub(super) title: &'a str,
    pub(super) x: &'a str,
    pub(super) y: &'a str,
    pub(super) series: Vec<Series>,
    /// Both axes have one scale, and reach this far from zero.
    pub(super) square: Option<f64>,
}

/// One line or cloud of points.
#[derive(Clone, Debug)]
pub(super) struct Series {
    pub(super) name: String,
    pub(super) points: Vec<[f64; 2]>,
    pub(super) style: Style,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Style {
    Line,
    Marks,
    MarkedLine,
}

impl Series {
    pub(super) fn new(name: impl Into<String>, points: Vec<[f64; 2]>, style: Style) -> Self {
        Self { name: name.into(), points, style }
    }
}

impl Chart<'_> {
    /// Draws it.
    pub(super) fn svg(&self) -> Result<String, ExperimentError> {
        let mut text = String::new();
        self.draw(&mut text).map_err(|error| ExperimentError::Draw(error.to_string()))?;
        Ok(text)
    }

    fn draw(&self, text: &mut String) -> Result<(), Box<dyn std::error::Error>> {
        let size = if self.square.is_some() { (SIZE.1 + 40, SIZE.1 + 20) } else { SIZE };
        let area = SVGBackend::with_string(text, size).into_drawing_area();
        area.fill(&WHITE)?;
        let [x, y] = [0, 1].map(|axis| self.range(axis));
        let mut chart = ChartBuilder::on(&area)
            .caption(self.title, ("sans-serif", 15))
            .margin(8)
            .x_label_area_size(38)
            .y_label_area_size(58)
            .build_cartesian_2d(x, y)?;
        chart
            .configure_mesh()
            .x_desc(self.x)
            .y_desc(self.y)
            .x_labels(7)
            .y_labels(7)
            .x_label_formatter(&label)
            .y_label_formatter(&label)
            .light_line_style(WHITE)
            .bold_line_style(RGBColor(225, 225, 225))
            .label_style(("sans-serif", 12))
            .axis_desc_style(("sans-serif", 13))
            .draw()?;
        for (series, &colour) in self.series.iter().zip(COLOURS.iter().cycle()) {
            let points = || series.points.iter().map(|&[x, y]| (x, y));
            if series.style != Style::Marks {
                let line = chart.draw_series(LineSeries::new(points(), colour.stroke_width(2)))?;
                line.label(&series.name)
                    .legend(move |(x, y)| PathElement::new([(x, y), (x + 14, y)], colour.stroke_width(2)));
            }
            if series.style != Style::Line {
                let marks = chart.draw_series(points().map(|at| Circle::new(at, 3, colour.filled())))?;
                if series.style == Style::Marks {
                    marks
                        .label(&series.name)
                        .legend(move |(x, y)| Circle::new((x + 7, y), 3, colour.filled()));
                }
            }
        }
        if self.series.len() > 1 {
            chart
                .configure_series_labels()
                .position(self.legend_place())
                .background_style(WHITE.mix(0.85))
                .border_style(RGBColor(200, 200, 200))
                .label_font(("sans-serif", 12))
                .draw()?;
        }
        area.present()?;
        Ok(())
    }

    fn values(&self, axis: usize) -> impl Iterator<Item = f64> + '_ {
        self.series.iter().flat_map(|series| &series.points).map(move |point| point[axis])
    }

    /// What an axis shows: all points, with room at the ends.
    fn range(&self, axis: usize) -> Range<f64> {
        if let Some(reach) = self.square {
            return -reach..reach;
        }
        let values = || self.values(axis).filter(|value| value.is_finite());
        let (low, high) =
            (values().fold(f64::INFINITY, f64::min), values().fold(f64::NEG_INFINITY, f64::max));
        if low > high {
            return 0.0..1.0;
        }
        let room = 0.06 * (high - low).max(1e-9 * high.abs()).max(1e-12);
        low - room..high + room
    }

    /// The corner with the fewest points.
    fn legend_place(&self) -> SeriesLabelPosition {
        let [x, y] = [0, 1].map(|axis| self.range(axis));
        let share = |range: &Range<f64>, value: f64| (value - range.start) / (range.end - range.start);
        let crowd = |right: bool, top: bool| {
            let is_there =
                |&&[px, py]: &&[f64; 2]| (share(&x, px) > 0.5) == right && (share(&y, py) > 0.6) == top;
            self.series.iter().flat_map(|series| &series.points).filter(is_there).count()
        };
        let corners = [
            (crowd(false, true), SeriesLabelPosition::UpperLeft),
            (crowd(true, true), SeriesLabelPosition::UpperRight),
            (crowd(true, false), SeriesLabelPosition::LowerRight),
            (crowd(false, false), SeriesLabelPosition::LowerLeft),
        ];
        corners
            .into_iter()
            .min_by_key(|(crowd, _)| *crowd)
            .map_or(SeriesLabelPosition::UpperLeft, |(_, at)| at)
    }
}

/// A number on an axis, without digits that say nothing.
#[allow(clippy::trivially_copy_pass_by_ref, reason = "plotters hands out references")]
fn label(value: &f64) -> String {
    let text = format!("{value:.4}");
    let text = text.trim_end_matches('0').trim_end_matches('.');
    if text == "-0" { "0".to_owned() } else { text.to_owned() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_diagram_shows_all_its_points_and_words() {
        let points: Vec<_> = (0..5).map(|i| [f64::from(i), f64::from(i * i)]).collect();
        let series = [Style::Marks, Style::MarkedLine]
            .map(|style| Series::new(format!("{style:?} here"), points.clone(), style));
        let chart =
            Chart { title: "a title", x: "load", y: "change", series: series.into(), ..Chart::default() };
        let svg = chart.svg().unwrap();
        for word in ["a title", "load", "change", "Marks here", "MarkedLine here", "<polyline"] {
            assert!(svg.contains(word), "{word}");
        }
        // One mark of each point in both series, and one in the legend.
        assert_eq!(svg.matches("<circle").count(), 11);
    }

    #[test]
    fn nothing_or_one_point_is_drawn_too() {
        for points in [vec![], vec![[1.0, 2.0]], vec![[f64::NAN, 1.0]]] {
            let series = vec![Series::new("x", points, Style::Marks)];
            assert!(Chart { series, ..Chart::default() }.svg().unwrap().ends_with("</svg>\n"));
        }
    }
}
