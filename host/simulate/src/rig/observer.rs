//! Observer: a board with the patch of one model, that sees what a rig scans.

use super::RigError;
use dermatome_model::{
    model::Model,
    quantize::{self, PatchBuildError},
    skin::Skin,
};
use dermatome_shared::{
    contact::{self, Contact},
    frame::Frame,
    patch::PatchView,
    pipeline::{self, PipelineState},
    units::RelativeConductivity,
};

/// Frames after which a board has found all of up to three fingers: in each it looks for one more at most.
pub const SETTLED: u16 = 6;

/// A board with the patch of one model. All it says is computed by the board's own code ([`pipeline`]): reference,
/// difference, reconstruction and contacts.
#[derive(Clone, Debug)]
pub struct Observer {
    model: Model,
    patch: Vec<u8>,
    state: PipelineState,
    /// Mean codes of the tare: `[step]`.
    reference: Vec<f64>,
}

impl Observer {
    /// Builds model and patch of a skin; there is no reference yet.
    pub fn new(skin: &Skin) -> Result<Self, RigError> {
        Self::with_model(skin, Model::build(skin, |_| ())?)
    }

    /// The same with a model that is built already.
    pub fn with_model(skin: &Skin, model: Model) -> Result<Self, RigError> {
        let patch = quantize::patch(skin, &model)?;
        Self::with_patch(model, patch)
    }

    /// The same with a patch of that model that is written already, such as a calibrated one.
    pub fn with_patch(model: Model, patch: Vec<u8>) -> Result<Self, RigError> {
        PatchView::open(&patch).map_err(PatchBuildError::Invalid)?;
        Ok(Self { model, patch, state: PipelineState::default(), reference: Vec::new() })
    }

    /// What its images are made with.
    #[must_use]
    pub fn model(&self) -> &Model {
        &self.model
    }

    /// The model's patch.
    #[must_use]
    pub fn patch(&self) -> PatchView<'_> {
        PatchView::open(&self.patch).expect("the patch was valid when it was made")
    }

    /// The same as it is flashed.
    #[must_use]
    pub fn patch_bytes(&self) -> &[u8] {
        &self.patch
    }

    /// Makes these frames its reference, and forgets all that came before.
    pub fn tare(&mut self, frames: &[Frame]) {
        self.state = PipelineState::default();
        self.state.start_tare(frames.len().try_into().unwrap_or(u16::MAX));
        frames.iter().for_each(|frame| {
            self.observe(frame);
        });
        let mean = |step: usize| {
            frames.iter().map(|f| f64::from(f.codes[step].0)).sum::<f64>() / frames.len() as f64
        };
        self.reference = (0..self.model.steps.len()).map(mean).collect();
    }

    /// What the board makes of the next frame.
    pub fn observe(&mut self, frame: &Frame) -> &PipelineState {
        let patch = PatchView::open(&self.patch).expect("the patch was valid when it was made");
        take(&patch, &mut self.state, frame);
        &self.state
    }

    /// What the board would make of the last of some frames if they came next.
    #[must_use]
    pub fn glance(&self, frames: &[Frame]) -> PipelineState {
        let mut state = self.state.clone();
        let patch = self.patch();
        frames.iter().for_each(|frame| take(&patch, &mut state, frame));
        state
    }

    /// Difference data that a host makes of the codes the board streams: `[measurement]`.
    #[must_use]
    pub fn difference(&self, frame: &Frame) -> Vec<f64> {
        let change = frame.codes.iter().zip(&self.reference).map(|(code, r)| f64::from(code.0) - r);
        self.model.difference_data(&change.collect::<Vec<_>>(), &self.reference)
    }

    /// Contacts that the board's code finds in an image, strongest first; relative conductivity changes, `[pixel]`.
    #[must_use]
    pub fn contacts(&self, image: &[f64]) -> Vec<Contact> {
        let patch = self.patch();
        let codes: Vec<_> = image.iter().map(|&value| RelativeConductivity::from_f64(value)).collect();
        contact::find(&patch.surface(), &codes, patch.header.contact_threshold).to_vec()
    }
}

/// As a board takes a frame: looks at its electrodes first.
fn take(patch: &PatchView<'_>, state: &mut PipelineState, frame: &Frame) {
    let mut frame = frame.clone();
    pipeline::examine(patch, state, patch.header.drive.frequency, &mut frame);
    pipeline::process(patch, state, &frame);
}
