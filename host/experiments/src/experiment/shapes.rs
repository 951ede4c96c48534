//! Feature recognition (thesis 5.4.2): an 'L' and an 'O' under 25 N on Sample 3.

use super::{
    ExperimentError,
    plot::{Chart, Series, Style},
    report::{Report, Wanted},
    saline::draw,
    sample::{Sample, Specimen, THREE_DUAL, THREE_SINGLE},
    sample_rig::{Artefacts, Shown},
};
use dermatome_simulate::{Footprint, Load, Press};
use dermatome_view::sheet::Panel;
use rayon::prelude::*;
use serde_json::{Value, json};
use std::f64::consts::{PI, TAU};

/// N.
const FORCE: f64 = 25.0;
/// The 'O': radii, m.
const O: Footprint = Footprint::Ring { outer: 0.055, inner: 0.033 };
const HOLE: f64 = 0.02;
/// The 'L', m.
const L: Footprint = Footprint::Corner { length: 0.1, width: 0.025 };

/// A sample under both shapes.
struct Pressed {
    specimen: Specimen,
    shown: [Shown; 2],
}

pub(super) fn run() -> Result<Report, ExperimentError> {
    let mut report = Report::new("shapes", "Feature recognition: 'L' and 'O' (thesis 5.4.2, Fig. 5.9)");
    report.words(format!(
        "An 'O' of 110 mm with a hole of 66 mm, and an 'L' with arms of 100 by 25 mm, each under {FORCE} N in the middle of a \
         fresh specimen of Sample 3 for 10 s. The thesis does not state the sizes of its shapes and gives pictures only. \
         Artefacts: {}.",
        Artefacts::SHEET.words()
    ));
    let samples = [THREE_SINGLE, THREE_DUAL];
    let pressed: Vec<_> = samples.par_iter().map(press).collect();
    let mut figures = serde_json::Map::new();
    let mut profiles = Vec::new();
    for (sample, pressed) in samples.iter().zip(pressed) {
        let pressed = pressed?;
        figures.insert(sample.material.to_owned(), show(&mut report, sample, &pressed)?);
        profiles.push(profile(sample, &pressed));
    }
    let truth = (-100..=100).map(|mm| [f64::from(mm), f64::from(u8::from((33..55).contains(&i32::abs(mm))))]);
    profiles.push(Series::new("where the O presses", truth.collect(), Style::Line));
    report.plots(&[Chart {
        title: "The 'O' along y = 0",
        x: "x, mm",
        y: "change over its largest",
        series: profiles,
        square: None,
    }])?;
    report.figures = Value::Object(figures);
    Ok(report)
}

fn press(sample: &Sample) -> Result<Pressed, ExperimentError> {
    let mut shown = Vec::new();
    let mut last = None;
    for footprint in [O, L] {
        let mut specimen = sample.specimen(Artefacts::SHEET, 1)?;
        shown.push(specimen.hold(&[Press::new(footprint, [0.0; 2], Load::Force(FORCE))], 10.0)?);
        last = Some(specimen);
    }
    let shown = shown.try_into().expect("two shapes");
    Ok(Pressed { specimen: last.expect("two shapes"), shown })
}

