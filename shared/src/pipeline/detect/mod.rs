//! Detection: presses are looked for in the difference data, where they stand out from the noise most.
//!
//! The matched filter z = a' S^-1 y / sqrt(a' S^-1 a) is the strongest test for a press of response a in data y with
//! covariance S (Kay, Fundamentals of Statistical Signal Processing II, chapter 4); on an untouched skin its variance is 1
//! wherever a lies. S is diagonal, as the board measured it ([`super::noise`]). The patch has the responses at some hundred
//! places.
//!
//! A change that is common to all voltages is no press, but drift, and says nothing of where one lies: it is taken out of
//! data and responses.
//!
//! The presses of the frame before are fitted to the new one (`fit`); what they leave is searched for another (`search`).
//! That takes most of the time: where there are presses, it is done in the frame after one that was found, and else not in
//! all. A press that noise, or what the others leave unexplained, accounts for is none.
//!
//! What changes slowly beside presses that are held (`held`) is drift, unless another press explains it, or a move of theirs.
//!
//! Some changes are known to be no press (`known`), but may come with one, as a finger pulls at the sheet. Where presses leave
//! much for some frames, both are fitted together; the reference takes at once what known changes explain then, so that what
//! is left of the data is presses.

mod beside;
mod filter;
mod fit;
mod held;
mod judge;
mod known;
mod leave;
mod lift;
mod opening;
mod press;
mod search;
mod spot;
mod still;
mod sums;
mod system;

use super::{
    UNKNOWN,
    average::Average,
    mask_measurements,
    noise::Noise,
    reference::{Changes, Reference},
};
use crate::{
    contact::{Contact, Contacts, Evidence},
    health::ElectrodeSet,
    limits::MAX_CONTACTS,
    patch::PatchView,
};
use filter::{Look, Norms};
use fit::{Fit, Skin};
use heapless::Vec;
use held::{Held, SLOW};
use judge::CLEARLY;
use lift::{LIFTS, Lifting};
use press::{Press, Was, copy, root};
use sums::Sums;

/// Most presses, with satellites.
const MAX_PRESSES: usize = MAX_CONTACTS + 2;
/// Most unknowns.
const MAX_UNKNOWNS: usize = spot::UNKNOWNS * MAX_CONTACTS;
/// Places whose normalisation is brought up to date in one frame.
const REFRESHED: usize = 2;
/// Frames with presses that are not searched for another, after one in which there was none: it takes long.
const PAUSE: u8 = 3;
/// Searches after one in which two presses for one explained no more, before that is asked again of the same presses: it
/// takes longer still.
const SPLIT_PAUSE: u8 = 16;
/// Frames closer than this are fast, us: there is no time to fit all presses twice in each.
const FAST: u32 = 5_000;
/// What has just come may move: its data are a mean of so few frames that this is left of their variance.
const FRESH: f32 = 0.15;
/// How many presses leave time for a search in each frame.
const PRESSES_IN_A_FRAME: usize = 3;
/// Standard deviations of chi square that noise does not leave.
pub(super) const LOUD: f32 = 8.0;
/// And those that one frame of noise hardly ever has.
pub(super) const NOISY: f32 = 5.0;
/// After so many frames that presses do not account for, what changed is something else.
const UNDECIDED: u8 = 20;
/// A press of this strength that was none in the frame before came faster than a sheet drifts.
const SUDDEN: f32 = 0.1;
/// A new press' strength alone is as significant as this share of the level: slopes may explain much where it is hardly any.
const OF_ITS_OWN: f32 = 0.5;
/// By so much more, in units of the noise's variance, a press that comes slowly explains than a smooth change, which would be
/// mended; it would not. One that explains hardly all of what changed.
const CLEARLY_PRESSED: f32 = 30.0;
/// How far the linear model of a press is off, beside noise: its position in radii of the standard press, its strength as
/// a share. Simulated fingers of 4 % of the size lie within two of these in 95 of 100 places on flat skins.
const MODEL_POSITION: f32 = 0.3;
const MODEL_STRENGTH: f32 = 0.11;
/// Frames after a known change in which only a press that comes suddenly is one.
const KNOWN_PAUSE: u8 = 100;
/// So long after electrodes slipped, us, as well: what the mend leaves of that is less than noise, and lasts.
const SLIPPED: u32 = 60_000_000;
/// What detection remembers from frame to frame. For a patch without places it does nothing.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Detector {
    noise: Noise,
    /// Electrodes that count for nothing.
    bad: ElectrodeSet,
    /// Inverse variances of the data: `[measurement]`.
    inverse_variances: Changes,
    norms: Norms,
    average: Average,
    /// The place whose norm is next to be brought up to date.
    next: usize,
    /// The latest frame's data, and sums over it.
    sums: Sums,
    /// Presses of the latest frame with their satellites.
    presses: Vec<Press, MAX_PRESSES>,
    /// Those that were contacts in the frame before.
    before: Vec<Was, MAX_CONTACTS>,
    /// Frames of which they do not account for most, one after the other.
    unexplained: u8,
    /// Frames of which they leave much, one after the other.
    unsettled: u8,
    change: Change,
    /// Whether electrodes have slipped.
    is_slipped: bool,
    /// Frames in which a press that comes slowly is taken for a change of the sheet.
    known_pause: u8,
    /// Searches of fast frames to come in which no two presses are asked for one.
    split_pause: u8,
    /// When electrodes were seen to slip last, in the clock's lower half, us, if that is not long ago.
    slipped_us: Option<u32>,
    /// Presses that are held, and what share of what they leave resembles another one.
    held: Held,
    resembles: f32,
    /// What was lifted not long ago.
    lifting: Option<Lifting>,
    /// Frames that are not searched for another press beside them.
    pause: u8,
    /// Whether presses went to other places in the latest frame: where frames come fast, those that lie still are asked to
    /// only in frames that are searched, as it takes long.
    is_going: bool,
    /// When the latest frame came, in the clock's lower half, and whether it came fast after the one before.
    frame_us: u32,
    is_fast: bool,
}

