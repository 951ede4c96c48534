//! What pressed when the reference was made, and lifts: new presses may be rests of it.

use super::{
    Detector, SUDDEN,
    filter::{self, Look},
    fit::Fit,
};
use crate::patch::places::Places;

/// While a press lifts that was part of the reference, and so long after, us, a new one that is weaker than this share of
/// it is a rest of that.
pub(super) const LIFTS: u32 = 2_000_000;
const REST: f32 = 0.75;
const A_LITTLE_MORE: f32 = 1.2;

/// A press that was part of the reference lifts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Lifting {
    /// When it was seen to last, in the clock's lower half, us.
    pub(super) latest_us: u32,
    /// A new press that is weaker is taken for a rest of it, of which that is this share.
    pub(super) rest: f32,
    share: f32,
}

impl Detector {
    /// Drops new presses that are rests of what lifts where a fit leaves this: the lifted one was strong, and what it leaves
    /// is not quite the opposite of a press. They shrink as the reference is mended.
    pub(super) fn drop_rests(&mut self, fit: &mut Fit<'_>, look: &Look, places: &Places<'_>) {
        let (place, z) = look.least;
        let lifted = filter::strength(places, place, &self.norms, -z);
        let share = self.lifting.map_or_else(
            || {
                // What comes in its first frame is one, however strong.
                let new = fit.presses.iter().filter(|press| press.is_new());
                let strongest = new.fold(0.0, |most: f32, press| most.max(press.strength));
                REST.max(A_LITTLE_MORE * strongest / lifted)
            },
            |lifting| lifting.share,
        );
        let rest = SUDDEN.max(share * lifted);
        self.lifting = Some(Lifting { latest_us: self.frame_us, rest, share });
        fit.retain(&|press| !press.is_new() || press.strength >= rest);
    }
}
