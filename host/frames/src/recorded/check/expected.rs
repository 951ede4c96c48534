//! What a skin should measure: what its model says, or what it measured when all was well.
//!
//! The voltage of any two pairs follows from the transfer impedances of the electrodes. Frames say only some of these:
//! with the model's as prior mean, equal variance for each of their errors, and the frames' voltages as observations,
//! the others follow as those of a Gaussian process do, each with its own error (Rasmussen and Williams 2006, chapter 2).

use super::{
    super::{
        order::{Arrangement, FileIndex, OrderError},
        read::Frames,
        statistics::{along_common_phase, median},
    },
    Reference,
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
    /// Those that were measured, with what noise may have added, by the electrodes of their step: an instrument may do
    /// more than a body does.
    voltages: HashMap<[u8; 4], (f64, f64)>,
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
        let reference = Reference::of(good);
        let read = |place: &FileIndex| reference.values[place.index] * if place.flipped { -1.0 } else { 1.0 };
        let mut measured = along_common_phase(&map.iter().map(read).collect::<Vec<_>>());
        let model: Vec<f64> = self.steps.iter().map(|&step| self.voltage(step)).collect();
        // Magnitudes have the model's signs.
        if measured.iter().all(|&value| value >= 0.0) {
            measured.iter_mut().zip(&model).for_each(|(value, m)| *value = value.copysign(*m));
        }
        let along: f64 = measured.iter().zip(&model).map(|(value, m)| value * m).sum();
        let size = median(measured.iter().map(|value| value.abs())) / median(model.iter().map(|m| m.abs()));
        let gain = size.copysign(along);
        if !(gain.abs() > 0.0 && gain.is_finite()) {
            return Err(GoodFramesError::Zero);
        }
        measured.iter_mut().for_each(|value| *value /= gain);
        let errors: Vec<f64> = measured.iter().zip(&model).map(|(value, m)| value - m).collect();
        let (transfer, covariance) = self.given(&errors);
        let blur = map.iter().map(|place| reference.blur * reference.noise[place.index] / gain.abs());
        let steps = self.steps.iter().map(|step| step.to_bytes());
        let voltages = steps.zip(measured.into_iter().zip(blur)).collect();
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
        if let Some((voltage, _)) = self.seen(step) {
            return voltage;
        }
        let [dp, dm, sp, sm] = step.to_bytes().map(usize::from);
        let at = |at: usize, driven: usize| self.transfer[at * usize::from(self.electrodes) + driven];
        (at(sp, dp) - at(sp, dm)) - (at(sm, dp) - at(sm, dm))
    }

    /// What frames say of a step, or of its pairs the other way round, and what noise may have added.
    fn seen(&self, step: Step) -> Option<(f64, f64)> {
        let voltages = &self.seen.as_ref()?.voltages;
        let [dp, dm, sp, sm] = step.to_bytes();
        let ways = [
            ([dp, dm, sp, sm], 1.0),
            ([dp, dm, sm, sp], -1.0),
            ([dm, dp, sp, sm], -1.0),
            ([dm, dp, sm, sp], 1.0),
        ];
        ways.iter().find_map(|(way, sign)| voltages.get(way).map(|(voltage, blur)| (sign * voltage, *blur)))
    }

    /// What is not known of the voltage of a step, relative: a standard deviation.
    pub(super) fn error(&self, step: Step) -> f64 {
        let voltage = self.voltage(step);
        if let Some((_, blur)) = self.seen(step) {
            return (CHANGE * voltage).hypot(blur);
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::recorded::{
        check::{
            check,
            findings::Level,
            wiring::{Exchange, Role, Wiring},
        },
        order::SenseOrder,
    };
    use dermatome_shared::stimulation::{Driven, pattern};
    use num_complex::Complex64;
    use rand::{Rng, SeedableRng};
    use rand_pcg::Pcg64;

    const PLAIN: Arrangement = Arrangement { sense: SenseOrder::Absolute, rotation: 0, mirrored: false };

    /// A disc whose impedances from electrode to electrode differ by so much from those of an even one.
    fn disc(unlike: f64) -> Expected {
        let mut random = Pcg64::seed_from_u64(5);
        let factors: Vec<f64> = (0..256).map(|_| 1.0 + unlike * random.random_range(-1.0..1.0)).collect();
        let factor = |a: usize, b: usize| factors[a.min(b) * 16 + a.max(b)];
        Expected::new(pattern(16, 1, 1, Driven::Skipped).collect(), 16, |at, driven| {
            let around = (at as f64 - driven as f64) * std::f64::consts::PI / 16.0;
            factor(at, driven) * if at == driven { 1.4 } else { -around.sin().abs().ln() }
        })
    }

    /// Frames of an instrument whose values each hold an eighth of the one before, and a constant of their channel.
    fn frames(body: &Expected, wiring: &Wiring, seed: u64) -> Frames {
        let mut random = Pcg64::seed_from_u64(seed);
        let mut values = Vec::new();
        for _ in 0..20 {
            let mut last = 0.0;
            for &step in &body.steps {
                let voltage = body.voltage(wiring.step(step));
                let constant = 0.02 * f64::from(step.sense_plus % 5);
                let noise = 1.0 + 0.002 * random.random_range(-1.0..1.0);
                values.push(Complex64::from((voltage + last / 8.0 + constant) * noise));
                last = voltage;
            }
        }
        Frames { measurements: body.steps.len(), frames: 20, complex: false, values }
    }

    fn faults(expected: &Expected, frames: &Frames) -> Vec<String> {
        let check = check(expected, frames, PLAIN).unwrap();
        let faults = check.findings.into_iter().filter(|it| it.level == Level::Fault);
        faults.map(|it| it.found).collect()
    }

    #[test]
    fn what_was_measured_is_expected_and_other_pairs_follow_from_it() {
        let (model, body) = (disc(0.0), disc(0.1));
        let steps = body.steps.clone();
        let values = steps.iter().map(|&step| Complex64::from(-7.0 * body.voltage(step))).collect();
        let good = Frames { measurements: steps.len(), frames: 1, complex: false, values };
        let measured = model.clone().measured(&good, PLAIN).unwrap();
        assert_eq!((model.known_by(), measured.known_by()), (KnownBy::Model, KnownBy::GoodFrames));
        let scale = measured.voltage(steps[40]) / body.voltage(steps[40]);
        for &step in &steps {
            assert!((measured.voltage(step) - scale * body.voltage(step)).abs() < 1e-9);
            let turned = Step { sense_plus: step.sense_minus, sense_minus: step.sense_plus, ..step };
            assert_eq!(measured.voltage(turned), -measured.voltage(step));
        }
        // Drive 0-1 never sensed 5-8, but 5-6, 6-7 and 7-8; 0-5 it never sensed at all, and the error says so.
        let sum = Step { drive_plus: 1, drive_minus: 0, sense_plus: 5, sense_minus: 8 };
        let contact = Step { sense_plus: 0, sense_minus: 5, ..sum };
        let size = (scale * body.voltage(sum)).abs();
        assert!((measured.voltage(sum) - scale * body.voltage(sum)).abs() < measured.error(sum));
        assert!(measured.error(sum) < 0.3 * size);
        assert!(measured.error(contact) > 0.5 * (scale * body.voltage(contact)).abs());
    }

    #[test]
    fn good_frames_tell_what_changed_on_an_instrument_that_no_model_fits() {
        let (model, body) = (disc(0.0), disc(0.3));
        let as_wired = Wiring::new(PLAIN, 16);
        let good = frames(&body, &as_wired, 1);
        assert!(!faults(&model, &good).is_empty());
        let expected = model.measured(&good, PLAIN).unwrap();
        assert_eq!(faults(&expected, &frames(&body, &as_wired, 2)), Vec::<String>::new());
        for role in [Role::Both, Role::Drive, Role::Sense] {
            let exchange = Exchange { electrodes: [3, 9], role };
            let check = check(&expected, &frames(&body, &as_wired.with(exchange), 3), PLAIN).unwrap();
            assert_eq!(check.numbering.exchanged, [exchange]);
        }
    }

    #[test]
    fn good_frames_of_nothing_are_refused() {
        let model = disc(0.0);
        let values = vec![Complex64::ZERO; model.steps.len()];
        let good = Frames { measurements: model.steps.len(), frames: 1, complex: false, values };
        assert!(matches!(model.measured(&good, PLAIN), Err(GoodFramesError::Zero)));
    }
}
