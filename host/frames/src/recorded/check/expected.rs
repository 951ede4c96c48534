//! What a skin should measure: what its model says, or what it measured when all was well.
//!
//! The voltage of any two pairs follows from the transfer impedances of the electrodes. Frames say only some of these:
//! with the model's as prior mean, equal variance for each of their errors, and the frames' voltages as observations,
//! the others follow as those of a Gaussian process do, each with its own error (Rasmussen and Williams 2006, chapter 2).

use super::{
    super::{
        order::{Arrangement, FileIndex, OrderError},
        read::Frames,
        statistics::median,
    },
    likeness::along_common_phase,
};
use dermatome_geometry::mesh::Lattice;
use dermatome_model::{
    forward::{Admittivity, Fields},
    model::{ModelError, forward_model, mesh},
    skin::Skin,
};
use dermatome_shared::stimulation::Step;
use faer::{
    Col, Mat, Scale, Side,
    linalg::solvers::{DenseSolveCore, Llt, Solve},
};
use serde::Serialize;
use std::{collections::HashMap, fmt};

/// Electrodes may lie so far, as a share of their distance, from where the model has them.
const PLACE_ERROR: f64 = 0.05;
/// A step that senses a driven electrode has its contact in it, of which the model knows little.
const CONTACT_ERROR: f64 = 1.0;
/// By so much, as a share of it, a voltage may have changed since it was measured.
const CHANGE: f64 = 0.03;
/// Variances that measured voltages' own errors may have, over that of a transfer impedance; the likeliest is taken.
const OWN: [f64; 5] = [1e-6, 1e-4, 1e-2, 0.1, 1.0];

/// What says how large voltages should be.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum KnownBy {
    /// The skin's model.
    Model,
    /// Frames from when all was well.
    GoodFrames,
}

impl fmt::Display for KnownBy {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Model => "the model",
            Self::GoodFrames => "the good frames",
        })
    }
}

/// Why good frames cannot stand in for the model.
#[derive(Debug, thiserror::Error)]
pub enum GoodFramesError {
    /// They cannot be read as frames of the skin.
    #[error(transparent)]
    Order(#[from] OrderError),
    /// They say nothing.
    #[error("the good frames are zero, or nearly, on average")]
    Zero,
}

/// What a skin should measure: its table, and in-phase voltages between any electrodes.
#[derive(Clone, Debug)]
pub struct Expected {
    /// Stimulation table: `[step]`.
    pub steps: Vec<Step>,
    pub(super) electrodes: u8,
    /// Potential at one electrode for unit current into another, relative: `[at][driven]`.
    transfer: Vec<f64>,
    /// What frames say, once some have been seen.
    seen: Option<Seen>,
}

/// What frames say of the voltages.
#[derive(Clone, Debug)]
struct Seen {
    /// Those that were measured, by the electrodes of their step: an instrument may do more than a body does.
    voltages: HashMap<[u8; 4], f64>,
    /// Covariance of the transfer impedances' errors: `[at][driven][at][driven]`.
    covariance: Mat<f64>,
}

impl Expected {
    /// Solves the untouched skin.
    pub fn of(skin: &Skin) -> Result<Self, ModelError> {
        let admittivity = skin.admittivity();
        if admittivity.im == 0.0 { solve(skin, admittivity.re) } else { solve(skin, admittivity) }
    }

    /// From transfer impedances `[at][driven]`.
    #[must_use]
    pub fn new(steps: Vec<Step>, electrodes: u8, transfer: impl Fn(usize, usize) -> f64) -> Self {
        let n = usize::from(electrodes);
        let transfer = (0..n * n).map(|i| transfer(i / n, i % n)).collect();
        Self { steps, electrodes, transfer, seen: None }
    }

