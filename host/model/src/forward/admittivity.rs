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
    Mat, MatMut, Par, Side, Spec,
    dyn_stack::{MemBuffer, MemStack},
    linalg::solvers::SolveCore,
    sparse::{
        SparseColMat, SymbolicSparseColMatRef,
        linalg::{
            cholesky::{LdltRef, SymbolicCholesky, factorize_symbolic_cholesky},
            solvers::{Llt, SymbolicLlt},
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

    /// Order of elimination and pattern of the factor.
    type Symbolic: Debug + Send + Sync;

    /// Entries of the lower half of the real matrix, row, column and value, that one entry of the
    /// lower half stands for.
    fn entries(row: usize, col: usize, value: Self) -> impl Iterator<Item = (usize, usize, f64)>;

    /// From its real unknowns.
    fn from_parts(parts: &[f64]) -> Self;

    /// Finds the order of elimination.
    fn analyse(pattern: SymbolicSparseColMatRef<'_, Index>) -> Result<Self::Symbolic, ForwardError>;

    /// Factors the lower half in `matrix` and solves for every column of `rhs`.
    fn solve(
        symbolic: &Self::Symbolic,
        matrix: SparseColMat<Index, f64>,
        rhs: Mat<f64>,
    ) -> Result<Mat<f64>, ForwardError>;

    /// Part in phase with the current.
    fn in_phase(self) -> f64;

    /// 1 / self.
    fn reciprocal(self) -> Self;
}

impl Admittivity for f64 {
    const PARTS: usize = 1;
    type Symbolic = SymbolicLlt<Index>;

    fn entries(row: usize, col: usize, value: Self) -> impl Iterator<Item = (usize, usize, f64)> {
        std::iter::once((row, col, value))
    }

    fn from_parts(parts: &[f64]) -> Self {
        parts[0]
    }

    fn analyse(pattern: SymbolicSparseColMatRef<'_, Index>) -> Result<Self::Symbolic, ForwardError> {
        SymbolicLlt::try_new(pattern, Side::Lower).map_err(ForwardError::solver)
    }

    fn solve(
        symbolic: &Self::Symbolic,
        matrix: SparseColMat<Index, f64>,
        rhs: Mat<f64>,
    ) -> Result<Mat<f64>, ForwardError> {
        let factor = Llt::try_new_with_symbolic(symbolic.clone(), matrix.as_ref(), Side::Lower)
            .map_err(|_| ForwardError::Singular)?;
        drop(matrix);
        Ok(solve_columns(rhs, |columns| factor.solve_in_place_with_conj(faer::Conj::No, columns)))
    }

    fn in_phase(self) -> f64 {
        self
    }

    fn reciprocal(self) -> Self {
        1.0 / self
    }
}

impl Admittivity for Complex64 {
    const PARTS: usize = 2;
    type Symbolic = SymbolicCholesky<Index>;

    fn entries(row: usize, col: usize, value: Self) -> impl Iterator<Item = (usize, usize, f64)> {
        let (real, imaginary) = (2 * row, 2 * row + 1);
        let above = (row != col).then_some((real, 2 * col + 1, -value.im));
        [(real, 2 * col, value.re), (imaginary, 2 * col, -value.im), (imaginary, 2 * col + 1, -value.re)]
            .into_iter()
            .chain(above)
    }

    fn from_parts(parts: &[f64]) -> Self {
        Self::new(parts[0], parts[1])
    }

    fn analyse(pattern: SymbolicSparseColMatRef<'_, Index>) -> Result<Self::Symbolic, ForwardError> {
        factorize_symbolic_cholesky(pattern, Side::Lower, Default::default(), Default::default())
            .map_err(ForwardError::solver)
    }

    fn solve(
        symbolic: &Self::Symbolic,
        matrix: SparseColMat<Index, f64>,
        rhs: Mat<f64>,
    ) -> Result<Mat<f64>, ForwardError> {
        let mut values = vec![0.0; symbolic.len_val()];
        let factor = ldlt(symbolic, &matrix, &mut values)?;
        drop(matrix);
        Ok(solve_columns(rhs, |columns| {
            let scratch = symbolic.solve_in_place_scratch::<f64>(columns.ncols(), Par::Seq);
            let mut memory = MemBuffer::new(scratch);
            let stack = MemStack::new(&mut memory);
            factor.solve_in_place_with_conj(faer::Conj::No, columns, Par::Seq, stack);
        }))
    }

    fn in_phase(self) -> f64 {
        self.re
    }

    fn reciprocal(self) -> Self {
        self.inv()
    }
}

fn ldlt<'a>(
    symbolic: &'a SymbolicCholesky<Index>,
    matrix: &SparseColMat<Index, f64>,
    values: &'a mut [f64],
) -> Result<LdltRef<'a, Index, f64>, ForwardError> {
    let parallelism = faer::get_global_parallelism();
    let scratch = symbolic.factorize_numeric_ldlt_scratch::<f64>(parallelism, Spec::default());
    let mut memory = MemBuffer::new(scratch);
    symbolic
        .factorize_numeric_ldlt(
            values,
            matrix.as_ref(),
            Side::Lower,
            Default::default(),
            parallelism,
            MemStack::new(&mut memory),
            Spec::default(),
        )
        .map_err(|_| ForwardError::Singular)
}

/// Columns solved together. The solver copies them, so that few of them need less memory.
const TOGETHER: usize = 8;

/// Solves all columns, a few of them at a time on each core.
pub(crate) fn solve_columns(mut rhs: Mat<f64>, solve: impl Fn(MatMut<'_, f64>) + Sync + Send) -> Mat<f64> {
    rhs.par_col_chunks_mut(TOGETHER).for_each(solve);
    rhs
}
