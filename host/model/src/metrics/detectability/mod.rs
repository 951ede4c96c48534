//! Detectability: what one frame tells at most of a press, place by place.
//!
//! The matched filter detects a press of response a in data of covariance S with d' = sqrt(a' S^-1 a) (Kay, Fundamentals
//! of Statistical Signal Processing II, chapter 4). No estimate of its place is more certain than the inverse of Fisher's
//! information D' S^-1 D, D the derivative of a with the place (Cramer and Rao; Kay I, chapter 3). From a, what it has in
//! common with a change of all voltages is taken out beforehand, as a board does, and from D also what another strength
//! would do. S is diagonal: white noise on every step. Detection is linear: a change of conductivity by d counts as
//! [`strength_of`] d.

use crate::pixels::{Pixels, Presses, tangents};
use faer::{Col, Mat};
use nalgebra::{Matrix2, Point3, Vector2, Vector3};
use rayon::prelude::*;

/// Standard deviations above which a board detects something by default at some 80 frames a second (5.7 at 50, 6.1 at 400).
pub const LEVEL: f32 = 5.8;
/// Frames of which a reference is the mean.
const REFERENCE_FRAMES: f64 = 20.0;
/// How many of the places next to one say how responses change there.
const NEAR: usize = 8;

/// A press, and how well voltages are measured.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sought {
    /// Its radius, m.
    pub radius: f64,
    /// Its strength: see [`strength_of`].
    pub strength: f64,
    /// Signal-to-noise ratio of every step, dB, against the root mean square of the untouched voltages.
    pub snr_db: f64,
}

impl Sought {
    /// A finger whose radius is 4 % of a skin's size, m, and that doubles the conductivity.
    #[must_use]
    pub fn finger(size: f64, snr_db: f64) -> Self {
        Self { radius: 0.04 * size, strength: strength_of(1.0), snr_db }
    }
}

/// Probability that normal noise passes so many standard deviations.
#[must_use]
pub fn passing(deviations: f64) -> f64 {
    0.5 * libm::erfc(deviations / std::f64::consts::SQRT_2)
}

/// The change of conductivity that a linear model takes a disc's true relative change for: its polarisation.
#[must_use]
pub fn strength_of(change: f64) -> f64 {
    2.0 * change / (2.0 + change)
}

/// What a frame consists of.
#[derive(Clone, Copy, Debug)]
pub struct Frame<'a> {
    /// d voltage / d relative conductivity: `[measurement][pixel]`.
    pub jacobian: &'a Mat<f64>,
    /// Voltages of the untouched skin: `[measurement]`.
    pub voltages: &'a [f64],
    /// How many steps each is the mean of: `[measurement]`.
    pub step_counts: &'a [f64],
    /// Root mean square of the untouched voltages of all steps.
    pub step_size: f64,
}

/// What a frame tells of a press at one place.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AtPlace {
    /// Where, m.
    pub position: Point3<f64>,
    /// Area of the skin that it stands for, m^2.
    pub area: f64,
    /// d' of the press, in standard deviations.
    pub significance: f64,
    /// Strength of the smallest press of this radius that is detected.
    pub smallest: f64,
    /// Least standard deviation of the place of the press along each axis of the skin, m.
    pub position_deviation: f64,
}

/// What a frame tells of a press all over a skin.
#[derive(Clone, Debug, PartialEq)]
pub struct Detectability {
    /// Place by place.
    pub places: Vec<AtPlace>,
}

/// Where a skin is deaf to a press.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Deaf {
    /// Share of its area.
    pub share: f64,
    /// The deafest place.
    pub worst: AtPlace,
}

impl Detectability {
    /// Where the press is not detected, if anywhere.
    #[must_use]
    pub fn deaf(&self) -> Option<Deaf> {
        let area = |places: &mut dyn Iterator<Item = &AtPlace>| places.map(|place| place.area).sum::<f64>();
        let worst = self.worst().filter(|worst| !worst.is_detected())?;
        let deaf = area(&mut self.places.iter().filter(|place| !place.is_detected()));
        Some(Deaf { share: deaf / area(&mut self.places.iter()), worst: *worst })
    }

    /// The place where the press stands out least.
    #[must_use]
    pub fn worst(&self) -> Option<&AtPlace> {
        self.places.iter().min_by(|a, b| a.significance.total_cmp(&b.significance))
    }

    /// Median of the significances.
    #[must_use]
    pub fn median(&self) -> f64 {
        let mut all: Vec<_> = self.places.iter().map(|place| place.significance).collect();
        all.sort_by(f64::total_cmp);
        all.get(all.len() / 2).copied().unwrap_or(0.0)
    }

    /// Largest of the deviations of places, m.
    #[must_use]
    pub fn worst_deviation(&self) -> f64 {
        self.places.iter().map(|place| place.position_deviation).fold(0.0, f64::max)
    }

