//! Board: a port that is open, be it a real board's, a simulated one's or a recording's.

mod info;
mod simulated;
mod stream;

pub(crate) use info::{Info, source_in_words};
pub(crate) use simulated::simulate;
pub(crate) use stream::Stream;

use crate::{
    desk::{Desk, WhenFull},
    drive::{Drive, GainOrWord, component_of},
    error::raised,
    patch::Patch,
    skin::SkinOrPath,
};
use dermatome_link::{self as link, Link, LinkError, LinkErrorKind};
use dermatome_shared::{
    protocol::{PatchInfo, Refusal, Request, Selection},
    reference::DEFAULT_TARE_FRAMES,
};
use dermatome_simulate::port::{self, Port};
use pyo3::{exceptions::PyValueError, prelude::*};
use std::{path::PathBuf, sync::Arc};

// Python shows defaults only where they are numbers as such.
const _: () = assert!(DEFAULT_TARE_FRAMES == 20);

/// Opens a board: `/dev/ttyACM0`, `COM5`, `tcp:HOST:PORT`, `rs485:LINE#ADDRESS`, `can:BUS#ADDRESS`, `sim:SKIN.toml` or
/// `replay:RUN.mcap`.
///
/// A simulated board holds the skin's patch; while it streams a finger goes round on the skin. A replay plays a recording
/// at the speed at which it was recorded.
#[pyfunction]
pub(crate) fn open(py: Python<'_>, port: &str) -> PyResult<Board> {
    let port: Port = port.parse().map_err(raised)?;
    let name = port.to_string();
    let desk = Desk::open(py, WhenFull::DropOldest, move || port::open(&port))?;
    Ok(Board { port: name, desk: Arc::new(desk) })
}

/// A board, open until it is closed: `with dermatome.open(PORT) as board`.
#[pyclass(frozen, module = "dermatome")]
pub(crate) struct Board {
    port: String,
    desk: Arc<Desk>,
}

#[pymethods]
impl Board {
    /// The port as it was written.
    #[getter]
    fn port(&self) -> &str {
        &self.port
    }

    /// What the board holds and does, asked now.
    #[getter]
    fn info(&self, py: Python<'_>) -> PyResult<Info> {
        let asked = self.desk.ask(py, |link| Ok((link.identity().clone(), link.info()?)))?;
        let (identity, info) = asked.map_err(|error: LinkError| raised(error))?;
        Ok(Info::new(&identity, &info))
    }

    /// How the skin is driven, asked now.
    #[getter]
    fn drive(&self, py: Python<'_>) -> PyResult<Drive> {
        Ok(Drive::new(&self.ask(py, |link| Ok(used(link)?.drive))?))
    }

    /// Drives the skin otherwise from now on, until the next patch or restart; what is not given stays. Frequency in Hz,
    /// amplitude in A, phase in degrees, settling and integration in carrier periods; gain is a number or "automatic",
    /// component "real", "imaginary" or "magnitude". The board makes a new reference by itself: nothing may touch the skin.
    #[pyo3(signature = (*, frequency=None, amplitude=None, phase=None, settling=None, integration=None, gain=None, component=None))]
    #[expect(clippy::too_many_arguments, reason = "each has a name in Python")]
    fn set_drive(
        &self,
        py: Python<'_>,
        frequency: Option<f32>,
        amplitude: Option<f32>,
        phase: Option<f32>,
        settling: Option<f32>,
        integration: Option<u8>,
        gain: Option<GainOrWord>,
        component: Option<&str>,
    ) -> PyResult<Drive> {
        let mut wanted = self.ask(py, |link| Ok(used(link)?.drive))?;
        wanted.frequency = frequency.unwrap_or(wanted.frequency);
        wanted.amplitude = amplitude.unwrap_or(wanted.amplitude);
        wanted.phase = phase.unwrap_or(wanted.phase);
        wanted.settling = settling.unwrap_or(wanted.settling);
        wanted.integration = integration.unwrap_or(wanted.integration);
        wanted.gain = gain.map_or(Ok(wanted.gain), |gain| gain.gain())?;
        wanted.component = component.map_or(Ok(wanted.component), component_of)?;
        wanted.check().map_err(|field| PyValueError::new_err(format!("not allowed: {field}")))?;
        self.ask(py, move |link| link.request(&Request::Drive(Some(wanted))).map(drop))?;
        self.drive(py)
    }

