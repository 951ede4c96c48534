//! Pipeline: measurements in, image and contacts out.
//!
//! The fixed configuration is the patch; [`PipelineState`] is all that changes.

pub mod average;
pub mod detect;
pub mod drift;
mod former;
pub mod noise;
pub mod reconstruct;
pub mod reference;
pub mod reflex;
mod wiring;

use crate::{
    contact::{
        self, Contacts,
        hysteresis::{Places, Strengths},
        track::Tracker,
    },
    drive::stimulation::Step,
    frame::{Frame, FrameFlags},
    health::{ElectrodeSet, Health},
    image::Image,
    patch::PatchView,
    units::RelativeConductivity,
};
use detect::{Change, Detector, LOUD, NOISY};
use drift::Drift;
use former::Former;
use reconstruct::reconstruct;
use reference::{Changes, DEFAULT_TARE_FRAMES, DifferenceData, Measured, Reference, Tare};
use wiring::Wiring;

/// A measurement that changes by more than this is more than a press does.
const IMPLAUSIBLE: f32 = 0.8;
/// A press near an electrode may do that to some measurements: to one in this many.
const IMPLAUSIBLE_SHARE: usize = 8;
/// No reference is made of such frames.
pub const UNFIT: FrameFlags = FrameFlags::NO_CURRENT.union(FrameFlags::SATURATED);
/// Nor does it follow such frames. Bad electrodes count for none of their measurements, and may be there.
const DOUBTFUL: FrameFlags = UNFIT.union(FrameFlags::IMPLAUSIBLE);

/// What [`sense`] itself finds in a frame, beside the frame's own flags.
const FOUND_LATER: FrameFlags = FrameFlags::IMPLAUSIBLE
    .union(FrameFlags::MASKED)
    .union(FrameFlags::UNLIKE_PRESS)
    .union(FrameFlags::LIFTED);

/// What the pipeline remembers from frame to frame, and its latest results.
#[derive(Clone, Debug, Default)]
pub struct PipelineState {
    tare: Option<Tare>,
    reference: Option<Reference>,
    former: Former,
    drift: Drift,
    wiring: Wiring,
    flags: FrameFlags,
    /// Relative changes of the latest frame, as contacts and image take them: `[measurement]`.
    relative: Changes,
    image: Image,
    contacts: Contacts,
    places: Places,
    detector: Detector,
    tracker: Tracker,
}

/// What became of a frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Outcome {
    /// The frame does not hold one code per step of the patch, and was dropped.
    WrongLength,
    /// The frame went into the reference being averaged.
    Taring,
    /// The frame completed the reference.
    Tared,
    /// New contacts are there, and data for an image.
    Image,
}

/// Takes one frame through all steps, from reference to calibration and image.
pub fn process(patch: &PatchView<'_>, state: &mut PipelineState, frame: &Frame) -> Outcome {
    let outcome = sense(patch, state, frame);
    if outcome == Outcome::Image {
        draw(patch, state);
    }
    outcome
}

/// Looks at a frame's tests and at what is clipped, with a carrier of this `frequency` (Hz): sets the flags that follow, and
/// masks bad electrodes in this frame and those to come.
pub fn examine(
    patch: &PatchView<'_>,
    state: &mut PipelineState,
    frequency: f32,
    frame: &mut Frame,
) -> Health {
    let (mut health, found) = Health::examine(patch, frequency, frame);
    frame.flags.insert(found);
    health.worse = state.wiring.see(health.bad_electrodes(), &frame.tests);
    frame.flags.insert_if(FrameFlags::WORSE_CONTACT, !health.worse.is_empty());
    let counts = |(number, step)| frame.clipped.contains(number) && !needs(step, state.wiring.bad());
    let is_saturated = !frame.clipped.is_empty() && patch.steps().enumerate().any(counts);
    frame.flags.insert_if(FrameFlags::SATURATED, is_saturated);
    health
}

/// As [`examine`], for a frame of a recording, whose flags and bad electrodes are known: `health` is what the board found.
pub fn recall(state: &mut PipelineState, health: &Health, frame: &mut Frame) {
    state.wiring.take(health.bad_electrodes());
    frame.flags = frame.flags.without(FOUND_LATER);
}

