//! Conductivities of all elements from a file, and the voltages they give.

use crate::array::{Array, ArrayError, Source, file, show_shape};
use dermatome_geometry::mesh::Mesh;
use dermatome_model::{
    forward::{Admittivity, Fields},
    model::{ModelError, forward_model},
    skin::Skin,
};
use num_complex::Complex64;

/// Voltages of a stimulation table.
#[derive(Clone, Debug, PartialEq)]
pub struct Voltages {
    /// Relative, see [`dermatome_model::forward`]: `[step]`.
    pub values: Vec<Complex64>,
    /// Whether they have a quadrature part.
    pub complex: bool,
}

/// Conductivities that cannot be used.
#[derive(Debug, thiserror::Error)]
#[error("cannot read conductivities from `{file}`: {problem}")]
pub struct ConductivityError {
    /// The file, with the key if one was given.
    pub file: String,
    /// What is wrong.
    pub problem: ConductivityProblem,
}

/// Why a file's content is not the conductivity of each element.
#[derive(Debug, thiserror::Error)]
pub enum ConductivityProblem {
    /// No array of numbers.
    #[error(transparent)]
    Read(#[from] ArrayError),
    /// Of another shape.
    #[error("its shape is {shape}; allowed is one value for each of the mesh's {elements} elements")]
    Shape {
        /// The array's shape.
        shape: String,
        /// Elements of the mesh.
        elements: usize,
    },
    /// A value that no material has.
    #[error(
        "the value of element {element} (counted from 0) is {value}; allowed is a finite real part above zero"
    )]
    Value {
        /// The element.
        element: usize,
        /// Its value.
        value: Complex64,
    },
}

/// Reads the relative admittivity of each element, 1 for the untouched sheet's conductivity: `[element]`.
pub fn read(source: &Source, elements: usize) -> Result<Vec<Complex64>, ConductivityError> {
    file::read(source)
        .map_err(ConductivityProblem::from)
        .and_then(|array| check(array, elements))
        .map_err(|problem| ConductivityError { file: source.to_string(), problem })
}

/// One row, one column, or one dimension.
fn check(array: Array<'_>, elements: usize) -> Result<Vec<Complex64>, ConductivityProblem> {
    let fits = matches!(array.shape[..], [n] | [n, 1] | [1, n] if n == elements);
    if !fits {
        return Err(ConductivityProblem::Shape { shape: show_shape(&array.shape), elements });
    }
    let values = array.into_complex();
    match values.iter().position(|value| !(value.is_finite() && value.re > 0.0)) {
        Some(element) => Err(ConductivityProblem::Value { element, value: values[element] }),
        None => Ok(values),
    }
}

/// Voltages of a skin's stimulation table for the relative admittivity of each element.
pub fn voltages(skin: &Skin, mesh: &Mesh, admittivity: &[Complex64]) -> Result<Voltages, ModelError> {
    let steps = skin.steps();
    let complex = admittivity.iter().any(|value| value.im != 0.0);
    let values = if complex {
        fields(skin, mesh, admittivity)?.voltages(&steps)
    } else {
        let real: Vec<f64> = admittivity.iter().map(|value| value.re).collect();
        fields(skin, mesh, &real)?.voltages(&steps).into_iter().map(Complex64::from).collect()
    };
    Ok(Voltages { values, complex })
}

fn fields<T: Admittivity>(skin: &Skin, mesh: &Mesh, admittivity: &[T]) -> Result<Fields<T>, ModelError> {
    Ok(forward_model::<T>(skin, mesh)?.solve(admittivity)?)
}
