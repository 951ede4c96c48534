//! The skin file as a person writes it, in TOML; [`super::check`] turns it into a checked [`Skin`].

use super::{Skin, check::Checker, quantity::Quantity};
use serde::Deserialize;
use std::{
    f64::consts::FRAC_PI_2,
    io,
    path::{Path, PathBuf},
};

/// Why a skin file cannot be used.
#[derive(Debug, thiserror::Error)]
pub enum SkinError {
    /// The file cannot be read.
    #[error("cannot read skin file `{}`: {reason}", path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// Why.
        reason: io::Error,
    },
    /// The file is not TOML, or lacks a field, or has one too many.
    #[error("skin file `{}`: {message}", path.display())]
    Syntax {
        /// The file.
        path: PathBuf,
        /// What the TOML reader says, with line and column.
        message: String,
    },
    /// A field has a value that is not allowed.
    #[error("skin file `{}`: `{field}` is {value}; allowed: {allowed}", path.display())]
    Value {
        /// The file.
        path: PathBuf,
        /// The field, with its table.
        field: &'static str,
        /// What it holds.
        value: String,
        /// What it may hold.
        allowed: String,
    },
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct File {
    pub(super) name: String,
    /// For people; not used further.
    #[serde(default, rename = "description")]
    pub(super) _description: String,
    pub(super) shape: Shape,
    pub(super) mesh: MeshTable,
    pub(super) material: Material,
    pub(super) electrodes: ElectrodeTable,
    pub(super) drive: DriveTable,
    pub(super) inverse: InverseTable,
    pub(super) image: ImageTable,
    pub(super) contact: ContactTable,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Shape {
    pub(super) kind: String,
    pub(super) diameter: Option<Quantity>,
    pub(super) width: Option<Quantity>,
    pub(super) height: Option<Quantity>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct MeshTable {
    pub(super) edge_length: Quantity,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Material {
    pub(super) sheet_conductivity: Quantity,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct ElectrodeTable {
    pub(super) count: i64,
    pub(super) placement: String,
    pub(super) pitch: Option<Quantity>,
    #[serde(default = "top")]
    pub(super) first: Quantity,
    #[serde(default = "clockwise")]
    pub(super) direction: String,
    pub(super) model: String,
    pub(super) width: Option<Quantity>,
    pub(super) contact_impedance: Option<OneOrEach>,
    #[serde(default = "one")]
    pub(super) ground: i64,
}

fn top() -> Quantity {
    Quantity::Number(FRAC_PI_2)
}

fn clockwise() -> String {
    "clockwise".to_owned()
}

fn one() -> i64 {
    1
}

#[derive(Deserialize)]
#[serde(untagged)]
pub(super) enum OneOrEach {
    One(Quantity),
    Each(Vec<Quantity>),
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct DriveTable {
    pub(super) pattern: String,
    pub(super) reciprocal: String,
    pub(super) frequency: Quantity,
    pub(super) amplitude: Quantity,
    pub(super) frame_rate: Quantity,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct InverseTable {
    pub(super) prior: String,
    pub(super) hyperparameter: f64,
    pub(super) normalised: bool,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct ImageTable {
    pub(super) columns: i64,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct ContactTable {
    pub(super) threshold: f64,
}

pub(super) fn load(path: &Path) -> Result<Skin, SkinError> {
    let read = std::fs::read_to_string(path);
    let text = read.map_err(|reason| SkinError::Read { path: path.to_owned(), reason })?;
    parse(path, &text)
}

pub(super) fn parse(path: &Path, text: &str) -> Result<Skin, SkinError> {
    let syntax = |error: toml::de::Error| {
        let message = error.to_string().trim_end().to_owned();
        SkinError::Syntax { path: path.to_owned(), message }
    };
    let file: File = toml::from_str(text).map_err(syntax)?;
    Checker { path }.skin(&file)
}
