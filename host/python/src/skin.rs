//! Skin: a skin file, and the model that is built of it.

use crate::{
    array::{columns_of, list, matrix, numbers, real_or_complex, rows, rows_of, table},
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
use dermatome_link::{pose, tables::SurfaceTables};
use dermatome_model::{
    model::{self, Model as Built, ModelError, Solution},
    quantize,
    skin::{self as described, Description},
};
use dermatome_shared::stimulation::Step;
use faer::Mat;
use num_complex::Complex64;
use numpy::{PyArray1, PyArray2};
use pyo3::{exceptions::PyValueError, prelude::*};
use std::{
    fmt::Display,
    path::{Path, PathBuf},
    sync::{Arc, OnceLock},
};

/// A skin file, read and checked.
pub(crate) struct Loaded {
    path: PathBuf,
    skin: described::Skin,
    /// Built when it is first asked for.
    model: OnceLock<Arc<Whole>>,
}

/// A skin's model, before and after reciprocal steps are averaged.
pub(crate) struct Whole {
    model: Built,
    /// `[step]`.
    voltages: Vec<Complex64>,
    /// `[step][pixel]`.
    jacobian: Jacobian,
}

enum Jacobian {
    Real(Mat<f64>),
    Complex(Mat<Complex64>),
}

impl Loaded {
    fn load(path: PathBuf) -> PyResult<Arc<Self>> {
        Self::of(path.clone(), Description::load(&path).map_err(raised)?)
    }

    fn of(path: PathBuf, description: Description) -> PyResult<Arc<Self>> {
        let skin = description.made().map_err(raised)?;
        Ok(Arc::new(Self { path, skin, model: OnceLock::new() }))
    }

    pub(crate) fn path(&self) -> &Path {
        &self.path
    }

    pub(crate) fn described(&self) -> &described::Skin {
        &self.skin
    }

    /// The model, built once.
    fn model(self: &Arc<Self>, py: Python<'_>) -> PyResult<Arc<Whole>> {
        if let Some(model) = self.model.get() {
            return Ok(model.clone());
        }
        let this = self.clone();
        let built = compute(py, move || Whole::build(&this.skin))?;
        let built = Arc::new(built.map_err(|error| of_skin_file(&self.path)(&error))?);
        Ok(self.model.get_or_init(|| built).clone())
    }

    /// Its patch.
    pub(crate) fn patch_bytes(self: &Arc<Self>, py: Python<'_>) -> PyResult<Vec<u8>> {
        let (this, model) = (self.clone(), self.model(py)?);
        let patch = compute(py, move || quantize::patch(&this.skin, &model.model))?;
        patch.map_err(|error| of_skin_file(&self.path)(&error))
    }

    /// Its pose, where it is the skin of a patch with this name and these pixels.
    pub(crate) fn pose_on(
        self: &Arc<Self>,
        py: Python<'_>,
        of_patch: &str,
        pixels: impl FnOnce() -> PyResult<SurfaceTables>,
    ) -> PyResult<pose::Pose> {
        let refuse = |words: &dyn Display| of_skin_file(&self.path)(words);
        let Some(pose) = &self.skin.pose else {
            return Err(refuse(&"`pose` is missing; allowed: a table `[pose]` as `dermatome cut` writes it"));
        };
        check_name(&self.skin, of_patch).map_err(|error| refuse(&error))?;
        let (this, pixels) = (self.clone(), pixels()?);
        let checked = compute(py, move || check_pixels(&this.skin, &pixels))?;
        checked.map_err(|error| refuse(&error))?;
        Ok(pose.clone())
    }
}

impl Whole {
    fn build(skin: &described::Skin) -> Result<Self, ModelError> {
        let mut solution = None;
        let model = Built::build_beside(skin, &mut drop, &mut |solved| solution = Some(solved), &mut |_| ())?;
        let (voltages, jacobian) = match solution.expect("a model that is built was solved") {
            Solution::Real(solved) => {
                let voltages = solved.voltages.into_iter().map(Complex64::from).collect();
                (voltages, Jacobian::Real(solved.jacobian))
            }
            Solution::Complex(solved) => (solved.voltages, Jacobian::Complex(solved.jacobian)),
        };
        Ok(Self { model, voltages, jacobian })
    }
}

/// A skin, or the file that describes it.
#[derive(FromPyObject)]
pub(crate) enum SkinOrPath {
    Skin(Py<Skin>),
    Path(PathBuf),
}

impl SkinOrPath {
    pub(crate) fn load(self, py: Python<'_>) -> PyResult<Arc<Loaded>> {
        match self {
            Self::Skin(skin) => Ok(skin.get().loaded.clone()),
            Self::Path(path) => compute(py, move || Loaded::load(path))?,
        }
    }
}

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

    fn whole(&self, py: Python<'_>) -> PyResult<Arc<Whole>> {
        self.loaded.model(py)
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
        &self.loaded.skin.name
    }

    /// Electrodes.
    #[getter]
    fn electrodes(&self) -> u8 {
        self.loaded.skin.electrodes.count
    }

    /// Stimulation table: uint8 [step][drive plus, drive minus, sense plus, sense minus], electrodes from 0.
    #[getter]
    fn steps<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<u8>>> {
        rows(py, self.loaded.skin.steps().into_iter().map(Step::to_bytes))
    }

    /// Times this, voltages of the model are volts: drive amplitude over sheet conductivity.
    #[getter]
    fn volts_per_unit(&self) -> f64 {
        self.loaded.skin.drive.amplitude / self.loaded.skin.material.sheet_conductivity
    }

    /// Where it lies on a robot, if its file says so.
    #[getter]
    fn pose(&self) -> Option<Pose> {
        self.loaded.skin.pose.clone().map(|pose| Pose { pose })
    }

    /// Its mesh, with electrodes.
    fn mesh(&self, py: Python<'_>) -> PyResult<Mesh> {
        let loaded = self.loaded.clone();
        let mesh = compute(py, move || model::mesh(&loaded.skin, 1.0, Lattice::default()))?;
        Ok((&mesh.map_err(|error| of_skin_file(&self.loaded.path)(&error))?).into())
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
            let skin = &loaded.skin;
            let mesh = model::mesh(skin, 1.0, Lattice::default())?;
            let untouched = || vec![skin.admittivity(); mesh.elements.len()];
            conductivity::voltages(skin, &mesh, &given.unwrap_or_else(untouched))
        })?;
        let voltages = voltages.map_err(|error| of_skin_file(&self.loaded.path)(&error))?;
        Ok(real_or_complex(py, voltages.values, voltages.complex))
    }

    /// Everything that is computed of it, once: mesh, pixels, Jacobian, reconstruction matrix.
    fn model(&self, py: Python<'_>) -> PyResult<Model> {
        Ok(Model { whole: self.whole(py)? })
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
        format!("<Skin {}, {} electrodes>", self.loaded.skin.name, self.loaded.skin.electrodes.count)
    }
}

