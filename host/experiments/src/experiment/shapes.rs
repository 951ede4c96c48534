//! Feature recognition (thesis 5.4.2): an 'L' and 'O's of three sizes under 25 N on Sample 3, and fingers as thin as a
//! pencil ([`thin_fingers`]).

use super::{
    ExperimentError,
    plot::{Chart, Series, Style},
    report::{Report, Wanted},
    saline::draw,
    sample::{Sample, Specimen, THREE_DUAL, THREE_SINGLE},
    sample_rig::{Artefacts, Shown},
    thin_fingers,
};
use dermatome_simulate::{Footprint, Load, Press};
use dermatome_view::sheet::Panel;
use rayon::prelude::*;
use serde_json::{Value, json};
use std::f64::consts::{PI, TAU};

/// N.
const FORCE: f64 = 25.0;
/// The 'O's: outer and inner radii, m, from the largest to the smallest.
const OS: [[f64; 2]; 3] = [[0.055, 0.033], [0.045, 0.027], [0.035, 0.021]];
/// What of a hole is far from its ring, share of its radius.
const HOLE: f64 = 0.6;
/// The hole is so much below its ring, %.
const DIP: f64 = 20.0;
/// The 'L', m.
const L: Footprint = Footprint::Corner { length: 0.1, width: 0.025 };
/// Where the middle lines of its arms meet.
const TRUE_CORNER: [f64; 2] = [-0.0375, -0.0375];

/// A sample under all shapes.
struct Pressed {
    specimen: Specimen,
    os: Vec<Shown>,
    l: Shown,
}

pub(super) fn run() -> Result<Report, ExperimentError> {
    let mut report =
        Report::new("shapes", "Feature recognition: 'L', 'O' and thin fingers (thesis 5.4.2, Fig. 5.9)");
    let sizes: Vec<_> = OS.iter().map(|o| size(*o)).collect();
    report.words(format!(
        "'O's of three sizes (outer over inner diameter: {}), and an 'L' with arms of 100 by 25 mm, each under {FORCE} N in \
         the middle of a fresh specimen of Sample 3 for 10 s. The thesis does not state the sizes of its shapes and gives \
         pictures only. Artefacts: {}.",
        sizes.join(", "),
        Artefacts::SHEET.words()
    ));
    let samples = [THREE_SINGLE, THREE_DUAL];
    let pressed: Vec<_> = samples.par_iter().map(press).collect();
    let mut figures = serde_json::Map::new();
    let mut profiles = Vec::new();
    for (sample, pressed) in samples.iter().zip(pressed) {
        let pressed = pressed?;
        figures.insert(sample.material.to_owned(), show(&mut report, sample, &pressed)?);
        profiles.push(profiles_of(sample, &pressed));
    }
    report.plots(&profiles)?;
    figures.insert("thin_fingers".to_owned(), thin_fingers::show(&mut report)?);
    report.figures = Value::Object(figures);
    Ok(report)
}

/// Diameters, in words.
fn size([outer, inner]: [f64; 2]) -> String {
    format!("{:.0}/{:.0} mm", 2e3 * outer, 2e3 * inner)
}

fn ring([outer, inner]: [f64; 2]) -> Footprint {
    Footprint::Ring { outer, inner }
}

fn press(sample: &Sample) -> Result<Pressed, ExperimentError> {
    let hold = |footprint| {
        let mut specimen = sample.specimen(Artefacts::SHEET, 1)?;
        let shown = specimen.hold(&[Press::new(footprint, [0.0; 2], Load::Force(FORCE))], 10.0)?;
        Ok::<_, ExperimentError>((specimen, shown))
    };
    let os = OS.iter().map(|o| Ok(hold(ring(*o))?.1)).collect::<Result<_, ExperimentError>>()?;
    let (specimen, l) = hold(L)?;
    Ok(Pressed { specimen, os, l })
}

/// How far the middle of a hole lies below its ring: mean change of both, and the difference, % of the ring's.
fn dip(places: &[[f64; 2]], image: &[f64], [outer, inner]: [f64; 2]) -> [f64; 3] {
    let hole = mean_where(places, image, |[x, y]| x.hypot(y) < HOLE * inner);
    let ring = mean_where(places, image, |[x, y]| (inner..outer).contains(&x.hypot(y)));
    [ring, hole, 100.0 * (ring - hole) / ring]
}

fn show(report: &mut Report, sample: &Sample, pressed: &Pressed) -> Result<Value, ExperimentError> {
    let places: Vec<[f64; 2]> =
        pressed.specimen.rig.model().pixels.centres.iter().map(|centre| [centre.x, centre.y]).collect();
    let holes = show_holes(report, sample, pressed, &places);
    let corner = show_corner(report, sample, pressed, &places);
    let picture = picture(sample, pressed, &places, &corner)?;
    report.picture(
        picture,
        &format!("{}: each image over its largest value; the circle is the corner found", sample.name),
    );
    Ok(json!({
        "o": holes,
        "corner_angle_deg": corner.angle().to_degrees(),
        "corner_error_percent": 100.0 * corner.miss() / pressed.specimen.rig.side(),
    }))
}

