//! Skin: what a person says of one sensor, read from `skin.toml` and checked.
//!
//! Numbers are SI here. docs/skin-file.md describes the file. Reading it imports no mesh: a [`Description`] says which
//! file to take it from, and [`crate::model`] makes the [`Skin`] that a model needs.

mod check;
mod described;
mod drive;
pub mod electrodes;
mod error;
mod file;
mod flattened;
mod inverse;
mod material;
pub mod quantity;
mod reflex;
pub mod syntax;
pub mod table;

use crate::stimulation::Stimulation;
use check::Checker;
pub use check::{is_frame_name, is_name};
pub use dermatome_geometry::shape::{NotFlat, Shape, electrodes_in_plane};
use dermatome_geometry::sheet::EdgeLengths;
use dermatome_patch::input;
pub use dermatome_patch::pose::Pose;
use dermatome_shared::{calibration::Calibration, stimulation::Step};
pub use described::{Described, MeshFile, Placement, UNITS};
pub use drive::{Drive, Pattern, Reciprocal};
use electrodes::Electrodes;
pub use error::SkinError;
pub use file::FoundIn;
pub use inverse::{Criterion, Hyperparameter, Inverse, Method, Prior, Weights};
pub use material::{ConductivityMap, Interpolation, Material};
use num_complex::Complex64;
pub use reflex::{Reflex, Region};
use std::{f64::consts::TAU, path::Path};

/// One sensor: shape, electrodes, drive, and how to image it.
///
/// `S` is its shape: as it is described, or with the mesh that a description only names.
#[derive(Clone, Debug, PartialEq)]
pub struct Skin<S = Shape> {
    /// Short name, at most 32 bytes; the board shows it.
    pub name: String,
    /// Shape of the sheet.
    pub shape: S,
    /// Edge lengths of a generated mesh; of a mesh file those of its mean triangle, zero until it is read.
    pub edges: EdgeLengths,
    /// Electrical properties of the untouched sheet.
    pub material: Material,
    /// Electrodes on the rim.
    pub electrodes: Electrodes,
    /// How current flows and voltage is sensed.
    pub drive: Drive,
    /// How images are computed.
    pub inverse: Inverse,
    /// What the image consists of.
    pub image: ImageLayout,
    /// Smallest relative conductivity change that counts as a contact.
    pub contact_threshold: f64,
    /// What a board finds contacts in.
    pub contacts_found_in: FoundIn,
    /// False contacts an hour on an untouched skin, where they are found in the voltages.
    pub false_alarms: f64,
    /// Time over which still frames are averaged there, s; 0 takes each for itself. None: see [`Skin::averaging`].
    pub averaging: Option<f64>,
    /// Time in which the reference follows the untouched skin, s; 0 for never. None: see [`Skin::drift_time`].
    pub drift_time: Option<f64>,
    /// Pressure by strength of a contact; empty if the skin is not calibrated.
    pub calibration: Calibration,
    /// What its board does by itself.
    pub reflexes: Vec<Reflex>,
    /// Where it lies on a robot, if that is known.
    pub pose: Option<Pose>,
}

/// What the image consists of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ImageLayout {
    /// Square pixels, so many across the larger side of a flat skin.
    Grid {
        /// Columns of pixels.
        columns: u8,
    },
    /// One pixel for each element of the mesh.
    Elements,
    /// So many element patches, each of about the same area; on any surface.
    ElementPatches {
        /// Number of pixels.
        count: usize,
    },
}

/// What a skin file says, checked; nothing that it names but tables of steps and weights was read.
pub type Description = Skin<Described>;

impl Description {
    /// Reads and checks a skin file.
    pub fn load(path: &Path) -> Result<Self, SkinError> {
        if path.is_dir() {
            return Err(SkinError::Folder { path: path.to_owned() });
        }
        let read = input::read_text(path);
        let text = read.map_err(|reason| SkinError::Read { path: path.to_owned(), reason })?;
        Self::parse(path, &text)
    }

    /// Checks the text of a skin file; `path` is for error messages.
    pub fn parse(path: &Path, text: &str) -> Result<Self, SkinError> {
        let refuse = |error: toml::de::Error| SkinError::Syntax {
            path: path.to_owned(),
            message: syntax::in_words(&error),
        };
        Checker { path }.skin(&toml::from_str(text).map_err(refuse)?)
    }
}

/// Time in which the reference follows unless the skin file says another, s.
const DRIFT_TIME: f64 = 30.0;
/// The same where contacts are found in the voltages: smooth changes are followed in less, and others might be presses that
/// grow slowly.
const DRIFT_TIME_OF_VOLTAGES: f64 = 120.0;

/// Time over which still frames are averaged unless the file says another, s, and how many at least.
const AVERAGING: f64 = 0.16;
const AVERAGED_FRAMES: f64 = 8.0;

impl<S> Skin<S> {
    /// Time over which still frames are averaged, s; 0 takes each for itself.
    #[must_use]
    pub fn averaging(&self) -> f64 {
        self.averaging.unwrap_or_else(|| AVERAGING.max(AVERAGED_FRAMES / self.drive.frame_rate))
    }

    /// Time in which the reference follows the untouched skin, s; 0 for never.
    #[must_use]
    pub fn drift_time(&self) -> f64 {
        self.drift_time.unwrap_or(match self.contacts_found_in {
            FoundIn::Image => DRIFT_TIME,
            FoundIn::Voltages => DRIFT_TIME_OF_VOLTAGES,
        })
    }

    /// Stimulation table: `[step]`, in canonical order.
    #[must_use]
    pub fn steps(&self) -> Vec<Step> {
        self.drive.steps(self.electrodes.count)
    }

    /// The same with what becomes of each step.
    #[must_use]
    pub fn stimulation(&self) -> Stimulation {
        self.drive.stimulation(self.electrodes.count)
    }

    /// Admittivity of the untouched sheet at the drive frequency, relative to its conductivity:
    /// 1 + j omega capacitance / conductivity.
    #[must_use]
    pub fn admittivity(&self) -> Complex64 {
        let Material { sheet_conductivity, sheet_capacitance, .. } = self.material;
        Complex64::new(1.0, TAU * self.drive.frequency * sheet_capacitance / sheet_conductivity)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const TINY: &str = include_str!("../../../tests/data/tiny.toml");

    #[test]
    fn still_frames_are_averaged_for_a_time_and_over_eight_at_least_unless_the_file_says_otherwise() {
        for (rate, averaging, seconds) in [
            ("400 Hz", "", 0.16),
            ("50 Hz", "", 0.16),
            ("4 Hz", "", 2.0),
            ("4 Hz", "averaging = \"0 s\"", 0.0),
            ("50 Hz", "averaging = \"1 s\"", 1.0),
        ] {
            let text = TINY.replace("frame_rate = \"50 Hz\"", &format!("frame_rate = \"{rate}\""));
            let text = text.replace("[contact]", &format!("[contact]\n{averaging}"));
            let skin = Skin::parse(Path::new("skin.toml"), &text).unwrap();
            assert_eq!(skin.averaging(), seconds, "{rate}, {averaging:?}");
        }
    }
}
