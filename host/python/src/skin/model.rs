//! Model: what is computed of a skin, as arrays.

use super::loaded::{Jacobian, Whole};
use crate::{
    array::{columns_of, list, matrix, numbers, real_or_complex, rows, table},
    mesh::Mesh,
};
use dermatome_model::model::Model as Built;
use numpy::{PyArray1, PyArray2};
use pyo3::{exceptions::PyValueError, prelude::*};
use std::sync::Arc;

/// A skin's model. Voltages are at unit current through a sheet of unit conductivity; arrays are named as `dermatome export`
/// names them, and made anew each time they are asked for.
#[pyclass(frozen, module = "dermatome")]
pub(crate) struct Model {
    pub(super) whole: Arc<Whole>,
}

impl Model {
    fn built(&self) -> &Built {
        &self.whole.model
    }

    /// Frames and a reference, both by steps, through `of`; one row comes back for each frame.
    fn each_frame<'py>(
        &self,
        frames: &Bound<'py, PyAny>,
        reference: &Bound<'py, PyAny>,
        of: impl Fn(&[f64], &[f64]) -> Vec<f64>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let (py, steps) = (frames.py(), self.built().steps.len());
        let check = |what: &str, found: usize| match found == steps {
            true => Ok(()),
            false => Err(PyValueError::new_err(format!("{what} has {found} steps, the skin {steps}"))),
        };
        let reference = numbers::<f64>(reference, "reference")?;
        check("reference", reference.len())?;
        let of_frame = |frame: &[f64]| {
            let change: Vec<f64> = frame.iter().zip(&reference).map(|(v, r)| v - r).collect();
            of(&change, &reference)
        };
        let Some(columns) = columns_of(frames) else {
            let frame = numbers::<f64>(frames, "frames")?;
            check("frame", frame.len())?;
            return Ok(list(py, of_frame(&frame)).into_any());
        };
        check("frame", columns)?;
        let frames = numbers::<f64>(&frames.call_method0("ravel")?, "frames")?;
        let results: Vec<Vec<f64>> = frames.chunks_exact(steps).map(of_frame).collect();
        let columns = results.first().map_or(0, Vec::len);
        Ok(table(py, results.concat(), columns)?.into_any())
    }
}

#[pymethods]
impl Model {
    /// The mesh, with electrodes.
    #[getter]
    fn mesh(&self) -> Mesh {
        (&self.built().mesh).into()
    }

    /// Of the untouched skin: [step], float64 or complex128.
    #[getter]
    fn voltages<'py>(&self, py: Python<'py>) -> Bound<'py, PyAny> {
        let is_complex = matches!(self.whole.jacobian, Jacobian::Complex(_));
        real_or_complex(py, self.whole.voltages.clone(), is_complex)
    }

    /// d voltage / d relative conductivity: [step][pixel], float64 or complex128.
    #[getter]
    pub(super) fn jacobian<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        Ok(match &self.whole.jacobian {
            Jacobian::Real(jacobian) => matrix(py, jacobian)?.into_any(),
            Jacobian::Complex(jacobian) => matrix(py, jacobian)?.into_any(),
        })
    }

    /// Relative conductivity change from difference data: float64 [pixel][measurement].
    #[getter]
    pub(super) fn reconstruction_matrix<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        matrix(py, &self.built().conductivity_from_difference)
    }

    /// Stimulation table: uint8 [step][drive plus, drive minus, sense plus, sense minus], electrodes from 0.
    #[getter]
    fn stimulation<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<u8>>> {
        rows(py, self.built().steps.iter().map(|step| step.to_bytes()))
    }

    /// Measurement that each step is averaged into: int64 [step].
    #[getter]
    fn step_measurement<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<i64>> {
        list(py, self.built().combination.iter().map(|into| into.measurement.into()).collect())
    }

    /// Sign with which each step is averaged, 1 or -1: int64 [step].
    #[getter]
    fn step_sign<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<i64>> {
        list(py, self.built().combination.iter().map(|into| if into.flipped { -1 } else { 1 }).collect())
    }

    /// The hyperparameter used.
    #[getter]
    fn hyperparameter(&self) -> f64 {
        self.built().hyperparameter
    }

    /// Noise figure of the matrix.
    #[getter]
    fn noise_figure(&self) -> f64 {
        self.built().noise_figure()
    }

    /// Centres of the pixels in the skin's frame, m: float64 [pixel][x, y, z].
    #[getter]
    fn pixel_centre<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        rows(py, self.built().pixels.centres.iter().map(|centre| centre.coords.into()))
    }

    /// Unit normals of the surface: float64 [pixel][x, y, z].
    #[getter]
    fn pixel_normal<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        rows(py, self.built().pixels.normals.iter().map(|normal| (*normal).into()))
    }

    /// Areas of the pixels, m^2: float64 [pixel].
    #[getter]
    fn pixel_area<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        list(py, self.built().pixels.areas.clone())
    }

    /// Difference data of voltages against a reference, both by steps in any one unit, as a board computes them:
    /// [measurement], or [frame][measurement] of several frames.
    fn difference<'py>(
        &self,
        frames: &Bound<'py, PyAny>,
        reference: &Bound<'py, PyAny>,
    ) -> PyResult<Bound<'py, PyAny>> {
        self.each_frame(frames, reference, |change, reference| {
            self.built().difference_data(change, reference)
        })
    }

    /// Images of voltages against a reference, both by steps in any one unit: relative conductivity change, [pixel], or
    /// [frame][pixel] of several frames.
    fn image<'py>(
        &self,
        frames: &Bound<'py, PyAny>,
        reference: &Bound<'py, PyAny>,
    ) -> PyResult<Bound<'py, PyAny>> {
        self.each_frame(frames, reference, |change, reference| self.built().image(change, reference))
    }

    fn __repr__(&self) -> String {
        let matrix = &self.built().conductivity_from_difference;
        format!("<Model {} pixels from {} measurements>", matrix.nrows(), matrix.ncols())
    }
}
