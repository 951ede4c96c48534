//! What an export writes: arrays with names and meanings, and sparse matrices as three of them.

use crate::array::{Array, Number};
use dermatome_model::forward::Admittivity;
use faer::Mat;

/// A named array.
pub struct Variable<'a> {
    /// Name of the file and of the variable.
    pub name: &'static str,
    /// Its values, of one or two dimensions.
    pub array: Array<'a>,
    /// Unit of the values; empty for a pure number.
    pub unit: &'static str,
    /// What it holds.
    pub meaning: &'static str,
}

impl<'a> Variable<'a> {
    /// One dimension.
    pub fn list<T: Number>(name: &'static str, length: usize, at: impl Fn(usize) -> T + 'a) -> Self {
        Self::new(name, Array::list(length, at))
    }

    /// Two dimensions.
    pub fn table<T: Number>(
        name: &'static str,
        rows: usize,
        columns: usize,
        at: impl Fn(usize, usize) -> T + 'a,
    ) -> Self {
        Self::new(name, Array::table(rows, columns, at))
    }

    /// A matrix as it is.
    pub fn matrix<T: Number>(name: &'static str, matrix: &'a Mat<T>) -> Self {
        Self::new(name, Array::matrix(matrix))
    }

    fn new(name: &'static str, array: Array<'a>) -> Self {
        Self { name, array, unit: "", meaning: "" }
    }

    /// Says what the array holds, and in which unit.
    #[must_use]
    pub fn means(self, unit: &'static str, meaning: &'static str) -> Self {
        Self { unit, meaning, ..self }
    }
}

/// A sparse matrix: row, column, value. Sorted by row and column, each place once.
pub type Entries<T> = Vec<(usize, usize, T)>;

/// Adds up entries of the same place.
#[must_use]
pub fn summed<T: Admittivity>(mut entries: Entries<T>) -> Entries<T> {
    use rayon::prelude::*;
    // Stable, so that sums do not depend on the number of cores.
    entries.par_sort_by_key(|&(row, column, _)| (row, column));
    entries.dedup_by(|next, first| {
        let same = (next.0, next.1) == (first.0, first.1);
        if same {
            first.2 = first.2 + next.2;
        }
        same
    });
    entries
}
