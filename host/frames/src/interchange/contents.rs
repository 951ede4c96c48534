//! The list of what an export holds: `export.json`.

use super::variable::Variable;
use crate::array::{mat, npy};
use dermatome_geometry::{mesh::Mesh, sheet::ElectrodeModel};
use dermatome_model::{forward::electrode_unknown, skin::Skin};
use dermatome_shared::patch::Difference;
use serde::Serialize;
use std::collections::BTreeMap;

/// The file that lists all others; it is written last.
pub const CONTENTS: &str = "export.json";
/// The MATLAB file.
pub const MATLAB: &str = "skin.mat";
/// The mesh for Gmsh, with its electrodes.
pub const GMSH: &str = "skin.msh";
/// The mesh alone.
pub const PLY: &str = "skin.ply";
/// The mesh for CAD programs.
pub const STL: &str = "skin.stl";
/// The stimulation table.
pub const STIMULATION: &str = "stimulation.csv";

/// Version of what is written.
pub const FORMAT_VERSION: u32 = 1;

/// What is in the folder: `export.json`. Keys are documented in docs/interchange.md.
#[derive(Clone, Debug, Serialize)]
pub struct Contents {
    /// Version of what is written: [`FORMAT_VERSION`].
    pub format: u32,
    /// Version of the program.
    pub dermatome: &'static str,
    /// Name of the skin.
    pub skin: String,
    /// Nodes of the mesh.
    pub nodes: usize,
    /// Elements of the mesh.
    pub elements: usize,
    /// Electrodes.
    pub electrodes: usize,
    /// Steps of the stimulation table.
    pub steps: usize,
    /// Measurements after reciprocal steps are averaged.
    pub measurements: usize,
    /// Pixels of the image.
    pub pixels: usize,
    /// Unknowns of the system matrix: nodes, then the electrodes of the complete model.
    pub unknowns: usize,
    /// Unknown that is held at 0 V.
    pub ground: usize,
    /// `"point"` or `"complete"`.
    pub electrode_model: &'static str,
    /// Whether conductivity, system matrix, voltages and Jacobian are complex.
    pub complex: bool,
    /// Volts of one unit of voltage: drive amplitude over sheet conductivity.
    pub volts_per_unit: f64,
    /// Drive amplitude, A.
    pub amplitude_a: f64,
    /// Drive frequency, Hz.
    pub frequency_hz: f64,
    /// Conductivity of the untouched sheet, S per square.
    pub sheet_conductivity_s: f64,
    /// Capacitance of the sheet, F per square.
    pub sheet_capacitance_f: f64,
    /// Whether difference data are divided by each measurement, or by the mean of all.
    pub normalised: bool,
    /// lambda in x = (J'WJ + lambda^2 R)^-1 J'W y.
    pub hyperparameter: f64,
    /// Files of the mesh, in metres.
    pub meshes: [&'static str; 3],
    /// By name.
    pub arrays: BTreeMap<&'static str, ArrayEntry>,
}

/// One array of the folder.
#[derive(Clone, Debug, Serialize)]
pub struct ArrayEntry {
    /// Name of the file.
    pub file: String,
    /// Its sides.
    pub shape: Vec<usize>,
    /// NumPy's name of the type.
    #[serde(rename = "type")]
    pub kind: &'static str,
    /// Unit of the values; empty for pure numbers.
    pub unit: &'static str,
    /// What it holds.
    pub meaning: &'static str,
    /// Whether the MATLAB file holds it too.
    pub in_mat: bool,
}

impl Contents {
    pub(super) fn new(
        skin: &Skin,
        mesh: &Mesh,
        [pixels, measurements]: [usize; 2],
        hyperparameter: f64,
        arrays: &[Variable<'_>],
    ) -> Self {
        let complete = matches!(skin.electrodes.model, ElectrodeModel::Complete { .. });
        let electrodes = mesh.electrodes.len();
        Self {
            format: FORMAT_VERSION,
            dermatome: env!("CARGO_PKG_VERSION"),
            skin: skin.name.clone(),
            nodes: mesh.nodes.len(),
            elements: mesh.elements.len(),
            electrodes,
            steps: skin.steps().len(),
            measurements,
            pixels,
            unknowns: mesh.nodes.len() + if complete { electrodes } else { 0 },
            ground: electrode_unknown(mesh, skin.electrodes.ground),
            electrode_model: if complete { "complete" } else { "point" },
            complex: skin.admittivity().im != 0.0,
            volts_per_unit: skin.drive.amplitude / skin.material.sheet_conductivity,
            amplitude_a: skin.drive.amplitude,
            frequency_hz: skin.drive.frequency,
            sheet_conductivity_s: skin.material.sheet_conductivity,
            sheet_capacitance_f: skin.material.sheet_capacitance,
            normalised: skin.inverse.difference == Difference::Normalised,
            hyperparameter,
            meshes: [GMSH, PLY, STL],
            arrays: arrays.iter().map(|variable| (variable.name, ArrayEntry::of(variable))).collect(),
        }
    }

    pub(super) fn json(&self) -> String {
        let text = serde_json::to_string_pretty(self).expect("numbers, text and maps with text keys");
        text + "\n"
    }
}

/// Whether a file of this name may be written by an export.
#[must_use]
pub fn is_exported(name: &str) -> bool {
    name.ends_with(".npy") || [CONTENTS, MATLAB, GMSH, PLY, STL, STIMULATION].contains(&name)
}

/// Name of an array's file.
pub(super) fn file_name(variable: &Variable<'_>) -> String {
    format!("{}.npy", variable.name)
}

impl ArrayEntry {
    fn of(variable: &Variable<'_>) -> Self {
        Self {
            file: file_name(variable),
            shape: variable.array.shape.clone(),
            kind: npy::type_name(&variable.array),
            unit: variable.unit,
            meaning: variable.meaning,
            in_mat: mat::fits(&variable.array),
        }
    }
}