/// What has changed since the reference was made.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Change {
    /// Nothing, or no more than drift does.
    #[default]
    Still,
    /// Something presses, or may turn out to.
    Pressed,
    /// Something presses, and beside it the sheet changes smoothly.
    PressedAndSmooth,
    /// Something is held, and beside it the sheet drifts.
    PressedAndDrifted,
    /// Something presses, and electrodes slipped at once.
    PressedAndSlipped,
    /// The sheet, smoothly: some of it is warmer.
    Smooth,
    /// What pressed when the reference was made is gone.
    Lifted,
    /// Something that no press does.
    Unlike,
}

/// Presses of one frame, strongest first.
type Presses = Vec<Press, MAX_CONTACTS>;

impl Detector {
    /// Forgets all.
    pub fn clear(&mut self) {
        self.noise.restart();
        self.sums.clear();
        self.norms.clear();
        self.forget_presses();
    }

    /// Nothing presses.
    pub fn forget_presses(&mut self) {
        self.presses.clear();
        self.before.clear();
        self.held.clear();
        self.average.restart();
        (self.unexplained, self.unsettled, self.pause, self.known_pause, self.split_pause) = (0, 0, 0, 0, 0);
        (self.is_slipped, self.is_going, self.lifting, self.slipped_us) = (false, false, None, None);
        self.change = Change::Still;
    }

    /// Takes in a frame's measurements, of which those that need bad electrodes mean nothing.
    pub fn see(&mut self, patch: &PatchView<'_>, measured: &[i64], bad: ElectrodeSet) {
        self.bad = bad;
        if patch.header.has_places() {
            self.noise.see(measured);
            mask_measurements(patch, bad, UNKNOWN, self.noise.latest_mut());
        }
    }

    /// The frame seen last is part of a reference, perhaps the first of it.
    pub fn tare(&mut self, is_first: bool) {
        if is_first {
            self.noise.restart();
        }
        self.noise.count();
    }

    /// A new reference: nothing presses.
    pub fn begin(&mut self, patch: &PatchView<'_>, reference: &Reference) {
        self.norms.clear();
        self.forget_presses();
        self.judge_noise(patch, reference);
    }

