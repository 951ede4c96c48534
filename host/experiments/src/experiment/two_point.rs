//! Two-point discrimination: from what distance on two contacts are two, everywhere on a skin.

use super::{
    ExperimentError,
    plot::{Chart, Series, Style},
    report::{Report, largest, number},
    sample::THREE_SINGLE,
    sample_rig::{Artefacts, SampleRig},
};
use dermatome_shared::contact::Contact;
use dermatome_simulate::{Footprint, Load, Press};
use nalgebra::{Point2, Vector2};
use num_complex::Complex64;
use rayon::prelude::*;
use serde_json::json;

/// Diameter of a contact, distance of neighbouring places, and step between distances, m.
const DIAMETER: f64 = 0.021;
const SPACING: f64 = 0.026;
const STEP: f64 = 0.005;
/// Ends of the rings, share of the way to the rim.
const RINGS: [f64; 4] = [0.0, 0.3, 0.6, 0.9];
/// Directions of a pair.
const DIRECTIONS: [&str; 2] = ["radial", "across"];

/// Pairs about one place in one direction, farthest apart first.
struct Pairs {
    place: Point2<f64>,
    direction: usize,
    middles: Vec<[[f64; 2]; 2]>,
    phasors: Vec<Vec<Complex64>>,
}

/// From what distance on the pairs of a place are told apart.
struct Limit {
    place: Point2<f64>,
    direction: usize,
    /// m; `None` if not even the largest is.
    distance: Option<f64>,
    largest: f64,
}

pub(super) fn run() -> Result<Report, ExperimentError> {
    let mut report = Report::new("two-point", "Two-point discrimination over the skin");
    report.words(format!(
        "Two flat discs of {:.0} mm, each doubling the conductivity beneath it, about places {:.0} mm apart on the disc of \
         210 mm, one behind the other as seen from the middle, or side by side. They are told apart if the board's two strongest \
         contacts are one for each, at this distance and all larger ones tried (steps of {:.0} mm), in the last of six frames. Artefacts: {}.",
        DIAMETER * 1e3,
        SPACING * 1e3,
        STEP * 1e3,
        Artefacts::MOVING.words()
    ));
    let mut rig = SampleRig::new(THREE_SINGLE.skin()?, Artefacts::MOVING, 1, 1)?;
    rig.tare(&vec![1.0; rig.elements()]);
    let radius = rig.side() / 2.0;
    let pairs: Vec<Pairs> = places(radius)
        .into_par_iter()
        .flat_map_iter(|place| (0..2).map(move |direction| (place, direction)))
        .filter_map(|(place, direction)| Pairs::about(&rig, place, direction, radius))
        .collect();
    let limits: Vec<Limit> = pairs.iter().map(|pairs| pairs.limit(&mut rig)).collect();
    summarise(&mut report, &limits, radius);
    report.plots(&[map(&limits, 0), map(&limits, 1)])?;
    Ok(report)
}

/// Places on a grid through the middle.
fn places(radius: f64) -> Vec<Point2<f64>> {
    let steps = (radius / SPACING).ceil() as i32;
    let at = |i: i32, j: i32| Point2::new(f64::from(i), f64::from(j)) * SPACING;
    let all = (-steps..=steps).flat_map(|j| (-steps..=steps).map(move |i| at(i, j)));
    all.filter(|place| place.coords.norm() < radius - DIAMETER / 2.0).collect()
}

impl Pairs {
    /// `None` where there is no room for any.
    fn about(rig: &SampleRig, place: Point2<f64>, direction: usize, radius: f64) -> Option<Self> {
        let outwards = place.coords.try_normalize(1e-6).unwrap_or(Vector2::x());
        let along = if direction == 0 { outwards } else { Vector2::new(-outwards.y, outwards.x) };
        let steps = (2.0 * radius / STEP) as u32;
        let pair = |step: u32| {
            let half = along * (DIAMETER + f64::from(step) * STEP) / 2.0;
            [place - half, place + half].map(|middle| [middle.x, middle.y])
        };
        let has_room =
            |middles: &[[f64; 2]; 2]| middles.iter().all(|[x, y]| x.hypot(*y) <= radius - DIAMETER / 2.0);
        let middles: Vec<_> = (0..steps).rev().map(pair).filter(has_room).collect();
        let phasors = middles.iter().map(|pair| {
            let press = |&at: &[f64; 2]| {
                Press::new(Footprint::Disc { radius: DIAMETER / 2.0 }, at, Load::Change(1.0))
            };
            rig.solve(&rig.truth().conductivity(&pair.each_ref().map(press)))
        });
        let phasors = phasors.collect();
        (!middles.is_empty()).then_some(Self { place, direction, middles, phasors })
    }

