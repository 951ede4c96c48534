//! Forward model: from the conductivity of every element to potentials and voltages.
//!
//! Everything is relative: admittivity in units of the untouched sheet's conductivity, lengths in
//! metres, current 1 A; true volts are these times `amplitude / sheet_conductivity`. The system
//! matrix is assembled once as a pattern, then filled and factored for each admittivity; all
//! electrodes are right-hand sides together, and every drive and sense pair is a difference of two
//! of those fields.

mod admittivity;
mod system;
mod tensors;

pub use admittivity::Admittivity;
pub(crate) use admittivity::solve_columns;
use admittivity::{Index, Symbolic, analyse, places};
use dermatome_geometry::mesh::Mesh;
use dermatome_shared::stimulation::Step;
use faer::{Mat, sparse::SparseColMat};
use rayon::prelude::*;
use system::System;
pub use tensors::SheetTensors;

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
    /// A contact impedance that cannot be reckoned with.
    #[error(
        "`electrodes.contact_impedance` of electrode {} comes to {size:e} m (ohm m times the sheet conductivity); \
         allowed: above zero, finite, and so its reciprocal",
        electrode + 1
    )]
    ContactImpedance {
        /// Index of the electrode.
        electrode: usize,
        /// Its magnitude, relative, m.
        size: f64,
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
    /// Numbers too far apart for double precision.
    #[error(
        "rounding leaves an error of {error:.1e} of the largest potential; allowed: {LARGEST_ERROR:e}; conductivities, \
         contact impedances or capacitances lie too far apart"
    )]
    Rounding {
        /// Error over the largest potential.
        error: f64,
    },
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
    /// m; it is not used by point electrodes. Any above zero is exact, from a perfect contact to an open one.
    pub fn new(mesh: &Mesh, contact_impedance: &[T]) -> Result<Self, ForwardError> {
        Self::on_sheet(mesh, contact_impedance, SheetTensors::default())
    }

    /// The same with a sheet that is not alike everywhere or in all directions; admittivities are relative to it.
    pub fn on_sheet(mesh: &Mesh, contact_impedance: &[T], sheet: SheetTensors) -> Result<Self, ForwardError> {
        if contact_impedance.len() != mesh.electrodes.len() {
            let (electrodes, given) = (mesh.electrodes.len(), contact_impedance.len());
            return Err(ForwardError::ContactImpedances { electrodes, given });
        }
        let system = System::new(mesh, contact_impedance, sheet)?;
        let symbolic = analyse(system.pattern())?;
        Ok(Self { system, symbolic })
    }

    /// Solves for the relative admittivity of each element: `[element]`.
    pub fn solve(&self, admittivity: &[T]) -> Result<Fields<T>, ForwardError> {
        let matrix = self.system.matrix(admittivity)?;
        let factor = T::factor(&self.symbolic, &matrix)?;
        let places = places(&self.symbolic);
        let solved = self.system.currents(places).map(|mut block| {
            T::solve_in_place(&self.symbolic, &factor, block.as_mut());
            block
        });
        let solution: Vec<_> = solved.collect();
        let error = self.error(&matrix, &factor, &solution);
        if error > LARGEST_ERROR || error.is_nan() {
            return Err(ForwardError::Rounding { error });
        }
        Ok(Fields {
            potentials: self.system.potentials(&solution, places),
            electrodes: self.system.electrodes().to_vec(),
            sheet: self.system.sheet().clone(),
        })
    }

    /// How far off the solution is, over the largest potential: what a step of iterative refinement would change
    /// (Higham 2002, section 12). It is taken of one mixture of all electrodes' fields.
    fn error(&self, matrix: &SparseColMat<Index, f64>, factor: &[f64], solution: &[Mat<f64>]) -> f64 {
        let places = places(&self.symbolic);
        let mut mixed = Mat::<f64>::zeros(places.len(), 1);
        let mut left = mixed.clone();
        let columns = solution.iter().flat_map(Mat::col_iter);
        for ((column, &electrode), share) in columns.zip(self.system.electrodes()).zip(shares()) {
            mixed.col_mut(0).iter_mut().zip(column.iter()).for_each(|(sum, value)| *sum += share * value);
            self.system.current_enters(electrode, places).for_each(|place| left[(place, 0)] += share);
        }
        for col in 0..matrix.ncols() {
            let at = places[col] as usize;
            for (&row, value) in matrix.row_idx_of_col_raw(col).iter().zip(matrix.val_of_col(col)) {
                let row = row as usize;
                left[(places[row] as usize, 0)] -= value * mixed[(at, 0)];
                if row != col {
                    left[(at, 0)] -= value * mixed[(places[row] as usize, 0)];
                }
            }
        }
        T::solve_in_place(&self.symbolic, factor, left.as_mut());
        // An open electrode's own potential may be many times all others.
        let is_electrode = self.system.is_electrode(places);
        let potentials = mixed.col(0).iter().zip(&is_electrode).filter(|(_, electrode)| !**electrode);
        let largest = potentials.map(|(value, _)| value.abs()).fold(0.0, f64::max);
        let error = |(change, value): (&f64, &f64)| change.abs() / largest.max(value.abs());
        // `max` would pass over NaN.
        let worse = |a: f64, b: f64| if b <= a { a } else { b };
        left.col(0).iter().zip(mixed.col(0).iter()).map(error).fold(0.0, worse)
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

/// Largest error of a solution that rounding may leave, over the largest potential.
const LARGEST_ERROR: f64 = 1e-9;

/// How much of each electrode's field is mixed in: numbers without a pattern.
fn shares() -> impl Iterator<Item = f64> {
    (1..).map(|electrode| f64::from(electrode * electrode).cos())
}

/// Potentials for unit current into each electrode and out of one node of the mesh, relative, per ampere. Only
/// differences between electrodes that drive mean something.
#[derive(Clone, Debug)]
pub struct Fields<T = f64> {
    /// `[unknown][electrode driven]`, row after row.
    potentials: Vec<T>,
    electrodes: Vec<usize>,
    sheet: SheetTensors,
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

    /// The untouched sheet that they are fields on.
    #[must_use]
    pub fn sheet(&self) -> &SheetTensors {
        &self.sheet
    }

    /// The fields of some electrodes only, in this order.
    #[must_use]
    pub fn only(&self, electrodes: &[usize]) -> Self {
        let potentials = self.potentials.chunks_exact(self.electrodes.len());
        Self {
            sheet: self.sheet.clone(),
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