    /// The frame seen last was in order and showed no press: follows the noise, a few places in each frame.
    pub fn follow(&mut self, patch: &PatchView<'_>, reference: &Reference) {
        if !patch.header.has_places() || !self.presses.is_empty() {
            return;
        }
        self.noise.count();
        if self.norms.is_empty() {
            return self.judge_noise(patch, reference);
        }
        let places = patch.places();
        if self.next == 0 {
            self.weigh(patch, reference);
            let layout = &patch.header.detection;
            self.sums.known.take(&places, layout, &self.inverse_variances, reference.weights());
        }
        self.sums.scaled.set(&places, &self.inverse_variances, reference.weights());
        for place in self.next..self.next + REFRESHED {
            if let Some(known) = self.norms.get_mut(place) {
                *known = filter::norm(&places, place, &self.sums.scaled);
            }
        }
        self.next = if self.next + REFRESHED < places.count() { self.next + REFRESHED } else { 0 };
    }

    /// The reference heals: what is common to all data changes with it, and known changes resemble that.
    pub fn heal(&mut self, patch: &PatchView<'_>, reference: &Reference) {
        let (places, layout) = (patch.places(), &patch.header.detection);
        self.sums.known.take(&places, layout, &self.inverse_variances, reference.weights());
        self.sums.clear();
    }

    /// Takes the noise as it is known now, if it is; until then there are no norms, and nothing is found.
    pub fn judge_noise(&mut self, patch: &PatchView<'_>, reference: &Reference) {
        if patch.header.has_places() && self.noise.is_known() {
            self.weigh(patch, reference);
            let (places, weights, common) = (patch.places(), &self.inverse_variances, reference.weights());
            self.sums.scaled.set(&places, weights, common);
            self.norms.clear();
            self.norms
                .extend((0..places.count()).map(|place| filter::norm(&places, place, &self.sums.scaled)));
            self.sums.known.take(&places, &patch.header.detection, weights, common);
            self.next = 0;
        }
    }

    /// Takes the noise of what is known.
    fn weigh(&mut self, patch: &PatchView<'_>, reference: &Reference) {
        self.noise.inverse_variances(patch, reference, &mut self.inverse_variances);
        mask_measurements(patch, self.bad, 0.0, &mut self.inverse_variances);
    }

    /// What has changed is no press, whatever it looks like; those of the frame before stay.
    pub fn begin_anew(&mut self) {
        self.held.clear();
        self.average.restart();
        (self.unexplained, self.unsettled, self.pause) = (0, 0, 0);
        self.change = Change::Still;
    }

    /// By how many standard deviations of chi square relative changes of one frame, `[measurement]`, without what is common
    /// to all, are more than noise; those that are not finite say nothing.
    pub fn chi_square(&self, relative: &mut Changes, reference: &Reference) -> f32 {
        let weights = &self.inverse_variances;
        let measurements = relative.iter().filter(|y| y.is_finite()).count() as f32;
        relative.iter_mut().filter(|y| !y.is_finite()).for_each(|y| *y = 0.0);
        sums::take_out(reference.weights(), weights, relative);
        (sums::energy(relative, weights) - measurements) / libm::sqrtf(2.0 * measurements.max(1.0))
    }