fn show_holes(report: &mut Report, sample: &Sample, pressed: &Pressed, places: &[[f64; 2]]) -> Vec<Value> {
    let name = sample.name;
    let mut figures = Vec::new();
    for (o, shown) in OS.iter().zip(&pressed.os) {
        let [ring, hole, contrast] = dip(places, &shown.image, *o);
        let what = format!("{name}: hole of the 'O' of {} against its ring", size(*o));
        report.compare(what, "%", None, contrast, Some(Wanted::AtLeast(DIP)));
        figures.push(json!({
            "outer_m": 2.0 * o[0],
            "inner_m": 2.0 * o[1],
            "ring": ring,
            "hole": hole,
            "hole_contrast_percent": contrast,
        }));
    }
    report.words(format!(
        "{name}: a hole is what lies within {HOLE} of its radius. Corner of the 'L': the two half lines from one point that \
         lie closest to the changes above a quarter of the largest, by least squares; where the arms' middle lines meet is \
         the true corner."
    ));
    figures
}

fn show_corner(report: &mut Report, sample: &Sample, pressed: &Pressed, places: &[[f64; 2]]) -> Corner {
    let name = sample.name;
    let corner = Corner::fit(places, &pressed.l.image);
    let angle = corner.angle().to_degrees();
    report.compare(format!("{name}: angle of the 'L' (90 pressed)"), "deg", None, angle, None);
    let wrong = (angle - 90.0).abs();
    report.compare(format!("{name}: error of that angle"), "deg", None, wrong, Some(Wanted::AtMost(20.0)));
    report.compare(
        format!("{name}: distance of the corner found from the true one"),
        "%",
        None,
        100.0 * corner.miss() / pressed.specimen.rig.side(),
        None,
    );
    corner
}

fn picture(
    sample: &Sample,
    pressed: &Pressed,
    places: &[[f64; 2]],
    corner: &Corner,
) -> Result<Vec<u8>, ExperimentError> {
    let shapes = OS.iter().map(|o| (ring(*o), format!("'O' of {} pressed", size(*o))));
    let shapes = shapes.chain([(L, "'L' pressed".to_owned())]);
    let shown = pressed.os.iter().chain([&pressed.l]);
    let pairs: Vec<_> = shapes
        .zip(shown)
        .map(|((footprint, words), shown)| {
            let press = Press::new(footprint, [0.0; 2], Load::Change(1.0));
            let truth: Vec<f64> = places.iter().map(|&place| press.change_at(place)).collect();
            (words, truth, over_its_largest(&shown.image))
        })
        .collect();
    let last = pairs.len() - 1;
    let panels = pairs.iter().enumerate().flat_map(|(index, (words, truth, image))| {
        let found = if index == last { vec![corner.at] } else { Vec::new() };
        let panel = |words: &str, values, found| Panel {
            caption: vec![words.to_owned()],
            values,
            found,
            ..Panel::default()
        };
        [panel(words, truth, Vec::new()), panel("image", image, found)]
    });
    draw(&pressed.specimen.rig, sample.name, 4, panels.collect())
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

/// Images of the 'O's along y = 0.
fn profiles_of(sample: &Sample, pressed: &Pressed) -> Chart<'static> {
    let model = pressed.specimen.rig.model();
    let pitch = model.pixels.areas.iter().copied().fold(0.0, f64::max).sqrt();
    let series = OS.iter().zip(&pressed.os).map(|(o, shown)| {
        let image = over_its_largest(&shown.image);
        let row = model.pixels.centres.iter().zip(image).filter(|(at, _)| (0.0..pitch).contains(&at.y));
        let points = row.map(|(centre, value)| [centre.x * 1e3, value]).collect();
        Series::new(size(*o), points, Style::MarkedLine)
    });
    let title = if sample.material == THREE_SINGLE.material {
        "'O's along y = 0, one layer"
    } else {
        "'O's along y = 0, two layers"
    };
    Chart { title, x: "x, mm", y: "change over its largest", series: series.collect(), square: None }
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
    /// Distance from where the arms' middle lines meet, m.
    fn miss(&self) -> f64 {
        (self.at[0] - TRUE_CORNER[0]).hypot(self.at[1] - TRUE_CORNER[1])
    }

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
    fn a_hole_is_a_dip_and_a_disc_has_none() {
        let (places, values) = image(&Press::new(ring(OS[2]), [0.0; 2], Load::Change(0.5)));
        assert!((dip(&places, &values, OS[2])[2] - 100.0).abs() < 1.0);
        let disc = Footprint::Disc { radius: OS[2][0] };
        let (places, values) = image(&Press::new(disc, [0.0; 2], Load::Change(0.5)));
        assert!(dip(&places, &values, OS[2])[2].abs() < 1.0);
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
            let (places, _) = image(&Press::new(ring(OS[0]), [0.0; 2], Load::Change(1.0)));
            let values: Vec<f64> =
                places.iter().map(|&at| f64::from(u8::from(along(at, a) || along(at, b)))).collect();
            let found = Corner::fit(&places, &values).angle();
            assert!((found - opening).abs() < 0.2, "{opening}: {found}");
        }
    }
}
