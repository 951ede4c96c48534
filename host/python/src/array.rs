//! Array: numbers of the crates as NumPy's arrays, and back. Vectors become arrays without a copy.

use faer::Mat;
use num_complex::Complex64;
use numpy::{Element, PyArray1, PyArray2, PyArrayDyn, PyArrayMethods, PyUntypedArrayMethods, dtype};
use pyo3::{exceptions::PyValueError, prelude::*, types::PyDict};

/// Numbers in a row.
pub(crate) fn list<T: Element>(py: Python<'_>, values: Vec<T>) -> Bound<'_, PyArray1<T>> {
    PyArray1::from_vec(py, values)
}

/// Numbers row after row: `[row][column]`.
pub(crate) fn table<T: Element>(
    py: Python<'_>,
    values: Vec<T>,
    columns: usize,
) -> PyResult<Bound<'_, PyArray2<T>>> {
    let rows = values.len().checked_div(columns).unwrap_or_default();
    list(py, values).reshape([rows, columns])
}

/// Rows of as many numbers each.
pub(crate) fn rows<T: Element + Copy, const N: usize>(
    py: Python<'_>,
    rows: impl IntoIterator<Item = [T; N]>,
) -> PyResult<Bound<'_, PyArray2<T>>> {
    table(py, rows.into_iter().flatten().collect(), N)
}

/// A matrix, copied into the order of C.
pub(crate) fn matrix<'py, T: Element + Copy>(
    py: Python<'py>,
    matrix: &Mat<T>,
) -> PyResult<Bound<'py, PyArray2<T>>> {
    let columns = matrix.ncols();
    let values = (0..matrix.nrows()).flat_map(|row| (0..columns).map(move |column| matrix[(row, column)]));
    table(py, values.collect(), columns)
}

/// Real numbers, or complex ones where they have an imaginary part.
pub(crate) fn real_or_complex(py: Python<'_>, values: Vec<Complex64>, is_complex: bool) -> Bound<'_, PyAny> {
    if is_complex {
        list(py, values).into_any()
    } else {
        list(py, values.into_iter().map(|value| value.re).collect()).into_any()
    }
}

/// Whatever NumPy takes for an array of this type; whole numbers are none of fractions, nor real ones of complex.
fn array_of<'py, T: Element>(any: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyArrayDyn<T>>> {
    let py = any.py();
    let options = PyDict::new(py);
    options.set_item("casting", "same_kind")?;
    options.set_item("copy", false)?;
    let array = py.import("numpy")?.call_method1("asarray", (any,))?;
    Ok(array.call_method("astype", (dtype::<T>(py),), Some(&options))?.cast_into()?)
}

/// A list of numbers.
pub(crate) fn numbers<T: Element + Copy>(any: &Bound<'_, PyAny>, what: &str) -> PyResult<Vec<T>> {
    let refuse = || PyValueError::new_err(format!("{what} must be numbers, one after another"));
    let array = array_of::<T>(any).map_err(|_| refuse())?;
    if array.ndim() != 1 {
        return Err(refuse());
    }
    Ok(array.readonly().as_array().iter().copied().collect())
}

/// A list of numbers, or one number that stands for all of so many.
pub(crate) fn one_or_each<T: Element + Copy>(
    any: &Bound<'_, PyAny>,
    what: &str,
    count: usize,
) -> PyResult<Vec<T>> {
    match array_of::<T>(any) {
        Ok(array) if array.ndim() == 0 => Ok(array
            .readonly()
            .as_array()
            .iter()
            .flat_map(|number| std::iter::repeat_n(*number, count))
            .collect()),
        _ => numbers(any, what),
    }
}

/// Rows of `N` numbers.
pub(crate) fn rows_of<T: Element + Copy + Default, const N: usize>(
    any: &Bound<'_, PyAny>,
    what: &str,
) -> PyResult<Vec<[T; N]>> {
    let refuse = || PyValueError::new_err(format!("{what} must be rows of {N} numbers"));
    let array = array_of::<T>(any).map_err(|_| refuse())?;
    if array.ndim() != 2 || array.shape()[1] != N {
        return Err(refuse());
    }
    let readable = array.readonly();
    let values: Vec<T> = readable.as_array().iter().copied().collect();
    Ok(values.as_chunks::<N>().0.to_vec())
}

/// How many columns an array has; none if it has no two dimensions.
pub(crate) fn columns_of(any: &Bound<'_, PyAny>) -> Option<usize> {
    let array = any.py().import("numpy").ok()?.call_method1("asarray", (any,)).ok()?;
    let (_, columns): (usize, usize) = array.getattr("shape").ok()?.extract().ok()?;
    Some(columns)
}

/// Rows of a type with named fields.
pub(crate) struct Records {
    bytes: Vec<u8>,
}

impl Records {
    pub(crate) fn new() -> Self {
        Self { bytes: Vec::new() }
    }

    /// The next field's bytes.
    pub(crate) fn put<const N: usize>(&mut self, bytes: [u8; N]) -> &mut Self {
        self.bytes.extend_from_slice(&bytes);
        self
    }

    /// The next numbers.
    pub(crate) fn put_all(&mut self, numbers: impl IntoIterator<Item = f32>) -> &mut Self {
        numbers.into_iter().for_each(|number| self.bytes.extend_from_slice(&number.to_le_bytes()));
        self
    }

    /// As an array of that type.
    pub(crate) fn array<'py>(self, of: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
        list(of.py(), self.bytes).call_method1("view", (of,))
    }
}

/// A type with named fields: their names, NumPy's names of their types, and how many each holds.
pub(crate) fn record_type<'py>(
    py: Python<'py>,
    fields: &[(&str, &str, Option<usize>)],
) -> PyResult<Bound<'py, PyAny>> {
    let described = fields.iter().map(|(name, kind, length)| match length {
        Some(length) => (*name, *kind, *length).into_pyobject(py).map(Bound::into_any),
        None => (*name, *kind).into_pyobject(py).map(Bound::into_any),
    });
    let described = described.collect::<PyResult<Vec<_>>>()?;
    let arguments = PyDict::new(py);
    arguments.set_item("align", false)?;
    py.import("numpy")?.getattr("dtype")?.call((described,), Some(&arguments))
}
