//! Recording: frames of a file, one by one or side by side as arrays.

use crate::{
    array::{Records, list, record_type, table},
    board::source_in_words,
    error::raised,
    frame::{Frame, contacts, seconds},
    patch::Patch,
    skin::Skin,
};
use dermatome_recording::{
    columns::Columns,
    frames::{Frames, Item, Parts},
    read::{Problem, ReadError, Recording as File},
    session::Session,
};
use numpy::{PyArray1, PyArray2};
use pyo3::{prelude::*, sync::PyOnceLock};
use std::{
    path::{Path, PathBuf},
    sync::{Mutex, PoisonError},
};

/// NumPy's type of a recorded frame without its parts.
const FIELDS: [(&str, &str, Option<usize>); 5] = [
    ("sequence", "<u4", None),
    ("time", "<f8", None),
    ("received", "<M8[ns]", None),
    ("flags", "<u2", None),
    ("reference", "<u4", None),
];

/// NumPy's type of a recorded frame, made once.
pub(crate) fn frame_type(py: Python<'_>) -> PyResult<&Bound<'_, PyAny>> {
    static TYPE: PyOnceLock<Py<PyAny>> = PyOnceLock::new();
    TYPE.get_or_try_init(py, || Ok(record_type(py, &FIELDS)?.unbind())).map(|kind| kind.bind(py))
}

/// Frames that are read before Python is asked for Ctrl-C: some tens of milliseconds.
const FRAMES_AT_ONCE: usize = 1000;

/// A recording: iterate over its frames, or take them all as arrays, a row for each frame.
///
/// Of a file of several skins, which `serve --record` makes, one is named behind it: `Recording("run.mcap:palm")`.
/// A method that gives arrays reads the file once; `read` gives several in one go. Contacts are in the skin's frame, or in
/// that of the robot's link where the recording was made with a skin file with a [pose].
#[pyclass(frozen, module = "dermatome")]
pub(crate) struct Recording {
    path: PathBuf,
    session: Session,
    patch: Py<Patch>,
}

#[pymethods]
impl Recording {
    #[new]
    fn new(py: Python<'_>, path: PathBuf) -> PyResult<Self> {
        let file = File::open(&path).map_err(raised)?;
        let session = file.session().clone();
        let patch = Patch::new(session.patch.clone());
        let patch = patch.map_err(|error| raised(file.refuse(Problem::Patch(error))))?;
        Ok(Self { path, session, patch: Py::new(py, patch)? })
    }

    /// The file.
    #[getter]
    fn path(&self) -> &Path {
        &self.path
    }

    /// The patch that the board used.
    #[getter]
    fn patch(&self, py: Python<'_>) -> Py<Patch> {
        self.patch.clone_ref(py)
    }

    /// The skin, where the recording holds its skin file.
    #[getter]
    fn skin(&self) -> PyResult<Option<Skin>> {
        let parse = |text: &String| Skin::parse(Path::new("skin.toml"), text);
        self.session.skin_file.as_ref().map(parse).transpose()
    }

    /// Kind of board.
    #[getter]
    fn board(&self) -> &str {
        &self.session.board
    }

    /// Version of its firmware.
    #[getter]
    fn firmware(&self) -> &str {
        &self.session.firmware
    }

    /// The port that it was at.
    #[getter]
    fn port(&self) -> &str {
        &self.session.port
    }

    /// Where its frames come from: "skin", "simulated" or "synthetic", which are numbers without meaning.
    #[getter]
    fn frame_source(&self) -> &'static str {
        source_in_words(self.session.frame_source)
    }

    fn __iter__(&self) -> PyResult<RecordingIterator> {
        Ok(RecordingIterator { frames: Mutex::new(self.frames_with(Parts::ALL).map_err(raised)?) })
    }

    /// Several columns in one go.
    #[pyo3(signature = (*, measurements=true, images=true, contacts=true))]
    fn read(&self, py: Python<'_>, measurements: bool, images: bool, contacts: bool) -> PyResult<Arrays> {
        let wanted = Parts { codes: measurements, images, contacts, health: false };
        Arrays::new(py, self.columns(py, wanted)?)
    }

    /// An array of `dermatome.FRAME`: which frames there are, and when.
    fn frames<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        frames_of(py, &self.columns(py, Parts::NONE)?)
    }

    /// When scans ended, s of the board's clock: float64 [frame].
    fn times<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray1<f64>>> {
        let columns = self.columns(py, Parts::NONE)?;
        Ok(list(py, columns.at.into_iter().map(seconds).collect()))
    }

    /// Codes in phase with the current: int32 [frame][step]; `dermatome.NO_CODE` where they were not recorded.
    fn measurements<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<i32>>> {
        let columns = self.columns(py, Parts { codes: true, ..Parts::NONE })?;
        table(py, columns.in_phase, columns.steps)
    }

    /// Codes in quadrature, likewise.
    fn quadrature<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<i32>>> {
        let columns = self.columns(py, Parts { codes: true, ..Parts::NONE })?;
        table(py, columns.quadrature, columns.steps)
    }

    /// Relative conductivity change: float32 [frame][pixel]; NaN where the board made no image.
    fn images<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f32>>> {
        let columns = self.columns(py, Parts { images: true, ..Parts::NONE })?;
        table(py, columns.images, columns.pixels)
    }

    /// All contacts of all frames: an array of `dermatome.CONTACT`.
    fn contacts<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        contacts_of(py, &self.columns(py, Parts { contacts: true, ..Parts::NONE })?)
    }

    fn __repr__(&self) -> String {
        let Session { skin, board, .. } = &self.session;
        format!("<Recording {}: {skin} on {board}>", self.path.display())
    }
}

