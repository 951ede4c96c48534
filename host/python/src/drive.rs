//! Drive: how a skin is driven and measured, as Python sees it.

use dermatome_shared::drive::{self, Component, Gain};
use pyo3::{exceptions::PyValueError, prelude::*};

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
    pub(crate) fn new(drive: &drive::Drive) -> Self {
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

pub(crate) fn component_of(word: &str) -> PyResult<Component> {
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
    pub(crate) fn gain(&self) -> PyResult<Gain> {
        match self {
            Self::Fixed(gain) => Ok(Gain::Fixed(*gain)),
            Self::Word(word) if word == "automatic" => Ok(Gain::Automatic),
            Self::Word(word) => {
                Err(PyValueError::new_err(format!("gain is {word:?}; allowed: \"automatic\" or a number")))
            }
        }
    }
}
