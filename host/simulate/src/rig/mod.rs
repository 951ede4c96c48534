//! Rig: a true skin, the instrument that scans it, and the board's code that observes its frames.
//!
//! Everything that tries Dermatome on a simulated skin is put together here: [`Scanner`] numbers and times the frames
//! of any [`crate::instrument::Instrument`], as a board does; [`Rig`] is a scanner of a [`SimulatedSkin`] under one
//! patch, for sheets of any conductivity; an [`Observer`] is a board with the patch of one model, and several may
//! observe the frames of one rig. [`crate::board::SimulatedBoard`] is a scanner and a whole device behind a byte stream.
//! [`IdealRig`] stands for an instrument without a converter and a board that computes in f64, and [`PlaceRig`] for one
//! place of a sheet under a loading machine.

mod ideal;
mod observer;
mod place;
mod scanner;

pub use ideal::{IdealRig, Measured};
pub use observer::{Observer, SETTLED};
pub use place::PlaceRig;
pub use scanner::Scanner;

use crate::{instrument::ScanTable, noise::Noise, script::Script, skin::SimulatedSkin, truth::TrueSkin};
use dermatome_model::{indenter::Press, model::ModelError, quantize::PatchBuildError, skin::Skin};
use dermatome_shared::{frame::Frame, patch::PatchView, reference::DEFAULT_TARE_FRAMES};
use num_complex::Complex64;

/// A true skin under an instrument that scans it as one patch says.
#[derive(Debug)]
pub struct Rig {
    scanner: Scanner<SimulatedSkin>,
    table: ScanTable,
}

/// Why there is no rig of a skin.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum RigError {
    /// The skin has no model.
    #[error(transparent)]
    Model(#[from] ModelError),
    /// The skin has no patch.
    #[error(transparent)]
    Patch(#[from] PatchBuildError),
}

impl Rig {
    /// A true skin that nobody presses, scanned as `patch` says; the noise is that under the true skin's own drive.
    pub fn new(true_skin: &Skin, patch: &PatchView<'_>, noise: Noise) -> Result<Self, ModelError> {
        Ok(Self::of(SimulatedSkin::new(true_skin, Script::nobody(), noise)?, patch))
    }

    /// A skin pressed by its script, scanned as `patch` says.
    #[must_use]
    pub fn of(skin: SimulatedSkin, patch: &PatchView<'_>) -> Self {
        Self { scanner: Scanner::new(skin), table: ScanTable::of_patch(patch) }
    }

    /// The true skin.
    #[must_use]
    pub fn truth(&self) -> &TrueSkin {
        self.scanner.instrument().truth()
    }

    /// The instrument with the true skin.
    #[must_use]
    pub fn skin(&self) -> &SimulatedSkin {
        self.scanner.instrument()
    }

    /// What a scan meets on a sheet of this relative conductivity, `[element]` of the true skin: phasors at unit current
    /// and conductivity, `[slot]`.
    #[must_use]
    pub fn solve(&self, conductivity: &[f64]) -> Vec<Complex64> {
        self.solve_on(self.truth(), conductivity)
    }

    /// The same on another true skin with these electrodes, such as one whose nodes have moved.
    #[must_use]
    pub fn solve_on(&self, truth: &TrueSkin, conductivity: &[f64]) -> Vec<Complex64> {
        truth.phasors(conductivity, &self.table.slots(), self.table.drive.frequency.into())
    }

    /// One scan of what [`Self::solve`] gave, with noise and converter.
    pub fn scan(&mut self, phasors: &[Complex64]) -> Frame {
        let frame = self.scanner.instrument_mut().read(&self.table, phasors);
        self.scanner.stamp(frame, &self.table)
    }

    /// So many scans of it.
    pub fn scans(&mut self, phasors: &[Complex64], count: u16) -> Vec<Frame> {
        (0..count).map(|_| self.scan(phasors)).collect()
    }

    /// So many scans of it as if they came next, whose noise follows from a number above zero: in any order, on many
    /// threads. For the rig no time passes.
    #[must_use]
    pub fn numbered_scans(&self, phasors: &[Complex64], count: u16, number: u64) -> Vec<Frame> {
        let mut clock = self.scanner.clock();
        let frames = self.skin().read_numbered(&self.table, phasors, count, number);
        frames.into_iter().map(|frame| clock.stamp(frame, &self.table)).collect()
    }

    /// In-phase voltages among what [`Self::solve`] gave: `[step]`.
    #[must_use]
    pub fn in_phase(&self, phasors: &[Complex64]) -> Vec<f64> {
        phasors[..self.table.steps.len()].iter().map(|voltage| voltage.re).collect()
    }

    /// One scan under these presses.
    pub fn press(&mut self, presses: &[Press]) -> Frame {
        let phasors = self.solve(&self.truth().conductivity(presses));
        self.scan(&phasors)
    }

    /// One scan `script_time` seconds into the skin's script, or of the untouched skin.
    pub fn play(&mut self, script_time: Option<f64>) -> Frame {
        self.scanner.scan(&self.table, script_time)
    }

    /// The scans that a reference is made of, on a sheet of this relative conductivity, `[element]`.
    pub fn tare(&mut self, conductivity: &[f64]) -> Vec<Frame> {
        let phasors = self.solve(conductivity);
        self.scans(&phasors, DEFAULT_TARE_FRAMES)
    }

    /// Other noise from now on, from its seed's first number.
    pub fn change_noise(&mut self, noise: Noise) {
        self.scanner.instrument_mut().change_noise(noise);
    }
}

#[cfg(test)]
mod tests;