    fn limit(&self, rig: &mut SampleRig) -> Limit {
        let mut told_apart = None;
        for (pair, phasors) in self.middles.iter().zip(&self.phasors) {
            if !are_told_apart(&rig.settle(phasors), pair) {
                break;
            }
            told_apart = Some(distance(pair));
        }
        let largest = self.middles.first().map_or(0.0, distance);
        Limit { place: self.place, direction: self.direction, distance: told_apart, largest }
    }
}

fn distance([a, b]: &[[f64; 2]; 2]) -> f64 {
    (a[0] - b[0]).hypot(a[1] - b[1])
}

/// Whether the two strongest contacts are one for each.
fn are_told_apart(contacts: &[Contact], pair: &[[f64; 2]; 2]) -> bool {
    let [first, second, ..] = contacts else { return false };
    let is_of =
        |contact: &Contact, at: [f64; 2]| distance(&[contact.from_above(), at]) < distance(pair) / 2.0;
    let [a, b] = *pair;
    is_of(first, a) && is_of(second, b) || is_of(first, b) && is_of(second, a)
}

fn summarise(report: &mut Report, limits: &[Limit], radius: f64) {
    let mut rows = Vec::new();
    let mut figures = Vec::new();
    for (index, &from) in RINGS.iter().enumerate() {
        let to = RINGS.get(index + 1).copied().unwrap_or(1.0);
        for (direction, name) in DIRECTIONS.into_iter().enumerate() {
            let is_there = |limit: &&Limit| {
                limit.direction == direction && (from..to).contains(&(limit.place.coords.norm() / radius))
            };
            let here: Vec<&Limit> = limits.iter().filter(is_there).collect();
            if here.is_empty() {
                continue;
            }
            let mut found: Vec<f64> = here.iter().filter_map(|limit| limit.distance).collect();
            found.sort_by(f64::total_cmp);
            let never = here.len() - found.len();
            let median = found.get(found.len() / 2).map(|distance| distance * 1e3);
            let percent = median.map(|distance| distance / (2.0 * radius) * 0.1);
            let cell = |value: Option<f64>| value.map_or("-".to_owned(), number);
            rows.push(vec![
                format!("{:.0} - {:.0} % of the way to the rim, {name}", 100.0 * from, 100.0 * to),
                here.len().to_string(),
                cell(median),
                cell(percent),
                cell(found.last().map(|distance| distance * 1e3)),
                never.to_string(),
            ]);
            figures.push(json!({
                "from": from, "to": to, "direction": name, "places": here.len(), "never": never,
                "median_mm": median, "max_mm": found.last().map(|distance| distance * 1e3),
            }));
        }
    }
    let all: Vec<f64> = {
        let mut all: Vec<f64> = limits.iter().filter_map(|limit| limit.distance).collect();
        all.sort_by(f64::total_cmp);
        all
    };
    let median = all.get(all.len() / 2).copied().unwrap_or(f64::NAN);
    report.compare("told apart from, median of all places", "mm", None, median * 1e3, None);
    report.compare(
        "told apart from, median over the diameter",
        "%",
        None,
        100.0 * median / (2.0 * radius),
        None,
    );
    let columns =
        ["", "places", "median, mm", "median, % of the diameter", "largest, mm", "never told apart"];
    report.table("Smallest distance of the middles at which two contacts are told apart", &columns, rows);
    report.words(
        "Never: not even at the largest distance for which there is room about the place, which near the rim is small for pairs \
         one behind the other.",
    );
    let room = largest(limits.iter().map(|limit| limit.largest));
    report.figures = json!({ "median_mm": median * 1e3, "largest_tried_mm": room * 1e3, "rings": figures });
}

/// Places by their distance.
fn map(limits: &[Limit], direction: usize) -> Chart<'static> {
    const BANDS: [(f64, &str); 5] = [
        (0.045, "up to 45 mm"),
        (0.065, "up to 65 mm"),
        (0.085, "up to 85 mm"),
        (f64::INFINITY, "more"),
        (f64::NAN, "never"),
    ];
    let band = |limit: &Limit| {
        let place = |distance: f64| BANDS.iter().position(|(end, _)| distance <= *end);
        limit.distance.and_then(place).unwrap_or(BANDS.len() - 1)
    };
    let series = BANDS.iter().enumerate().map(|(index, (_, name))| {
        let here = limits.iter().filter(|limit| limit.direction == direction && band(limit) == index);
        let points = here.map(|limit| [limit.place.x * 1e3, limit.place.y * 1e3]).collect();
        Series::new(*name, points, Style::Marks)
    });
    let title = ["One behind the other", "Side by side"][direction];
    Chart { title, x: "x, mm", y: "y, mm", series: series.collect(), square: Some(145.0) }
}