fn show(report: &mut Report, sample: &Sample, pressed: &Pressed) -> Result<Value, ExperimentError> {
    let rig = &pressed.specimen.rig;
    let places: Vec<[f64; 2]> =
        rig.model().pixels.centres.iter().map(|centre| [centre.x, centre.y]).collect();
    let [o, l] = &pressed.shown;
    let hole = mean_where(&places, &o.image, |[x, y]| x.hypot(y) < HOLE);
    let ring = mean_where(&places, &o.image, |[x, y]| (0.033..0.055).contains(&x.hypot(y)));
    let contrast = 100.0 * (ring - hole) / ring;
    let corner = Corner::fit(&places, &l.image);
    let angle = corner.angle().to_degrees();
    let name = sample.name;
    report.compare(
        format!("{name}: hole of the 'O' against its ring"),
        "%",
        None,
        contrast,
        Some(Wanted::AtLeast(20.0)),
    );
    report.compare(format!("{name}: angle of the 'L' (90 pressed)"), "deg", None, angle, None);
    let wrong = (angle - 90.0).abs();
    report.compare(format!("{name}: error of that angle"), "deg", None, wrong, Some(Wanted::AtMost(20.0)));
    let true_corner = [-0.0375, -0.0375];
    let miss = (corner.at[0] - true_corner[0]).hypot(corner.at[1] - true_corner[1]);
    report.compare(
        format!("{name}: distance of the corner found from the true one"),
        "%",
        None,
        100.0 * miss / rig.side(),
        None,
    );
    report.words(format!(
        "{name}: mean change {ring:.3} where the 'O' presses and {hole:.3} within 20 mm of its middle. Corner of the 'L': the \
         two half lines from one point that lie closest to the changes above a quarter of the largest, by least squares; where \
         the arms' middle lines meet is the true corner."
    ));
    let truths = [O, L].map(|footprint| {
        let press = Press::new(footprint, [0.0; 2], Load::Change(1.0));
        places.iter().map(|&place| press.change_at(place)).collect::<Vec<_>>()
    });
    let images = [&o.image, &l.image].map(|image| over_its_largest(image));
    let panels = [
        ("'O' pressed", &truths[0]),
        ("image", &images[0]),
        ("'L' pressed", &truths[1]),
        ("image", &images[1]),
    ];
    let panels = panels.into_iter().enumerate().map(|(index, (caption, values))| Panel {
        caption: vec![caption.to_owned()],
        values,
        found: if index == 3 { vec![corner.at] } else { Vec::new() },
        ..Panel::default()
    });
    let picture = draw(rig, name, 4, panels.collect())?;
    report.picture(
        picture,
        &format!("{name}: each image over its largest value; the circle is the corner found"),
    );
    Ok(json!({
        "ring": ring,
        "hole": hole,
        "hole_contrast_percent": contrast,
        "corner_angle_deg": angle,
        "corner_error_percent": 100.0 * miss / rig.side(),
    }))
}

fn mean_where(places: &[[f64; 2]], image: &[f64], is_there: impl Fn([f64; 2]) -> bool) -> f64 {
    let values: Vec<f64> =
        places.iter().zip(image).filter(|(place, _)| is_there(**place)).map(|(_, value)| *value).collect();
    values.iter().sum::<f64>() / values.len().max(1) as f64
}

fn over_its_largest(image: &[f64]) -> Vec<f64> {
    let largest = image.iter().copied().fold(f64::MIN_POSITIVE, f64::max);
    image.iter().map(|value| value / largest).collect()
}

/// The image of the 'O' along y = 0.
fn profile(sample: &Sample, pressed: &Pressed) -> Series {
    let image = over_its_largest(&pressed.shown[0].image);
    let centres = &pressed.specimen.rig.model().pixels.centres;
    let pitch = pressed.specimen.rig.model().pixels.areas.iter().copied().fold(0.0, f64::max).sqrt();
    let row = centres.iter().zip(&image).filter(|(centre, _)| (0.0..pitch).contains(&centre.y));
    let points = row.map(|(centre, value)| [centre.x * 1e3, *value]).collect();
    Series::new(sample.name, points, Style::MarkedLine)
}

/// Two half lines from one point.
#[derive(Clone, Copy, Debug)]
struct Corner {
    at: [f64; 2],
    /// Directions, rad.
    arms: [f64; 2],
    /// Length of both, m.
    length: f64,
}

impl Corner {
    /// The corner that lies closest to what is above a quarter of the image's largest value.
    fn fit(places: &[[f64; 2]], image: &[f64]) -> Self {
        let largest = image.iter().copied().fold(0.0, f64::max);
        let weighted: Vec<([f64; 2], f64)> = places
            .iter()
            .zip(image)
            .map(|(&place, &value)| (place, value - 0.25 * largest))
            .filter(|(_, weight)| *weight > 0.0)
            .collect();
        let total: f64 = weighted.iter().map(|(_, weight)| weight).sum();
        let mean = |axis: usize| weighted.iter().map(|(at, weight)| at[axis] * weight).sum::<f64>() / total;
        let middle = [mean(0), mean(1)];
        let spread = weighted
            .iter()
            .map(|([x, y], weight)| weight * ((x - middle[0]).powi(2) + (y - middle[1]).powi(2)))
            .sum::<f64>();
        let length = 2.0 * (spread / total).sqrt();
        let starts = (0..12).map(|turn| {
            let turn = f64::from(turn) * TAU / 12.0;
            let back = 0.4 * length;
            // The corner lies behind the middle, as seen along the bisector.
            let at = [middle[0] - back * turn.cos(), middle[1] - back * turn.sin()];
            Self { at, arms: [turn - PI / 4.0, turn + PI / 4.0], length }.settle(&weighted)
        });
        let best = starts.min_by(|a, b| a.cost(&weighted).total_cmp(&b.cost(&weighted)));
        best.expect("there are starts")
    }