/// Takes one frame from reference to calibrated contacts, which need no image where the patch has places to look for
/// them.
///
/// Without a reference, a tare of [`DEFAULT_TARE_FRAMES`] steady frames begins by itself.
pub fn sense(patch: &PatchView<'_>, state: &mut PipelineState, frame: &Frame) -> Outcome {
    if frame.codes.len() != usize::from(patch.header.steps) {
        return Outcome::WrongLength;
    }
    state.flags = FrameFlags::default();
    let mut measured = Measured::new();
    reference::combine(patch, frame, &mut measured);
    state.detector.see(patch, &measured, state.wiring.bad());
    if let Some(outcome) = state.average(patch, frame, &measured) {
        return outcome;
    }
    let Some(reference) = &state.reference else { return Outcome::Taring };
    reference.subtract(&mut measured);
    if state.wiring.is_settling() {
        state.settle(patch, frame, &mut measured);
        return Outcome::Image;
    }
    state.compare(patch, frame, &measured);
    if state.undo_wrong_mend(patch, &mut measured) {
        state.compare(patch, frame, &measured);
    }
    if patch.header.has_places() {
        state.detector.contacts(patch, &mut state.contacts);
    } else {
        state.reconstruct(patch);
        state.contacts = contact::find(&patch.surface(), &state.image, patch.header.contact_threshold);
    }
    let strengths = state.without_hysteresis(patch);
    patch.header.calibration.apply(&mut state.contacts, &strengths);
    state.tracker.follow(frame.timestamp_us, patch.header.detection.radius, &mut state.contacts);
    state.follow(patch, frame, &mut measured);
    Outcome::Image
}

/// Makes the image of the latest frame that [`sense`] took, unless the contacts came from it.
pub fn draw(patch: &PatchView<'_>, state: &mut PipelineState) {
    if patch.header.has_places() {
        state.reconstruct(patch);
    }
}

impl PipelineState {
    /// Forgets all, as before the first frame: in place, where a new one would lie on the stack first.
    pub fn clear(&mut self) {
        let Self {
            tare,
            reference,
            former,
            drift,
            wiring,
            flags,
            relative,
            image,
            contacts,
            places,
            detector,
            tracker,
        } = self;
        (*tare, *reference, *drift, *places) = (None, None, Drift::default(), Places::default());
        (*wiring, *flags) = (Wiring::default(), FrameFlags::default());
        former.clear();
        relative.clear();
        image.clear();
        contacts.clear();
        detector.clear();
        tracker.forget();
    }

    /// Averages the next `frames` frames into a new reference.
    pub fn start_tare(&mut self, frames: u16) {
        self.tare = Some(Tare::new(frames));
    }

    /// What the latest frame showed to be wrong, beside its own flags.
    #[must_use]
    pub fn flags(&self) -> FrameFlags {
        self.flags
    }

    /// Drift of all voltages that is taken out of the images, relative.
    #[must_use]
    pub fn common_drift(&self) -> f32 {
        self.drift.common()
    }

    /// Adds a frame to the reference that is being averaged; none if there is nothing to average any more.
    // Not inlined, so that what it needs of the stack is free again for all else.
    #[inline(never)]
    fn average(&mut self, patch: &PatchView<'_>, frame: &Frame, measured: &[i64]) -> Option<Outcome> {
        if self.reference.is_none() && self.tare.is_none() {
            self.tare = Some(Tare::of_steady_frames(DEFAULT_TARE_FRAMES));
        }
        let tare = self.tare.as_mut()?;
        if frame.flags.intersects(UNFIT) {
            if tare.gives_up() {
                self.tare = None;
            }
            return Some(Outcome::Taring);
        }
        let reference = tare.add(patch, measured);
        self.detector.tare(tare.has_begun());
        if tare.has_begun() {
            self.wiring.begin();
        }
        let Some(reference) = reference else { return Some(Outcome::Taring) };
        self.detector.begin(patch, &reference);
        self.wiring.keep(&frame.tests);
        (self.tare, self.reference, self.drift) = (None, Some(reference), Drift::default());
        self.places = Places::default();
        self.former.clear();
        Some(Outcome::Tared)
    }