    /// The place next to a point.
    #[must_use]
    pub fn nearest(&self, point: Point3<f64>) -> Option<&AtPlace> {
        let away = |place: &AtPlace| (place.position - point).norm_squared();
        self.places.iter().min_by(|a, b| away(a).total_cmp(&away(b)))
    }
}

impl AtPlace {
    /// Whether the press is detected here.
    #[must_use]
    pub fn is_detected(&self) -> bool {
        self.significance > f64::from(LEVEL)
    }
}

/// What a frame tells of a press, all over a skin.
#[must_use]
pub fn detectability(pixels: &Pixels, frame: &Frame<'_>, sought: &Sought) -> Detectability {
    let presses = pixels.presses(sought.radius);
    let responses = responses(&presses, frame, sought.snr_db);
    let count = presses.places.len();
    let at = |place: usize| {
        let pixel = presses.places[place];
        let unit = responses.col(place).norm_l2();
        let position = pixels.centres[pixel];
        let ways = (0..count).filter(|&other| other != place);
        let mut near: Vec<_> =
            ways.map(|other| (other, pixels.centres[presses.places[other]] - position)).collect();
        near.sort_by(|(_, a), (_, b)| a.norm_squared().total_cmp(&b.norm_squared()));
        near.truncate(NEAR);
        let gradient = gradient(&responses, place, &near, &pixels.normals[pixel]);
        AtPlace {
            position,
            area: pixels.areas[pixel],
            significance: sought.strength.abs() * unit,
            smallest: f64::from(LEVEL) / unit,
            position_deviation: gradient
                .map_or(f64::INFINITY, |g| deviation(&responses, place, &g) / sought.strength.abs()),
        }
    };
    Detectability { places: (0..count).into_par_iter().map(at).collect() }
}

/// d' of presses of unit strength: `[place]`.
#[must_use]
pub fn significances(presses: &Presses, frame: &Frame<'_>, snr_db: f64) -> Vec<f64> {
    responses(presses, frame, snr_db).col_iter().map(|column| column.norm_l2()).collect()
}

/// Responses in standard deviations of the noise, without what is common to all: `[measurement][place]`.
fn responses(presses: &Presses, frame: &Frame<'_>, snr_db: f64) -> Mat<f64> {
    let deviations = deviations(frame, snr_db);
    let mut responses = whitened(presses, frame, &deviations);
    let common = Col::from_fn(deviations.len(), |m| frame.voltages[m] / deviations[m]);
    let shares = faer::Scale(1.0 / common.squared_norm_l2()) * (common.transpose() * &responses);
    responses -= &common * shares;
    responses
}

/// Responses in standard deviations of the noise: `[measurement][place]`.
fn whitened(presses: &Presses, frame: &Frame<'_>, deviations: &[f64]) -> Mat<f64> {
    let mut responses = presses.responses(frame.jacobian);
    responses.row_iter_mut().zip(deviations).for_each(|(mut row, deviation)| row /= faer::Scale(*deviation));
    responses
}

/// Of the changes from the reference, model volts: `[measurement]`.
fn deviations(frame: &Frame<'_>, snr_db: f64) -> Vec<f64> {
    let step = frame.step_size * 10_f64.powf(-snr_db / 20.0) * (1.0 + 1.0 / REFERENCE_FRAMES).sqrt();
    frame.step_counts.iter().map(|count| step / count.sqrt()).collect()
}

/// Derivatives of a response with the place along two axes of the skin, by least squares over the places near;
/// none where these do not lie all round.
fn gradient(
    responses: &Mat<f64>,
    place: usize,
    near: &[(usize, Vector3<f64>)],
    normal: &Vector3<f64>,
) -> Option<[Col<f64>; 2]> {
    let [first, second] = tangents(normal);
    let along = |way: &Vector3<f64>| Vector2::new(way.dot(&first), way.dot(&second));
    let moments: Matrix2<f64> = near.iter().map(|(_, way)| along(way) * along(way).transpose()).sum();
    let inverse = moments.try_inverse()?;
    let mut gradient = [(); 2].map(|()| Col::zeros(responses.nrows()));
    for (other, way) in near {
        let weights = inverse * along(way);
        let change = responses.col(*other) - responses.col(place);
        gradient
            .iter_mut()
            .zip(weights.iter())
            .for_each(|(sum, &weight)| *sum += faer::Scale(weight) * &change);
    }
    Some(gradient)
}

/// Standard deviation of the place of a press of unit strength, along an axis on average, m.
fn deviation(responses: &Mat<f64>, place: usize, gradient: &[Col<f64>; 2]) -> f64 {
    let own = responses.col(place);
    let square = own.squared_norm_l2();
    let with_own = [0, 1].map(|axis| own.transpose() * &gradient[axis]);
    let information =
        Matrix2::from_fn(|a, b| gradient[a].transpose() * &gradient[b] - with_own[a] * with_own[b] / square);
    information.try_inverse().map_or(f64::INFINITY, |covariance| (covariance.trace() / 2.0).max(0.0).sqrt())
}

#[cfg(test)]
mod tests;
