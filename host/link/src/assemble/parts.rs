//! Parts: which parts a frame has, or should have.

use super::ScanFrame;
use dermatome_shared::protocol::Selection;

/// A set of parts of a frame.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Parts(u8);

impl Parts {
    /// Raw codes.
    pub const MEASUREMENTS: Self = Self(1);
    /// Image.
    pub const IMAGE: Self = Self(2);
    /// Contacts.
    pub const CONTACTS: Self = Self(4);
    /// Health.
    pub const HEALTH: Self = Self(8);
    /// Samples of the scope.
    pub const SCOPE: Self = Self(16);

    /// The parts that a board sends of the frame of this sequence number: each is sent of every so many frames.
    #[must_use]
    pub fn due(selection: &Selection, sequence: u32) -> Self {
        let is_due = |every: u16| every > 0 && sequence.is_multiple_of(every.into());
        let parts = periods(selection).into_iter().filter(|(every, _)| is_due(*every));
        parts.fold(Self::default(), |all, (_, part)| Self(all.0 | part.0))
    }

    /// Whether some part but the scope's samples is sent of each frame.
    pub(super) fn is_due_each_frame(selection: &Selection) -> bool {
        periods(selection).iter().any(|(every, part)| *every == 1 && *part != Self::SCOPE)
    }

    /// Whether this holds all parts of `other`.
    #[must_use]
    pub fn contains(self, other: Self) -> bool {
        self.0 & other.0 == other.0
    }

    /// Whether there are none.
    #[must_use]
    pub fn is_empty(self) -> bool {
        self.0 == 0
    }

    /// How many there are.
    #[must_use]
    pub fn count(self) -> u32 {
        self.0.count_ones()
    }

    /// Whether a part is among them whose event says of which scan it is.
    pub(super) fn is_stamped(self) -> bool {
        self.0 & !Self::SCOPE.0 != 0
    }

    pub(super) fn remove(&mut self, part: Self) {
        self.0 &= !part.0;
    }
}

impl ScanFrame {
    /// The parts that came.
    #[must_use]
    pub fn parts(&self) -> Parts {
        let parts = [
            (self.measurements.is_some(), Parts::MEASUREMENTS),
            (self.image.is_some(), Parts::IMAGE),
            (self.contacts.is_some(), Parts::CONTACTS),
            (self.health.is_some(), Parts::HEALTH),
            (self.scope.is_some(), Parts::SCOPE),
        ];
        parts
            .into_iter()
            .filter(|(is_there, _)| *is_there)
            .fold(Parts(0), |all, (_, part)| Parts(all.0 | part.0))
    }
}

fn periods(selection: &Selection) -> [(u16, Parts); 5] {
    [
        (selection.measurements, Parts::MEASUREMENTS),
        (selection.images, Parts::IMAGE),
        (selection.contacts, Parts::CONTACTS),
        (selection.health, Parts::HEALTH),
        (selection.scope, Parts::SCOPE),
    ]
}