    /// Looks for presses in relative changes from a reference, `[measurement]`; those that are not finite say nothing.
    // Not inlined, so that what it needs of the stack is free again for all else.
    #[inline(never)]
    pub fn detect(&mut self, patch: &PatchView<'_>, relative: &[f32], reference: &Reference) {
        if self.norms.is_empty() {
            return;
        }
        let level = patch.header.detection.level;
        let skin = Skin::of(patch, reference.weights());
        let noise = self.average.variance() + reference.variance();
        self.sums.take(relative, &self.inverse_variances, reference.weights(), noise);
        let mut fit = Fit::new(&skin, &self.sums.data);
        fit.begin(&self.presses);
        while !fit.presses.is_empty() {
            let is_fresh = self.average.variance() > FRESH;
            let may_go = self.is_going || self.pause == 0 || !self.is_fast || is_fresh;
            self.is_going = fit.refine(&mut self.sums, may_go);
            if !fit.retain(&|press| press.is_held(level) && !self.held.has_gone(press)) {
                break;
            }
        }
        self.note_left(&fit);
        self.change = Change::Pressed;
        self.known_pause = self.known_pause.saturating_sub(1);
        self.lifting = self.lifting.filter(|lifting| self.frame_us.wrapping_sub(lifting.latest_us) < LIFTS);
        self.slipped_us = self.slipped_us.filter(|slipped| self.frame_us.wrapping_sub(*slipped) < SLIPPED);
        if fit.presses.is_empty() || self.pause == 0 {
            let mut look = fit.look(&mut self.sums, &self.norms);
            let count = fit.presses.len();
            self.resembles = look.most.1 * look.most.1 / look.left;
            self.pause = self.add_another(&mut fit, &mut look, level);
            if fit.presses.len() != count {
                self.split_pause = 0;
            } else if !self.is_slipped && !look.is_of_lift() {
                self.split_pause = match self.split_pause.checked_sub(1) {
                    Some(pause) if self.is_fast => pause,
                    _ => {
                        fit.split(&mut self.sums, &self.norms, level);
                        SPLIT_PAUSE
                    }
                };
            }
            self.change = self.judge(&fit, &look, level);
            self.sums.latest_known = look.known;
            if self.change == Change::Smooth {
                self.known_pause = KNOWN_PAUSE;
            }
            // What noise leaves of a slip that is mended is no other one.
            if self.is_slipped && look.left > LOUD * fit.spread() {
                self.slipped_us = Some(self.frame_us);
            }
            if self.change == Change::Lifted && look.is_of_lift() {
                self.drop_rests(&mut fit, &look, &patch.places());
            }
        } else {
            self.pause -= 1;
        }
        let is_known = self.change == Change::Smooth || self.change == Change::Lifted;
        let is_explained = !self.is_slipped && (is_known || self.is_explained(&fit));
        self.unexplained = if is_explained { 0 } else { self.unexplained.saturating_add(1) };
        let is_settled = is_explained && (is_known || self.is_settled(&fit));
        self.unsettled = if is_settled { 0 } else { beside::next_after(self.unsettled) };
        for press in &mut fit.presses {
            press.is_doubtful = !is_explained && (press.is_doubtful || press.is_new());
        }
        if self.unexplained >= UNDECIDED {
            fit.presses.retain(|press| !press.is_doubtful);
        }
        if self.unexplained > 0 {
            self.change = if self.is_undecided() { Change::Pressed } else { Change::Unlike };
        }
        copy(&fit.presses, &mut self.presses);
        if self.follow_held(&fit) && matches!(self.change, Change::Pressed | Change::PressedAndSmooth) {
            self.change = Change::PressedAndDrifted;
        }
        // What is told from presses is mended, or each such frame alone would have a contact.
        if beside::is_asked_after(self.unsettled, self.is_fast) && patch.header.drift_time > 0.0 {
            if self.is_fast && self.pause == PAUSE && !fit.presses.is_empty() {
                // A search as well takes too long for one frame: it is asked in the next, which has none.
                self.unsettled -= 1;
            } else {
                self.look_beside_known(&fit, level);
            }
        }
    }

