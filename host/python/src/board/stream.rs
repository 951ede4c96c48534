//! Stream: frames of a board, for whoever iterates.

use crate::{
    desk::{Desk, Queue},
    error::raised,
    frame::Frame,
};
use dermatome_link::pose::Pose;
use pyo3::{exceptions::PyRuntimeWarning, prelude::*};
use std::{ffi::CString, sync::Arc};

/// Frames as they come; the board stops when this is closed, or forgotten.
#[pyclass(frozen, module = "dermatome")]
pub(crate) struct Stream {
    pub(super) queue: Arc<Queue>,
    pub(super) pose: Option<Pose>,
    /// The port stays open as long as somebody listens.
    pub(super) _desk: Arc<Desk>,
}

#[pymethods]
impl Stream {
    fn __iter__(this: Py<Self>) -> Py<Self> {
        this
    }

    fn __next__(&self, py: Python<'_>) -> PyResult<Option<Frame>> {
        while let Some((frame, came)) = self.queue.take(py)? {
            if let Some(words) = self.queue.take_warning() {
                PyErr::warn(
                    py,
                    &py.get_type::<PyRuntimeWarning>(),
                    &CString::new(words).map_err(raised)?,
                    1,
                )?;
            }
            if let Some(frame) = Frame::of_board(py, &frame, came, self.pose.as_ref())? {
                return Ok(Some(frame));
            }
        }
        Ok(None)
    }

    /// Frames that did not come from the board, as its numbers tell.
    #[getter]
    fn lost(&self) -> u64 {
        self.queue.losses()[0]
    }

    /// Frames that came and were dropped, because they were not fetched in time.
    #[getter]
    fn dropped(&self) -> u64 {
        self.queue.losses()[1]
    }

    /// Ends the stream.
    fn close(&self) {
        self.queue.leave();
    }

    fn __enter__(this: Py<Self>) -> Py<Self> {
        this
    }

    #[pyo3(signature = (*_exception))]
    fn __exit__(&self, _exception: &Bound<'_, PyAny>) {
        self.close();
    }
}

impl Drop for Stream {
    fn drop(&mut self) {
        self.queue.leave();
    }
}
