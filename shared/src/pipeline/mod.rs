//! Pipeline: measurements in, image and contacts out.
//!
//! The fixed configuration is the patch; [`PipelineState`] is all that changes.

pub mod average;
pub mod detect;
pub mod drift;
pub mod noise;
pub mod reconstruct;
pub mod reference;

use crate::{
    contact::{
        self, Contacts,
        hysteresis::{Places, Strengths},
    },
    drive::stimulation::Step,
    frame::{Frame, FrameFlags},
    health::ElectrodeSet,
    image::Image,
    patch::PatchView,
    units::RelativeConductivity,
};
use detect::{Change, Detector};
use drift::Drift;
use reconstruct::reconstruct;
use reference::{Changes, DEFAULT_TARE_FRAMES, DifferenceData, Measured, Reference, Tare};

/// A measurement that changes by more than this is more than a press does.
const IMPLAUSIBLE: f32 = 0.8;
/// A press near an electrode may do that to some measurements: to one in this many.
const IMPLAUSIBLE_SHARE: usize = 8;
/// No reference is made of such frames.
const UNFIT: FrameFlags = FrameFlags::NO_CURRENT.union(FrameFlags::SATURATED);
/// Nor does it follow such frames. Bad electrodes count for none of their measurements, and may be there.
const DOUBTFUL: FrameFlags = UNFIT.union(FrameFlags::IMPLAUSIBLE);

/// What the pipeline remembers from frame to frame, and its latest results.
#[derive(Clone, Debug, Default)]
pub struct PipelineState {
    tare: Option<Tare>,
    reference: Option<Reference>,
    drift: Drift,
    bad_electrodes: ElectrodeSet,
    flags: FrameFlags,
    difference: DifferenceData,
    image: Image,
    contacts: Contacts,
    places: Places,
    detector: Detector,
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
    state.detector.see(patch, &measured);
    if let Some(outcome) = state.average(patch, frame, &measured) {
        return outcome;
    }
    let Some(reference) = &state.reference else { return Outcome::Taring };
    reference.subtract(&mut measured);
    state.compare(patch, frame, &measured);
    if patch.header.has_places() {
        state.contacts = state.detector.contacts(patch);
    } else {
        reconstruct(patch, &state.difference, &mut state.image);
        state.contacts = contact::find(&patch.surface(), &state.image, patch.header.contact_threshold);
    }
    let strengths = state.without_hysteresis(patch);
    patch.header.calibration.apply(&mut state.contacts, &strengths);
    state.follow(patch, frame, &mut measured);
    Outcome::Image
}

/// Makes the image of the latest frame that [`sense`] took, unless the contacts came from it.
pub fn draw(patch: &PatchView<'_>, state: &mut PipelineState) {
    if patch.header.has_places() {
        reconstruct(patch, &state.difference, &mut state.image);
    }
}

impl PipelineState {
    /// Forgets all, as before the first frame: in place, where a new one would lie on the stack first.
    pub fn clear(&mut self) {
        let Self {
            tare,
            reference,
            drift,
            bad_electrodes,
            flags,
            difference,
            image,
            contacts,
            places,
            detector,
        } = self;
        (*tare, *reference, *drift, *places) = (None, None, Drift::default(), Places::default());
        (*bad_electrodes, *flags) = (ElectrodeSet::default(), FrameFlags::default());
        difference.codes.clear();
        image.clear();
        contacts.clear();
        detector.clear();
    }

    /// Averages the next `frames` frames into a new reference.
    pub fn start_tare(&mut self, frames: u16) {
        self.tare = Some(Tare::new(frames));
    }

    /// Measurements that need these electrodes count as unchanged from now on.
    pub fn mask(&mut self, bad_electrodes: ElectrodeSet) {
        self.bad_electrodes = bad_electrodes;
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
        let Some(reference) = reference else { return Some(Outcome::Taring) };
        self.detector.begin(patch, &reference);
        (self.tare, self.reference, self.drift) = (None, Some(reference), Drift::default());
        self.places = Places::default();
        Some(Outcome::Tared)
    }

