//! Skin: what a person says of one sensor, read from `skin.toml` and checked.
//!
//! Numbers are SI here. docs/skin-file.md describes the file.

mod above;
mod check;
pub use check::{UNITS, is_frame_name, is_name};
pub mod cut_out;
pub mod electrodes;
mod file;
pub mod quantity;
mod shape;

use dermatome_geometry::sheet::EdgeLengths;
pub use dermatome_patch::pose::Pose;
use dermatome_shared::{
    calibration::Calibration,
    drive::{self, Component, Gain},
    patch::{CombinedInto, Difference},
    stimulation::{self, Driven, Step},
};
use electrodes::Electrodes;
pub use file::SkinError;
use num_complex::Complex64;
pub use shape::{NotFlat, Shape, electrodes_in_plane};
use std::{collections::HashSet, f64::consts::TAU, path::Path};

/// One sensor: shape, electrodes, drive, and how to image it.
#[derive(Clone, Debug, PartialEq)]
pub struct Skin {
    /// Short name, at most 32 bytes; the board shows it.
    pub name: String,
    /// Shape of the sheet.
    pub shape: Shape,
    /// Edge lengths of a generated mesh.
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
    /// Time in which the reference follows the untouched skin, s; 0 for never.
    pub drift_time: f64,
    /// Pressure by strength of a contact; empty if the skin is not calibrated.
    pub calibration: Calibration,
    /// Where it lies on a robot, if that is known.
    pub pose: Option<Pose>,
}

/// Electrical properties of the untouched sheet.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Material {
    /// Conductivity, S per square.
    pub sheet_conductivity: f64,
    /// Capacitance, F per square: the sheet's admittivity is conductivity + j omega capacitance.
    pub sheet_capacitance: f64,
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
    /// So many patches of elements, each of about the same area; on any surface.
    Patches {
        /// Number of pixels.
        count: usize,
    },
}

/// Header of a stimulation table in a CSV file; its electrodes count from 0.
pub const STEP_COLUMNS: [&str; 4] = ["drive_plus", "drive_minus", "sense_plus", "sense_minus"];

/// How current flows and voltage is sensed.
#[derive(Clone, Debug, PartialEq)]
pub struct Drive {
    /// Which pairs drive and sense.
    pub pattern: Pattern,
    /// What becomes of reciprocal steps.
    pub reciprocal: Reciprocal,
    /// Carrier frequency, Hz.
    pub frequency: f64,
    /// Current amplitude, A.
    pub amplitude: f64,
    /// Frames per second.
    pub frame_rate: f64,
    /// By how much the in-phase reference lags the current, degrees.
    pub phase: f64,
    /// Carrier periods between switching and measuring.
    pub settling: f64,
    /// Carrier periods over which a voltage is measured.
    pub integration: u8,
    /// Gain of the programmable amplifier.
    pub gain: Gain,
    /// Which part of a voltage goes into the image.
    pub component: Component,
}

impl Drive {
    /// As boards know it.
    #[must_use]
    pub fn for_board(&self) -> drive::Drive {
        drive::Drive {
            frequency: self.frequency as f32,
            amplitude: self.amplitude as f32,
            frame_rate: self.frame_rate as f32,
            phase: self.phase as f32,
            settling: self.settling as f32,
            integration: self.integration,
            gain: self.gain,
            component: self.component,
        }
    }
}

/// What becomes of reciprocal steps: those with drive and sense pairs exchanged.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Reciprocal {
    /// Both are measured and averaged into one measurement.
    Combined,
    /// Both are measured, each a measurement of its own.
    Kept,
    /// Only the first of them is measured.
    Once,
}

/// Which pairs drive and sense.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Pattern {
    /// The same from every electrode.
    Cyclic {
        /// Electrodes from one end of the driven pair to the other: 1 is adjacent.
        drive_distance: u8,
        /// The same for the sensing pair.
        sense_distance: u8,
        /// Whether pairs that touch a driven electrode are measured too.
        driven: Driven,
    },
    /// A table of steps, in the order given.
    Table(Vec<Step>),
}

/// How images are computed.
#[derive(Clone, Debug, PartialEq)]
pub struct Inverse {
    /// Where the reconstruction matrix comes from.
    pub method: Method,
    /// Weight of the prior or of the noise, or how it is chosen.
    pub hyperparameter: Hyperparameter,
    /// Plain or normalised difference data.
    pub difference: Difference,
    /// How much each measurement counts.
    pub weights: Weights,
    /// Weight of the prior on electrode movement over the prior on the image (EIDORS'
    /// `prior_movement`), if electrodes are taken to move.
    pub electrode_movement: Option<f64>,
    /// Signal-to-noise ratio, dB, of the simulated frames on which a hyperparameter is chosen.
    pub noise_db: f64,
}

/// Where the reconstruction matrix comes from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Method {
    /// One Gauss-Newton step with a prior.
    OneStep(Prior),
    /// Trained on small targets (GREIT).
    Greit {
        /// Radius of the desired image of a target, as a share of half the skin's larger side.
        radius: f64,
    },
}

