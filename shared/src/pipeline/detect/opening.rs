//! Opening: which frames open the average of still ones.
//!
//! A frame that differs by more than noise does. Chi square doubts what a press as faint as one frame can show only a
//! little: such a frame of an untouched skin is looked at by itself.

use super::{
    Detector, FAST,
    fit::{Fit, Skin},
};
use crate::{
    patch::PatchView,
    pipeline::{
        average::OPENS,
        reference::{Changes, Reference},
    },
};

/// A frame that differs from the average by so many standard deviations of chi square is looked at by itself.
const MAY_OPEN: f32 = 1.0;

impl Detector {
    /// Takes the mean of relative changes over the frames that are alike instead of those of this time: `[measurement]`.
    pub fn average(
        &mut self,
        patch: &PatchView<'_>,
        relative: &mut Changes,
        reference: &Reference,
        now_us: u64,
    ) {
        self.is_fast = (now_us as u32).wrapping_sub(self.frame_us) < FAST;
        self.frame_us = now_us as u32;
        if self.norms.is_empty() {
            return;
        }
        let excess = self.average.excess(relative, &self.inverse_variances);
        let may_open = excess > MAY_OPEN && self.presses.is_empty();
        if excess > OPENS || may_open && self.is_pressed_at_once(patch, relative, reference) {
            self.average.restart();
        }
        self.average.take(relative, now_us, patch.header.detection.averaging);
    }

    /// Whether something presses an untouched skin in these changes of one frame, `[measurement]`, by itself.
    // Not inlined, so that what it needs of the stack is free again for all else.
    #[inline(never)]
    fn is_pressed_at_once(&mut self, patch: &PatchView<'_>, relative: &[f32], reference: &Reference) -> bool {
        let skin = Skin::of(patch, reference.weights());
        self.sums.take(relative, &self.inverse_variances, reference.weights(), 1.0 + reference.variance());
        let fit = Fit::new(&skin, &self.sums.data);
        let z = fit.look(&mut self.sums, &self.norms).most.1;
        fit.significance(z * z) > patch.header.detection.level
    }
}
