//! The matrix that makes round spots of learnt responses.
//!
//! With the responses R to n presses (where there were some, and on the pixels among them), the spots D wanted of them, and
//! the covariance C of what responses miss of a press ([`Responses`]), the matrix W minimises the mean square of
//! `W (r + e) - d`, as GREIT's does (Adler et al. 2009), with t times the misfit e that was found:
//!
//! ```text
//! W = D R'/n (R R'/n + t C)^-1
//! ```
//!
//! It is scaled so that presses look as strong as in the model's images (median of the peaks); conductivity rises in it
//! where the skin is pressed. A spot has the shape of GREIT's with half its steepness. Near the skin's edge it is moved
//! outwards until the centre that a board finds of what is left of it, above a quarter of its peak, lies on the press.

use super::{
    LearnError, Strength,
    presses::Presses,
    responses::{Process, Responses},
};
use crate::recorded::statistics::median;
use dermatome_model::{inverse::targets::half_side, jacobian::step_counts, model::Model, pixels::Pixels};
use faer::{
    Conj, Mat, Scale, Side,
    linalg::solvers::{Llt, SolveCore},
};
use nalgebra::{Point3, Vector3};
use rayon::prelude::*;
use serde::Serialize;

/// Steepness of a spot's edge times its radius; GREIT's is 10.
const STEEPNESS: f64 = 5.0;
/// Rounds in which spots are moved.
const ROUNDS: usize = 6;
/// Share of a spot's peak above which a board looks for its centre, see [`dermatome_shared::contact`].
const REGION: f64 = 0.25;

/// Radius of the discs in which the model's images say whether conductivity falls, as a share of half the larger side.
const RADIUS_OF_SIGN: f64 = 0.25;

/// What cross-validation chooses.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Settings {
    /// How many times the misfit that was found is allowed for: t. More of it makes images calmer and less sharp.
    pub misfit: f64,
    /// Radius of the wanted spots at half their peak, as a share of half the skin's larger side.
    pub radius: f64,
}

/// A learnt matrix.
#[derive(Clone, Debug)]
pub struct LearntMatrix {
    /// Relative conductivity, up where pressed, from difference data: `[pixel][measurement]`.
    pub matrix: Mat<f64>,
    /// The model's, with the sign that makes presses positive.
    pub prior: Mat<f64>,
    /// Whether the model says that presses lower the conductivity.
    pub falls: bool,
}

/// Presses made ready to learn from.
#[derive(Clone, Debug)]
pub struct Training<'a> {
    model: &'a Model,
    learnt: Responses<'a>,
    /// Where responses are learnt from: `[point]`.
    points: Vec<Point3<f64>>,
    /// R': `[point][measurement]`.
    responses: Mat<f64>,
    /// R R'/n: `[measurement][measurement]`.
    gram: Mat<f64>,
    /// C: `[measurement][measurement]`.
    misfit: Mat<f64>,
    /// Heights of the wanted spots: `[point]`.
    heights: Vec<f64>,
    /// The model's images of the presses, divided by their sizes: `[pixel][press]`.
    model_images: Mat<f64>,
    falls: bool,
    /// Standard deviation of difference data for equal noise on every step: `[measurement]`.
    pub noise: Vec<f64>,
}

impl<'a> Training<'a> {
    /// Takes some of the presses; `numbers` are those of all presses' places.
    pub fn new(
        model: &'a Model,
        presses: &Presses,
        which: &[usize],
        numbers: &[usize],
        strength: Strength,
    ) -> Result<Self, LearnError> {
        let learnt = Responses::learn(model, presses, which, numbers)?;
        let places: Vec<_> = which.iter().map(|&press| presses.places[press]).collect();
        let points = among(model, &places);
        let responses = learnt.at(&points);
        let heights = match (strength, &presses.forces) {
            (Strength::Force, Some(forces)) => heights(&learnt, forces, which, &points),
            _ => vec![1.0; points.len()],
        };
        let matrix = &model.conductivity_from_difference;
        let in_units = Mat::from_fn(matrix.nrows(), matrix.ncols(), |p, m| matrix[(p, m)] * learnt.usual[m]);
        let model_images = in_units * learnt.presses.transpose();
        let counts = step_counts(&model.combination);
        let noise =
            presses.mean_divisors.iter().zip(&counts).map(|(v, count)| inverse_or_zero(v * count.sqrt()));
        Ok(Self {
            model,
            gram: responses.transpose() * &responses * Scale(1.0 / points.len() as f64),
            misfit: learnt.covariance(),
            falls: falls(&model_images, model, &places)?,
            points,
            responses,
            heights,
            model_images,
            noise: noise.collect(),
            learnt,
        })
    }

    /// Which process tells presses best.
    #[must_use]
    pub fn process(&self) -> Process {
        self.learnt.process()
    }

    /// Share of the presses' squares that those at other places do not tell.
    #[must_use]
    pub fn missing_share(&self) -> f64 {
        self.learnt.missing_share()
    }

    /// D of this radius, see [`Settings`], for [`Self::matrix`]: `[pixel][point]`.
    #[must_use]
    pub fn wanted(&self, radius: f64) -> Mat<f64> {
        let spots = spots(self.model, &self.points, radius);
        Mat::from_fn(spots.nrows(), spots.ncols(), |pixel, point| spots[(pixel, point)] * self.heights[point])
    }

