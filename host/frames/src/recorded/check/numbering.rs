//! Which electrode of the skin each electrode of the file is.

use super::{
    super::order::{Arrangement, OrderError},
    causes::{self, Explained},
    likeness::Comparison,
    reading::Reading,
};
use dermatome_shared::stimulation::Step;
use serde::Serialize;

/// What the reference says about the order and the numbers of a file's electrodes.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Numbering {
    /// The arrangement asked for.
    pub used: Arrangement,
    /// Its correlation of log magnitudes with the model, -1 to 1.
    pub correlation: f64,
    /// The best arrangement; of those that tie, the one with the fewest changes.
    pub best: Arrangement,
    /// Its correlation.
    pub best_correlation: f64,
    /// Whether another rotation is as good as the best one, as on any disc.
    pub rotation_ambiguous: bool,
    /// Electrodes that seem to be exchanged, besides.
    pub exchanged: Vec<Exchange>,
    /// The correlation once they are put right; that of `best` if there are none.
    pub exchanged_correlation: f64,
}

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

impl Numbering {
    /// Of a frame that is read as explained; correlations are with everything else that was found.
    pub(super) fn of(
        comparison: &Comparison<'_>,
        explained: &Explained,
        used: Arrangement,
    ) -> Result<Self, OrderError> {
        let electrodes = comparison.expected.electrodes;
        let best = explained.reading.arrangement();
        let as_wired = Reading { exchanged: Vec::new(), ..explained.reading.clone() };
        let correlation = |arrangement: Arrangement| -> Result<f64, OrderError> {
            Ok(comparison.of(&as_wired.rearranged(arrangement, electrodes))?.correlation())
        };
        Ok(Self {
            used,
            correlation: correlation(used)?,
            best,
            best_correlation: correlation(best)?,
            rotation_ambiguous: another_rotation_ties(comparison, explained),
            exchanged: explained.reading.exchanged.clone(),
            exchanged_correlation: explained.likeness.correlation(),
        })
    }
}

/// Whether another rotation explains the frame as well.
fn another_rotation_ties(comparison: &Comparison<'_>, last: &Explained) -> bool {
    let electrodes = comparison.expected.electrodes;
    let arrangement = last.reading.arrangement();
    let others = (0..electrodes).filter(|&rotation| rotation != arrangement.rotation);
    let ties = |rotation: u8| {
        let reading = last.reading.rearranged(Arrangement { rotation, ..arrangement }, electrodes);
        comparison.of(&reading).is_ok_and(|other| causes::ties(other.disorder(), last.likeness.disorder()))
    };
    others.into_iter().any(ties)
}
