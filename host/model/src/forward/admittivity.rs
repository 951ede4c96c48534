//! Admittivity: a real conductivity, or complex where the sheet or its contacts have capacitance.
//!
//! Both become real symmetric systems. A conductivity gives a positive definite matrix, which is
//! factored by Cholesky. A complex symmetric system (A + jB)(x + jy) = f with A positive definite
//! becomes, unknown by unknown,
//!
//! ```text
//! [  A  -B ] [x]   [ f]
//! [ -B  -A ] [y] = [ 0]
//! ```
//!
//! which is symmetric quasi-definite: LDL' exists for every order of elimination and needs no
//! pivoting (Vanderbei 1995), so the complex case keeps the sparse symmetric factorisation and its
//! ordering. faer's complex factorisations are Hermitian, which an admittance matrix is not.

use super::ForwardError;
use faer::{
    Conj, Mat, MatMut, Par, Side, Spec,
    dyn_stack::{MemBuffer, MemStack, StackReq},
    sparse::{
        SparseColMat, SymbolicSparseColMatRef,
        linalg::cholesky::{
            SymbolicCholesky, SymbolicCholeskyRaw, factorize_symbolic_cholesky,
            simplicial::{SimplicialLdltRef, SimplicialLltRef},
            supernodal::{SupernodalLdltRef, SupernodalLltRef},
        },
    },
};
use num_complex::Complex64;
use rayon::prelude::*;
use std::{
    fmt::Debug,
    iter::Sum,
    ops::{Add, Div, Mul, Neg, Sub},
};

/// Number of an unknown in the sparse solver: half as long as usize, which is half the memory to go through.
pub(super) type Index = u32;

/// Order of elimination and pattern of the factor.
pub(super) type Symbolic = SymbolicCholesky<Index>;

/// Finds the order of elimination of a matrix whose lower half has this pattern.
pub(super) fn analyse(pattern: SymbolicSparseColMatRef<'_, Index>) -> Result<Symbolic, ForwardError> {
    factorize_symbolic_cholesky(pattern, Side::Lower, Default::default(), Default::default())
        .map_err(ForwardError::solver)
}

/// Where each real unknown comes in the order of elimination.
pub(super) fn places(symbolic: &Symbolic) -> &[Index] {
    symbolic.perm().expect("the order of elimination is chosen, not given").arrays().1
}

