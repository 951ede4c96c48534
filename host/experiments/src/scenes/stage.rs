//! Stage: a true skin under one instrument, and boards that see the same scans through models of their own.
//!
//! What the instrument reads are codes; all that follows from them is the board's own code ([`pipeline`]): reference,
//! difference, reconstruction and contacts.

use super::ScenesError;
use dermatome_model::{
    model::Model,
    quantize::{self, PatchBuildError},
    skin::Skin,
};
use dermatome_shared::{
    frame::Frame,
    patch::PatchView,
    pipeline::{self, PipelineState},
    reference::DEFAULT_TARE_FRAMES,
};
use dermatome_simulate::{Noise, Script, SimulatedSkin, TrueSkin, board::ScanTable};
use num_complex::Complex64;

/// A true skin and the instrument that scans it.
#[derive(Debug)]
pub(crate) struct Stage {
    simulated: SimulatedSkin,
    table: ScanTable,
    sequence: u32,
}

impl Stage {
    /// A true skin, scanned as this eye's patch says; the noise is that under the true skin's own drive.
    pub(crate) fn new(true_skin: &Skin, eye: &Eye, noise: Noise) -> Result<Self, ScenesError> {
        let outline = true_skin.shape.from_above()?;
        let still = Script::still(&[], &outline).expect("nothing to refuse");
        let patch = eye.patch();
        Ok(Self {
            simulated: SimulatedSkin::new(true_skin, still, noise)?,
            table: ScanTable::new(&patch, patch.header.drive),
            sequence: 0,
        })
    }

    /// The true skin.
    pub(crate) fn truth(&self) -> &TrueSkin {
        self.simulated.truth()
    }

    /// What a scan meets on a sheet of this relative conductivity, `[element]` of the true skin.
    pub(crate) fn solve(&self, conductivity: &[f64]) -> Vec<Complex64> {
        self.simulated.solve(&self.table, conductivity)
    }

    /// One scan of that, with noise and converter.
    pub(crate) fn scan(&mut self, phasors: &[Complex64]) -> Frame {
        self.sequence += 1;
        let period_us = 1e6 / f64::from(self.table.drive.frame_rate);
        let time_us = (f64::from(self.sequence) * period_us) as u64;
        self.simulated.read(&self.table, phasors).frame(self.sequence, time_us)
    }

    /// The scans that a reference is made of, on a sheet of this relative conductivity.
    pub(crate) fn tare(&mut self, conductivity: &[f64]) -> Vec<Frame> {
        let phasors = self.solve(conductivity);
        (0..DEFAULT_TARE_FRAMES).map(|_| self.scan(&phasors)).collect()
    }
}

/// A board with the patch of one model.
#[derive(Debug)]
pub(crate) struct Eye {
    pub(crate) model: Model,
    patch: Vec<u8>,
    state: PipelineState,
    /// Mean codes of the tare: `[step]`.
    reference: Vec<f64>,
}

impl Eye {
    /// Without a reference yet.
    pub(crate) fn new(skin: &Skin) -> Result<Self, ScenesError> {
        let model = Model::build(skin, |_| ())?;
        let patch = quantize::patch(skin, &model)?;
        PatchView::open(&patch).map_err(PatchBuildError::Invalid)?;
        Ok(Self { model, patch, state: PipelineState::default(), reference: Vec::new() })
    }

    /// Makes these frames its reference.
    pub(crate) fn tare(&mut self, frames: &[Frame]) {
        let mut state = PipelineState::default();
        state.start_tare(frames.len().try_into().unwrap_or(u16::MAX));
        for frame in frames {
            pipeline::process(&self.patch(), &mut state, frame);
        }
        self.state = state;
        let mean = |step: usize| {
            frames.iter().map(|f| f64::from(f.codes[step].0)).sum::<f64>() / frames.len() as f64
        };
        self.reference = (0..self.model.steps.len()).map(mean).collect();
    }

    /// What the board makes of a frame as the first one after its tare.
    pub(crate) fn look(&self, frame: &Frame) -> PipelineState {
        let mut state = self.state.clone();
        pipeline::process(&self.patch(), &mut state, frame);
        state
    }

    /// Difference data that a host makes of the codes the board streams: `[measurement]`.
    pub(crate) fn difference(&self, frame: &Frame) -> Vec<f64> {
        let change = frame.codes.iter().zip(&self.reference).map(|(code, r)| f64::from(code.0) - r);
        self.model.difference_data(&change.collect::<Vec<_>>(), &self.reference)
    }

    fn patch(&self) -> PatchView<'_> {
        PatchView::open(&self.patch).expect("the patch was valid when it was made")
    }
}