    /// As frames from when all was well say, read as `used`; where they say nothing, as before.
    pub fn measured(self, good: &Frames, used: Arrangement) -> Result<Self, GoodFramesError> {
        let map = used.index_map(&self.steps, self.electrodes, good.measurements)?;
        let mean = good.mean();
        let read = |place: &FileIndex| mean[place.index] * if place.flipped { -1.0 } else { 1.0 };
        let mut measured = along_common_phase(&map.iter().map(read).collect::<Vec<_>>());
        let model: Vec<f64> = self.steps.iter().map(|&step| self.voltage(step)).collect();
        if mean.iter().all(|value| value.im == 0.0 && value.re >= 0.0) {
            measured.iter_mut().zip(&model).for_each(|(value, m)| *value = value.abs().copysign(*m));
        }
        let along: f64 = measured.iter().zip(&model).map(|(value, m)| (value * m).signum()).sum();
        let size = median(measured.iter().map(|value| value.abs())) / median(model.iter().map(|m| m.abs()));
        let gain = size.copysign(along);
        if !(gain.abs() > 0.0 && gain.is_finite()) {
            return Err(GoodFramesError::Zero);
        }
        measured.iter_mut().for_each(|value| *value /= gain);
        let errors: Vec<f64> = measured.iter().zip(&model).map(|(value, m)| value - m).collect();
        let (transfer, covariance) = self.given(&errors);
        let voltages = self.steps.iter().map(|step| step.to_bytes()).zip(measured).collect();
        Ok(Self { transfer, seen: Some(Seen { voltages, covariance }), ..self })
    }

    /// Transfer impedances, and the covariance of their errors, given by what measured voltages are off: `[step]`.
    fn given(&self, errors: &[f64]) -> (Vec<f64>, Mat<f64>) {
        let terms: Vec<[(usize, f64); 4]> = self.steps.iter().map(|&step| self.terms(step)).collect();
        let size = self.transfer.len();
        let mut rows = Mat::<f64>::zeros(terms.len(), size);
        for (step, terms) in terms.iter().enumerate() {
            terms.iter().for_each(|&(place, sign)| rows[(step, place)] = sign);
        }
        let gram = &rows * rows.transpose();
        let errors = Col::from_iter(errors.iter().copied());
        let likeliest = OWN.iter().filter_map(|&own| Given::of(&gram, &errors, own));
        let likeliest = likeliest.max_by(|a, b| a.likelihood.total_cmp(&b.likelihood));
        let Some(Given { inverse, weights, variance, .. }) = likeliest else {
            return (self.transfer.clone(), Mat::identity(size, size));
        };
        let change = rows.transpose() * weights;
        let transfer = self.transfer.iter().zip(change.iter()).map(|(before, change)| before + change);
        let covariance = Mat::<f64>::identity(size, size) - rows.transpose() * inverse * &rows;
        (transfer.collect(), covariance * Scale(variance))
    }

    /// Transfer impedances that add up to the voltage of a step.
    fn terms(&self, step: Step) -> [(usize, f64); 4] {
        let n = usize::from(self.electrodes);
        let [dp, dm, sp, sm] = step.to_bytes().map(usize::from);
        [(sp * n + dp, 1.0), (sp * n + dm, -1.0), (sm * n + dp, -1.0), (sm * n + dm, 1.0)]
    }

    /// Number of electrodes.
    #[must_use]
    pub fn electrodes(&self) -> u8 {
        self.electrodes
    }

    /// What the voltages come from.
    #[must_use]
    pub fn known_by(&self) -> KnownBy {
        if self.seen.is_some() { KnownBy::GoodFrames } else { KnownBy::Model }
    }

    /// Voltage of any step, relative.
    #[must_use]
    pub fn voltage(&self, step: Step) -> f64 {
        if let Some(voltage) = self.seen(step) {
            return voltage;
        }
        let [dp, dm, sp, sm] = step.to_bytes().map(usize::from);
        let at = |at: usize, driven: usize| self.transfer[at * usize::from(self.electrodes) + driven];
        (at(sp, dp) - at(sp, dm)) - (at(sm, dp) - at(sm, dm))
    }

