//! Skin: a skin file, and the model that is built of it.

mod loaded;
mod model;
mod pose;

pub(crate) use loaded::{Loaded, SkinOrPath};
pub(crate) use model::Model;
pub(crate) use pose::Pose;

use crate::{
    array::{numbers, real_or_complex, rows, table},
    error::{of_skin_file, raised},
    mesh::Mesh,
    patch::Patch,
    waiting::compute,
};
use dermatome_frames::{
    array::Source,
    interchange::conductivity,
    recorded::read::{self, Frames},
};
use dermatome_geometry::mesh::Lattice;
use dermatome_model::{model::mesh, skin::Description};
use dermatome_shared::stimulation::Step;
use num_complex::Complex64;
use numpy::PyArray2;
use pyo3::prelude::*;
use std::{
    path::{Path, PathBuf},
    sync::Arc,
};

/// A skin, as its file describes it: `Skin.load("skin.toml")`.
#[pyclass(frozen, module = "dermatome")]
pub(crate) struct Skin {
    loaded: Arc<Loaded>,
}

impl Skin {
    /// Of the text of a skin file, which is called so.
    pub(crate) fn parse(path: &Path, text: &str) -> PyResult<Self> {
        let description = Description::parse(path, text).map_err(raised)?;
        Ok(Self { loaded: Loaded::of(path.to_owned(), description)? })
    }
}

#[pymethods]
impl Skin {
    /// Reads and checks a skin file.
    #[staticmethod]
    fn load(py: Python<'_>, path: PathBuf) -> PyResult<Self> {
        Ok(Self { loaded: SkinOrPath::Path(path).load(py)? })
    }

    /// Its name.
    #[getter]
    fn name(&self) -> &str {
        &self.loaded.described().name
    }

    /// Electrodes.
    #[getter]
    fn electrodes(&self) -> u8 {
        self.loaded.described().electrodes.count
    }

    /// Stimulation table: uint8 [step][drive plus, drive minus, sense plus, sense minus], electrodes from 0.
    #[getter]
    fn steps<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<u8>>> {
        rows(py, self.loaded.described().steps().into_iter().map(Step::to_bytes))
    }

    /// Times this, voltages of the model are volts: drive amplitude over sheet conductivity.
    #[getter]
    fn volts_per_unit(&self) -> f64 {
        self.loaded.described().drive.amplitude / self.loaded.described().material.sheet_conductivity
    }

    /// Where it lies on a robot, if its file says so.
    #[getter]
    fn pose(&self) -> Option<Pose> {
        self.loaded.described().pose.clone().map(|pose| Pose { pose })
    }

    /// Its mesh, with electrodes.
    fn mesh(&self, py: Python<'_>) -> PyResult<Mesh> {
        let loaded = self.loaded.clone();
        let mesh = compute(py, move || mesh(loaded.described(), 1.0, Lattice::default()))?;
        Ok((&mesh.map_err(|error| of_skin_file(self.loaded.path())(&error))?).into())
    }

    /// Voltages of its steps at unit current through a sheet of unit conductivity: [step], float64 or complex128.
    ///
    /// `conductivity` is relative to the untouched sheet's: one number for each element of `mesh()`, complex for an
    /// admittivity. Without it the skin is untouched.
    #[pyo3(signature = (conductivity=None))]
    fn forward<'py>(
        &self,
        py: Python<'py>,
        conductivity: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let given = conductivity.map(|given| numbers::<Complex64>(given, "conductivity")).transpose()?;
        let loaded = self.loaded.clone();
        let voltages = compute(py, move || {
            let skin = loaded.described();
            let mesh = mesh(skin, 1.0, Lattice::default())?;
            let untouched = || vec![skin.admittivity(); mesh.elements.len()];
            conductivity::voltages(skin, &mesh, &given.unwrap_or_else(untouched))
        })?;
        let voltages = voltages.map_err(|error| of_skin_file(self.loaded.path())(&error))?;
        Ok(real_or_complex(py, voltages.values, voltages.complex))
    }

    /// Everything that is computed of it, once: mesh, pixels, Jacobian, reconstruction matrix.
    fn model(&self, py: Python<'_>) -> PyResult<Model> {
        Ok(Model { whole: self.loaded.model(py)? })
    }

    /// As `model().jacobian`.
    fn jacobian<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        self.model(py)?.jacobian(py)
    }

    /// As `model().reconstruction_matrix`.
    fn reconstruction_matrix<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        self.model(py)?.reconstruction_matrix(py)
    }

    /// Its patch, for a board; written to a file if one is named.
    #[pyo3(signature = (path=None))]
    fn build_patch(&self, py: Python<'_>, path: Option<PathBuf>) -> PyResult<Patch> {
        let patch = Patch::new(self.loaded.patch_bytes(py)?).map_err(raised)?;
        path.map_or(Ok(()), |path| patch.save(path))?;
        Ok(patch)
    }

    fn __repr__(&self) -> String {
        format!(
            "<Skin {}, {} electrodes>",
            self.loaded.described().name,
            self.loaded.described().electrodes.count
        )
    }
}

/// Frames that another instrument has recorded, in its unit: [frame][measurement], float64 or complex128.
///
/// Reads .npy, .npz and .mat (`FILE.npz:KEY`), .csv, .txt, .get, Sciospec's .eit and folders of those.
#[pyfunction]
pub(crate) fn read_frames(py: Python<'_>, path: PathBuf) -> PyResult<Bound<'_, PyAny>> {
    let read = compute(py, move || read::read(&Source::new(path.as_os_str())))?;
    let Frames { values, measurements, complex, .. } = read.map_err(raised)?;
    if complex {
        return Ok(table(py, values, measurements)?.into_any());
    }
    Ok(table(py, values.into_iter().map(|value| value.re).collect(), measurements)?.into_any())
}
