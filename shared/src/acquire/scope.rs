//! Scope: the samples of one slot, for those who want to see what the converter saw.

use super::scan::Timing;
use heapless::Vec;
use postcard_schema::Schema;
use serde::{Deserialize, Serialize};

/// Most samples of a slot that are shown.
pub const MAX_SCOPE_SAMPLES: usize = 512;

/// Samples of one slot, from its start.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub struct SlotSamples {
    /// Slot of the scan.
    pub slot: u16,
    /// Gain of the programmable amplifier in it.
    pub gain: u8,
    /// Samples of it that are left out while the voltage settles.
    pub settling: u16,
    /// Codes of the converter, 0 to 4095.
    pub samples: Vec<u16, MAX_SCOPE_SAMPLES>,
}

impl SlotSamples {
    /// Nothing seen yet of this slot.
    pub(super) fn of(slot: u16, timing: Timing) -> Self {
        Self { slot, settling: timing.settling, ..Self::default() }
    }

    /// Takes those of `samples`, which begin at `position` of a frame, that lie in the slot.
    pub(super) fn take(&mut self, samples: &[u16], position: usize, slot_samples: usize) {
        let start = usize::from(self.slot) * slot_samples;
        if (position..position + samples.len()).contains(&start) {
            self.samples.clear();
        }
        let from = start.saturating_sub(position).min(samples.len());
        let to = (start + slot_samples).saturating_sub(position).min(samples.len());
        // Where the slot lies before or behind the samples, `from` is not before `to`.
        let room = self.samples.capacity() - self.samples.len();
        for &sample in samples.get(from..to).unwrap_or_default().iter().take(room) {
            let _ = self.samples.push(sample);
        }
    }
}
