//! What changed, by how well presses, a slip, a press that was lifted, and smooth changes of the sheet explain it.

use super::{Change, Detector, LOUD, UNDECIDED, filter::Look, fit::Fit, press::Press};

/// Standard deviations of chi square down to which the reference heals.
const HEALED: f32 = 1.0;
/// Presses leave more than this share of what they explain where there may be something else beside them.
const UNSETTLED: f32 = 0.05;
/// By so much more, in units of the noise's variance, one explanation is better than another.
pub(super) const CLEARLY: f32 = 12.0;
/// One that was lifted leaves less than this share of what one press more does. Near the rim of some skins the opposite of
/// a press elsewhere explains simulated fingers better than a press does; it left 0.37 to 0.45 of what that left.
const LIFT_LEAVES: f32 = 0.25;
/// Electrodes that slip by a hundredth of the skin's size leave less than this share of what changed unexplained, presses
/// hardly ever as little: simulated fingers of 3 to 10 % of the size leave at least 0.1 %, in corners, and 10 to 40 % in
/// most places.
const SLIP_LEAVES: f32 = 0.005;
/// And presses leave more of a slip than this share of what they explain, any other one press and smooth changes of the
/// rest.
const OTHERS_LEAVE: f32 = 0.15;
/// The same of one that is being mended.
const OTHERS_LEAVE_LATER: f32 = 0.05;

impl Detector {
    /// Whether a press that was taken away, which explains so much of what a fit leaves, accounts for all but hardly any of
    /// that, and one press more, which gains so much, does not, nor do smooth changes.
    pub(super) fn is_lift(&self, fit: &Fit<'_>, look: &Look, gain: f32, by_lift: f32) -> bool {
        by_lift > fit.explained.max(look.known.explained + CLEARLY * self.sums.data.noise)
            && look.left - by_lift + 3.0 * fit.spread() < LIFT_LEAVES * (look.left - gain)
    }

    /// Whether electrodes that slip, seen by a look at what a fit leaves, account for that, and one press more, which
    /// explains so much of it, does not, nor do smooth changes.
    // Once on the board, for all that asks.
    #[inline(never)]
    pub(super) fn is_slip(&self, fit: &Fit<'_>, look: &Look, by_press: f32) -> bool {
        let left = look.left;
        // While the reference follows a slip, what is common to all resembles it, and smooth changes what is common.
        let by_smooth = if self.is_slipped { 0.0 } else { look.known.explained };
        let left_by_others = left - by_press.max(look.least.1 * look.least.1).max(by_smooth);
        let share = if self.is_slipped { OTHERS_LEAVE_LATER } else { OTHERS_LEAVE };
        left_by_others > (share * left.max(fit.explained)).max(self.loud(fit))
            && left - look.known.with_slips < SLIP_LEAVES * left + 3.0 * fit.spread()
    }

    /// What more than noise leaves at least, in units of one frame's variance.
    fn loud(&self, fit: &Fit<'_>) -> f32 {
        let deviations = if self.unexplained < UNDECIDED { LOUD } else { HEALED };
        deviations * fit.spread()
    }

    /// Whether presses leave little but noise.
    pub(super) fn is_settled(&self, fit: &Fit<'_>) -> bool {
        fit.unexplained() <= self.loud(fit).max(UNSETTLED * fit.explained)
    }

    /// Whether presses account for most of what noise does not.
    pub(super) fn is_explained(&self, fit: &Fit<'_>) -> bool {
        let left = fit.unexplained();
        if fit.presses.is_empty() { left <= self.loud(fit) } else { left < fit.explained }
    }

    /// What changed, if these are the presses and this is what they leave.
    pub(super) fn judge(&self, fit: &Fit<'_>, look: &Look, level: f32) -> Change {
        let noise = self.sums.data.noise;
        let [most, least] = [look.most.1, look.least.1].map(|z| z * z);
        let smooth = look.known.explained;
        let is_clear = |one: f32, other: f32| one > other + CLEARLY * noise;
        let is_loud = |explained: f32| fit.significance(explained) > level;
        // What drift took of presses that have gone.
        let is_rest =
            self.held.is_rest(0.0, self.frame_us) && (is_loud(most.max(least)) || look.left > self.loud(fit));
        if !fit.presses.is_empty() {
            // What is left of presses is like all sorts of things.
            let is_of_one = 2.0 * least > fit.unexplained() && least > fit.explained;
            let is_settled = !fit.presses.iter().any(Press::is_new);
            if is_of_one && is_clear(least, smooth.max(most)) {
                Change::Lifted
            } else if is_settled && is_loud(smooth) && !self.held.is_still(self.frame_us) {
                Change::PressedAndSmooth
            } else {
                Change::Pressed
            }
        } else if is_rest
            || (is_loud(smooth) && is_clear(smooth, most.max(least)) && 2.0 * smooth > look.left)
        {
            Change::Smooth
        } else if is_loud(least) && 3.0 * least > look.left && is_clear(least, smooth.max(most)) {
            Change::Lifted
        } else if is_loud(most) {
            // No press was made of it: a rest of what lifts.
            if self.lifting.is_some() { Change::Lifted } else { Change::Pressed }
        } else {
            Change::Still
        }
    }
}