/// A skin's model. Voltages are at unit current through a sheet of unit conductivity; arrays are named as `dermatome export`
/// names them, and made anew each time they are asked for.
#[pyclass(frozen, module = "dermatome")]
pub(crate) struct Model {
    whole: Arc<Whole>,
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
    fn jacobian<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        Ok(match &self.whole.jacobian {
            Jacobian::Real(jacobian) => matrix(py, jacobian)?.into_any(),
            Jacobian::Complex(jacobian) => matrix(py, jacobian)?.into_any(),
        })
    }

    /// Relative conductivity change from difference data: float64 [pixel][measurement].
    #[getter]
    fn reconstruction_matrix<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
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

/// Where a skin lies on a robot's link: points of its frame are turned, then moved.
#[pyclass(frozen, module = "dermatome")]
pub(crate) struct Pose {
    pose: pose::Pose,
}

#[pymethods]
impl Pose {
    /// Name of the link's frame.
    #[getter]
    fn link(&self) -> &str {
        &self.pose.link
    }

    /// The skin's origin in the link's frame, m.
    #[getter]
    fn position(&self) -> (f64, f64, f64) {
        self.pose.position.into()
    }

    /// Turn from the skin's frame to the link's: a unit quaternion x, y, z, w.
    #[getter]
    fn orientation(&self) -> (f64, f64, f64, f64) {
        self.pose.orientation.into()
    }

    /// Points of the skin's frame in the link's, m: float64 [point][x, y, z].
    fn points<'py>(
        &self,
        py: Python<'py>,
        points: &Bound<'py, PyAny>,
    ) -> PyResult<Bound<'py, PyArray2<f64>>> {
        rows(py, rows_of::<f64, 3>(points, "points")?.into_iter().map(|point| self.pose.point(point)))
    }

    fn __repr__(&self) -> String {
        let pose::Pose { link, position, orientation } = &self.pose;
        format!("<Pose on {link} at {position:?} m, turned by {orientation:?}>")
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
