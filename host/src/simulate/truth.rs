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
}

/// Forward model of a sheet without or with capacitance.
#[derive(Debug)]
enum Forward {
    Real(Box<ForwardModel<f64>>),
    /// With the relative susceptance of the sheet, which presses leave as it is.
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
            admittivity => Forward::Complex(Box::new(forward_model(skin, &mesh)?), admittivity.im),
        };
        Ok(Self { mesh, forward })
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
        match &self.forward {
            Forward::Real(model) => in_phase(model, conductivity, steps),
            Forward::Complex(model, susceptance) => {
                let admittivity: Vec<_> =
                    conductivity.iter().map(|&sigma| Complex64::new(sigma, *susceptance)).collect();
                in_phase(model, &admittivity, steps)
            }
        }
    }
}

fn in_phase<T: Admittivity>(model: &ForwardModel<T>, admittivity: &[T], steps: &[Step]) -> Vec<f64> {
    let fields = model.solve(admittivity).expect("a positive conductivity has a solution");
    fields.voltages(steps).into_iter().map(T::in_phase).collect()
}
