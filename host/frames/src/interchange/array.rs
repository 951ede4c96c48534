//! Arrays on their way to a file: values are made one by one as they are written, in either order.

use dermatome_model::forward::Admittivity;
use faer::Mat;
use num_complex::Complex64;

/// A named array of one or two dimensions.
pub struct Array<'a> {
    /// Name of the file and of the variable.
    pub name: &'static str,
    /// Its sides.
    pub shape: Vec<usize>,
    /// Its values.
    pub values: Values<'a>,
    /// Unit of the values; empty for a pure number.
    pub unit: &'static str,
    /// What it holds.
    pub meaning: &'static str,
}

/// Values by row and column; the column is 0 in one dimension.
pub enum Values<'a> {
    /// Indices and signs.
    Integer(Box<dyn Fn(usize, usize) -> i64 + 'a>),
    /// Real numbers.
    Real(Box<dyn Fn(usize, usize) -> f64 + 'a>),
    /// Complex numbers.
    Complex(Box<dyn Fn(usize, usize) -> Complex64 + 'a>),
}

impl Values<'_> {
    /// NumPy's name of the type, little-endian.
    #[must_use]
    pub fn type_name(&self) -> &'static str {
        match self {
            Self::Integer(_) => "<i8",
            Self::Real(_) => "<f8",
            Self::Complex(_) => "<c16",
        }
    }
}

/// A number that an array may hold.
pub trait Number: Copy {
    /// Values of this kind.
    fn values<'a>(at: impl Fn(usize, usize) -> Self + 'a) -> Values<'a>;
}

impl Number for usize {
    fn values<'a>(at: impl Fn(usize, usize) -> Self + 'a) -> Values<'a> {
        Values::Integer(Box::new(move |row, column| at(row, column) as i64))
    }
}

impl Number for i64 {
    fn values<'a>(at: impl Fn(usize, usize) -> Self + 'a) -> Values<'a> {
        Values::Integer(Box::new(at))
    }
}

impl Number for f64 {
    fn values<'a>(at: impl Fn(usize, usize) -> Self + 'a) -> Values<'a> {
        Values::Real(Box::new(at))
    }
}

impl Number for Complex64 {
    fn values<'a>(at: impl Fn(usize, usize) -> Self + 'a) -> Values<'a> {
        Values::Complex(Box::new(at))
    }
}

impl<'a> Array<'a> {
    /// One dimension.
    pub fn list<T: Number>(name: &'static str, length: usize, at: impl Fn(usize) -> T + 'a) -> Self {
        Self::new(name, vec![length], T::values(move |row, _| at(row)))
    }

    /// Two dimensions.
    pub fn table<T: Number>(
        name: &'static str,
        rows: usize,
        columns: usize,
        at: impl Fn(usize, usize) -> T + 'a,
    ) -> Self {
        Self::new(name, vec![rows, columns], T::values(at))
    }

    /// A matrix as it is.
    pub fn matrix<T: Number>(name: &'static str, matrix: &'a Mat<T>) -> Self {
        Self::table(name, matrix.nrows(), matrix.ncols(), |row, column| matrix[(row, column)])
    }

    fn new(name: &'static str, shape: Vec<usize>, values: Values<'a>) -> Self {
        Self { name, shape, values, unit: "", meaning: "" }
    }

    /// Says what the array holds, and in which unit.
    #[must_use]
    pub fn means(self, unit: &'static str, meaning: &'static str) -> Self {
        Self { unit, meaning, ..self }
    }

    /// Rows and columns; a list is one column.
    #[must_use]
    pub fn sides(&self) -> [usize; 2] {
        [self.shape[0], self.shape.get(1).copied().unwrap_or(1)]
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
