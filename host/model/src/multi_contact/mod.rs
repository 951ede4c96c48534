//! Multi-contact fit: how many fingers press, and where, from the voltages themselves.
//!
//! An image of few voltages is blurred, and far from all electrodes two fingers become one hill in it. The
//! voltages still tell them apart: how they respond to one finger is known everywhere (`atlas`), and the
//! fingers are few. So fingers are added one after the other where what is still unexplained asks for one most,
//! all places and strengths are fitted anew by least squares (`fit`), and it ends when another finger explains
//! no more than noise would.
//!
//! It takes difference data as boards send them (event `Measurements`), and runs on the host: a patch has no
//! room for the responses.

mod atlas;
mod fit;
#[cfg(test)]
mod tests;

use crate::{
    forward::{Admittivity, ForwardError},
    jacobian::{combine_rows, jacobian, step_counts},
    model::{Model, ModelError, forward_model},
    pixels::Pixels,
    skin::Skin,
};
use atlas::Atlas;
use faer::Mat;
use fit::Fit;
use nalgebra::{DVector, Point3};

/// Most fingers that are looked for.
const MOST_FINGERS: usize = 8;
/// By how much a finger must lower the sum of squares, in units of the noise's variance. It has three unknowns, which
/// noise alone fills with 3 on average, and more because the best place of all is taken.
const LEAST_GAIN: f64 = 20.0;
/// Weaker ones than this share of the strongest are none, as with the quarter of an image's peak.
const LEAST_SHARE: f64 = 0.25;
/// Most nodes of a mesh.
const MOST_NODES: usize = 20_000;

/// What is known beforehand.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Settings {
    /// Radius of a finger, m. Responses hardly depend on it; no two fingers are closer than twice of it.
    pub radius: f64,
    /// Signal-to-noise ratio of the voltages, dB, as a simulated skin has it.
    pub snr_db: f64,
}

/// One finger.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FittedContact {
    /// Its middle, m.
    pub position: Point3<f64>,
    /// Relative change of conductivity under its middle, as a linear model reads it.
    pub strength: f64,
}

/// Why a skin has no multi-contact fit.
#[derive(Debug, thiserror::Error)]
pub enum FitError {
    /// No forward solution.
    #[error(transparent)]
    Model(#[from] ModelError),
    /// A mesh too fine to keep an response for each node.
    #[error(
        "the mesh has {nodes} nodes; to resolve fingers at most {MOST_NODES} are allowed: a larger `mesh.edge_length` does"
    )]
    TooFine {
        /// Its nodes.
        nodes: usize,
    },
    /// A setting out of range.
    #[error("`{field}` is {value}; allowed: a number above zero")]
    NotPositive {
        /// The setting.
        field: &'static str,
        /// Its value.
        value: f64,
    },
}

impl From<ForwardError> for FitError {
    fn from(error: ForwardError) -> Self {
        Self::Model(error.into())
    }
}

/// Finds the fingers in difference data of one skin.
#[derive(Clone, Debug)]
pub struct MultiContactFit {
    atlas: Atlas,
    /// What makes noise of size 1 of difference data: `[measurement]`.
    scale: Vec<f64>,
    radius: f64,
}

impl MultiContactFit {
    /// Prepares the skin of this model.
    pub fn new(skin: &Skin, model: &Model, settings: Settings) -> Result<Self, FitError> {
        let Settings { radius, snr_db } = settings;
        for (field, value) in [("radius", radius), ("snr_db", snr_db)] {
            if !(value > 0.0 && value.is_finite()) {
                return Err(FitError::NotPositive { field, value });
            }
        }
        let nodes = model.mesh.nodes.len();
        if nodes > MOST_NODES {
            return Err(FitError::TooFine { nodes });
        }
        let noise = noise(model, snr_db);
        let fingers = atlas::fingers(&model.mesh, radius);
        let admittivity = skin.admittivity();
        let responses = if admittivity.im == 0.0 {
            responses(skin, model, &fingers, admittivity.re)?
        } else {
            responses(skin, model, &fingers, admittivity)?
        };
        let scale = model.divisors().iter().zip(&noise).map(|(divisor, noise)| divisor / noise).collect();
        let whitened = |node: usize| DVector::from_fn(noise.len(), |m, _| responses[(m, node)] / noise[m]);
        Ok(Self { atlas: Atlas::new(&model.mesh, whitened), scale, radius })
    }