    /// Drives the skin as its patch says.
    fn reset_drive(&self, py: Python<'_>) -> PyResult<Drive> {
        self.ask(py, |link| link.request(&Request::Drive(None)).map(drop))?;
        self.drive(py)
    }

    /// Makes the skin, as it is now, the reference, from so many frames: nothing may touch it.
    #[pyo3(signature = (frames=20))]
    fn tare(&self, py: Python<'_>, frames: u16) -> PyResult<()> {
        self.ask(py, move |link| {
            let patch = used(link)?;
            link::tare(link, frames, link::tare_timeout(&patch, frames))
        })
    }

    /// Sends a patch, which the board stores and uses from now on.
    fn flash(&self, py: Python<'_>, patch: PatchOrPath) -> PyResult<()> {
        let bytes = patch.bytes()?;
        self.desk.ask(py, move |link| link::upload(link, &bytes, |_| ()).map(drop))?.map_err(raised)
    }

    /// The patch that the board uses, read back whole.
    fn patch(&self, py: Python<'_>) -> PyResult<Patch> {
        let bytes = self.ask(py, |link| used(link).and_then(|_| link.patch()))?;
        Patch::new(bytes).map_err(raised)
    }

    /// Streams frames, each with what is wanted of it, every so many frames; a stream that goes on ends.
    ///
    /// With `skin`, the skin file that the patch was built from, contacts are in the frame of the robot's link, by its
    /// [pose]. Frames that Python does not fetch wait; once 2048 wait the oldest are dropped, and counted.
    #[pyo3(signature = (*, images=true, contacts=true, measurements=false, health=false, every=1, skin=None))]
    #[expect(clippy::too_many_arguments, reason = "each has a name in Python")]
    fn stream(
        &self,
        py: Python<'_>,
        images: bool,
        contacts: bool,
        measurements: bool,
        health: bool,
        every: u16,
        skin: Option<SkinOrPath>,
    ) -> PyResult<Stream> {
        let [images, contacts, measurements, health] =
            [images, contacts, measurements, health].map(|is_wanted| if is_wanted { every } else { 0 });
        let selection = Selection { images, contacts, measurements, health, ..Selection::default() };
        if !selection.any() {
            return Err(PyValueError::new_err(
                "a stream of nothing; allowed: one part at least, and every >= 1",
            ));
        }
        let patch = self.ask(py, used)?;
        let pixels = || self.ask(py, Link::surface);
        let pose = skin.map(|skin| skin.load(py)?.pose_on(py, &patch.skin, pixels)).transpose()?;
        Ok(Stream { queue: self.desk.stream(selection, patch)?, pose, _desk: self.desk.clone() })
    }

    /// Closes the port; a stream ends.
    fn close(&self, py: Python<'_>) -> PyResult<()> {
        self.desk.close(py)
    }

    fn __enter__(this: Py<Self>) -> Py<Self> {
        this
    }

    #[pyo3(signature = (*_exception))]
    fn __exit__(&self, py: Python<'_>, _exception: &Bound<'_, PyAny>) -> PyResult<()> {
        self.close(py)
    }

    fn __repr__(&self) -> String {
        format!("<Board at {}>", self.port)
    }
}

impl Board {
    fn ask<T: Send + 'static>(
        &self,
        py: Python<'_>,
        ask: impl FnOnce(&mut Link) -> Result<T, LinkError> + Send + 'static,
    ) -> PyResult<T> {
        self.desk.ask(py, ask)?.map_err(raised)
    }
}

/// The patch that the board uses, which it must hold, with the drive in effect.
fn used(link: &mut Link) -> Result<PatchInfo, LinkError> {
    let info = link.info()?;
    let in_effect = |patch: PatchInfo| PatchInfo { drive: info.drive.unwrap_or(patch.drive), ..patch };
    info.patch.map(in_effect).ok_or_else(|| link.error(LinkErrorKind::Refused(Refusal::NoPatch)))
}

/// A patch, or the file that holds it.
#[derive(FromPyObject)]
pub(crate) enum PatchOrPath {
    Patch(Py<Patch>),
    Path(PathBuf),
}

impl PatchOrPath {
    fn bytes(&self) -> PyResult<Vec<u8>> {
        match self {
            Self::Patch(patch) => Ok(patch.get().bytes().to_vec()),
            Self::Path(path) => Ok(Patch::read(path)?.bytes().to_vec()),
        }
    }
}