/// What an element's admittivity may be: `f64` or [`Complex64`].
pub trait Admittivity:
    Copy
    + Debug
    + Default
    + From<f64>
    + Send
    + Sync
    + Add<Output = Self>
    + Sub<Output = Self>
    + Neg<Output = Self>
    + Mul<Output = Self>
    + Mul<f64, Output = Self>
    + Div<f64, Output = Self>
    + Sum
    + 'static
{
    /// Real unknowns that make up one of this kind.
    const PARTS: usize;

    /// Entries of the lower half of the real matrix, row, column and value, that one entry of the
    /// lower half stands for.
    fn entries(row: usize, col: usize, value: Self) -> impl Iterator<Item = (usize, usize, f64)>;

    /// From its real unknowns.
    fn from_parts(part: impl Fn(usize) -> f64) -> Self;

    /// Factors the lower half in `matrix`: values of the factor.
    fn factor(symbolic: &Symbolic, matrix: &SparseColMat<Index, f64>) -> Result<Vec<f64>, ForwardError>;

    /// Solves with a factor, in place and on one core; rows are in the order of elimination.
    fn solve_in_place(symbolic: &Symbolic, factor: &[f64], columns: MatMut<'_, f64>);

    /// Part in phase with the current.
    fn in_phase(self) -> f64;

    /// Its absolute value.
    fn size(self) -> f64;

    /// 1 / self.
    fn reciprocal(self) -> Self;
}

impl Admittivity for f64 {
    const PARTS: usize = 1;

    fn entries(row: usize, col: usize, value: Self) -> impl Iterator<Item = (usize, usize, f64)> {
        std::iter::once((row, col, value))
    }

    fn from_parts(part: impl Fn(usize) -> f64) -> Self {
        part(0)
    }

    fn factor(symbolic: &Symbolic, matrix: &SparseColMat<Index, f64>) -> Result<Vec<f64>, ForwardError> {
        let parallelism = faer::get_global_parallelism();
        let mut values = vec![0.0; symbolic.len_val()];
        with_stack(symbolic.factorize_numeric_llt_scratch::<f64>(parallelism, Spec::default()), |stack| {
            let factor = symbolic.factorize_numeric_llt(
                &mut values,
                matrix.as_ref(),
                Side::Lower,
                Default::default(),
                parallelism,
                stack,
                Spec::default(),
            );
            factor.map(drop).map_err(|_| ForwardError::Singular)
        })?;
        Ok(values)
    }

    fn solve_in_place(symbolic: &Symbolic, factor: &[f64], columns: MatMut<'_, f64>) {
        let parallelism = Par::Seq;
        match symbolic.raw() {
            SymbolicCholeskyRaw::Simplicial(symbolic) => {
                with_stack(symbolic.solve_in_place_scratch::<f64>(columns.ncols()), |stack| {
                    let factor = SimplicialLltRef::new(symbolic, factor);
                    factor.solve_in_place_with_conj(Conj::No, columns, parallelism, stack);
                });
            }
            SymbolicCholeskyRaw::Supernodal(symbolic) => {
                with_stack(symbolic.solve_in_place_scratch::<f64>(columns.ncols(), parallelism), |stack| {
                    let factor = SupernodalLltRef::new(symbolic, factor);
                    factor.solve_in_place_with_conj(Conj::No, columns, parallelism, stack);
                });
            }
        }
    }

    fn in_phase(self) -> f64 {
        self
    }

    fn size(self) -> f64 {
        self.abs()
    }

    fn reciprocal(self) -> Self {
        1.0 / self
    }
}

impl Admittivity for Complex64 {
    const PARTS: usize = 2;

    fn entries(row: usize, col: usize, value: Self) -> impl Iterator<Item = (usize, usize, f64)> {
        let (real, imaginary) = (2 * row, 2 * row + 1);
        let above = (row != col).then_some((real, 2 * col + 1, -value.im));
        [(real, 2 * col, value.re), (imaginary, 2 * col, -value.im), (imaginary, 2 * col + 1, -value.re)]
            .into_iter()
            .chain(above)
    }

    fn from_parts(part: impl Fn(usize) -> f64) -> Self {
        Self::new(part(0), part(1))
    }

    fn factor(symbolic: &Symbolic, matrix: &SparseColMat<Index, f64>) -> Result<Vec<f64>, ForwardError> {
        let parallelism = faer::get_global_parallelism();
        let mut values = vec![0.0; symbolic.len_val()];
        with_stack(symbolic.factorize_numeric_ldlt_scratch::<f64>(parallelism, Spec::default()), |stack| {
            let factor = symbolic.factorize_numeric_ldlt(
                &mut values,
                matrix.as_ref(),
                Side::Lower,
                Default::default(),
                parallelism,
                stack,
                Spec::default(),
            );
            factor.map(drop).map_err(|_| ForwardError::Singular)
        })?;
        Ok(values)
    }

    fn solve_in_place(symbolic: &Symbolic, factor: &[f64], columns: MatMut<'_, f64>) {
        let parallelism = Par::Seq;
        match symbolic.raw() {
            SymbolicCholeskyRaw::Simplicial(symbolic) => {
                with_stack(symbolic.solve_in_place_scratch::<f64>(columns.ncols()), |stack| {
                    let factor = SimplicialLdltRef::new(symbolic, factor);
                    factor.solve_in_place_with_conj(Conj::No, columns, parallelism, stack);
                });
            }
            SymbolicCholeskyRaw::Supernodal(symbolic) => {
                with_stack(symbolic.solve_in_place_scratch::<f64>(columns.ncols(), parallelism), |stack| {
                    let factor = SupernodalLdltRef::new(symbolic, factor);
                    factor.solve_in_place_with_conj(Conj::No, columns, parallelism, stack);
                });
            }
        }
    }

    fn in_phase(self) -> f64 {
        self.re
    }

    fn size(self) -> f64 {
        self.norm()
    }

    fn reciprocal(self) -> Self {
        self.inv()
    }
}

/// Does `work` with as much memory as it needs.
fn with_stack<R>(needed: StackReq, work: impl FnOnce(&mut MemStack) -> R) -> R {
    work(MemStack::new(&mut MemBuffer::new(needed)))
}

/// Columns solved together: few of them need less memory.
pub(super) const TOGETHER: usize = 8;

/// Solves all columns, a few of them at a time on each core.
pub(crate) fn solve_columns(mut rhs: Mat<f64>, solve: impl Fn(MatMut<'_, f64>) + Sync + Send) -> Mat<f64> {
    rhs.par_col_chunks_mut(TOGETHER).for_each(solve);
    rhs
}