    /// Returns to the former reference where a frame is as that has it, down to noise, and not as the present one has it;
    /// differences from the reference, `[measurement]`, become those from the former one. Says whether it did.
    // Not inlined, so that what it needs of the stack is free again for all else.
    #[inline(never)]
    fn undo_wrong_mend(&mut self, patch: &PatchView<'_>, differences: &mut [i64]) -> bool {
        let Some(reference) = &mut self.reference else { return false };
        let is_asked = self.former.is_kept() && self.detector.has_time();
        if self.detector.change() == Change::Still || !is_asked {
            return false;
        }
        let chi_square = |reference: &Reference, differences: &[i64]| {
            let mut changes = Changes::new();
            reference.relative_change(differences, &mut changes);
            mask_measurements(patch, self.wiring.bad(), UNKNOWN, &mut changes);
            self.detector.chi_square(&mut changes, reference)
        };
        let now = chi_square(reference, differences);
        self.former.shift(reference, differences, 1);
        let then = chi_square(reference, differences);
        let is_wrong = then < NOISY && now > then + LOUD;
        if is_wrong {
            self.former.undo(patch, reference);
            self.detector.forget_presses();
            self.detector.heal(patch, reference);
            self.flags = FrameFlags::default();
        } else {
            self.former.shift(reference, differences, -1);
        }
        is_wrong
    }

    /// Differences -> relative changes, without drift and bad electrodes, and presses in them.
    // Not inlined, so that what it needs of the stack is free again for all else.
    #[inline(never)]
    fn compare(&mut self, patch: &PatchView<'_>, frame: &Frame, differences: &[i64]) {
        let (Some(reference), relative) = (&self.reference, &mut self.relative) else { return };
        reference.relative_change(differences, relative);
        mask_measurements(patch, self.wiring.bad(), UNKNOWN, relative);
        self.flags.insert_if(FrameFlags::MASKED, !self.wiring.bad().is_empty());
        if frame.flags.contains(FrameFlags::NO_CURRENT) {
            relative.fill(UNKNOWN);
        }
        self.flags.insert_if(FrameFlags::IMPLAUSIBLE, is_implausible(relative));
        let drift_time = patch.header.drift_time;
        self.drift.correct(relative, reference.weights(), frame.timestamp_us, drift_time);
        self.detector.average(patch, relative, reference, frame.timestamp_us);
        self.detector.detect(patch, relative, reference);
        let is_unlike = matches!(self.detector.change(), Change::Unlike | Change::PressedAndSlipped);
        self.flags.insert_if(FrameFlags::UNLIKE_PRESS, is_unlike);
        self.flags.insert_if(FrameFlags::LIFTED, self.detector.change() == Change::Lifted);
    }

    /// Relative changes -> image.
    // Not inlined, so that what it needs of the stack is free again for all else.
    #[inline(never)]
    fn reconstruct(&mut self, patch: &PatchView<'_>) {
        if patch.header.has_places() && !self.wiring.bad().is_empty() {
            self.detector.fill_unknown(patch, &mut self.relative);
        }
        let mut difference = DifferenceData::default();
        difference.quantise(&self.relative, patch.matrix().column_exponents());
        reconstruct(patch, &difference, &mut self.image);
    }

    /// Strengths of the contacts without hysteresis: `[contact]`.
    fn without_hysteresis(&mut self, patch: &PatchView<'_>) -> Strengths {
        let threshold = patch.header.contact_threshold;
        let quarter = |contact: &contact::Contact| RelativeConductivity::from_f32(contact.peak / 4.0);
        let level = || self.contacts.first().map_or(threshold, quarter);
        let noise = RelativeConductivity(threshold.0 / 2);
        self.places.compensate(&patch.play_operators(), &self.contacts, noise, level)
    }

    /// The reference follows what is no press, where measurements are known: `[measurement]`, their differences from it.
    fn follow(&mut self, patch: &PatchView<'_>, frame: &Frame, differences: &mut [i64]) {
        let change = match self.detector.change() {
            _ if !patch.header.has_places() && !self.contacts.is_empty() => Change::Pressed,
            change => change,
        };
        let is_pressed = !matches!(change, Change::Still | Change::Smooth | Change::Unlike | Change::Lifted);
        if is_pressed {
            self.drift.touch(frame.timestamp_us);
        }
        let Some(reference) = &mut self.reference else { return };
        if frame.flags.intersects(DOUBTFUL) || self.flags.intersects(DOUBTFUL) {
            return;
        }
        if change == Change::Still {
            self.former.clear();
            self.detector.follow(patch, reference);
        }
        let Some(part) = self.drift.part(change, patch.header.drift_time, reference.variance()) else {
            return;
        };
        if change != Change::Still {
            self.former.keep(reference);
        }
        self.take_in(patch, differences, change, part);
        if !is_pressed {
            self.drift.followed(part);
        }
    }

