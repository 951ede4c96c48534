//! Which electrode of the skin is behind each of the file's, and which of these are exchanged.

use super::super::order::Arrangement;
use dermatome_shared::stimulation::Step;
use serde::Serialize;

/// Two electrodes that are exchanged, by the file's numbers from 0.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub struct Exchange {
    /// Which ones.
    pub electrodes: [u8; 2],
    /// Where.
    pub role: Role,
}

/// What an electrode is used for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Role {
    /// To drive and to sense.
    Both,
    /// To drive.
    Drive,
    /// To sense.
    Sense,
}

/// The model's electrode behind each electrode of the file.
#[derive(Clone, Debug)]
pub(super) struct Wiring {
    pub(super) arrangement: Arrangement,
    drive: Vec<u8>,
    sense: Vec<u8>,
}

impl Wiring {
    pub(super) fn new(arrangement: Arrangement, electrodes: u8) -> Self {
        let on_model: Vec<u8> = (0..electrodes).map(|k| arrangement.on_model(k, electrodes)).collect();
        Self { arrangement, drive: on_model.clone(), sense: on_model }
    }

    pub(super) fn with(&self, exchange: Exchange) -> Self {
        let mut wiring = self.clone();
        let [a, b] = exchange.electrodes.map(usize::from);
        if exchange.role != Role::Sense {
            wiring.drive.swap(a, b);
        }
        if exchange.role != Role::Drive {
            wiring.sense.swap(a, b);
        }
        wiring
    }

    /// A step of the file in the model's numbers.
    pub(super) fn step(&self, step: Step) -> Step {
        let (drive, sense) = (|e: u8| self.drive[usize::from(e)], |e: u8| self.sense[usize::from(e)]);
        Step {
            drive_plus: drive(step.drive_plus),
            drive_minus: drive(step.drive_minus),
            sense_plus: sense(step.sense_plus),
            sense_minus: sense(step.sense_minus),
        }
    }
}
