//! Former reference: the one that a mend began from.
//!
//! What is taken for no press, and learnt, may have been one: seldom, as hardly any data look so, but the contact that it
//! leaves on the untouched skin would stay for ever. Frames that are as the former reference has them, down to noise, and
//! not as the present one has them, show it, and the mend is undone. Once the skin has looked untouched for a while after
//! a mend, it was right, and what comes back is a press.

use super::{
    detect::Change,
    reference::{Measured, Reference},
};
use crate::patch::PatchView;

/// A mend was right once the reference has followed the untouched skin so often since it began: that takes a second.
const TRUSTED: u8 = 10;

/// Sums of the former reference; none unless something was mended just now.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Former {
    sums: Measured,
    /// How often the reference followed the untouched skin since then.
    still: u8,
}

impl Former {
    /// Forgets it.
    pub(super) fn clear(&mut self) {
        self.sums.clear();
        self.still = 0;
    }

    /// The reference is about to follow such a change.
    pub(super) fn keep(&mut self, reference: &Reference, change: Change) {
        if change == Change::Still {
            self.still = self.still.saturating_add(1);
            if self.still >= TRUSTED {
                self.clear();
            }
        } else if self.sums.is_empty() {
            self.sums.extend(reference.sums().iter().copied());
            self.still = 0;
        }
    }

    /// Turns differences from the reference, `[measurement]`, into those from the former one, or back, by the sign.
    pub(super) fn shift(&self, reference: &Reference, differences: &mut [i64], sign: i64) {
        let moved = reference.sums().iter().zip(&self.sums).map(|(now, then)| now - then);
        differences.iter_mut().zip(moved).for_each(|(difference, moved)| *difference += sign * moved);
    }

    /// Whether something was mended just now.
    pub(super) fn is_kept(&self) -> bool {
        !self.sums.is_empty()
    }

    /// The reference is as it was.
    pub(super) fn undo(&mut self, patch: &PatchView<'_>, reference: &mut Reference) {
        reference.return_to(patch, &self.sums);
        self.clear();
    }
}