    /// What frames say of a step, or of its pairs the other way round.
    fn seen(&self, step: Step) -> Option<f64> {
        let voltages = &self.seen.as_ref()?.voltages;
        let [dp, dm, sp, sm] = step.to_bytes();
        let ways = [
            ([dp, dm, sp, sm], 1.0),
            ([dp, dm, sm, sp], -1.0),
            ([dm, dp, sp, sm], -1.0),
            ([dm, dp, sm, sp], 1.0),
        ];
        ways.iter().find_map(|(way, sign)| voltages.get(way).map(|voltage| sign * voltage))
    }

    /// What is not known of the voltage of a step, relative: a standard deviation.
    pub(super) fn error(&self, step: Step) -> f64 {
        let voltage = self.voltage(step);
        if self.seen(step).is_some() {
            return CHANGE * voltage.abs();
        }
        let contact = if step.senses_driven() { CONTACT_ERROR * voltage } else { 0.0 };
        let Some(Seen { covariance, .. }) = &self.seen else {
            return (PLACE_ERROR * self.slope(step)).hypot(contact);
        };
        let terms = self.terms(step);
        let products = terms.iter().flat_map(|&(row, one)| {
            terms.iter().map(move |&(column, other)| one * other * covariance[(row, column)])
        });
        products.sum::<f64>().max(0.0).sqrt().hypot(CHANGE * voltage).hypot(contact)
    }

    /// By how much the voltage of a step would change if each of its electrodes lay where its neighbours are, half the
    /// way between them: the root of the sum of squares.
    fn slope(&self, step: Step) -> f64 {
        let n = usize::from(self.electrodes);
        let at = |at: usize, driven: usize| self.transfer[at * n + driven];
        let [dp, dm, sp, sm] = step.to_bytes().map(usize::from);
        let sensed = |e: usize| at(e, dp) - at(e, dm);
        let driven = |e: usize| at(sp, e) - at(sm, e);
        let across = |of: &dyn Fn(usize) -> f64, e: usize| (of((e + 1) % n) - of((e + n - 1) % n)) / 2.0;
        let squares = [across(&sensed, sp), across(&sensed, sm), across(&driven, dp), across(&driven, dm)];
        squares.iter().map(|change| change * change).sum::<f64>().sqrt()
    }
}

/// A Gaussian process with one size of the voltages' own errors.
struct Given {
    inverse: Mat<f64>,
    weights: Col<f64>,
    /// Of a transfer impedance.
    variance: f64,
    /// Logarithm, but for a constant.
    likelihood: f64,
}

impl Given {
    fn of(gram: &Mat<f64>, errors: &Col<f64>, own: f64) -> Option<Self> {
        let steps = errors.nrows();
        let covariance = gram + Mat::<f64>::identity(steps, steps) * Scale(own);
        let factor = Llt::new(covariance.as_ref(), Side::Lower).ok()?;
        let weights = factor.solve(errors);
        let variance = (errors.transpose() * &weights) / steps as f64;
        let determinant: f64 = (0..steps).map(|step| factor.L()[(step, step)].ln()).sum();
        let likelihood = -0.5 * steps as f64 * variance.max(f64::MIN_POSITIVE).ln() - determinant;
        Some(Self { inverse: factor.inverse(), weights, variance, likelihood })
    }
}

fn solve<T: Admittivity>(skin: &Skin, admittivity: T) -> Result<Expected, ModelError> {
    let mesh = mesh(skin, 1.0, Lattice::default())?;
    let fields: Fields<T> = forward_model(skin, &mesh)?.solve(&vec![admittivity; mesh.elements.len()])?;
    let transfer = |at, driven| fields.transfer(at, driven).in_phase();
    Ok(Expected::new(skin.steps(), skin.electrodes.count, transfer))
}