    /// Adds one press more to the fit, if the data ask for it; says how many frames need not be asked next. Where that is no
    /// press, but one that was lifted, the look has what that explains.
    // Not inlined, so that what it needs of the stack is free again for all else.
    #[inline(never)]
    fn add_another(&mut self, fit: &mut Fit<'_>, look: &mut Look, level: f32) -> u8 {
        if !fit.has_room() {
            self.is_slipped = false;
            return PAUSE;
        }
        let by_most = look.most.1 * look.most.1;
        // What a press has to explain that did not come suddenly; by its place alone it explains half of that.
        let least = if self.held.is_sudden(self.frame_us) { 0.0 } else { SLOW * fit.unexplained() };
        let loudest = fit.loudest(look, &self.norms, level).filter(|_| 2.0 * by_most >= least);
        let Some(press) = loudest else {
            self.is_slipped = self.is_slip(fit, look, by_most);
            return PAUSE;
        };
        let strength = press.strength;
        let is_sudden = strength >= SUDDEN && least == 0.0;
        let mut next = fit.clone();
        let _ = next.presses.push(press);
        next.refine(&mut self.sums, true);
        // It may lie where one of the others was taken to be.
        let has_gone = next.retain(&|_| true);
        if has_gone && next.presses.iter().any(Press::is_new) {
            next.refine(&mut self.sums, true);
        }
        let gain = next.explained - fit.explained;
        self.resembles = if gain > look.known.explained { gain / look.left } else { 0.0 };
        self.is_slipped = self.is_slip(fit, look, gain);
        if !self.is_slipped && look.is_of_lift() {
            let by_lift = fit.by_lift(look, &self.norms, &mut self.sums);
            if self.is_lift(fit, look, gain, by_lift) {
                look.least.1 = -libm::sqrtf(by_lift);
                return PAUSE;
            }
        }
        let is_more = fit.is_asked_for(look, strength, gain, next.misfit(), level);
        // What comes slowly may be drift.
        let margin = if gain > SLOW * look.left { CLEARLY } else { CLEARLY_PRESSED };
        let clearly = look.known.explained + margin * self.sums.data.noise;
        let is_rest = self.lifting.is_some_and(|lifting| strength < lifting.rest)
            || (fit.presses.is_empty() && self.held.is_rest(strength, self.frame_us));
        let may_be_slow = self.known_pause == 0 && self.slipped_us.is_none();
        let is_press = !is_rest && (is_sudden || (may_be_slow && gain > clearly.max(least)));
        let has_new =
            next.presses.iter().any(|press| press.is_new() && press.significance > OF_ITS_OWN * level);
        if is_more && is_press && !self.is_slipped && has_new {
            fit.clone_from(&next);
            (fit.presses.len() / PRESSES_IN_A_FRAME) as u8
        } else {
            PAUSE
        }
    }

    /// Whether the latest frame leaves time for more: where frames come fast and something presses, one before a search.
    #[must_use]
    pub fn has_time(&self) -> bool {
        !self.is_fast || self.presses.is_empty() || self.pause == 1
    }

    /// What the latest frame shows to have changed.
    #[must_use]
    pub fn change(&self) -> Change {
        self.change
    }

    /// Whether the latest frame may turn out to be pressed, although presses do not account for it yet.
    fn is_undecided(&self) -> bool {
        (1..UNDECIDED).contains(&self.unexplained)
    }

    /// Finds the contacts of the latest frame, strongest first; none if it is of another kind than presses are, such as a
    /// sheet that became a better conductor. Strengths are those over the area of the standard press.
    // Not inlined, so that what it needs of the stack is free again for all else.
    #[inline(never)]
    pub fn contacts(&mut self, patch: &PatchView<'_>, contacts: &mut Contacts) {
        contacts.clear();
        if self.unexplained > 0 {
            return;
        }
        let (places, surface, radius) = (patch.places(), patch.surface(), patch.header.detection.radius);
        let contact = |press: &Press| Contact {
            position: press.spot.inside(&surface, &places, press.position),
            normal: spot::at(&surface, &places, press.spot.place()).1,
            area: core::f32::consts::PI * radius * radius,
            strength: press.strength,
            peak: press.strength,
            pressure: None,
            load_area: None,
            evidence: Some(Evidence {
                significance: press.significance,
                position_deviation: root(press.position_deviation, MODEL_POSITION * radius),
                strength_deviation: root(press.strength_deviation, MODEL_STRENGTH * press.strength),
            }),
            identity: None,
        };
        let mut presses = Presses::new();
        press::sort(&mut self.presses);
        press::gathered(&self.presses, &self.before, radius, &mut presses);
        self.before = press::remembered(&presses, &self.before, radius);
        contacts.extend(presses.iter().map(contact));
    }
}

#[cfg(test)]
mod tests;
