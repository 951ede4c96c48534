//! Presses that are held: what changes slowly beside them, and is like neither a move of theirs nor another press, is drift
//! of the sheet, whatever its shape.
//!
//! Drift resembles presses that are there: fitted together with a quarter of the sheet that has warmed by 6 %, they lie 20 mm
//! and more from where they are. So the reference takes all that has changed since they came to lie where they are.

use super::{
    Detector, LOUD, MAX_PRESSES, SUDDEN,
    fit::{Fit, Skin},
    press::Press,
    still::{self, Still},
    sums::{energy, take_out},
};
use crate::pipeline::reference::Changes;
use heapless::Vec;

/// Presses have lain still for so long, us.
const STILL: u32 = 1_000_000;
/// It is looked at no more often than this, us.
const EACH: u32 = 100_000;
/// Presses that move leave less than this share of what has changed.
const MOVED: f32 = 0.25;
/// Presses that leave more than this share of what they explain as they come to lie still are wider than the standard one:
/// what they leave changes with them.
const WIDE: f32 = 0.2;
/// Faster than all voltages that change by this share in a second no sheet drifts.
const FASTEST: f32 = 0.005;
/// After what presses leave has more than doubled others may come, us: one in each frame.
const SUDDENLY: u32 = 500_000;
/// What explains this share of what they leave is another press however slowly it comes, and what explains less drift.
pub(super) const SLOW: f32 = 0.85;

/// After a press beside which the sheet drifted, so long, us, what is weaker than this share of it, and less and less, is
/// what the drift took of it.
const RESTS: u32 = 1_500_000;
const REST: f32 = 0.2;

/// Presses that are held.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Held {
    presses: Vec<Still, MAX_PRESSES>,
    /// Since when, and when they were looked at last, in the clock's lower half, us.
    since_us: u32,
    looked_us: u32,
    are_wide: bool,
    /// Root of the energy that had changed then.
    changed: f32,
    /// What presses left in the frame before, and when it last was far more than before, us.
    left: f32,
    jumped_us: u32,
    /// What is weaker than this is a rest of presses beside which the sheet drifted; when there were any last, us.
    rest: f32,
    pressed_us: u32,
}

impl Held {
    pub(super) fn clear(&mut self) {
        self.presses.clear();
        (self.left, self.rest) = (0.0, 0.0);
    }

    /// Whether a press is what drift took of it, and has gone itself.
    pub(super) fn has_gone(&self, press: &Press) -> bool {
        self.rest > 0.0 && press.strength < REST * press.before
    }

    /// Whether a press of this strength may be a rest of those that went not long ago.
    // Once on the board, for all that asks.
    #[inline(never)]
    pub(super) fn is_rest(&self, strength: f32, now_us: u32) -> bool {
        let since = now_us.wrapping_sub(self.pressed_us);
        since < RESTS && strength < self.rest * (1.0 - since as f32 / RESTS as f32)
    }

    /// Whether presses have lain still for long enough.
    pub(super) fn is_still(&self, now_us: u32) -> bool {
        !self.are_wide && now_us.wrapping_sub(self.since_us) > STILL
    }

    /// Whether what presses leave has jumped not long ago.
    pub(super) fn is_sudden(&self, now_us: u32) -> bool {
        now_us.wrapping_sub(self.jumped_us) < SUDDENLY
    }

    /// Presses lie still from now on.
    // Once on the board, for all that asks.
    #[inline(never)]
    fn begin(&mut self, fit: &Fit<'_>, now_us: u32) {
        self.presses = still::of(&fit.presses);
        (self.since_us, self.looked_us) = (now_us, now_us);
        let left = fit.unexplained();
        (self.are_wide, self.changed) = (left > WIDE * fit.explained, libm::sqrtf(left.max(0.0)));
    }
}

impl Detector {
    /// Notes what presses of the frame before leave of this one.
    pub(super) fn note_left(&mut self, fit: &Fit<'_>) {
        let left = fit.unexplained();
        if left > 2.0 * self.held.left.max(LOUD * fit.spread()) || fit.presses.is_empty() {
            self.held.jumped_us = self.frame_us;
        }
        self.held.left = left;
        if !fit.presses.is_empty() {
            self.held.pressed_us = self.frame_us;
        } else if !self.held.is_rest(0.0, self.frame_us) {
            self.held.rest = 0.0;
        }
    }

    /// What has changed since the presses came to lie where they are, `[measurement]`, without what is common to all.
    // Once on the board, for all that asks.
    #[inline(never)]
    pub(super) fn changed(&self, skin: &Skin<'_>) -> Changes {
        let mut changed = Changes::new();
        changed.extend(self.sums.data.values.iter().copied());
        let mut take = |m: usize, change: f32| {
            if let Some(y) = changed.get_mut(m) {
                *y -= change;
            }
        };
        still::responses(&skin.places, &self.held.presses, &mut take);
        take_out(skin.common, &self.sums.data.weights, &mut changed);
        changed
    }

    /// Follows presses that are held; says whether the sheet drifts beside them.
    // Not inlined, so that what it needs of the stack is free again for all else.
    #[inline(never)]
    pub(super) fn follow_held(&mut self, fit: &Fit<'_>) -> bool {
        let now = self.frame_us;
        let is_same = self.held.presses.len() == fit.presses.len() && !fit.presses.iter().any(Press::is_new);
        if !is_same || self.held.are_wide {
            self.held.begin(fit, now);
            return false;
        }
        let since = now.wrapping_sub(self.held.looked_us);
        if since < EACH {
            return false;
        }
        let changed = self.changed(fit.skin);
        let energy = energy(&changed, &self.sums.data.weights) - fit.measurements * fit.noise;
        let root = libm::sqrtf(energy.max(0.0));
        let fastest = FASTEST * since as f32 * 1e-6 * libm::sqrtf(self.sums.scaled.of_common);
        let is_fast = root - self.held.changed > fastest;
        (self.held.looked_us, self.held.changed) = (now, root);
        if energy < LOUD * fit.spread() {
            return false;
        }
        let by_smooth = self.sums.known_of(&fit.skin.places, &changed).explained;
        let left = fit.unexplained();
        if is_fast || left < (MOVED * energy).min(energy - by_smooth) {
            self.held.begin(fit, now);
            return false;
        }
        let strongest = fit.presses.iter().fold(0.0, |most: f32, press| most.max(press.strength));
        let is_drift = strongest >= SUDDEN && self.held.is_still(now) && self.resembles < SLOW;
        if is_drift {
            self.held.rest = SUDDEN.max(REST * strongest);
        }
        is_drift
    }
}
