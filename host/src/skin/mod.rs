//! Skin: what a person says of one sensor, read from `skin.toml` and checked.
//!
//! Numbers are SI here. docs/skin-file.md describes the file.

mod check;
pub mod electrodes;
mod file;
pub mod outline;
pub mod quantity;

use dermatome_shared::{
    patch::{CombinedInto, Difference},
    stimulation::{self, Step},
};
use electrodes::Electrodes;
pub use file::SkinError;
use outline::Outline;
use std::path::Path;

/// One sensor: shape, electrodes, drive, and how to image it.
#[derive(Clone, Debug, PartialEq)]
pub struct Skin {
    /// Short name, at most 32 bytes; the board shows it.
    pub name: String,
    /// Shape of the sheet.
    pub outline: Outline,
    /// Edge length of the mesh's triangles, m.
    pub edge_length: f64,
    /// Conductivity of the untouched sheet, S per square.
    pub sheet_conductivity: f64,
    /// Electrodes on the rim.
    pub electrodes: Electrodes,
    /// How current flows and voltage is sensed.
    pub drive: Drive,
    /// How images are computed.
    pub inverse: Inverse,
    /// Columns of pixels across the larger side of the skin.
    pub image_columns: u8,
    /// Smallest relative conductivity change that counts as a contact.
    pub contact_threshold: f64,
}

/// How current flows and voltage is sensed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Drive {
    /// Electrodes from one end of the driven pair to the other: 1 is adjacent.
    pub drive_distance: u8,
    /// The same for the sensing pair.
    pub sense_distance: u8,
    /// Whether reciprocal steps are averaged into one measurement.
    pub combine_reciprocal: bool,
    /// Carrier frequency, Hz.
    pub frequency: f64,
    /// Current amplitude, A.
    pub amplitude: f64,
    /// Frames per second.
    pub frame_rate: f64,
}

/// How images are computed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Inverse {
    /// What is known of images beforehand.
    pub prior: Prior,
    /// Weight of the prior: lambda in x = (J'WJ + lambda^2 R)^-1 J'W y.
    pub hyperparameter: f64,
    /// Plain or normalised difference data.
    pub difference: Difference,
}

/// Regularisation prior R.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Prior {
    /// Neighbouring pixels are alike (EIDORS `prior_laplace`, used as R'R).
    Laplace,
    /// Pixels are small (identity).
    Tikhonov,
    /// Pixels are small where the data say much: diag(J'WJ)^0.5 (EIDORS `prior_noser`).
    Noser,
}

impl Skin {
    /// Reads and checks a skin file.
    pub fn load(path: &Path) -> Result<Self, SkinError> {
        file::load(path)
    }

    /// Checks the text of a skin file; `path` is for error messages.
    pub fn parse(path: &Path, text: &str) -> Result<Self, SkinError> {
        file::parse(path, text)
    }

    /// Stimulation table: `[step]`, in canonical order.
    #[must_use]
    pub fn steps(&self) -> Vec<Step> {
        let electrodes = self.electrodes.count();
        stimulation::pattern(electrodes, self.drive.drive_distance, self.drive.sense_distance).collect()
    }

    /// Centre of each electrode in the skin's frame, m: `[electrode]`.
    #[must_use]
    pub fn rim(&self) -> Vec<[f64; 2]> {
        self.electrodes.centres.iter().map(|&s| self.outline.rim_point(s).into()).collect()
    }

    /// Where each step's code goes: `[step]`; reciprocal steps share a measurement if the skin
    /// says so.
    #[must_use]
    pub fn combination(&self, steps: &[Step]) -> Vec<CombinedInto> {
        if self.drive.combine_reciprocal { combine_reciprocal(steps) } else { keep_all(steps) }
    }
}

fn keep_all(steps: &[Step]) -> Vec<CombinedInto> {
    (0..steps.len() as u16).map(|measurement| CombinedInto { measurement, flipped: false }).collect()
}

/// Measurements in the order in which their first step appears, with that step's sign.
fn combine_reciprocal(steps: &[Step]) -> Vec<CombinedInto> {
    let mut first: Vec<stimulation::Reciprocity> = Vec::new();
    let mut combine = |step: &Step| {
        let this = step.reciprocity();
        let known = first.iter().position(|other| other.pairs == this.pairs);
        let measurement = known.unwrap_or_else(|| {
            first.push(this);
            first.len() - 1
        });
        CombinedInto { measurement: measurement as u16, flipped: this.flipped != first[measurement].flipped }
    };
    steps.iter().map(&mut combine).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn reciprocal_steps_of_the_adjacent_pattern_share_104_measurements_unflipped() {
        let steps: Vec<_> = stimulation::pattern(16, 1, 1).collect();
        let combination = combine_reciprocal(&steps);
        let mut counts = [0; 104];
        for target in &combination {
            counts[usize::from(target.measurement)] += 1;
            assert!(!target.flipped);
        }
        assert!(counts.iter().all(|&count| count == 2));
    }

    #[test]
    fn opposite_drives_that_differ_in_direction_only_are_subtracted() {
        let steps: Vec<_> = stimulation::pattern(16, 8, 1).collect();
        let combination = combine_reciprocal(&steps);
        assert_eq!(combination.iter().filter(|target| target.flipped).count(), 96);
        assert_eq!(combination.iter().map(|target| target.measurement).max(), Some(95));
    }
}
