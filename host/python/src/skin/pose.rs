//! Pose: where a skin lies on a robot, as Python sees it.

use crate::array::{rows, rows_of};
use dermatome_link::pose;
use numpy::PyArray2;
use pyo3::prelude::*;

/// Where a skin lies on a robot's link: points of its frame are turned, then moved.
#[pyclass(frozen, module = "dermatome")]
pub(crate) struct Pose {
    pub(super) pose: pose::Pose,
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