    /// The reference goes this part of the way to a frame that differs from it like that, `[measurement]`, where measurements
    /// are known, and as far as such a change is no press.
    fn take_in(&mut self, patch: &PatchView<'_>, differences: &mut [i64], change: Change, part: f32) {
        let Some(reference) = &mut self.reference else { return };
        self.detector.leave_followed(patch, reference, change, differences);
        let mut parts = Changes::new();
        let _ = parts.resize(reference.sums().len(), part);
        mask_measurements(patch, self.wiring.bad(), UNKNOWN, &mut parts);
        reference.follow(patch, differences, &parts);
        if change != Change::PressedAndSlipped {
            reference.blur(part);
        }
        if matches!(change, Change::Unlike | Change::PressedAndSlipped) {
            self.detector.heal(patch, reference);
        }
    }

    /// The wiring has just changed: the reference takes all that is new beside the presses of the frame before, and there
    /// are no contacts.
    // Not inlined, so that what it needs of the stack is free again for all else.
    #[inline(never)]
    fn settle(&mut self, patch: &PatchView<'_>, frame: &Frame, differences: &mut [i64]) {
        self.contacts.clear();
        let _ = self.relative.resize(differences.len(), 0.0);
        self.relative.fill(0.0);
        self.flags.insert_if(FrameFlags::MASKED, !self.wiring.bad().is_empty());
        if !patch.header.has_places() {
            self.reconstruct(patch);
        }
        if frame.flags.intersects(UNFIT) {
            return;
        }
        self.former.clear();
        self.detector.begin_anew();
        self.take_in(patch, differences, Change::Unlike, 1.0);
        self.drift.followed(1.0);
        if self.wiring.has_settled()
            && let Some(reference) = &self.reference
        {
            self.detector.judge_noise(patch, reference);
        }
    }

    /// Whether a reference is being averaged.
    #[must_use]
    pub fn is_taring(&self) -> bool {
        self.tare.is_some()
    }

    /// Whether somebody asked for the reference that is being averaged.
    #[must_use]
    pub fn is_asked_to_tare(&self) -> bool {
        self.frames_asked_for().is_some()
    }

    /// How many frames the reference takes that is being averaged; none if nobody asked for it.
    #[must_use]
    pub fn frames_asked_for(&self) -> Option<u16> {
        self.tare.as_ref().filter(|tare| !tare.is_automatic()).map(Tare::frames)
    }

    /// The reference in use.
    #[must_use]
    pub fn reference(&self) -> Option<&Reference> {
        self.reference.as_ref()
    }

    /// The latest image.
    #[must_use]
    pub fn image(&self) -> &Image {
        &self.image
    }

    /// Contacts of the latest image.
    #[must_use]
    pub fn contacts(&self) -> &Contacts {
        &self.contacts
    }
}

/// What stands for the value of a measurement that means nothing.
const UNKNOWN: f32 = f32::NAN;

/// Gives this value to every measurement that needs a bad electrode.
// Once on the board, for all that asks.
#[inline(never)]
fn mask_measurements(patch: &PatchView<'_>, bad: ElectrodeSet, value: f32, values: &mut [f32]) {
    if bad.is_empty() {
        return;
    }
    for (_, target) in patch.steps().zip(patch.combination()).filter(|&(step, _)| needs(step, bad)) {
        if let Some(masked) = values.get_mut(usize::from(target.measurement)) {
            *masked = value;
        }
    }
}

/// Whether a step needs one of these electrodes.
fn needs(step: Step, electrodes: ElectrodeSet) -> bool {
    step.to_bytes().into_iter().any(|electrode| electrodes.contains(electrode))
}

fn is_implausible(relative: &[f32]) -> bool {
    let far = relative.iter().filter(|&&change| change.abs() > IMPLAUSIBLE).count();
    far * IMPLAUSIBLE_SHARE > relative.len()
}

#[cfg(test)]
mod tests;
