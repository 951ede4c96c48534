//! Board: a port that is open, be it a real board's, a simulated one's or a recording's.

use crate::{
    desk::{Desk, Queue, WhenFull},
    error::raised,
    frame::Frame,
    patch::Patch,
    skin::SkinOrPath,
};
use dermatome_link::{self as link, Link, LinkError, LinkErrorKind, pose::Pose, shared};
use dermatome_model::indenter::Press;
use dermatome_simulate::{
    Noise, Script, SimulatedSkin,
    board::{BoardOptions, DEFAULT_NOISE, Pace, SimulatedBoard},
    port::{self, Port},
};
use pyo3::{exceptions::PyValueError, prelude::*};
use shared::{
    drive::{Component, Gain},
    protocol::{self, FrameSource, PatchInfo, Refusal, Request, Selection},
    reference::DEFAULT_TARE_FRAMES,
};
use std::{path::PathBuf, sync::Arc};

// Python shows defaults only where they are numbers as such.
const _: () = assert!(DEFAULT_TARE_FRAMES == 20 && DEFAULT_NOISE.snr_db == 60.0 && DEFAULT_NOISE.seed == 1);

/// Opens a board: `/dev/ttyACM0`, `COM5`, `tcp:HOST:PORT`, `sim:SKIN.toml` or `replay:RUN.mcap`.
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