    /// Differences -> difference data, without drift and bad electrodes, and presses in them.
    // Not inlined, so that what it needs of the stack is free again for all else.
    #[inline(never)]
    fn compare(&mut self, patch: &PatchView<'_>, frame: &Frame, differences: &[i64]) {
        let Some(reference) = &self.reference else { return };
        let mut relative = Changes::new();
        reference.relative_change(differences, &mut relative);
        let masked = mask_measurements(patch, self.bad_electrodes, &mut relative);
        self.flags.insert_if(FrameFlags::MASKED, masked);
        if frame.flags.contains(FrameFlags::NO_CURRENT) {
            relative.fill(UNKNOWN);
        }
        self.flags.insert_if(FrameFlags::IMPLAUSIBLE, is_implausible(&relative));
        let drift_time = patch.header.drift_time;
        self.drift.correct(&mut relative, reference.weights(), frame.timestamp_us, drift_time);
        self.detector.average(patch, &mut relative, frame.timestamp_us);
        self.difference.quantise(&relative, patch.matrix().column_exponents());
        self.detector.detect(patch, &relative, reference);
        self.flags.insert_if(FrameFlags::UNLIKE_PRESS, self.detector.change() == Change::Unlike);
        self.flags.insert_if(FrameFlags::LIFTED, self.detector.change() == Change::Lifted);
    }

