//! Frame: one full scan of the stimulation pattern.

use crate::{MAX_STEPS, units::AdcCode};
use heapless::Vec;
use postcard_schema::Schema;
use serde::{Deserialize, Serialize};

/// One full scan: a voltage per stimulation step, in the order of the patch's stimulation table.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Frame {
    /// Running number since the board started.
    pub sequence: u32,
    /// When the scan ended, microseconds of the board's own clock.
    pub timestamp_us: u64,
    /// What was wrong with the scan.
    pub flags: FrameFlags,
    /// In-phase voltages: `[step]`.
    pub codes: Vec<AdcCode, MAX_STEPS>,
}

/// What was wrong with a frame; a set of bits, so that more can follow.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub struct FrameFlags(pub u8);

impl FrameFlags {
    /// At least one sample reached the end of the converter's range.
    pub const SATURATED: Self = Self(1);

    /// Whether all bits of `other` are set.
    #[must_use]
    pub const fn contains(self, other: Self) -> bool {
        self.0 & other.0 == other.0
    }

    /// Sets the bits of `other`.
    pub const fn insert(&mut self, other: Self) {
        self.0 |= other.0;
    }
}