/// Starts a simulated board with a simulated skin, which holds the skin's patch.
///
/// `presses` are fingers that rest on the skin while the board streams, each (x, y, radius, depth) in m, m, m and relative
/// change of conductivity; `script` names a CSV file of moving ones (docs/cli.md); without either a finger goes round. A
/// tare sees the untouched skin. `paced=False` gives frames as fast as they are solved and taken.
#[pyfunction]
#[pyo3(signature = (skin, presses=None, *, script=None, noise_db=60.0, seed=1, paced=true))]
pub(crate) fn simulate(
    py: Python<'_>,
    skin: SkinOrPath,
    presses: Option<Vec<[f64; 4]>>,
    script: Option<PathBuf>,
    noise_db: f64,
    seed: u64,
    paced: bool,
) -> PyResult<Board> {
    if presses.is_some() && script.is_some() {
        return Err(PyValueError::new_err("presses and script exclude each other"));
    }
    if !(0.0..=200.0).contains(&noise_db) {
        return Err(PyValueError::new_err(format!("noise_db is {noise_db}; allowed: 0 to 200 dB")));
    }
    let skin = skin.load(py)?;
    let name = format!("sim:{}", skin.path().display());
    let patch = skin.patch_bytes(py)?;
    let (pace, when_full) = match paced {
        true => (Pace::FrameRate, WhenFull::DropOldest),
        false => (Pace::Unpaced, WhenFull::Wait),
    };
    let port = name.clone();
    let start = move || -> Result<Link, String> {
        let skin = skin.described();
        let words = |error: &dyn std::fmt::Display| error.to_string();
        let has_presses = presses.is_some();
        let outline = skin.shape.from_above().map_err(|error| words(&error))?;
        let presses =
            presses.iter().flatten().map(|&[x, y, radius, depth]| Press::finger([x, y], radius, depth));
        let script = match (script, presses.collect::<Vec<_>>()) {
            (Some(path), _) => Script::load(&path, &outline),
            (None, resting) if has_presses => Script::still(&resting, &outline),
            (None, _) => Ok(Script::round(&outline)),
        };
        let script = script.map_err(|error| words(&error))?;
        let source = SimulatedSkin::new(skin, script, Noise { snr_db: noise_db, seed });
        let source = source.map_err(|error| words(&error))?;
        let electrodes = skin.electrodes.count;
        let options = BoardOptions { electrodes, patch: Some(patch), pace, ..BoardOptions::default() };
        let board = SimulatedBoard::start(options, source).map_err(|error| words(&error))?;
        board.connect(port).map_err(|error| words(&error))
    };
    let desk = Desk::open(py, when_full, start)?;
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

/// Frames as they come; the board stops when this is closed, or forgotten.
#[pyclass(frozen, module = "dermatome")]
pub(crate) struct Stream {
    queue: Arc<Queue>,
    pose: Option<Pose>,
    /// The port stays open as long as somebody listens.
    _desk: Arc<Desk>,
}

#[pymethods]
impl Stream {
    fn __iter__(this: Py<Self>) -> Py<Self> {
        this
    }

    fn __next__(&self, py: Python<'_>) -> PyResult<Option<Frame>> {
        while let Some((frame, came)) = self.queue.take(py)? {
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

/// What a board holds and does.
#[pyclass(frozen, get_all, module = "dermatome")]
pub(crate) struct Info {
    /// Kind of board.
    board: String,
    /// Version of its firmware.
    firmware: String,
    /// Electrodes wired to it.
    electrodes: u8,
    /// Where its frames come from: "skin", "simulated" or "synthetic", which are numbers without meaning.
    frame_source: &'static str,
    /// Volts between two electrodes for one step of a code; None of a board without an analogue front end.
    volts_per_code: Option<f32>,
    /// How long ago it started, s.
    uptime: f64,
    /// Whether it has a reference, so that images can be made.
    tared: bool,
    /// Name of the skin whose patch it uses; None without a patch, as all that follows.
    skin: Option<String>,
    /// Checksum of the patch, which identifies it.
    patch_crc: Option<u32>,
    /// Steps of a frame.
    steps: Option<u16>,
    /// Measurements after reciprocal steps are averaged.
    measurements: Option<u16>,
    /// Pixels of an image.
    pixels: Option<u16>,
    /// Frames a second, at most.
    frame_rate: Option<f32>,
}

impl Info {
    fn new(identity: &protocol::Identity, info: &protocol::Info) -> Self {
        let patch = info.patch.as_ref();
        Self {
            board: identity.board.as_str().to_owned(),
            firmware: identity.firmware.as_str().to_owned(),
            electrodes: info.electrodes,
            frame_source: source_in_words(info.frame_source),
            volts_per_code: info.front_end.as_ref().map(|front_end| front_end.volts_per_code),
            uptime: info.uptime_ms as f64 / 1e3,
            tared: info.tared,
            skin: patch.map(|patch| patch.skin.as_str().to_owned()),
            patch_crc: patch.map(|patch| patch.crc),
            steps: patch.map(|patch| patch.steps),
            measurements: patch.map(|patch| patch.measurements),
            pixels: patch.map(|patch| patch.pixels),
            frame_rate: patch.map(|patch| info.drive.unwrap_or(patch.drive).frame_rate),
        }
    }
}

#[pymethods]
impl Info {
    fn __repr__(&self) -> String {
        let Self { board, firmware, frame_source, tared, .. } = self;
        let skin = self.skin.as_deref().unwrap_or("no patch");
        let tared = if *tared { "tared" } else { "not tared" };
        format!("<Info {board} {firmware}, {skin}, frames {frame_source}, {tared}>")
    }
}

/// Where frames come from, in a word.
pub(crate) fn source_in_words(source: FrameSource) -> &'static str {
    match source {
        FrameSource::Skin => "skin",
        FrameSource::Simulated => "simulated",
        FrameSource::Synthetic => "synthetic",
    }
}

/// How a skin is driven and measured.
#[pyclass(frozen, get_all, module = "dermatome")]
pub(crate) struct Drive {
    /// Carrier frequency, Hz.
    frequency: f32,
    /// Current amplitude, A.
    amplitude: f32,
    /// Frames a second, at most.
    frame_rate: f32,
    /// By how much the in-phase reference lags the current, degrees.
    phase: f32,
    /// Carrier periods between switching and measuring.
    settling: f32,
    /// Carrier periods over which a voltage is measured.
    integration: u8,
    /// Gain of the amplifier; None where the board finds it.
    gain: Option<u8>,
    /// Which part of a voltage goes into the image: "real", "imaginary" or "magnitude".
    component: &'static str,
}

/// Parts of a voltage by their names.
const COMPONENTS: [(&str, Component); 3] =
    [("real", Component::Real), ("imaginary", Component::Imaginary), ("magnitude", Component::Magnitude)];

impl Drive {
    pub(crate) fn new(drive: &shared::drive::Drive) -> Self {
        let name = COMPONENTS.iter().find(|(_, component)| *component == drive.component);
        Self {
            frequency: drive.frequency,
            amplitude: drive.amplitude,
            frame_rate: drive.frame_rate,
            phase: drive.phase,
            settling: drive.settling,
            integration: drive.integration,
            gain: match drive.gain {
                Gain::Automatic => None,
                Gain::Fixed(gain) => Some(gain),
            },
            component: name.map_or("real", |(name, _)| name),
        }
    }
}

#[pymethods]
impl Drive {
    fn __repr__(&self) -> String {
        let Self { frequency, amplitude, frame_rate, component, .. } = self;
        let gain = self.gain.map_or("automatic".to_owned(), |gain| gain.to_string());
        format!("<Drive {frequency} Hz, {amplitude} A, {frame_rate} frames/s, gain {gain}, {component}>")
    }
}

fn component_of(word: &str) -> PyResult<Component> {
    let found = COMPONENTS.iter().find(|(name, _)| *name == word).map(|(_, component)| *component);
    found.ok_or_else(|| {
        PyValueError::new_err(format!(
            "component is {word:?}; allowed: \"real\", \"imaginary\" or \"magnitude\""
        ))
    })
}

/// A gain as Python gives it.
#[derive(FromPyObject)]
pub(crate) enum GainOrWord {
    Fixed(u8),
    Word(String),
}

impl GainOrWord {
    fn gain(&self) -> PyResult<Gain> {
        match self {
            Self::Fixed(gain) => Ok(Gain::Fixed(*gain)),
            Self::Word(word) if word == "automatic" => Ok(Gain::Automatic),
            Self::Word(word) => {
                Err(PyValueError::new_err(format!("gain is {word:?}; allowed: \"automatic\" or a number")))
            }
        }
    }
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
