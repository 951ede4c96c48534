//! Forward model: from the conductivity of every element to potentials and voltages.
//!
//! Everything is relative: admittivity in units of the untouched sheet's conductivity, lengths in
//! metres, current 1 A; true volts are these times `amplitude / sheet_conductivity`. The system
//! matrix is assembled once as a pattern, then filled and factored for each admittivity; all
//! electrodes are right-hand sides together, and every drive and sense pair is a difference of two
//! of those fields.

mod admittivity;
mod system;

pub use admittivity::Admittivity;
pub(crate) use admittivity::solve_columns;
use admittivity::{Symbolic, analyse, places};
use dermatome_geometry::mesh::Mesh;
use dermatome_shared::stimulation::Step;
use faer::Mat;
use rayon::prelude::*;
use system::System;

/// A mesh made ready to be solved for many admittivities, real ([`f64`]) or complex.
#[derive(Debug)]
pub struct ForwardModel<T: Admittivity = f64> {
    system: System<T>,
    symbolic: Symbolic,
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

impl ForwardError {
    fn solver(error: impl std::fmt::Debug) -> Self {
        Self::Solver(format!("{error:?}"))
    }
}

impl<T: Admittivity> ForwardModel<T> {
    /// Prepares `mesh`.
    ///
    /// `contact_impedance`, `[electrode]`, is relative: ohm m times the sheet conductivity, hence
    /// m; it is not used by point electrodes. `ground` is the unknown held at 0 V: see
    /// [`electrode_unknown`].
    pub fn new(mesh: &Mesh, contact_impedance: &[T], ground: usize) -> Result<Self, ForwardError> {
        if contact_impedance.len() != mesh.electrodes.len() {
            let (electrodes, given) = (mesh.electrodes.len(), contact_impedance.len());
            return Err(ForwardError::ContactImpedances { electrodes, given });
        }
        let system = System::new(mesh, contact_impedance, ground)?;
        let symbolic = analyse(system.pattern())?;
        Ok(Self { system, symbolic })
    }

    /// Solves for the relative admittivity of each element: `[element]`.
    pub fn solve(&self, admittivity: &[T]) -> Result<Fields<T>, ForwardError> {
        let matrix = self.system.matrix(admittivity)?;
        let places = places(&self.symbolic);
        let solution = T::solve(&self.symbolic, matrix, self.system.currents(places))?;
        let is_finite =
            |block: &Mat<f64>| block.par_col_iter().all(|column| column.iter().all(|v| v.is_finite()));
        if !solution.iter().all(is_finite) {
            return Err(ForwardError::Singular);
        }
        Ok(Fields {
            potentials: self.system.with_ground(&solution, places),
            electrodes: self.system.electrodes().to_vec(),
        })
    }

    /// Entries of the full symmetric system matrix, ground included: row, column, value; entries of
    /// one place are to be added.
    pub fn system_matrix(&self, admittivity: &[T]) -> Result<Vec<(usize, usize, T)>, ForwardError> {
        self.system.entries(admittivity)
    }
}

/// Number of the unknown that is the potential of `electrode`: its node, or, in the complete
/// model, one of the unknowns behind all nodes.
#[must_use]
pub fn electrode_unknown(mesh: &Mesh, electrode: usize) -> usize {
    system::electrode_unknown(mesh, electrode)
}

/// Potentials for unit current into each electrode and out of the ground, relative, per ampere.
#[derive(Clone, Debug)]
pub struct Fields<T = f64> {
    /// `[unknown][electrode driven]`, row after row.
    potentials: Vec<T>,
    electrodes: Vec<usize>,
}

impl<T: Admittivity> Fields<T> {
    /// Number of electrodes.
    #[must_use]
    pub fn electrodes(&self) -> usize {
        self.electrodes.len()
    }

    /// Potentials of one unknown: `[electrode driven]`. Nodes come first, then, in the complete
    /// model, the electrodes.
    #[must_use]
    pub fn at(&self, unknown: usize) -> &[T] {
        let count = self.electrodes.len();
        &self.potentials[unknown * count..(unknown + 1) * count]
    }

    /// The fields of some electrodes only, in this order.
    #[must_use]
    pub fn only(&self, electrodes: &[usize]) -> Self {
        let potentials = self.potentials.chunks_exact(self.electrodes.len());
        Self {
            potentials: potentials
                .flat_map(|row| electrodes.iter().map(|&electrode| row[electrode]))
                .collect(),
            electrodes: electrodes.iter().map(|&electrode| self.electrodes[electrode]).collect(),
        }
    }

    /// Potential of electrode `at` for unit current into electrode `driven`.
    #[must_use]
    pub fn transfer(&self, at: usize, driven: usize) -> T {
        self.at(self.electrodes[at])[driven]
    }

    /// Voltage of one step at unit current.
    #[must_use]
    pub fn voltage(&self, step: Step) -> T {
        let [dp, dm, sp, sm] = step.to_bytes().map(usize::from);
        (self.transfer(sp, dp) - self.transfer(sp, dm)) - (self.transfer(sm, dp) - self.transfer(sm, dm))
    }

    /// Voltages of a stimulation table at unit current: `[step]`.
    #[must_use]
    pub fn voltages(&self, steps: &[Step]) -> Vec<T> {
        steps.iter().map(|&step| self.voltage(step)).collect()
    }
}
