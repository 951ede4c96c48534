//! Scenes: random contacts on a true skin, counted and placed through two models of it, the surface's own
//! and the flattened one of the thesis (section 5.3.3.2).
//!
//! Each scene is one forward solution on the true skin's mesh, scanned with noise into the codes of some frames
//! ([`dermatome_simulate::rig`]), which go through the board's own code with either patch. What the flattened model finds lies
//! in its plane, and is laid back onto the true skin from above. The codes of the first frame are also resolved on the host
//! ([`dermatome_model::multi_contact`]), which sees no image.

use dermatome_geometry::mesh::{neighbours::boundary_edges, triangle};
use dermatome_model::{
    model::ModelError,
    multi_contact::{FitError, MultiContactFit, Settings},
    skin::{NotFlat, Skin},
};
use dermatome_shared::{contact::Contact, frame::Frame};
use dermatome_simulate::{
    Noise, Press, Rig, TrueSkin,
    rig::{Observer, RigError, SETTLED},
};
use nalgebra::Point3;
use rand::{Rng, SeedableRng};
use rand_pcg::Pcg64Mcg;
use rayon::prelude::*;
use serde::Serialize;

/// What is put on the skin, and how well it is measured.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Options {
    /// Scenes: one, two, three contacts in turn.
    pub scenes: usize,
    /// Signal-to-noise ratio, dB, as in [`dermatome_simulate::Noise`].
    pub snr_db: f64,
    /// Radius of a contact, a share of the skin's diameter.
    pub radius: f64,
    /// Relative conductivity change at a contact's centre.
    pub depth: f64,
    /// Least distance of two centres, a share of the skin's diameter.
    pub apart: f64,
    /// Seed of places and noise.
    pub seed: u64,
}

impl Default for Options {
    /// Fingers as in the demo.
    fn default() -> Self {
        Self { scenes: 500, snr_db: 60.0, radius: 0.06, depth: 1.0, apart: 0.25, seed: 1 }
    }
}

/// One scene and what became of it.
#[derive(Clone, Debug, PartialEq)]
pub struct Scene {
    /// Centres of the contacts, m.
    pub truth: Vec<Point3<f64>>,
    /// Contacts that the surface's model shows, m, strongest first.
    pub surface: Vec<Point3<f64>>,
    /// Contacts that the flattened model shows, m, laid onto the skin.
    pub flattened: Vec<Point3<f64>>,
    /// Fingers that the host resolves with the surface's model, m, strongest first.
    pub resolved: Vec<Point3<f64>>,
}