/// Regularisation prior R.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Prior {
    /// Neighbouring pixels are alike (EIDORS `prior_laplace`, used as R'R).
    Laplace,
    /// The same with the graph Laplacian as R, so that its square is R'R (thesis equations 2.11 and
    /// 3.1).
    SquaredLaplace,
    /// Pixels are small (identity).
    Tikhonov,
    /// Pixels are small where the data say much: diag(J'WJ)^exponent (EIDORS `prior_noser`).
    Noser {
        /// 0.5 in EIDORS.
        exponent: f64,
    },
    /// What a Gaussian filter would smooth away is small (EIDORS `prior_gaussian_HPF`).
    Gaussian {
        /// Diameter of the filter as a share of the skin's larger side; 0.1 in EIDORS.
        diameter: f64,
    },
}

/// lambda in x = (J'WJ + lambda^2 R)^-1 J'W y, or GREIT's weight of the noise.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Hyperparameter {
    /// A number.
    Fixed(f64),
    /// Chosen for the skin.
    Chosen(Criterion),
}

/// How a hyperparameter is chosen.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Criterion {
    /// Corner of the L-curve.
    LCurve,
    /// Generalised cross-validation.
    CrossValidation,
    /// This noise figure.
    NoiseFigure(f64),
    /// The sharpest image of a small target.
    BestResolution,
}

impl Criterion {
    /// What the skin file calls it.
    #[must_use]
    pub fn name(&self) -> &'static str {
        match self {
            Self::LCurve => "l-curve",
            Self::CrossValidation => "gcv",
            Self::NoiseFigure(_) => "noise-figure",
            Self::BestResolution => "best-resolution",
        }
    }
}

/// Weights W of measurements.
#[derive(Clone, Debug, PartialEq)]
pub enum Weights {
    /// How many steps a measurement averages.
    Steps,
    /// The same times the reference squared, as EIDORS weighs normalised data.
    ReferenceSquared,
    /// One for each measurement.
    Each(Vec<f64>),
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
        let steps = match &self.drive.pattern {
            Pattern::Cyclic { drive_distance, sense_distance, driven } => {
                let electrodes = self.electrodes.count;
                stimulation::pattern(electrodes, *drive_distance, *sense_distance, *driven).collect()
            }
            Pattern::Table(steps) => steps.clone(),
        };
        if self.drive.reciprocal == Reciprocal::Once { first_of_pairs(&steps) } else { steps }
    }

    /// Admittivity of the untouched sheet at the drive frequency, relative to its conductivity:
    /// 1 + j omega capacitance / conductivity.
    #[must_use]
    pub fn admittivity(&self) -> Complex64 {
        let Material { sheet_conductivity, sheet_capacitance } = self.material;
        Complex64::new(1.0, TAU * self.drive.frequency * sheet_capacitance / sheet_conductivity)
    }

    /// Where each step's code goes: `[step]`; reciprocal steps share a measurement if the skin
    /// says so.
    #[must_use]
    pub fn combination(&self, steps: &[Step]) -> Vec<CombinedInto> {
        match self.drive.reciprocal {
            Reciprocal::Combined => combine_reciprocal(steps),
            Reciprocal::Kept | Reciprocal::Once => keep_all(steps),
        }
    }
}

/// The steps without those that measure again what one before them does.
fn first_of_pairs(steps: &[Step]) -> Vec<Step> {
    let mut known = HashSet::new();
    steps.iter().copied().filter(|step| known.insert(step.reciprocity().pairs)).collect()
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
        let steps: Vec<_> = stimulation::pattern(16, 1, 1, Driven::Skipped).collect();
        let combination = combine_reciprocal(&steps);
        let mut counts = [0; 104];
        for target in &combination {
            counts[usize::from(target.measurement)] += 1;
            assert!(!target.flipped);
        }
        assert!(counts.iter().all(|&count| count == 2));
    }

    #[test]
    fn each_pair_of_reciprocal_steps_is_measured_once_if_asked() {
        let steps: Vec<_> = stimulation::pattern(16, 1, 1, Driven::Skipped).collect();
        let once = first_of_pairs(&steps);
        assert_eq!(once.len(), 104);
        let pairs =
            |steps: &[Step]| steps.iter().map(|step| step.reciprocity().pairs).collect::<HashSet<_>>();
        assert_eq!(pairs(&once), pairs(&steps));
    }

    #[test]
    fn opposite_drives_that_differ_in_direction_only_are_subtracted() {
        let steps: Vec<_> = stimulation::pattern(16, 8, 1, Driven::Skipped).collect();
        let combination = combine_reciprocal(&steps);
        assert_eq!(combination.iter().filter(|target| target.flipped).count(), 96);
        assert_eq!(combination.iter().map(|target| target.measurement).max(), Some(95));
    }
}
