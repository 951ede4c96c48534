//! Report: what an experiment found, for people and for scripts.

use super::ExperimentError;
use serde_json::{Value, json};

/// What one experiment found.
#[derive(Clone, Debug)]
pub struct Report {
    /// Name of the experiment.
    pub name: &'static str,
    /// Its heading.
    pub title: &'static str,
    /// Our figures beside the thesis'.
    pub comparisons: Vec<Comparison>,
    /// Its row of the thesis' Table 6.1, if it has one.
    pub assessment: Option<Assessment>,
    /// All figures, for scripts.
    pub figures: Value,
    pub(super) blocks: Vec<Block>,
}

/// One sample in the thesis' Table 6.1.
#[derive(Clone, Debug, PartialEq)]
pub struct Assessment {
    /// The sample.
    pub sample: &'static str,
    /// Range, hysteresis, position error.
    pub figures: [Comparison; 3],
}

/// One figure beside the thesis'.
#[derive(Clone, Debug, PartialEq)]
pub struct Comparison {
    /// What it is.
    pub what: String,
    /// Its unit; may be empty.
    pub unit: &'static str,
    /// What the thesis found, if it says.
    pub thesis: Option<f64>,
    /// What was found here.
    pub found: f64,
    /// What it should be.
    pub wanted: Option<Wanted>,
}

/// What a figure should be.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Wanted {
    /// No more than this.
    AtMost(f64),
    /// No less than this.
    AtLeast(f64),
}

/// A part of the page.
#[derive(Clone, Debug)]
pub(super) enum Block {
    /// A paragraph.
    Words(String),
    /// A table.
    Table(Table),
    /// Diagrams side by side, SVG.
    Plots(Vec<String>),
    /// A picture, PNG, and what it shows.
    Picture(Vec<u8>, String),
}

/// A table; the first column is the row's name.
#[derive(Clone, Debug)]
pub(super) struct Table {
    pub(super) caption: String,
    pub(super) columns: Vec<String>,
    pub(super) rows: Vec<Vec<String>>,
}

impl Report {
    pub(super) fn new(name: &'static str, title: &'static str) -> Self {
        Self {
            name,
            title,
            comparisons: Vec::new(),
            assessment: None,
            figures: Value::Null,
            blocks: Vec::new(),
        }
    }

    pub(super) fn words(&mut self, words: impl Into<String>) {
        self.blocks.push(Block::Words(words.into()));
    }

    pub(super) fn table(&mut self, caption: &str, columns: &[&str], rows: Vec<Vec<String>>) {
        let columns = columns.iter().map(|&column| column.to_owned()).collect();
        self.blocks.push(Block::Table(Table { caption: caption.to_owned(), columns, rows }));
    }

    pub(super) fn plots(&mut self, charts: &[super::plot::Chart<'_>]) -> Result<(), ExperimentError> {
        let drawn = charts.iter().map(super::plot::Chart::svg).collect::<Result<_, _>>()?;
        self.blocks.push(Block::Plots(drawn));
        Ok(())
    }

    pub(super) fn picture(&mut self, png: Vec<u8>, words: &str) {
        self.blocks.push(Block::Picture(png, words.to_owned()));
    }

    pub(super) fn compare(
        &mut self,
        what: impl Into<String>,
        unit: &'static str,
        thesis: Option<f64>,
        found: f64,
        wanted: Option<Wanted>,
    ) {
        self.comparisons.push(Comparison { what: what.into(), unit, thesis, found, wanted });
    }
}

impl Comparison {
    /// Whether it is as it should be; `None` where nothing is asked for.
    #[must_use]
    pub fn met(&self) -> Option<bool> {
        self.wanted.map(|wanted| match wanted {
            Wanted::AtMost(limit) => self.found <= limit,
            Wanted::AtLeast(limit) => self.found >= limit,
        })
    }

    fn json(&self) -> Value {
        let (at_most, at_least) = match self.wanted {
            Some(Wanted::AtMost(limit)) => (Some(limit), None),
            Some(Wanted::AtLeast(limit)) => (None, Some(limit)),
            None => (None, None),
        };
        json!({
            "what": self.what,
            "unit": self.unit,
            "thesis": self.thesis,
            "found": self.found,
            "at_most": at_most,
            "at_least": at_least,
            "met": self.met(),
        })
    }
}

/// All reports, for scripts; keys are documented in docs/experiments.md.
#[must_use]
pub fn json(reports: &[Report]) -> Value {
    let report = |report: &Report| {
        json!({
            "name": report.name,
            "title": report.title,
            "comparisons": report.comparisons.iter().map(Comparison::json).collect::<Vec<_>>(),
            "figures": report.figures,
        })
    };
    let assessed = |assessment: &Assessment| {
        json!({
            "sample": assessment.sample,
            "figures": assessment.figures.iter().map(Comparison::json).collect::<Vec<_>>(),
        })
    };
    let table: Vec<_> =
        reports.iter().filter_map(|report| report.assessment.as_ref()).map(assessed).collect();
    json!({
        "simulated": true,
        "table_6_1": table,
        "experiments": reports.iter().map(report).collect::<Vec<_>>(),
    })
}

/// A number with so many digits that people can compare it.
pub(super) fn number(value: f64) -> String {
    match value.abs() {
        0.0 => "0".to_owned(),
        size if size >= 100.0 => format!("{value:.0}"),
        size if size >= 10.0 => format!("{value:.1}"),
        size if size >= 0.1 => format!("{value:.2}"),
        size if size >= 0.001 => format!("{value:.4}"),
        _ => format!("{value:.1e}"),
    }
}

/// Mean and standard deviation (of a sample); zeros of nothing.
pub(super) fn mean_and_deviation(values: &[f64]) -> [f64; 2] {
    let count = values.len() as f64;
    if values.is_empty() {
        return [0.0; 2];
    }
    let mean = values.iter().sum::<f64>() / count;
    let squares: f64 = values.iter().map(|value| (value - mean).powi(2)).sum();
    [mean, (squares / (count - 1.0).max(1.0)).sqrt()]
}

/// Largest value; zero of nothing.
pub(super) fn largest(values: impl IntoIterator<Item = f64>) -> f64 {
    values.into_iter().fold(0.0, f64::max)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_figure_is_met_or_not_or_not_asked_for() {
        let figure = |found, wanted| Comparison { what: "x".into(), unit: "%", thesis: None, found, wanted };
        assert_eq!(figure(1.0, Some(Wanted::AtMost(1.0))).met(), Some(true));
        assert_eq!(figure(1.1, Some(Wanted::AtMost(1.0))).met(), Some(false));
        assert_eq!(figure(1.1, Some(Wanted::AtLeast(1.0))).met(), Some(true));
        assert_eq!(figure(f64::NAN, Some(Wanted::AtMost(1.0))).met(), Some(false));
        assert_eq!(figure(1.1, None).met(), None);
    }

    #[test]
    fn mean_and_deviation_of_a_sample() {
        let [mean, deviation] = mean_and_deviation(&[1.0, 2.0, 3.0]);
        assert!((mean - 2.0).abs() < 1e-15 && (deviation - 1.0).abs() < 1e-15);
        assert_eq!(mean_and_deviation(&[]), [0.0; 2]);
        assert_eq!(mean_and_deviation(&[5.0]), [5.0, 0.0]);
    }
}
