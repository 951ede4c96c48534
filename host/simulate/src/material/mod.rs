//! Material: how the sheet of a skin responds to pressure, as a model.
//!
//! A stacked contact-resistance sheet conducts better the more of its contacts are closed. Each contact
//! closes at one pressure and opens at a lower one, so the sheet is a Preisach operator (`preisach`); some
//! contacts stay closed without load and open with time (the memory of earlier presses); what the
//! operator says arrives partly at once and partly late (creep). [`Transducer`] is one place of the sheet.
//!
//! The shipped materials, `models/materials/*.toml`, are fitted to the figures of the thesis. docs/materials.md
//! says what is fitted and what is assumed.

mod curve;
mod file;
mod preisach;
mod transducer;

pub use transducer::Transducer;

use dermatome_patch::input;
use preisach::{Everett, Preisach};
use std::{
    path::{Path, PathBuf},
    sync::Arc,
};

/// The materials that come with the program: name and file.
const SHIPPED: [(&str, &str); 5] = [
    ("sample-1", include_str!("../../../../models/materials/sample-1.toml")),
    ("sample-2", include_str!("../../../../models/materials/sample-2.toml")),
    ("sample-3-single", include_str!("../../../../models/materials/sample-3-single.toml")),
    ("sample-3-dual", include_str!("../../../../models/materials/sample-3-dual.toml")),
    ("saline", include_str!("../../../../models/materials/saline.toml")),
];

/// A checked material. Shares are of the full change unless they say otherwise; copies are cheap.
#[derive(Clone, Debug)]
pub struct Material {
    /// Its name.
    pub name: String,
    /// What it is, in words.
    pub description: String,
    /// Pressure beyond which nothing more is detected, kPa.
    pub range_kpa: f64,
    /// Relative change of sheet conductivity when every contact is closed; negative where pressure takes
    /// conductor away.
    pub full_change: f64,
    /// Share of the contacts that stay closed without load, and open with time.
    pub residual: f64,
    /// Time in which those open, s.
    pub recovery_s: f64,
    /// Creep.
    pub creep: Creep,
    /// What differs from place to place, press to press, and with time.
    pub scatter: Scatter,
    /// Contacts that open with the load.
    everett: Arc<Everett>,
}

/// The part of a change that arrives late.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Creep {
    /// Share of the change that is late; the time constants have equal parts of it.
    pub share: f64,
    /// Time constants, s.
    pub times_s: [f64; 2],
}

/// Standard deviations of what does not repeat.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Scatter {
    /// Of a place's gain, relative.
    pub place: f64,
    /// Of a press's gain, relative: how the load sits this time.
    pub press: f64,
    /// Of the drift in one minute, share of the full change; it grows with the root of time.
    pub drift: f64,
}

impl Material {
    /// Reads a material file.
    pub fn load(path: &Path) -> Result<Self, MaterialError> {
        let read = input::read_text(path);
        let text = read.map_err(|reason| MaterialError::Read { path: path.to_owned(), reason })?;
        file::parse(path, &text)
    }

    /// One of the materials that come with the program.
    pub fn named(name: &str) -> Result<Self, MaterialError> {
        let shipped = SHIPPED.iter().find(|(shipped, _)| *shipped == name);
        let (_, text) = shipped.ok_or_else(|| MaterialError::Name { name: name.to_owned() })?;
        file::parse(Path::new(&format!("models/materials/{name}.toml")), text)
    }

    /// Names of the materials that come with the program.
    pub fn names() -> impl Iterator<Item = &'static str> {
        SHIPPED.iter().map(|(name, _)| *name)
    }
}

/// Why a material cannot be used.
#[derive(Debug, thiserror::Error)]
pub enum MaterialError {
    /// There is no such shipped material.
    #[error("there is no material `{name}`; allowed: {}", SHIPPED.map(|(name, _)| name).join(", "))]
    Name {
        /// What was asked for.
        name: String,
    },
    /// The file cannot be read.
    #[error("cannot read material file `{}`: {reason}", path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// Why.
        reason: std::io::Error,
    },
    /// The file is not the TOML of a material.
    #[error("material file `{}`: {message}", path.display())]
    Syntax {
        /// The file.
        path: PathBuf,
        /// Where and why.
        message: String,
    },
    /// A field has a value that it cannot have.
    #[error("material file `{}`: `{field}` is {value}; allowed: {allowed}", path.display())]
    Value {
        /// The file.
        path: PathBuf,
        /// The field.
        field: &'static str,
        /// Its value.
        value: String,
        /// What it may be.
        allowed: String,
    },
}

#[cfg(test)]
mod tests;
