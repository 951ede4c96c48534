//! Dermatome for Python: what the crates do, with NumPy's arrays. No arithmetic of its own.
//!
//! [`open`](board::open) a port, or load a [`skin`] or a [`recording`]; frames and models come out as arrays. What waits
//! for a board or computes for long does so without the interpreter's lock, and looks for Ctrl-C meanwhile ([`waiting`]).
//! Types as Python's checkers see them stand in `package/dermatome/_native.pyi`; `./test` compares both.
#![forbid(unsafe_code)]
#![expect(clippy::needless_pass_by_value, reason = "PyO3 hands what Python gives over by value")]

mod array;
mod board;
mod desk;
mod drive;
mod error;
mod frame;
mod mesh;
mod patch;
mod recording;
mod skin;
mod waiting;

use pyo3::prelude::*;

#[pymodule]
mod _native {
    #[pymodule_export]
    use crate::{
        board::{Board, Info, Stream, open, simulate},
        drive::Drive,
        error::Error,
        frame::{Frame, Health},
        mesh::{Mesh, pattern},
        patch::Patch,
        recording::{Arrays, Recording, RecordingIterator},
        skin::{Model, Pose, Skin, read_frames},
    };

    use crate::{frame::contact_type, recording::frame_type};
    use pyo3::prelude::*;

    #[pymodule_init]
    fn init(module: &Bound<'_, PyModule>) -> PyResult<()> {
        let py = module.py();
        module.add("__version__", env!("CARGO_PKG_VERSION"))?;
        module.add("CONTACT", contact_type(py)?)?;
        module.add("FRAME", frame_type(py)?)?;
        module.add("NO_CODE", dermatome_recording::columns::NO_CODE)
    }
}