    /// The fingers in difference data, `[measurement]` as [`Model::difference_data`] gives them, strongest first.
    #[must_use]
    pub fn contacts(&self, difference: &[f64]) -> Vec<FittedContact> {
        let data = DVector::from_iterator(
            difference.len().min(self.scale.len()),
            difference.iter().zip(&self.scale).map(|(change, scale)| change * scale),
        );
        let mut fit = Fit::of_nothing(data.clone());
        while fit.fingers.len() < MOST_FINGERS {
            let starts = fit.starts(&self.atlas, 2.0 * self.radius);
            let fits = starts
                .into_iter()
                .map(|start| fit::refined(fit.with(start), &self.atlas, &data, self.radius));
            let best = fits.min_by(|a, b| a.square.total_cmp(&b.square));
            let Some(best) = best.filter(|best| fit.square - best.square > LEAST_GAIN) else { break };
            fit = best;
        }
        let fingers = fit
            .fingers
            .iter()
            .map(|finger| FittedContact { position: self.atlas.point(finger.at), strength: finger.strength });
        strong(joined(fingers.collect(), 2.0 * self.radius))
    }
}

/// Standard deviation of each measurement, in model volts: `[measurement]`.
fn noise(model: &Model, snr_db: f64) -> Vec<f64> {
    let mean_square = model.voltages.iter().map(|v| v * v).sum::<f64>() / model.voltages.len() as f64;
    let step = mean_square.sqrt() * 10_f64.powf(-snr_db / 20.0);
    step_counts(&model.combination).iter().map(|count| step / count.sqrt()).collect()
}

/// How the measurements respond to each finger, in model volts: `[measurement][finger]`.
fn responses<T: Admittivity>(
    skin: &Skin,
    model: &Model,
    fingers: &Pixels,
    admittivity: T,
) -> Result<Mat<f64>, FitError> {
    let fields =
        forward_model::<T>(skin, &model.mesh)?.solve(&vec![admittivity; model.mesh.elements.len()])?;
    Ok(combine_rows(&jacobian(&model.mesh, &fields, &model.steps, fingers), &model.combination))
}

/// Fingers closer than this become one: what the model does not explain of a strong one looks like another beside it.
fn joined(mut fingers: Vec<FittedContact>, apart: f64) -> Vec<FittedContact> {
    while let Some([i, j]) = closest(&fingers, apart) {
        let (one, other) = (fingers[i], fingers.remove(j));
        let strength = one.strength + other.strength;
        let position = one.position + (other.position - one.position) * (other.strength / strength);
        fingers[i] = FittedContact { position, strength };
    }
    fingers
}

/// The closest two of those that are closer than `apart`, ascending.
fn closest(fingers: &[FittedContact], apart: f64) -> Option<[usize; 2]> {
    let distance = |[i, j]: [usize; 2]| (fingers[i].position - fingers[j].position).norm();
    let pairs = (0..fingers.len()).flat_map(|j| (0..j).map(move |i| [i, j]));
    pairs.filter(|&pair| distance(pair) < apart).min_by(|&a, &b| distance(a).total_cmp(&distance(b)))
}

fn strong(mut fingers: Vec<FittedContact>) -> Vec<FittedContact> {
    fingers.sort_by(|a, b| b.strength.total_cmp(&a.strength));
    let least = LEAST_SHARE * fingers.first().map_or(0.0, |finger| finger.strength);
    fingers.retain(|finger| finger.strength >= least);
    fingers
}
