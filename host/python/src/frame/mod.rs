//! Frame: one scan of a skin, as Python sees it.

mod contact;

pub(crate) use contact::{contact_type, contacts, seconds};

use crate::array::list;
use dermatome_link::{ScanFrame, assemble::HealthReport, pose::Pose};
use dermatome_recording::frames::RecordedFrame;
use dermatome_shared::{
    contact::Contact,
    health::ElectrodeSet,
    protocol::{FrameStamp, PackedImage},
    units::AdcCode,
};
use numpy::PyArray1;
use pyo3::prelude::*;
use std::time::{SystemTime, UNIX_EPOCH};

/// One scan: what was asked for of it. What did not come, or was not asked for, is None.
#[pyclass(frozen, get_all, module = "dermatome")]
pub(crate) struct Frame {
    /// Running number since the board started.
    sequence: u32,
    /// When the scan ended, s of the board's clock.
    time: f64,
    /// When it came, s since 1970 by this computer's clock.
    received: f64,
    /// What was wrong with the scan, in words; empty where nothing was.
    flags: Vec<&'static str>,
    /// Relative conductivity change: float32 [pixel].
    image: Option<Py<PyArray1<f32>>>,
    /// Codes in phase with the current: int32 [step].
    measurements: Option<Py<PyArray1<i32>>>,
    /// Codes in quadrature: int32 [step], empty where the board does not measure them.
    quadrature: Option<Py<PyArray1<i32>>>,
    /// Contacts, strongest first: an array of `dermatome.CONTACT`.
    contacts: Option<Py<PyAny>>,
    /// What the scan says about the board and its skin.
    health: Option<Py<Health>>,
}

/// What a scan says about the board and its skin.
#[pyclass(frozen, get_all, module = "dermatome")]
pub(crate) struct Health {
    /// ohm: float32 [electrode]; empty where it is not measured.
    contact_impedance: Py<PyArray1<f32>>,
    /// Electrodes without contact, from 0.
    open: Vec<u16>,
    /// Electrodes connected to a neighbour, from 0.
    shorted: Vec<u16>,
    /// Electrodes that touch worse than when the reference was made, from 0.
    worse: Vec<u16>,
    /// How much voltages with drive and sense exchanged differ, relative.
    reciprocity_error: Option<f32>,
    /// Of the chip, degrees Celsius.
    temperature: Option<f32>,
    /// Share of the processor's time, 0 to 1.
    load: f32,
    /// Drift of all voltages that is taken out of the images, relative.
    drift: f32,
}

/// Where the parts of a frame come from.
struct Source<'a> {
    at: FrameStamp,
    received: f64,
    codes: Option<[&'a Vec<AdcCode>; 2]>,
    image: Option<&'a PackedImage>,
    contacts: Option<&'a [Contact]>,
    health: Option<&'a HealthReport>,
    pose: Option<&'a Pose>,
}

impl Frame {
    /// Of a board's frame that came then; samples of the scope alone are none. Contacts are in the frame of `pose`'s link.
    pub(crate) fn of_board(
        py: Python<'_>,
        frame: &ScanFrame,
        came: SystemTime,
        pose: Option<&Pose>,
    ) -> PyResult<Option<Self>> {
        let Some(at) = frame.at else { return Ok(None) };
        let source = Source {
            at,
            received: came.duration_since(UNIX_EPOCH).unwrap_or_default().as_secs_f64(),
            codes: frame.measurements.as_ref().map(|codes| [&codes.codes, &codes.quadrature]),
            image: frame.image.as_ref(),
            contacts: frame.contacts.as_deref(),
            health: frame.health.as_ref(),
            pose,
        };
        Self::new(py, &source).map(Some)
    }

    /// Of a recorded frame.
    pub(crate) fn of_recording(py: Python<'_>, frame: &RecordedFrame) -> PyResult<Self> {
        Self::new(
            py,
            &Source {
                at: frame.at,
                received: frame.log_time as f64 / 1e9,
                codes: frame.codes.as_ref().map(|[in_phase, quadrature]| [in_phase, quadrature]),
                image: frame.image.as_ref(),
                contacts: frame.contacts.as_deref(),
                health: frame.health.as_ref(),
                pose: None,
            },
        )
    }

    fn new(py: Python<'_>, source: &Source<'_>) -> PyResult<Self> {
        let Source { at, received, codes, image, contacts: found, health, pose } = *source;
        let array = |codes: &Vec<AdcCode>| list(py, codes.iter().map(|code| code.0).collect()).unbind();
        let placed = |contact: &Contact| (at, pose.map_or(*contact, |pose| pose.contact(contact)));
        let found = found.map(|found| contacts(py, found.iter().map(placed))).transpose()?;
        Ok(Self {
            sequence: at.sequence,
            time: seconds(at),
            received,
            flags: at.flags.words().collect(),
            image: image.map(|image| list(py, image.values().map(|value| value as f32).collect()).unbind()),
            measurements: codes.map(|[in_phase, _]| array(in_phase)),
            quadrature: codes.map(|[_, quadrature]| array(quadrature)),
            contacts: found.map(Bound::unbind),
            health: health.map(|report| Py::new(py, Health::new(py, report))).transpose()?,
        })
    }
}

#[pymethods]
impl Frame {
    fn __repr__(&self, py: Python<'_>) -> PyResult<String> {
        let contacts = self.contacts.as_ref().map(|contacts| contacts.bind(py).len()).transpose()?;
        let contacts = contacts.map_or(String::new(), |count| format!(", {count} contacts"));
        let flags: String = self.flags.iter().map(|words| format!(", {words}")).collect();
        Ok(format!("<Frame {} at {:.3} s{contacts}{flags}>", self.sequence, self.time))
    }
}

impl Health {
    fn new(py: Python<'_>, report: &HealthReport) -> Self {
        let HealthReport { health, vitals, drift, .. } = report;
        let electrodes = |set: ElectrodeSet| set.iter().map(u16::from).collect();
        Self {
            contact_impedance: list(py, health.contact_impedance.to_vec()).unbind(),
            open: electrodes(health.open),
            shorted: electrodes(health.shorted),
            worse: electrodes(health.worse),
            reciprocity_error: health.reciprocity_error,
            temperature: vitals.temperature,
            load: vitals.load,
            drift: *drift,
        }
    }
}

#[pymethods]
impl Health {
    fn __repr__(&self) -> String {
        let Self { open, shorted, worse, load, .. } = self;
        format!("<Health open {open:?}, shorted {shorted:?}, worse {worse:?}, load {load:.2}>")
    }
}
