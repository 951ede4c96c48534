//! Frame: one full scan of the stimulation pattern.

use crate::{
    limits::{MAX_ELECTRODES, MAX_STEPS},
    units::AdcCode,
};
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
    /// The part of each voltage that goes into the image: `[step]`.
    pub codes: Vec<AdcCode, MAX_STEPS>,
    /// The part in quadrature: `[step]`; empty where it is not measured.
    pub quadrature: Vec<AdcCode, MAX_STEPS>,
    /// Steps with a sample at the end of the converter's range.
    pub clipped: StepSet,
    /// Voltages of the electrodes' tests ([`crate::acquire::scan::test_step`]): `[electrode]`; empty where they
    /// are not measured.
    pub tests: Vec<ElectrodeTest, MAX_ELECTRODES>,
}

impl Frame {
    /// Becomes another frame, copying no more than that one holds.
    pub fn copy_from(&mut self, other: &Self) {
        (self.sequence, self.timestamp_us, self.flags) = (other.sequence, other.timestamp_us, other.flags);
        self.clear();
        self.clipped = other.clipped;
        // Each list has the capacity of the other's.
        let _ = self.codes.extend_from_slice(&other.codes);
        let _ = self.quadrature.extend_from_slice(&other.quadrature);
        let _ = self.tests.extend_from_slice(&other.tests);
    }

    /// Forgets all voltages.
    pub fn clear(&mut self) {
        self.codes.clear();
        self.quadrature.clear();
        self.tests.clear();
        self.clipped = StepSet::default();
    }
}

/// Steps of a scan, one bit each.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct StepSet([u32; MAX_STEPS / 32]);

impl StepSet {
    /// Whether it holds the step of this number.
    #[must_use]
    pub fn contains(&self, step: usize) -> bool {
        self.0.get(step / 32).is_some_and(|word| word >> (step % 32) & 1 == 1)
    }

    /// Adds the step of this number, if a scan can have it.
    pub fn insert(&mut self, step: usize) {
        if let Some(word) = self.0.get_mut(step / 32) {
            *word |= 1 << (step % 32);
        }
    }

    /// Whether it holds none.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.0.iter().all(|word| *word == 0)
    }
}

/// Voltage of one electrode's test.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub struct ElectrodeTest {
    /// In phase with the current.
    pub in_phase: AdcCode,
    /// In quadrature with it.
    pub quadrature: AdcCode,
    /// Whether the converter or its amplifier was at the end of its range.
    pub is_clipped: bool,
}

/// What was wrong with a frame: a set of bits.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub struct FrameFlags(pub u16);

impl FrameFlags {
    /// A sample that counts reached the end of the converter's range: not one that needs a bad electrode.
    pub const SATURATED: Self = Self(1);
    /// An electrode has no contact.
    pub const OPEN_ELECTRODE: Self = Self(1 << 1);
    /// An electrode is connected to its neighbour.
    pub const SHORTED_ELECTRODE: Self = Self(1 << 2);
    /// No current flows: the source, its converter, or all of the wiring.
    pub const NO_CURRENT: Self = Self(1 << 3);
    /// Voltages with drive and sense exchanged differ: a multiplexer, or something not linear.
    pub const NOT_RECIPROCAL: Self = Self(1 << 4);
    /// Voltages differ from the reference by more than any press could explain.
    pub const IMPLAUSIBLE: Self = Self(1 << 5);
    /// The board lost samples between the frame before and this one.
    pub const MISSED: Self = Self(1 << 6);
    /// Measurements with bad electrodes count for nothing; in the image they are what contacts explain.
    pub const MASKED: Self = Self(1 << 7);
    /// The board's chip is hotter than it may be.
    pub const HOT: Self = Self(1 << 8);
    /// Voltages have changed unlike a press: a stretched skin, a moved electrode, a sheet that changed.
    pub const UNLIKE_PRESS: Self = Self(1 << 9);
    /// What pressed when the reference was made has been lifted.
    pub const LIFTED: Self = Self(1 << 10);
    /// An electrode touches worse than when the reference was made.
    pub const WORSE_CONTACT: Self = Self(1 << 11);

    /// Each flag with what it says, in few words.
    pub const ALL: [(Self, &str); 12] = [
        (Self::SATURATED, "saturated"),
        (Self::OPEN_ELECTRODE, "open electrode"),
        (Self::SHORTED_ELECTRODE, "shorted electrode"),
        (Self::NO_CURRENT, "no current"),
        (Self::NOT_RECIPROCAL, "not reciprocal"),
        (Self::IMPLAUSIBLE, "implausible"),
        (Self::MISSED, "samples missed"),
        (Self::MASKED, "bad electrodes masked"),
        (Self::HOT, "chip too hot"),
        (Self::UNLIKE_PRESS, "changed unlike a press"),
        (Self::LIFTED, "was touched in the tare"),
        (Self::WORSE_CONTACT, "worse contact"),
    ];

    /// Whether nothing is known to be wrong with what is found in the frame: samples that were missed before it do not
    /// spoil it.
    #[must_use]
    pub const fn leaves_contacts_valid(self) -> bool {
        self.without(Self::MISSED).0 == 0
    }

    /// What the flags that are set say, in few words.
    pub fn words(self) -> impl Iterator<Item = &'static str> {
        Self::ALL.into_iter().filter(move |&(flag, _)| self.contains(flag)).map(|(_, words)| words)
    }

    /// The bits of both.
    #[must_use]
    pub const fn union(self, other: Self) -> Self {
        Self(self.0 | other.0)
    }

    /// The bits that `other` does not have.
    #[must_use]
    pub const fn without(self, other: Self) -> Self {
        Self(self.0 & !other.0)
    }

    /// Whether all bits of `other` are set.
    #[must_use]
    pub const fn contains(self, other: Self) -> bool {
        self.0 & other.0 == other.0
    }

    /// Whether any bit of `other` is set.
    #[must_use]
    pub const fn intersects(self, other: Self) -> bool {
        self.0 & other.0 != 0
    }

    /// Sets the bits of `other`.
    pub const fn insert(&mut self, other: Self) {
        self.0 |= other.0;
    }

    /// Sets the bits of `other` if something is so.
    pub const fn insert_if(&mut self, other: Self, is_so: bool) {
        if is_so {
            self.insert(other);
        }
    }
}