/// Why there are no scenes of a skin.
#[derive(Debug, thiserror::Error)]
pub enum ScenesError {
    /// No model of the true skin.
    #[error(transparent)]
    Model(#[from] ModelError),
    /// No model or no patch.
    #[error(transparent)]
    Rig(#[from] RigError),
    /// Not to be resolved.
    #[error(transparent)]
    Fit(#[from] FitError),
    /// Not seen from above.
    #[error(transparent)]
    NotFlat(#[from] NotFlat),
    /// Centres cannot lie so far apart.
    #[error("`apart` is {apart} of the diameter: no place is left for contact {contact}; allowed is less")]
    Crowded {
        /// What was asked for.
        apart: f64,
        /// The contact without a place.
        contact: usize,
    },
}

/// Plays random scenes on `true_skin`, and shows them through the model of `skin`, which has the same
/// electrodes and drive on a mesh of its own, and through that of `skin` flattened.
pub fn play(skin: &Skin, true_skin: &Skin, options: &Options) -> Result<Vec<Scene>, ScenesError> {
    let mut random = Pcg64Mcg::seed_from_u64(options.seed);
    let diameter = true_skin.shape.from_above()?.diameter();
    let mut observers = Observers::new(skin, options.radius * diameter, options.snr_db)?;
    let noise = Noise { snr_db: options.snr_db, seed: random.random() };
    let mut rig = Rig::new(true_skin, &observers.surface.patch(), noise)?;
    let untouched = rig.truth().conductivity(&[]);
    observers.tare(&rig.tare(&untouched));
    let places = (0..options.scenes)
        .map(|scene| centres(rig.truth(), diameter, options, 1 + scene % 3, &mut random))
        .collect::<Result<Vec<_>, ScenesError>>()?;
    let press =
        |centre: &Point3<f64>| Press::finger([centre.x, centre.y], options.radius * diameter, options.depth);
    let phasors: Vec<_> = places
        .par_iter()
        .map(|centres| {
            let presses: Vec<_> = centres.iter().map(press).collect();
            rig.solve(&rig.truth().conductivity(&presses))
        })
        .collect();
    let frames: Vec<_> = phasors.iter().map(|phasors| rig.scans(phasors, SETTLED)).collect();
    let scenes = places.into_par_iter().zip(&frames);
    Ok(scenes.map(|(truth, frames)| observers.see(truth, frames, rig.truth())).collect())
}

/// Both boards, and the host.
struct Observers {
    surface: Observer,
    flattened: Observer,
    fit: MultiContactFit,
}

impl Observers {
    fn new(skin: &Skin, radius: f64, snr_db: f64) -> Result<Self, ScenesError> {
        let [surface, flattened] = [Observer::new(skin)?, Observer::new(&skin.flattened()?)?];
        let fit = MultiContactFit::new(skin, surface.model(), Settings { radius, snr_db })?;
        Ok(Self { surface, flattened, fit })
    }

    fn tare(&mut self, frames: &[Frame]) {
        self.surface.tare(frames);
        self.flattened.tare(frames);
    }

    fn see(&self, truth: Vec<Point3<f64>>, frames: &[Frame], true_skin: &TrueSkin) -> Scene {
        let flattened = self.flattened.glance(frames);
        let fingers = self.fit.contacts(&self.surface.difference(&frames[0]));
        Scene {
            truth,
            surface: self.surface.glance(frames).contacts().iter().map(place).collect(),
            flattened: flattened.contacts().iter().map(|c| true_skin.lay(c.from_above())).collect(),
            resolved: fingers.iter().map(|finger| finger.position).collect(),
        }
    }
}

/// Distance of each true centre from the contact that is its own: the closest pair of both belongs together, then
/// the closest of the rest. `None` where none is left.
#[must_use]
pub fn matched(truth: &[Point3<f64>], found: &[Point3<f64>]) -> Vec<Option<f64>> {
    let pairs = (0..truth.len()).flat_map(|t| (0..found.len()).map(move |f| (t, f)));
    let mut pairs: Vec<_> = pairs.map(|(t, f)| ((truth[t] - found[f]).norm(), t, f)).collect();
    pairs.sort_by(|a, b| a.0.total_cmp(&b.0));
    let (mut distances, mut is_taken) = (vec![None; truth.len()], vec![false; found.len()]);
    for (distance, t, f) in pairs {
        if distances[t].is_none() && !is_taken[f] {
            (distances[t], is_taken[f]) = (Some(distance), true);
        }
    }
    distances
}

/// Where a contact lies, m.
pub(crate) fn place(contact: &Contact) -> Point3<f64> {
    Point3::from(contact.position.map(f64::from))
}

/// Random centres, evenly over the surface, a contact's radius from the boundary.
fn centres(
    truth: &TrueSkin,
    diameter: f64,
    options: &Options,
    count: usize,
    random: &mut Pcg64Mcg,
) -> Result<Vec<Point3<f64>>, ScenesError> {
    const TRIES: usize = 10_000;
    let mesh = truth.mesh();
    let boundary: Vec<_> = boundary_edges(&mesh.elements).into_iter().flatten().collect();
    let area = |element: usize| triangle::area(mesh.corners(element));
    let largest = (0..mesh.elements.len()).map(area).fold(0.0, f64::max);
    let mut centres: Vec<Point3<f64>> = Vec::new();
    for _ in 0..TRIES {
        if centres.len() == count {
            break;
        }
        let element = random.random_range(0..mesh.elements.len());
        let centre = triangle::centroid(mesh.corners(element));
        let keep = random.random::<f64>() * largest < area(element);
        let is_inside =
            boundary.iter().all(|&node| (mesh.nodes[node] - centre).norm() > options.radius * diameter);
        let is_apart = centres.iter().all(|other| (other - centre).norm() >= options.apart * diameter);
        if keep && is_inside && is_apart {
            centres.push(centre);
        }
    }
    match centres.len() {
        found if found == count => Ok(centres),
        found => Err(ScenesError::Crowded { apart: options.apart, contact: found + 1 }),
    }
}

/// What scenes show, all in all.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Figures {
    /// Contacts counted by the board's finder in the image of the surface's model.
    pub board: Counts,
    /// Fingers counted by the host ([`dermatome_model::multi_contact`]).
    pub resolved: Counts,
    /// Mean distance of a single contact from its true centre by the surface's model, mm, away from the pole.
    pub surface_error_mm: f64,
    /// The same by the flattened model.
    pub flattened_error_mm: f64,
    /// The same as the host resolves it.
    pub resolved_error_mm: f64,
}

/// Shares of scenes with the right number of contacts.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Counts {
    /// By the true number: `[contacts - 1]`.
    pub right: [f64; 3],
    /// Of all scenes.
    pub right_of_all: f64,
}

impl Counts {
    fn new(scenes: &[Scene], found: impl Fn(&Scene) -> usize) -> Self {
        let share = |of: &dyn Fn(&Scene) -> bool| {
            let chosen: Vec<_> = scenes.iter().filter(|scene| of(scene)).collect();
            let right = chosen.iter().filter(|scene| found(scene) == scene.truth.len()).count();
            right as f64 / chosen.len().max(1) as f64
        };
        let right = [1, 2, 3].map(|count| share(&move |scene| scene.truth.len() == count));
        Self { right, right_of_all: share(&|_| true) }
    }
}

/// Sums up scenes. `is_counted` says which single contacts, by their true centre, go into the errors;
/// a contact that a model misses counts as `miss`, m.
#[must_use]
pub fn figures(scenes: &[Scene], miss: f64, is_counted: impl Fn(&Point3<f64>) -> bool) -> Figures {
    let error = |found: &dyn Fn(&Scene) -> Option<Point3<f64>>| {
        let single = scenes.iter().filter(|scene| scene.truth.len() == 1 && is_counted(&scene.truth[0]));
        let errors: Vec<f64> =
            single.map(|scene| found(scene).map_or(miss, |at| (at - scene.truth[0]).norm())).collect();
        1e3 * errors.iter().sum::<f64>() / errors.len().max(1) as f64
    };
    Figures {
        board: Counts::new(scenes, |scene| scene.surface.len()),
        resolved: Counts::new(scenes, |scene| scene.resolved.len()),
        surface_error_mm: error(&|scene| scene.surface.first().copied()),
        flattened_error_mm: error(&|scene| scene.flattened.first().copied()),
        resolved_error_mm: error(&|scene| scene.resolved.first().copied()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(x: f64) -> Point3<f64> {
        Point3::new(x, 0.0, 0.0)
    }

    #[test]
    fn each_finger_has_the_contact_that_is_closest_and_no_one_elses() {
        let close = |found: Vec<Option<f64>>, expected: &[Option<f64>]| {
            assert_eq!(found.len(), expected.len());
            for (found, expected) in found.iter().zip(expected) {
                assert!((found.unwrap_or(-1.0) - expected.unwrap_or(-1.0)).abs() < 1e-12, "{found:?}");
            }
        };
        close(matched(&[at(0.0), at(1.0)], &[at(0.9), at(0.2)]), &[Some(0.2), Some(0.1)]);
        // The contact between both belongs to the closer one.
        close(matched(&[at(0.0), at(1.0)], &[at(0.6)]), &[None, Some(0.4)]);
        close(matched(&[at(0.0)], &[]), &[None]);
        close(matched(&[], &[at(0.0)]), &[]);
    }
}