    /// Walks downhill in smaller and smaller steps.
    fn settle(mut self, weighted: &[([f64; 2], f64)]) -> Self {
        let mut step = 0.3;
        let mut cost = self.cost(weighted);
        while step > 1e-3 {
            let better = (0..10).map(|way| self.moved(way, step)).find_map(|corner| {
                let other = corner.cost(weighted);
                (other < cost).then_some((corner, other))
            });
            match better {
                Some((corner, other)) => (self, cost) = (corner, other),
                None => step /= 2.0,
            }
        }
        self
    }

    /// One of ten small changes.
    fn moved(mut self, way: usize, step: f64) -> Self {
        let by = if way.is_multiple_of(2) { step } else { -step };
        match way / 2 {
            axis @ (0 | 1) => self.at[axis] += by * self.length,
            arm @ (2 | 3) => self.arms[arm - 2] += by,
            _ => self.length *= by.exp(),
        }
        self
    }

    /// Squared distances from the nearer arm, weighted.
    fn cost(&self, weighted: &[([f64; 2], f64)]) -> f64 {
        let from_arm = |at: [f64; 2], arm: f64| {
            let [x, y] = [at[0] - self.at[0], at[1] - self.at[1]];
            let along = (x * arm.cos() + y * arm.sin()).clamp(0.0, self.length);
            (x - along * arm.cos()).powi(2) + (y - along * arm.sin()).powi(2)
        };
        weighted
            .iter()
            .map(|&(at, weight)| weight * from_arm(at, self.arms[0]).min(from_arm(at, self.arms[1])))
            .sum()
    }

    /// Angle between the arms, 0 to pi.
    fn angle(&self) -> f64 {
        let between = (self.arms[0] - self.arms[1]).rem_euclid(TAU);
        between.min(TAU - between)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// An image of a press on a grid of 4 mm.
    fn image(press: &Press) -> (Vec<[f64; 2]>, Vec<f64>) {
        let at = |i: i32| f64::from(i) * 0.004;
        let places: Vec<_> = (-25..=25).flat_map(|j| (-25..=25).map(move |i| [at(i), at(j)])).collect();
        let values = places.iter().map(|&place| press.change_at(place)).collect();
        (places, values)
    }

    #[test]
    fn the_corner_of_an_l_is_found_in_any_attitude() {
        for angle in [0.0, 0.7, 2.0, 4.4] {
            let press = Press { angle, ..Press::new(L, [0.01, -0.005], Load::Change(1.0)) };
            let (places, values) = image(&press);
            let corner = Corner::fit(&places, &values);
            assert!((corner.angle().to_degrees() - 90.0).abs() < 8.0, "{angle}: {corner:?}");
            let (sin, cos) = angle.sin_cos();
            let true_corner = [0.01 - 0.0375 * (cos - sin), -0.005 - 0.0375 * (sin + cos)];
            let miss = (corner.at[0] - true_corner[0]).hypot(corner.at[1] - true_corner[1]);
            assert!(miss < 0.008, "{angle}: {corner:?} {true_corner:?}");
        }
    }

    #[test]
    fn other_angles_are_not_taken_for_right_ones() {
        let arm = |turn: f64| [0.09 * turn.cos(), 0.09 * turn.sin()];
        for opening in [0.6_f64, 2.4] {
            let [a, b] = [arm(0.0), arm(opening)];
            let along = |at: [f64; 2], to: [f64; 2]| {
                let share = ((at[0] * to[0] + at[1] * to[1]) / 0.0081).clamp(0.0, 1.0);
                (at[0] - share * to[0]).hypot(at[1] - share * to[1]) < 0.008
            };
            let (places, _) = image(&Press::new(O, [0.0; 2], Load::Change(1.0)));
            let values: Vec<f64> =
                places.iter().map(|&at| f64::from(u8::from(along(at, a) || along(at, b)))).collect();
            let found = Corner::fit(&places, &values).angle();
            assert!((found - opening).abs() < 0.2, "{opening}: {found}");
        }
    }
}
