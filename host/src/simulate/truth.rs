//! The true skin: solved on a mesh of its own, never on the one its images are reconstructed with.

use crate::{
    forward::{Admittivity, ForwardModel},
    mesh::{Lattice, Mesh, refine},
    model::{ModelError, forward_model, mesh},
    skin::{Shape, Skin},
};
use dermatome_shared::stimulation::Step;
use num_complex::Complex64;

/// Triangles of the true skin are this much smaller than the reconstruction's, along an edge.
const FINENESS: f64 = 0.66;
/// The lattice is turned and shifted against the reconstruction's.
const LATTICE: Lattice = Lattice { angle: 0.35, shift: 0.37 };

/// A skin whose voltages can be solved for any conductivity.
#[derive(Debug)]
pub struct TrueSkin {
    mesh: Mesh,
    forward: Forward,
    /// Carrier frequency of the skin file, Hz.
    frequency: f64,
}

/// Forward model of a sheet without or with capacitance.
#[derive(Debug)]
enum Forward {
    Real(Box<ForwardModel<f64>>),
    /// With the relative susceptance of the sheet for each hertz, which presses leave as it is.
    Complex(Box<ForwardModel<Complex64>>, f64),
}

impl TrueSkin {
    /// Meshes a skin; an imported mesh is refined instead, which keeps its nodes.
    pub fn new(skin: &Skin) -> Result<Self, ModelError> {
        let mesh = match &skin.shape {
            Shape::Sheet(_) => mesh(skin, FINENESS, LATTICE)?,
            Shape::Mesh { mesh, .. } => refine(mesh),
        };
        let forward = match skin.admittivity() {
            admittivity if admittivity.im == 0.0 => Forward::Real(Box::new(forward_model(skin, &mesh)?)),
            admittivity => {
                let per_hertz = admittivity.im / skin.drive.frequency;
                Forward::Complex(Box::new(forward_model(skin, &mesh)?), per_hertz)
            }
        };
        Ok(Self { mesh, forward, frequency: skin.drive.frequency })
    }

    /// Its mesh.
    #[must_use]
    pub fn mesh(&self) -> &Mesh {
        &self.mesh
    }

    /// In-phase voltages at unit current: `[step]`. `conductivity`, `[element]`, is relative and must
    /// be above zero.
    #[must_use]
    pub fn voltages(&self, conductivity: &[f64], steps: &[Step]) -> Vec<f64> {
        self.phasors(conductivity, steps, self.frequency).into_iter().map(|voltage| voltage.re).collect()
    }

    /// Voltages at unit current of this frequency, Hz: `[step]`.
    #[must_use]
    pub fn phasors(&self, conductivity: &[f64], steps: &[Step], frequency: f64) -> Vec<Complex64> {
        match &self.forward {
            Forward::Real(model) => {
                solve(model, conductivity, steps).into_iter().map(Complex64::from).collect()
            }
            Forward::Complex(model, per_hertz) => {
                let with_capacitance = |&sigma| Complex64::new(sigma, per_hertz * frequency);
                solve(model, &conductivity.iter().map(with_capacitance).collect::<Vec<_>>(), steps)
            }
        }
    }
}

fn solve<T: Admittivity>(model: &ForwardModel<T>, admittivity: &[T], steps: &[Step]) -> Vec<T> {
    model.solve(admittivity).expect("a positive conductivity has a solution").voltages(steps)
}