impl Recording {
    fn frames_with(&self, wanted: Parts) -> Result<Frames, ReadError> {
        Ok(Frames::of(File::open(&self.path)?).only(wanted))
    }

    /// The columns of these parts, read without the interpreter's lock.
    fn columns(&self, py: Python<'_>, wanted: Parts) -> PyResult<Columns> {
        let mut frames = self.frames_with(wanted).map_err(raised)?;
        let mut columns = Columns::new(&self.patch.get().view()?, wanted);
        loop {
            let more;
            (frames, columns, more) = py.detach(move || {
                let more = read_some(&mut frames, &mut columns);
                (frames, columns, more)
            });
            if !more.map_err(raised)? {
                return Ok(columns);
            }
            py.check_signals()?;
        }
    }
}

/// Reads some frames; false at the end.
fn read_some(frames: &mut Frames, columns: &mut Columns) -> Result<bool, ReadError> {
    for _ in 0..FRAMES_AT_ONCE {
        let Some(item) = frames.next_item()? else { return Ok(false) };
        columns.take(&item).map_err(|problem| frames.recording().refuse(problem))?;
    }
    Ok(true)
}

fn frames_of<'py>(py: Python<'py>, columns: &Columns) -> PyResult<Bound<'py, PyAny>> {
    let mut records = Records::new();
    for ((at, log_time), reference) in columns.at.iter().zip(&columns.log_times).zip(&columns.references) {
        records
            .put(at.sequence.to_le_bytes())
            .put(seconds(*at).to_le_bytes())
            .put(log_time.to_le_bytes())
            .put(at.flags.0.to_le_bytes())
            .put(reference.to_le_bytes());
    }
    records.array(frame_type(py)?)
}

fn contacts_of<'py>(py: Python<'py>, columns: &Columns) -> PyResult<Bound<'py, PyAny>> {
    contacts(py, columns.contacts.iter().map(|&(row, contact)| (columns.at[row], contact)))
}

/// Columns of a recording, a row for each frame; None for what was not asked for.
#[pyclass(frozen, get_all, module = "dermatome")]
pub(crate) struct Arrays {
    /// An array of `dermatome.FRAME`.
    frames: Py<PyAny>,
    /// int32 [frame][step].
    measurements: Option<Py<PyArray2<i32>>>,
    /// int32 [frame][step].
    quadrature: Option<Py<PyArray2<i32>>>,
    /// float32 [frame][pixel].
    images: Option<Py<PyArray2<f32>>>,
    /// All contacts of all frames: an array of `dermatome.CONTACT`.
    contacts: Option<Py<PyAny>>,
}

impl Arrays {
    fn new(py: Python<'_>, columns: Columns) -> PyResult<Self> {
        let wanted = columns.wanted();
        let frames = frames_of(py, &columns)?.unbind();
        let contacts = if wanted.contacts { Some(contacts_of(py, &columns)?.unbind()) } else { None };
        let Columns { steps, pixels, in_phase, quadrature, images, .. } = columns;
        let codes =
            |codes| if wanted.codes { table(py, codes, steps).map(|of| Some(of.unbind())) } else { Ok(None) };
        Ok(Self {
            frames,
            measurements: codes(in_phase)?,
            quadrature: codes(quadrature)?,
            images: if wanted.images { Some(table(py, images, pixels)?.unbind()) } else { None },
            contacts,
        })
    }
}

/// The frames of a recording, one by one.
#[pyclass(frozen, module = "dermatome")]
pub(crate) struct RecordingIterator {
    frames: Mutex<Frames>,
}

#[pymethods]
impl RecordingIterator {
    fn __iter__(this: Py<Self>) -> Py<Self> {
        this
    }

    fn __next__(&self, py: Python<'_>) -> PyResult<Option<Frame>> {
        let next = py.detach(|| {
            let mut frames = self.frames.lock().unwrap_or_else(PoisonError::into_inner);
            loop {
                match frames.next_item() {
                    Ok(Some(Item::Frame(frame))) => return Ok(Some(frame)),
                    Ok(Some(Item::Reference(_))) => {}
                    Ok(None) => return Ok(None),
                    Err(error) => return Err(error),
                }
            }
        });
        next.map_err(raised)?.map(|frame| Frame::of_recording(py, &frame)).transpose()
    }
}
