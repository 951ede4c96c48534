//! Arrays of numbers and their files: NumPy's ([`npy`], [`npz`]), tables of text (`text`), MATLAB's ([`mat`], `mat_read`),
//! and those of instruments (`sciospec`, `get`).
//!
//! An [`Array`] that was read holds its values; one on its way to a file may compute them one by one as they are
//! written, so that a large matrix is in memory once. [`file::read`] reads whatever file it is given.

pub mod error;
pub mod file;
mod get;
pub mod mat;
mod mat_read;
pub mod npy;
pub mod npz;
mod sciospec;
mod text;

pub use error::ArrayError;
pub use file::Source;

use faer::Mat;
use num_complex::Complex64;

/// Longest file that is read, and longest array inside an archive, bytes.
pub const MAX_BYTES: u64 = 1 << 30;
/// Most values in one array that is read; they take 8 bytes each in memory, complex ones 16.
pub const MAX_VALUES: usize = 1 << 26;

/// Numbers in C order, of any number of dimensions.
pub struct Array<'a> {
    /// Its sides.
    pub shape: Vec<usize>,
    /// Its values.
    pub values: Values<'a>,
}

/// Values of one type.
pub enum Values<'a> {
    /// Indices and signs.
    Integer(Numbers<'a, i64>),
    /// Real numbers.
    Real(Numbers<'a, f64>),
    /// Complex numbers.
    Complex(Numbers<'a, Complex64>),
}

/// Where values come from.
pub enum Numbers<'a, T> {
    /// From memory, in C order.
    Stored(Vec<T>),
    /// Computed from row and column, see [`Array::sides`], each time they are asked for.
    Computed(Box<dyn Fn(usize, usize) -> T + 'a>),
}

impl<T: Copy> Numbers<'_, T> {
    /// The value in a row and column of an array of so many columns.
    fn at(&self, row: usize, column: usize, columns: usize) -> T {
        match self {
            Self::Stored(values) => values[row * columns + column],
            Self::Computed(at) => at(row, column),
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
        Values::Integer(Numbers::Computed(Box::new(move |row, column| at(row, column) as i64)))
    }
}

impl Number for i64 {
    fn values<'a>(at: impl Fn(usize, usize) -> Self + 'a) -> Values<'a> {
        Values::Integer(Numbers::Computed(Box::new(at)))
    }
}

impl Number for f64 {
    fn values<'a>(at: impl Fn(usize, usize) -> Self + 'a) -> Values<'a> {
        Values::Real(Numbers::Computed(Box::new(at)))
    }
}

impl Number for Complex64 {
    fn values<'a>(at: impl Fn(usize, usize) -> Self + 'a) -> Values<'a> {
        Values::Complex(Numbers::Computed(Box::new(at)))
    }
}

impl<'a> Array<'a> {
    /// One dimension, computed.
    pub fn list<T: Number>(length: usize, at: impl Fn(usize) -> T + 'a) -> Self {
        Self { shape: vec![length], values: T::values(move |row, _| at(row)) }
    }

    /// Two dimensions, computed.
    pub fn table<T: Number>(rows: usize, columns: usize, at: impl Fn(usize, usize) -> T + 'a) -> Self {
        Self { shape: vec![rows, columns], values: T::values(at) }
    }

    /// A matrix as it is.
    pub fn matrix<T: Number>(matrix: &'a Mat<T>) -> Self {
        Self::table(matrix.nrows(), matrix.ncols(), |row, column| matrix[(row, column)])
    }

    /// Rows and columns: the first side, and the product of all others. A list is one column.
    #[must_use]
    pub fn sides(&self) -> [usize; 2] {
        let (rows, columns) = self.shape.split_first().unwrap_or((&1, &[]));
        [*rows, columns.iter().product()]
    }

    /// Whether its values are complex.
    #[must_use]
    pub fn is_complex(&self) -> bool {
        matches!(self.values, Values::Complex(_))
    }

    /// Its values in C order.
    #[must_use]
    pub fn into_complex(self) -> Vec<Complex64> {
        let [rows, columns] = self.sides();
        let places = (0..rows).flat_map(|row| (0..columns).map(move |column| (row, column)));
        match self.values {
            Values::Complex(Numbers::Stored(values)) => values,
            Values::Complex(numbers) => places.map(|(r, c)| numbers.at(r, c, columns)).collect(),
            Values::Real(numbers) => places.map(|(r, c)| numbers.at(r, c, columns).into()).collect(),
            Values::Integer(numbers) => {
                places.map(|(r, c)| (numbers.at(r, c, columns) as f64).into()).collect()
            }
        }
    }
}

/// A shape as Python writes it.
#[must_use]
pub fn show_shape<T: ToString>(shape: &[T]) -> String {
    let sides: Vec<_> = shape.iter().map(ToString::to_string).collect();
    format!("({}{})", sides.join(", "), if sides.len() == 1 { "," } else { "" })
}