    /// The matrix for wanted spots.
    pub fn matrix(&self, misfit: f64, wanted: &Mat<f64>) -> Result<LearntMatrix, LearnError> {
        let products = wanted * &self.responses * Scale(1.0 / self.points.len() as f64);
        let factor = Llt::new((&self.gram + &self.misfit * Scale(misfit)).as_ref(), Side::Lower)
            .map_err(|_| LearnError::Singular)?;
        let mut solution = products.transpose().to_owned();
        factor.solve_in_place_with_conj(Conj::No, solution.as_mut());
        let strongest = |images: &Mat<f64>, sign: f64| {
            let peak = |press: usize| images.col(press).iter().fold(0.0, |max: f64, v| max.max(v * sign));
            median((0..images.ncols()).map(|press| peak(press) * self.learnt.sizes[press]))
        };
        let sign = if self.falls { -1.0 } else { 1.0 };
        let images = solution.transpose() * self.learnt.presses.transpose();
        let scale = strongest(&self.model_images, sign) / strongest(&images, 1.0);
        if !scale.is_finite() || scale == 0.0 {
            return Err(LearnError::Singular);
        }
        let usual = &self.learnt.usual;
        Ok(LearntMatrix {
            matrix: Mat::from_fn(wanted.nrows(), usual.len(), |p, m| solution[(m, p)] * scale / usual[m]),
            prior: self.model.conductivity_from_difference.clone() * Scale(sign),
            falls: self.falls,
        })
    }
}

/// The places, and the pixels that lie no farther from one than twice what they are usually apart.
fn among(model: &Model, places: &[Point3<f64>]) -> Vec<Point3<f64>> {
    let centres = &model.pixels.centres;
    let nearest = |from: &Point3<f64>| {
        let away = places.iter().map(|place| (place - from).norm());
        away.filter(|&away| away > 0.0).fold(f64::INFINITY, f64::min)
    };
    let pitch = median(model.pixels.areas.iter().map(|area| area.sqrt()));
    let reach = (2.0 * median(places.iter().map(nearest))).max(pitch);
    let near = centres.iter().filter(|centre| places.iter().any(|place| (place - *centre).norm() < reach));
    places.iter().chain(near).copied().collect()
}

/// Whether images `[pixel][press]` fall where the presses are.
fn falls(images: &Mat<f64>, model: &Model, places: &[Point3<f64>]) -> Result<bool, LearnError> {
    let (centres, radius) = (&model.pixels.centres, RADIUS_OF_SIGN * half_side(&model.mesh));
    let near = |(press, place): (usize, &Point3<f64>)| {
        let inside = (0..centres.len()).filter(|&pixel| (centres[pixel] - place).norm() < radius);
        inside.map(|pixel| images[(pixel, press)]).sum::<f64>()
    };
    let sum: f64 = places.iter().enumerate().map(near).sum();
    if sum.is_finite() && sum != 0.0 { Ok(sum < 0.0) } else { Err(LearnError::Singular) }
}

/// Heights of spots for equal forces, with a median of 1 over the presses.
fn heights(learnt: &Responses<'_>, forces: &[f64], which: &[usize], points: &[Point3<f64>]) -> Vec<f64> {
    let ratios: Vec<f64> =
        which.iter().zip(&learnt.sizes).map(|(&press, size)| forces[press] / size).collect();
    let usual = median(ratios.iter().copied());
    let logs: Vec<f64> = ratios.iter().map(|ratio| (ratio / usual).ln()).collect();
    learnt.field(&logs, points).into_iter().map(f64::exp).collect()
}

/// The spots wanted of presses at some points: `[pixel][point]`. `radius` as in [`Settings`].
#[must_use]
pub fn spots(model: &Model, points: &[Point3<f64>], radius: f64) -> Mat<f64> {
    let radius = radius * half_side(&model.mesh);
    let pixels = &model.pixels;
    let spots: Vec<Vec<f64>> =
        points.par_iter().map(|&place| spot(pixels, moved(pixels, place, radius), radius)).collect();
    Mat::from_fn(pixels.count(), spots.len(), |pixel, point| spots[point][pixel])
}

/// A spot of height 1 on the pixels.
fn spot(pixels: &Pixels, centre: Point3<f64>, radius: f64) -> Vec<f64> {
    let value =
        |pixel: &Point3<f64>| 1.0 / (1.0 + (STEEPNESS * ((pixel - centre).norm() / radius - 1.0)).exp());
    let values: Vec<f64> = pixels.centres.iter().map(value).collect();
    let peak = values.iter().copied().fold(f64::MIN_POSITIVE, f64::max);
    values.iter().map(|value| value / peak).collect()
}

/// The centre of a spot that is found at a place, no farther from it than the radius, in the plane that touches the skin
/// there: of a curved skin the mean of pixels lies beneath it, and a board lays it back.
fn moved(pixels: &Pixels, place: Point3<f64>, radius: f64) -> Point3<f64> {
    let normal = pixels.normals[nearest(pixels, place)];
    let mut offset = Vector3::zeros();
    for _ in 0..ROUNDS {
        let missing = place - found(pixels, &spot(pixels, place + offset, radius));
        offset += missing - normal * normal.dot(&missing);
        let length = offset.norm();
        if length > radius {
            offset *= radius / length;
        }
    }
    place + offset
}

fn nearest(pixels: &Pixels, place: Point3<f64>) -> usize {
    let away = |pixel: &usize| (pixels.centres[*pixel] - place).norm_squared();
    (0..pixels.count()).min_by(|a, b| away(a).total_cmp(&away(b))).unwrap_or(0)
}

/// The centre that a board finds of an image of height 1.
fn found(pixels: &Pixels, image: &[f64]) -> Point3<f64> {
    let (mut moment, mut weight) = (Vector3::zeros(), 0.0);
    for ((value, centre), area) in image.iter().zip(&pixels.centres).zip(&pixels.areas) {
        if *value > REGION {
            moment += centre.coords * (value * area);
            weight += value * area;
        }
    }
    Point3::from(moment / weight)
}

fn inverse_or_zero(value: f64) -> f64 {
    if value == 0.0 { 0.0 } else { 1.0 / value.abs() }
}
