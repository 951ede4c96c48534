//! Loaded: a skin file that was read, and its model, which is built once.

use super::Skin;
use crate::{
    error::{of_skin_file, raised},
    waiting::compute,
};
use dermatome_body::surface;
use dermatome_link::{pose, tables::SurfaceTables};
use dermatome_model::{
    model::{Model as Built, ModelError, Solution},
    quantize,
    skin::{self as described, Description},
};
use faer::Mat;
use num_complex::Complex64;
use pyo3::prelude::*;
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
    pub(super) model: Built,
    /// `[step]`.
    pub(super) voltages: Vec<Complex64>,
    /// `[step][pixel]`.
    pub(super) jacobian: Jacobian,
}

pub(super) enum Jacobian {
    Real(Mat<f64>),
    Complex(Mat<Complex64>),
}

impl Loaded {
    pub(super) fn load(path: PathBuf) -> PyResult<Arc<Self>> {
        Self::of(path.clone(), Description::load(&path).map_err(raised)?)
    }

    pub(super) fn of(path: PathBuf, description: Description) -> PyResult<Arc<Self>> {
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
    pub(super) fn model(self: &Arc<Self>, py: Python<'_>) -> PyResult<Arc<Whole>> {
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
        surface::check_name(&self.skin, of_patch).map_err(|error| refuse(&error))?;
        let (this, pixels) = (self.clone(), pixels()?);
        compute(py, move || surface::check_pixels(&this.skin, &pixels))?.map_err(|error| refuse(&error))?;
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
