//! Former reference: the one that a mend began from.
//!
//! What is taken for no press, and learnt, may have been one: seldom, as hardly any data look so, but the contact that it
//! leaves on the untouched skin would stay for ever. Frames that are as the former reference has them, down to noise, and
//! not as the present one has them, show it, and the mend is undone. Once the skin has looked untouched after a mend, that
//! was right, and what comes back is a press.

use super::reference::{Measured, Reference};
use crate::patch::PatchView;

/// Sums of the former reference, none unless something is being mended, and the variance of its noise.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Former {
    sums: Measured,
    variance: f32,
}

impl Former {
    /// The reference is new, or a frame is as it has it.
    pub(super) fn clear(&mut self) {
        self.sums.clear();
    }

    /// The reference is about to be mended.
    pub(super) fn keep(&mut self, reference: &Reference) {
        if self.sums.is_empty() {
            self.sums.extend(reference.sums().iter().copied());
            self.variance = reference.variance();
        }
    }

    /// Turns differences from the reference, `[measurement]`, into those from the former one, or back, by the sign.
    pub(super) fn shift(&self, reference: &Reference, differences: &mut [i64], sign: i64) {
        let moved = reference.sums().iter().zip(&self.sums).map(|(now, then)| now - then);
        differences.iter_mut().zip(moved).for_each(|(difference, moved)| *difference += sign * moved);
    }

    /// Whether there is one to return to.
    pub(super) fn is_kept(&self) -> bool {
        !self.sums.is_empty()
    }

    /// The reference is as it was.
    pub(super) fn undo(&mut self, patch: &PatchView<'_>, reference: &mut Reference) {
        reference.return_to(patch, &self.sums, self.variance);
        self.clear();
    }
}
