//! The board on a true skin: contacts found in the voltages, by its own code.

use super::find::Found;
use dermatome_model::{model::Model, skin::Skin};
use dermatome_simulate::{
    Noise, Rig, TrueSkin,
    rig::{Observer, RigError, SETTLED},
};
use num_complex::Complex64;

/// A board that was tared on the untouched true skin.
#[derive(Debug)]
pub(super) struct Board {
    rig: Rig,
    observer: Observer,
}

impl Board {
    /// Flashes the patch of `model`, whose skin is `skin`, and tares.
    pub(super) fn new(skin: &Skin, model: &Model, true_skin: &Skin, noise: Noise) -> Result<Self, RigError> {
        let mut observer = Observer::with_model(skin, model.clone())?;
        let mut rig = Rig::new(true_skin, &observer.patch(), noise)?;
        let untouched = rig.truth().conductivity(&[]);
        observer.tare(&rig.tare(&untouched));
        Ok(Self { rig, observer })
    }

    /// The true skin.
    #[must_use]
    pub(super) fn truth(&self) -> &TrueSkin {
        self.rig.truth()
    }

    /// What a scan meets on a sheet of this relative conductivity, `[element]`: phasors, `[slot]`.
    #[must_use]
    pub(super) fn solve(&self, conductivity: &[f64]) -> Vec<Complex64> {
        self.rig.solve(conductivity)
    }

    /// In-phase voltages among them: `[step]`.
    #[must_use]
    pub(super) fn in_phase(&self, phasors: &[Complex64]) -> Vec<f64> {
        self.rig.in_phase(phasors)
    }

    /// The contacts once such scans have come for a while, strongest first. Noise follows from a number above zero.
    #[must_use]
    pub(super) fn contacts(&self, phasors: &[Complex64], number: u64) -> Vec<Found> {
        let frames = self.rig.numbered_scans(phasors, SETTLED, number);
        self.observer.glance(&frames).contacts().iter().map(Found::from).collect()
    }
}
