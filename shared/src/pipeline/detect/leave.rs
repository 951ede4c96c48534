//! What of a frame is no press: the reference follows it; and what presses say where measurements are not known.

use super::{Change, Detector, fit::Skin, still};
use crate::{
    patch::PatchView,
    pipeline::reference::{Changes, Reference},
};

impl Detector {
    /// Leaves of differences from a reference, `[measurement]`, what it follows after such a change: beside presses what is
    /// smooth, or slips as well, or all that has changed since they lie where they are, and else all but what presses
    /// explain.
    pub fn leave_followed(
        &self,
        patch: &PatchView<'_>,
        reference: &Reference,
        change: Change,
        differences: &mut [i64],
    ) {
        let is_beside = matches!(
            change,
            Change::PressedAndSmooth | Change::PressedAndDrifted | Change::PressedAndSlipped
        );
        let sign = if is_beside { 1.0 } else { -1.0 };
        if is_beside {
            differences.fill(0);
        }
        let mut add = |m: usize, change: f32| {
            differences[m] += reference.scales().get(m).map_or(0, |scale| (sign * change / scale) as i64);
        };
        let skin = Skin::of(patch, reference.weights());
        match change {
            Change::PressedAndDrifted => {
                self.changed(&skin).into_iter().enumerate().for_each(|(m, change)| add(m, change));
            }
            Change::PressedAndSmooth | Change::PressedAndSlipped => {
                let only_smooth = change == Change::PressedAndSmooth;
                self.sums.known.add(&self.sums.latest_known.parts, only_smooth, &skin.places, &mut add);
            }
            _ => still::responses(&skin.places, &still::of(&self.presses), &mut add),
        }
    }

    /// Replaces relative changes that are not known, `[measurement]`, by what presses explain.
    // Not inlined, so that what it needs of the stack is free again for all else.
    #[inline(never)]
    pub fn fill_unknown(&self, patch: &PatchView<'_>, relative: &mut [f32]) {
        let mut responses = Changes::new();
        let mut push = |_, response| responses.push(response).unwrap_or(());
        still::responses(&patch.places(), &still::of(&self.presses), &mut push);
        let unknown = relative.iter_mut().zip(&responses).filter(|(change, _)| !change.is_finite());
        unknown.for_each(|(change, response)| *change = *response);
    }
}
