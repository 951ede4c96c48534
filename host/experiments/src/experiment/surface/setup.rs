//! What is simulated: a mesh of the thesis with its matrix, and the skin that it stands for, meshed anew.

use super::mesh;
use crate::experiment::{ExperimentError, hemisphere, sample};
use dermatome_geometry::{
    mesh::{Mesh, soundness::inspect, triangle},
    sheet::ElectrodeModel,
};
use dermatome_model::{
    model::{self, Model},
    skin::{Hyperparameter, ImageLayout, Inverse, Method, Prior, Shape, Skin, Weights},
};
use dermatome_shared::patch::Difference;
use dermatome_simulate::{TrueSkin, rig::IdealRig};
use nalgebra::Point3;
use std::f64::consts::FRAC_PI_2;

/// How far from the middle a place lies: direction as seen from above, degrees, and share of the way to the rim.
pub(super) type Place = [f64; 2];

/// What is measured of regions of this radius, a share of the larger side.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Way {
    pub(super) radius: f64,
    pub(super) measured: Measured,
}

/// What is measured.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Measured {
    /// The mesh that the matrix is of, without noise.
    SameMesh,
    /// The skin meshed anew, with noise of so many dB, if any.
    Skin(Option<f64>),
}

/// A mesh of the thesis, and the skin that it stands for.
#[derive(Clone, Copy, Debug)]
pub(super) struct Setup {
    pub(super) name: &'static str,
    /// Nodes and elements in the thesis.
    pub(super) counts: [usize; 2],
    /// At unit current, on which EIDORS' depends with its weights.
    pub(super) hyperparameter: f64,
    skin: fn() -> Result<Skin, ExperimentError>,
    mesh: Option<fn(f64) -> Mesh>,
}

/// Seed of all noise.
const SEED: u64 = 1;
/// Current with which EIDORS' common models drive, as a multiple of that in the thesis' listing of the surface.
pub(super) const COMMON_CURRENT: f64 = 10.0;

/// The thesis' surface mesh, with which it simulates, and its two planar ones; hyperparameters of its listing and of
/// tables 5.5 and 4.1.
pub(super) const SETUPS: [Setup; 3] = [
    Setup {
        name: "Fig. 5.2, hemisphere",
        counts: [337, 624],
        hyperparameter: 1e-3,
        skin: hemisphere::by_formula,
        mesh: Some(mesh::hemisphere),
    },
    Setup {
        name: "Fig. 5.6, disc",
        counts: [1201, 2304],
        hyperparameter: 0.15 / COMMON_CURRENT,
        skin: || sample::shipped(sample::DISC_210),
        mesh: Some(mesh::disc),
    },
    Setup {
        name: "Fig. 3.10, square",
        counts: [2075, 4078],
        hyperparameter: 0.032 / COMMON_CURRENT,
        skin: || sample::shipped(sample::SQUARE_50),
        mesh: None,
    },
];

/// A setup, solved.
pub(super) struct Bench {
    /// Larger side of the skin, m.
    pub(super) side: f64,
    /// What images are made with.
    pub(super) model: Model,
    imaged: Skin,
    truth: TrueSkin,
    is_curved: bool,
}

impl Setup {
    pub(super) fn bench(&self) -> Result<Bench, ExperimentError> {
        let skin = (self.skin)()?;
        let rim = skin.shape.electrode_centres();
        let radius = rim.iter().map(|at| at.coords.amax()).fold(0.0, f64::max);
        let imaged = self.imaged(&skin, radius);
        let is_curved = skin.shape.flat().is_err();
        let (model, truth) = (Model::build(&imaged, |_| ())?, TrueSkin::new(&skin)?);
        Ok(Bench { side: 2.0 * radius, model, imaged, truth, is_curved })
    }

    /// The skin on the thesis' mesh: point electrodes where that has nodes for them.
    fn imaged(&self, skin: &Skin, radius: f64) -> Skin {
        let inverse = inverse(self.hyperparameter);
        let skin = Skin { image: ImageLayout::Elements, inverse, ..skin.clone() };
        let Some(mesh) = self.mesh else { return skin };
        let mesh = mesh(radius);
        let soundness = inspect(&mesh.nodes, &mesh.elements);
        let mut imaged = Skin { shape: Shape::imported(mesh, &soundness), ..skin };
        imaged.electrodes.model = ElectrodeModel::Point;
        imaged
    }
}

/// EIDORS' step of the thesis' listing: Laplace prior, normalised data, which EIDORS weighs by the reference squared.
fn inverse(hyperparameter: f64) -> Inverse {
    Inverse {
        method: Method::OneStep(Prior::Laplace),
        hyperparameter: Hyperparameter::Fixed(hyperparameter),
        difference: Difference::Normalised,
        weights: Weights::ReferenceSquared,
        electrode_movement: None,
        noise_db: 60.0,
    }
}

impl Bench {
    /// Where a place lies, m.
    pub(super) fn lay(&self, [direction, way]: Place) -> Point3<f64> {
        let (sine, cosine) = direction.to_radians().sin_cos();
        let (away, up) = if self.is_curved { (way * FRAC_PI_2).sin_cos() } else { (way, 0.0) };
        Point3::new(away * cosine, away * sine, up) * (self.side / 2.0)
    }

    /// Images that one way gives of regions that conduct twice as well, by frame: `[frame][element]`. Without noise there
    /// is one.
    pub(super) fn images(
        &self,
        way: &Way,
        centres: &[Point3<f64>],
        frames: u64,
    ) -> Result<Vec<Vec<f64>>, ExperimentError> {
        let radius = way.radius * self.side;
        let Measured::Skin(snr_db) = way.measured else {
            return Ok(vec![self.same_mesh(&doubled(&self.model.mesh, centres, radius))?]);
        };
        let rig = IdealRig::new(&self.truth, &self.model, snr_db, SEED);
        let conductivity = doubled(self.truth.mesh(), centres, radius);
        let voltages = self.truth.voltages(&conductivity, &self.model.steps);
        let count = if snr_db.is_some() { frames } else { 1 };
        Ok((1..=count).map(|frame| rig.read(voltages.clone(), frame).image).collect())
    }

    /// Forward and inverse on one mesh, as in the thesis.
    fn same_mesh(&self, conductivity: &[f64]) -> Result<Vec<f64>, ExperimentError> {
        let model = &self.model;
        let forward = model::forward_model::<f64>(&self.imaged, &model.mesh)?;
        let fields = forward.solve(conductivity).map_err(model::ModelError::from)?;
        let voltages = fields.voltages(&model.steps);
        let change: Vec<f64> = voltages.iter().zip(&model.voltages).map(|(now, then)| now - then).collect();
        Ok(model.image(&change, &model.voltages))
    }
}

/// Relative conductivity of the elements: two where their middle is this close to a centre, one elsewhere.
pub(super) fn doubled(mesh: &Mesh, centres: &[Point3<f64>], radius: f64) -> Vec<f64> {
    let sigma = |element: usize| {
        let middle = triangle::centroid(mesh.corners(element));
        let is_in = centres.iter().any(|centre| (middle - centre).norm() <= radius);
        if is_in { 2.0 } else { 1.0 }
    };
    (0..mesh.elements.len()).map(sigma).collect()
}
