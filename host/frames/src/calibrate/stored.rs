//! What `calibrate` stores in a patch, so that another patch of the same skin can have it too.

use super::patch::with_calibration;
use dermatome_shared::{
    calibration::Calibration,
    hysteresis::PlayOperator,
    patch::{PatchError, PatchView},
};

/// Curve and plays of a patch.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Stored {
    /// Pressure and load area.
    pub curve: Calibration,
    /// Against hysteresis.
    pub plays: Vec<PlayOperator>,
}

impl Stored {
    /// Those of a patch.
    #[must_use]
    pub fn of(patch: &PatchView<'_>) -> Self {
        Self { curve: patch.header.calibration.clone(), plays: patch.play_operators().collect() }
    }

    /// Whether there is neither curve nor play.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.curve.points.is_empty() && self.plays.is_empty()
    }

    /// The patch `bytes` with these instead of its own.
    pub fn put_into(&self, bytes: &[u8]) -> Result<Vec<u8>, PatchError> {
        with_calibration(bytes, &self.curve, &self.plays)
    }
}

/// Whether two patches turn the same voltages into the same images, so that a curve of one suits the other.
#[must_use]
pub fn have_same_matrix(a: &PatchView<'_>, b: &PatchView<'_>) -> bool {
    let is_same_combination = || a.steps().eq(b.steps()) && a.combination().eq(b.combination());
    a.matrix() == b.matrix() && a.exponents() == b.exponents() && is_same_combination()
}