    /// Strengths of the contacts without hysteresis: `[contact]`.
    fn without_hysteresis(&mut self, patch: &PatchView<'_>) -> Strengths {
        let threshold = patch.header.contact_threshold;
        let quarter =
            |contact: &contact::Contact| RelativeConductivity::from_f64(f64::from(contact.peak) / 4.0);
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
        if change == Change::Pressed {
            self.drift.touch(frame.timestamp_us);
        }
        let Some(reference) = &mut self.reference else { return };
        if frame.flags.intersects(DOUBTFUL) || self.flags.intersects(DOUBTFUL) {
            return;
        }
        if change == Change::Still {
            self.detector.follow(patch, reference);
        }
        if change == Change::Pressed && !self.detector.is_smooth_beside() {
            return;
        }
        let Some(part) = self.drift.part(change, patch.header.drift_time) else { return };
        let code =
            |m: usize, response: f32| reference.scales().get(m).map_or(0, |scale| (response / scale) as i64);
        if change == Change::Pressed {
            differences.fill(0);
            self.detector.add_smooth(patch, |m, response| differences[m] += code(m, response));
        } else {
            self.detector.add_responses(patch, reference, |m, response| differences[m] -= code(m, response));
        }
        let mut parts = Changes::new();
        let _ = parts.resize(reference.sums().len(), part);
        mask_measurements(patch, self.bad_electrodes, &mut parts);
        reference.follow(patch, differences, &parts);
        if change != Change::Pressed {
            self.drift.followed(part);
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
        self.tare.as_ref().is_some_and(|tare| !tare.is_automatic())
    }

    /// The reference in use.
    #[must_use]
    pub fn reference(&self) -> Option<&Reference> {
        self.reference.as_ref()
    }

    /// Difference data of the latest image.
    #[must_use]
    pub fn difference(&self) -> &DifferenceData {
        &self.difference
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

/// Makes the value of every measurement that needs a bad electrode unknown; says whether there are bad ones.
fn mask_measurements(patch: &PatchView<'_>, bad: ElectrodeSet, relative: &mut Changes) -> bool {
    if bad.is_empty() {
        return false;
    }
    let needs_bad = |step: Step| step.to_bytes().into_iter().any(|electrode| bad.contains(electrode));
    for (_, target) in patch.steps().zip(patch.combination()).filter(|&(step, _)| needs_bad(step)) {
        if let Some(change) = relative.get_mut(usize::from(target.measurement)) {
            *change = UNKNOWN;
        }
    }
    true
}

fn is_implausible(relative: &[f32]) -> bool {
    let far = relative.iter().filter(|&&change| change.abs() > IMPLAUSIBLE).count();
    far * IMPLAUSIBLE_SHARE > relative.len()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::patch::{
        Difference,
        tests::{flat_frame, patch_with_hysteresis, small_patch},
    };
    use crate::{contact::hysteresis::PlayOperator, units::AdcCode};

    fn tared(patch: &PatchView<'_>, value: i32, frames: u16) -> PipelineState {
        let mut state = PipelineState::default();
        state.start_tare(frames);
        for _ in 1..frames {
            assert_eq!(process(patch, &mut state, &flat_frame(value)), Outcome::Taring);
        }
        assert_eq!(process(patch, &mut state, &flat_frame(value)), Outcome::Tared);
        state
    }

    #[test]
    fn normalised_data_is_the_change_over_the_reference_of_each_measurement() {
        let bytes = small_patch(Difference::Normalised);
        let patch = PatchView::validate(&bytes).unwrap();
        let mut state = tared(&patch, -2000, 20);
        let mut frame = flat_frame(-2000);
        frame.codes[1] = AdcCode(-2500);
        frame.codes[3] = AdcCode(-1900);
        assert_eq!(process(&patch, &mut state, &frame), Outcome::Image);
        let image: std::vec::Vec<_> = state.image().iter().map(|value| value.to_f64()).collect();
        for (value, expected) in image.iter().zip([0.0, 0.25, 0.0, -0.05]) {
            assert!((value - expected).abs() < 1e-5, "{image:?}");
        }
        assert_eq!(state.contacts().len(), 1);
        assert!((state.contacts()[0].position[0] - 0.005).abs() < 1e-6);
    }

    #[test]
    fn plain_data_is_the_change_over_the_mean_reference() {
        let bytes = small_patch(Difference::Plain);
        let patch = PatchView::validate(&bytes).unwrap();
        let mut uneven = flat_frame(1000);
        uneven.codes[0] = AdcCode(-5000);
        let mut state = PipelineState::default();
        state.start_tare(1);
        assert_eq!(process(&patch, &mut state, &uneven), Outcome::Tared);
        uneven.codes[0] = AdcCode(-5220);
        assert_eq!(process(&patch, &mut state, &uneven), Outcome::Image);
        // Mean of |v_ref|: (5000 + 39 * 1000) / 40 = 1100.
        assert!((state.image()[0].to_f64() + 0.2).abs() < 1e-5);
    }

    #[test]
    fn strengths_are_averaged_within_half_the_threshold_and_count_at_once_beyond() {
        let bytes = patch_with_hysteresis(&[PlayOperator::from_f64(10.0, 1.5)]);
        let patch = PatchView::validate(&bytes).unwrap();
        let mut state = tared(&patch, 1000, 20);
        // 100 kPa for each 1, and a first press passes unchanged. The threshold is 0.01: of a step of 0.015, all but
        // the last 0.005 counts at once, and an eighth of that.
        for (code, pressure) in [(1100, 10_000.0 - 7.0 / 8.0 * 500.0), (1115, 9562.5 + 1437.5 + 62.5)] {
            assert_eq!(process(&patch, &mut state, &flat_frame(code)), Outcome::Image);
            let found = state.contacts()[0].pressure.unwrap();
            assert!((found - pressure).abs() < 100.0, "{code}: {found} Pa");
        }
    }

    #[test]
    fn a_frame_of_the_wrong_length_is_dropped_and_nothing_changes() {
        let bytes = small_patch(Difference::Plain);
        let patch = PatchView::validate(&bytes).unwrap();
        let mut state = tared(&patch, 700, 2);
        let mut frame = flat_frame(700);
        frame.codes.pop();
        assert_eq!(process(&patch, &mut state, &frame), Outcome::WrongLength);
    }

    #[test]
    fn without_a_reference_twenty_steady_frames_make_one() {
        let bytes = small_patch(Difference::Plain);
        let patch = PatchView::validate(&bytes).unwrap();
        let mut state = PipelineState::default();
        let mut steps = (0..25).map(|n| if n < 5 { 1000 + 100 * n } else { 2000 });
        let outcomes: std::vec::Vec<_> =
            steps.by_ref().map(|value| process(&patch, &mut state, &flat_frame(value))).collect();
        assert!(outcomes[..24].iter().all(|outcome| *outcome == Outcome::Taring));
        assert_eq!(outcomes[24], Outcome::Tared);
        assert_eq!(state.reference().unwrap().sums()[7], 20 * 2000);
    }

    #[test]
    fn frames_without_current_make_no_reference() {
        let bytes = small_patch(Difference::Plain);
        let patch = PatchView::validate(&bytes).unwrap();
        let mut state = PipelineState::default();
        state.start_tare(1);
        let dead = Frame { flags: FrameFlags::NO_CURRENT, ..flat_frame(3) };
        assert_eq!(process(&patch, &mut state, &dead), Outcome::Taring);
        assert_eq!(process(&patch, &mut state, &flat_frame(700)), Outcome::Tared);
    }

    #[test]
    fn saturated_frames_make_no_reference_and_frames_without_current_no_contact() {
        let bytes = small_patch(Difference::Normalised);
        let patch = PatchView::validate(&bytes).unwrap();
        let mut state = PipelineState::default();
        state.start_tare(1);
        let saturated = Frame { flags: FrameFlags::SATURATED, ..flat_frame(900) };
        assert_eq!(process(&patch, &mut state, &saturated), Outcome::Taring);
        assert_eq!(process(&patch, &mut state, &flat_frame(-700)), Outcome::Tared);
        let pressed = flat_frame(-1400);
        assert_eq!(process(&patch, &mut state, &pressed), Outcome::Image);
        assert_eq!(state.contacts().len(), 1);
        let dead = Frame { flags: FrameFlags::NO_CURRENT, ..pressed };
        assert_eq!(process(&patch, &mut state, &dead), Outcome::Image);
        assert!(state.contacts().is_empty() && state.image().iter().all(|value| value.0 == 0));
    }

    #[test]
    fn drift_is_followed_beside_a_bad_electrode_whose_measurements_stay() {
        let bytes = crate::patch::tests::drifting_patch(30.0);
        let patch = PatchView::validate(&bytes).unwrap();
        let mut state = tared(&patch, 1_000_000, 2);
        state.mask(ElectrodeSet(1 << 3));
        let mut parts = Changes::new();
        parts.resize(patch.header.measurements.into(), 0.0).unwrap();
        mask_measurements(&patch, ElectrodeSet(1 << 3), &mut parts);
        let values = drifting(&patch, &mut state, 10.0, [0.0, 300.0], 0.0);
        assert!(values.iter().all(|value| value.abs() < 0.008), "{:?}", values.last());
        assert!(state.contacts().is_empty());
        assert_eq!(state.flags(), FrameFlags::MASKED);
        assert!(parts.iter().any(|part| part.is_nan()) && !parts.iter().all(|part| part.is_nan()));
        for (sum, part) in state.reference().unwrap().sums().iter().zip(&parts) {
            assert_eq!(*sum == 2_000_000, part.is_nan(), "{sum}");
        }
    }

    #[test]
    fn voltages_that_no_press_explains_are_flagged() {
        let bytes = small_patch(Difference::Normalised);
        let patch = PatchView::validate(&bytes).unwrap();
        let mut state = tared(&patch, 1000, 2);
        let mut frame = flat_frame(1000);
        frame.codes.iter_mut().step_by(6).for_each(|code| code.0 = 0);
        process(&patch, &mut state, &frame);
        assert_eq!(state.flags(), FrameFlags::IMPLAUSIBLE);
        frame = flat_frame(1000);
        frame.codes.iter_mut().step_by(10).for_each(|code| code.0 = 0);
        process(&patch, &mut state, &frame);
        assert_eq!(state.flags(), FrameFlags::default());
    }

    /// Frames for `seconds`, so many a second: all voltages drift by 1 % a minute, and measurement 1 is
    /// pressed by `press`.
    fn drifting(
        patch: &PatchView<'_>,
        state: &mut PipelineState,
        rate: f64,
        [start, seconds]: [f64; 2],
        press: f64,
    ) -> std::vec::Vec<f64> {
        let mut values = std::vec::Vec::new();
        for n in 0..(seconds * rate) as usize {
            let time = start + n as f64 / rate;
            let drift = 1.0 - time / 6000.0;
            let mut frame = flat_frame((1e6 * drift) as i32);
            frame.codes[1] = AdcCode((1e6 * drift * (1.0 + press)) as i32);
            frame.timestamp_us = (time * 1e6) as u64;
            process(patch, state, &frame);
            values.push(state.image()[1].to_f64());
        }
        values
    }

    #[test]
    fn drift_is_followed_and_a_held_press_is_not() {
        let bytes = crate::patch::tests::drifting_patch(30.0);
        let patch = PatchView::validate(&bytes).unwrap();
        for rate in [10.0, 1.0, 0.5] {
            let mut state = tared(&patch, 1_000_000, 2);
            let untouched = drifting(&patch, &mut state, rate, [0.0, 300.0], 0.0);
            assert!(untouched.iter().all(|value| value.abs() < 0.008), "{:?}", untouched.last());
            assert!(state.contacts().is_empty());
            let pressed = drifting(&patch, &mut state, rate, [300.0, 600.0], 0.2);
            let (first, last) = (pressed[2], pressed[pressed.len() - 1]);
            assert!((first - 0.2).abs() < 0.01 && (last - first).abs() < 0.02 * first, "{first} {last}");
            assert_eq!(state.contacts().len(), 1);
            let released = drifting(&patch, &mut state, rate, [900.0, 100.0], 0.0);
            assert!(released[5..].iter().all(|value| value.abs() < 0.01), "{:?}", released.last());
        }
    }

    #[test]
    fn without_a_drift_time_nothing_is_followed() {
        let bytes = small_patch(Difference::Normalised);
        let patch = PatchView::validate(&bytes).unwrap();
        let mut state = tared(&patch, 1_000_000, 2);
        let last = drifting(&patch, &mut state, 10.0, [0.0, 300.0], 0.0).pop().unwrap();
        assert!((last + 0.05).abs() < 1e-3, "{last}");
    }

    #[test]
    fn a_dead_measurement_reads_zero_instead_of_infinity() {
        let bytes = small_patch(Difference::Normalised);
        let patch = PatchView::validate(&bytes).unwrap();
        let mut state = tared(&patch, 0, 2);
        assert_eq!(process(&patch, &mut state, &flat_frame(90)), Outcome::Image);
        assert!(state.image().iter().all(|value| value.0 == 0));
    }
}
