//! Forward model: from the conductivity of every element to potentials and voltages.
//!
//! Everything is relative: conductivity in units of the untouched sheet, lengths in metres,
//! current 1 A; true volts are these times `amplitude / sheet_conductivity`. The system matrix is
//! assembled once as a pattern, then filled and factored for each conductivity; all electrodes
//! are right-hand sides together, and every drive and sense pair is a difference of two of those
//! fields.

mod system;

use crate::mesh::Mesh;
use dermatome_shared::stimulation::Step;
use faer::{Mat, Side, linalg::solvers::SolveCore, sparse::linalg::solvers as sparse};
use system::System;

/// A mesh made ready to be solved for many conductivities.
#[derive(Debug)]
pub struct ForwardModel {
    system: System,
    symbolic: sparse::SymbolicLlt<usize>,
}

/// Why a forward model cannot be solved.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ForwardError {
    /// There must be a contact impedance per electrode of the complete model.
    #[error("{electrodes} electrodes need as many contact impedances, got {given}")]
    ContactImpedances {
        /// Electrodes of the mesh.
        electrodes: usize,
        /// Contact impedances given.
        given: usize,
    },
    /// There must be a conductivity per element.
    #[error("{elements} elements need as many conductivities, got {given}")]
    Conductivities {
        /// Elements of the mesh.
        elements: usize,
        /// Conductivities given.
        given: usize,
    },
    /// No unique solution.
    #[error(
        "the system matrix is singular: a conductivity is not above zero, or a part of the mesh is cut off"
    )]
    Singular,
    /// The solver failed for lack of memory or a malformed pattern.
    #[error("the sparse solver failed: {0}")]
    Solver(String),
}

impl ForwardModel {
    /// Prepares `mesh`.
    ///
    /// `contact_impedance`, `[electrode]`, is relative: ohm m times the sheet conductivity, hence
    /// m; it is not used by point electrodes. `ground` is the unknown held at 0 V: see
    /// [`electrode_unknown`].
    pub fn new(mesh: &Mesh, contact_impedance: &[f64], ground: usize) -> Result<Self, ForwardError> {
        if contact_impedance.len() != mesh.electrodes.len() {
            let (electrodes, given) = (mesh.electrodes.len(), contact_impedance.len());
            return Err(ForwardError::ContactImpedances { electrodes, given });
        }
        let system = System::new(mesh, contact_impedance, ground)?;
        let symbolic = sparse::SymbolicLlt::try_new(system.pattern(), Side::Lower)
            .map_err(|error| ForwardError::Solver(format!("{error:?}")))?;
        Ok(Self { system, symbolic })
    }

    /// Solves for the relative conductivity of each element: `[element]`.
    pub fn solve(&self, conductivity: &[f64]) -> Result<Fields, ForwardError> {
        let matrix = self.system.matrix(conductivity)?;
        let factor = sparse::Llt::try_new_with_symbolic(self.symbolic.clone(), matrix.as_ref(), Side::Lower)
            .map_err(|_| ForwardError::Singular)?;
        let mut unknowns = self.system.currents();
        factor.solve_in_place_with_conj(faer::Conj::No, unknowns.as_mut());
        if !(0..unknowns.ncols()).all(|j| unknowns.col(j).iter().all(|v| v.is_finite())) {
            return Err(ForwardError::Singular);
        }
        Ok(Fields {
            potentials: self.system.with_ground(&unknowns),
            electrodes: self.system.electrodes().to_vec(),
        })
    }

    /// Entries of the full symmetric system matrix, ground included: row, column, value.
    pub fn system_matrix(&self, conductivity: &[f64]) -> Result<Vec<(usize, usize, f64)>, ForwardError> {
        self.system.entries(conductivity)
    }
}

/// Number of the unknown that is the potential of `electrode`: its node, or, in the complete
/// model, one more unknown behind all nodes.
#[must_use]
pub fn electrode_unknown(mesh: &Mesh, electrode: usize) -> usize {
    system::electrode_unknown(mesh, electrode)
}

/// Potentials for unit current into each electrode and out of the ground.
#[derive(Clone, Debug)]
pub struct Fields {
    /// Potential per ampere, relative: `[unknown][electrode driven]`; nodes first, then, in the
    /// complete model, the electrodes.
    pub potentials: Mat<f64>,
    electrodes: Vec<usize>,
}

impl Fields {
    /// Potential of electrode `at` for unit current into electrode `driven`.
    #[must_use]
    pub fn transfer(&self, at: usize, driven: usize) -> f64 {
        self.potentials[(self.electrodes[at], driven)]
    }

    /// Voltage of one step at unit current.
    #[must_use]
    pub fn voltage(&self, step: Step) -> f64 {
        let [dp, dm, sp, sm] = step.to_bytes().map(usize::from);
        (self.transfer(sp, dp) - self.transfer(sp, dm)) - (self.transfer(sm, dp) - self.transfer(sm, dm))
    }

    /// Voltages of a stimulation table at unit current: `[step]`.
    #[must_use]
    pub fn voltages(&self, steps: &[Step]) -> Vec<f64> {
        steps.iter().map(|&step| self.voltage(step)).collect()
    }
}
