//! Pipeline: measurements in, image and contacts out.
//!
//! The fixed configuration is the patch; [`PipelineState`] is all that changes.

use crate::{
    contact::{self, Contacts},
    frame::Frame,
    image::Image,
    patch::PatchView,
    reconstruct::reconstruct,
    reference::{DifferenceData, Reference, Tare},
};

/// What the pipeline remembers from frame to frame, and its latest results.
#[derive(Clone, Debug, Default)]
pub struct PipelineState {
    tare: Option<Tare>,
    reference: Option<Reference>,
    difference: DifferenceData,
    image: Image,
    contacts: Contacts,
}

/// What became of a frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Outcome {
    /// The frame does not hold one code per step of the patch, and was dropped.
    WrongLength,
    /// There is no reference yet; ask for a tare.
    NoReference,
    /// The frame went into the reference being averaged.
    Taring,
    /// The frame completed the reference.
    Tared,
    /// A new image and its contacts are there.
    Image,
}

/// Takes one frame through reference, reconstruction and contact finding.
pub fn process(patch: &PatchView<'_>, state: &mut PipelineState, frame: &Frame) -> Outcome {
    if frame.codes.len() != usize::from(patch.header.steps) {
        return Outcome::WrongLength;
    }
    if let Some(tare) = &mut state.tare {
        let Some(reference) = tare.add(patch, frame) else { return Outcome::Taring };
        state.tare = None;
        state.reference = Some(reference);
        return Outcome::Tared;
    }
    let Some(reference) = &state.reference else { return Outcome::NoReference };
    reference.difference(patch, frame, &mut state.difference);
    reconstruct(patch, &state.difference, &mut state.image);
    let header = &patch.header;
    state.contacts = contact::find(&header.grid, patch.mask(), &state.image, header.contact_threshold);
    Outcome::Image
}

impl PipelineState {
    /// Averages the next `frames` frames into a new reference.
    pub fn start_tare(&mut self, frames: u16) {
        self.tare = Some(Tare::new(frames));
    }

    /// Whether a reference is being averaged.
    #[must_use]
    pub fn is_taring(&self) -> bool {
        self.tare.is_some()
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::patch::{
        Difference,
        tests::{flat_frame, small_patch},
    };
    use crate::units::AdcCode;

    fn tared(patch: &PatchView<'_>, value: i32, frames: u16) -> PipelineState {
        let mut state = PipelineState::default();
        assert_eq!(process(patch, &mut state, &flat_frame(value)), Outcome::NoReference);
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
    fn a_frame_of_the_wrong_length_is_dropped_and_nothing_changes() {
        let bytes = small_patch(Difference::Plain);
        let patch = PatchView::validate(&bytes).unwrap();
        let mut state = tared(&patch, 700, 2);
        let mut frame = flat_frame(700);
        frame.codes.pop();
        assert_eq!(process(&patch, &mut state, &frame), Outcome::WrongLength);
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
