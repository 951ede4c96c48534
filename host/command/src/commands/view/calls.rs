//! Calls: what the page can ask for.

use anyhow::{Context, ensure};
use dermatome_messages::dermatome::gain_of_number;
use dermatome_page::{Call, Service};
use dermatome_shared::drive::Drive;
use serde::{Deserialize, de::DeserializeOwned};

/// A service without a request.
const NOTHING: &str = r#"{"type":"object","properties":{}}"#;

const OF_TARE: Service = Service { name: TARE, request: NOTHING };
const OF_DRIVE: Service = Service {
    name: DRIVE,
    request: r#"{"type":"object","properties":{"frequency_hz":{"type":"number"},"amplitude_ma":{"type":"number"},"gain":{"type":"integer"}}}"#,
};

/// What can be asked for of each of a robot's skins.
pub(in crate::commands) static OF_EACH: [Service; 2] = [OF_TARE, OF_DRIVE];

/// What the page can ask for.
pub(in crate::commands) static SERVICES: [Service; 8] = [
    OF_TARE,
    OF_DRIVE,
    Service {
        name: PATCH,
        request: r#"{"type":"object","properties":{"index":{"type":"integer"}},"required":["index"]}"#,
    },
    Service {
        name: THRESHOLD,
        request: r#"{"type":"object","properties":{"value":{"type":"number"}},"required":["value"]}"#,
    },
    Service {
        name: RECORD,
        request: r#"{"type":"object","properties":{"start":{"type":"boolean"}},"required":["start"]}"#,
    },
    Service { name: SCOPE, request: r#"{"type":"object","properties":{"slot":{"type":"integer"}}}"# },
    Service { name: CHECK, request: NOTHING },
    Service {
        name: CALIBRATE,
        request: r#"{"type":"object","properties":{"readings":{"type":"array","items":{"type":"object","properties":{"pressure_kpa":{"type":"number"},"strength":{"type":"number"}}}}},"required":["readings"]}"#,
    },
];

pub(in crate::commands) const TARE: &str = "/dermatome/tare";
pub(in crate::commands) const DRIVE: &str = "/dermatome/drive";
pub(in crate::commands) const PATCH: &str = "/dermatome/patch";
pub(in crate::commands) const THRESHOLD: &str = "/dermatome/threshold";
pub(in crate::commands) const RECORD: &str = "/dermatome/record";
pub(in crate::commands) const SCOPE: &str = "/dermatome/scope";
pub(in crate::commands) const CHECK: &str = "/dermatome/check";
pub(in crate::commands) const CALIBRATE: &str = "/dermatome/calibrate";

/// What is to change of the drive.
#[derive(Clone, Copy, Debug, Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub(in crate::commands) struct Change {
    frequency_hz: Option<f32>,
    amplitude_ma: Option<f32>,
    /// 0: automatic.
    gain: Option<u8>,
}

#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(in crate::commands) struct Index {
    pub(in crate::commands) index: usize,
}

#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(in crate::commands) struct Value {
    pub(in crate::commands) value: f32,
}

#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(in crate::commands) struct Start {
    pub(in crate::commands) start: bool,
}

#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(in crate::commands) struct Slot {
    pub(in crate::commands) slot: Option<u16>,
}

/// What was read while a known pressure pressed.
#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(in crate::commands) struct Read {
    pub(in crate::commands) pressure_kpa: f64,
    pub(in crate::commands) strength: f64,
}

#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(in crate::commands) struct Readings {
    pub(in crate::commands) readings: Vec<Read>,
}

/// The request of a call.
pub(in crate::commands) fn request<T: DeserializeOwned>(call: &Call) -> anyhow::Result<T> {
    serde_json::from_value(call.request.clone())
        .with_context(|| format!("`{}` was asked wrongly", call.service))
}

impl Change {
    /// The drive with these changes, checked as far as this computer can.
    pub(in crate::commands) fn of(self, drive: &Drive) -> anyhow::Result<Drive> {
        let mut drive = *drive;
        drive.frequency = self.frequency_hz.unwrap_or(drive.frequency);
        drive.amplitude = self.amplitude_ma.map_or(drive.amplitude, |milliamperes| milliamperes * 1e-3);
        drive.gain = self.gain.map_or(drive.gain, gain_of_number);
        let checked = drive.check();
        ensure!(checked.is_ok(), "allowed: {}", checked.err().unwrap_or_default());
        Ok(drive)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use dermatome_shared::drive::Gain;

    #[test]
    fn a_drive_is_changed_only_where_it_was_asked_and_what_is_not_allowed_is_named() {
        let drive = Drive::new(50e3, 1e-3, 50.0);
        let change = |text: &str| serde_json::from_str::<Change>(text).unwrap().of(&drive);
        assert_eq!(change("{}").unwrap(), drive);
        let changed = change(r#"{"amplitude_ma":0.5,"gain":8}"#).unwrap();
        assert_eq!((changed.amplitude, changed.gain, changed.frequency), (0.5e-3, Gain::Fixed(8), 50e3));
        assert!(change(r#"{"amplitude_ma":-1}"#).unwrap_err().to_string().contains("drive.amplitude"));
        assert!(change(r#"{"gain":3}"#).unwrap_err().to_string().contains("drive.gain"));
        assert!(serde_json::from_str::<Change>(r#"{"amplitude":1}"#).is_err());
    }
}
