//! Presses beside changes that are known to be none: a finger may move the electrodes that it pulls at.

use super::{Change, Detector, SUDDEN, fit::Fit, press::copy};

/// After so many frames of which presses leave much that is looked for, after so many again, and each so many from then on,
/// where they are fast or not: about each second. It takes longer than a fast frame.
const AFTER: u8 = 6;
const AGAIN: u8 = 22;
const EACH: u8 = 61;
const EACH_FAST: u8 = 4 * EACH;
/// Presses beside known changes explain so many times what both leave: what electrodes that slip by half a hundredth of the
/// skin's size leave, as they change voltages not quite linearly, looks like a press that explains up to 1.8 times the rest.
const EXPLAIN: f32 = 2.0;
/// Where presses alone explain most, this share of what they leave: fingers of 4 % of the size beside slips and stretches
/// leave up to 0.2 %, and as many presses without them hardly ever less than 2 %.
const LEAVE: f32 = 0.01;
/// Where there is a slip and no press, this share, and this one of all: slips of 2 % of the skin's size leave up to 0.8 %, as
/// they change voltages not quite linearly.
const KNOWN_LEAVE: f32 = 0.1;
const KNOWN_LEAVE_OF_ALL: f32 = 0.02;

/// Whether it is looked for after so many frames, fast ones or not.
pub(super) fn is_asked_after(frames: u8, is_fast: bool) -> bool {
    frames == AFTER || frames % if is_fast { EACH_FAST } else { EACH } == AGAIN
}

/// One frame more than so many; the count does not end.
pub(super) fn next_after(frames: u8) -> u8 {
    frames.checked_add(1).unwrap_or(u8::MAX - EACH_FAST + 1)
}

impl Detector {
    /// Fits presses together with electrodes that slip and smooth changes of the sheet, where presses alone leave much: a
    /// finger may move the electrodes that it pulls at. Takes them where they explain the frame far better, and else a slip
    /// without any where that does.
    // Not inlined, so that what it needs of the stack is free again for all else.
    #[inline(never)]
    pub(super) fn look_beside_known(&mut self, alone: &Fit<'_>, level: f32) {
        let looked_for = self.sums.latest_known;
        let mut fit = alone.beside_known(&mut self.sums);
        let mut look = fit.look(&mut self.sums, &self.norms);
        let by_known = look.left;
        while fit.has_room() {
            let Some(press) = fit.loudest(&look, &self.norms, level) else { break };
            let (count, explained) = (fit.presses.len(), fit.explained);
            let _ = fit.presses.push(press);
            fit.refine(&mut self.sums, true);
            if fit.explained - explained < level * level * fit.misfit() {
                fit.presses.truncate(count);
                fit.refine(&mut self.sums, true);
                break;
            }
            look = fit.look(&mut self.sums, &self.norms);
        }
        // As it is, not by the fit: what known changes explain is not quite known where they are alike.
        let left = look.left;
        let is_better = !self.is_explained(alone)
            || (fit.presses.len() <= alone.presses.len()
                && left.max(fit.spread()) < LEAVE * alone.unexplained());
        let is_pressed = fit.explained > EXPLAIN * left
            && fit.presses.first().is_some_and(|press| press.strength >= SUDDEN);
        if is_better && is_pressed {
            self.sums.latest_known.parts = fit.known(&mut self.sums);
            copy(&fit.presses, &mut self.presses);
            self.change = Change::PressedAndSlipped;
            (self.unexplained, self.unsettled, self.is_slipped) = (0, 0, false);
            self.average.restart();
            return;
        }
        self.sums.latest_known = looked_for;
        let by_noise = 3.0 * fit.spread();
        if by_known < KNOWN_LEAVE_OF_ALL * alone.energy + by_noise
            && by_known.max(by_noise) < KNOWN_LEAVE * alone.unexplained()
        {
            self.presses.clear();
            self.change = Change::Pressed;
            (self.unexplained, self.is_slipped, self.slipped_us) =
                (self.unexplained.max(1), true, Some(self.frame_us));
        }
    }
}
