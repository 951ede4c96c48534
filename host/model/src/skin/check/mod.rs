//! Checks a skin file table by table: what a person wrote -> [`Description`].

mod beside;
mod contact;
mod drive;
mod electrodes;
mod image;
mod inverse;
mod material;
mod mesh_file;
mod pose;
pub use pose::is_frame_name;
mod reflex;
mod shape;

use super::{
    Described, Description, Skin, SkinError,
    electrodes::Electrodes,
    file::File,
    quantity::{Kind, Quantity},
};
use dermatome_geometry::sheet::{EdgeLengths, Sheet};
use std::{ops::RangeInclusive, path::Path};

/// Numbers above zero that the arithmetic of models and boards can take, in SI units; a physical one is well inside.
const USABLE: RangeInclusive<f64> = 1e-18..=1e18;

/// Turns each table into its checked form; knows the file for error messages.
pub(super) struct Checker<'a> {
    pub(super) path: &'a Path,
}

impl Checker<'_> {
    pub(super) fn skin(&self, file: &File) -> Result<Description, SkinError> {
        self.only_fields_of_kind(&file.shape)?;
        let electrodes = self.electrodes(&file.electrodes)?;
        let (shape, edges) = match file.shape.kind.as_str() {
            "mesh" => self.mesh_file(file)?,
            _ => self.sheet(file, &electrodes)?,
        };
        Ok(Skin {
            name: self.name(&file.name)?,
            material: self.material_of(&file.material, &shape)?,
            shape,
            edges,
            drive: self.drive(&file.drive, electrodes.count)?,
            electrodes,
            inverse: self.inverse(&file.inverse)?,
            image: self.image(&file.image)?,
            contact_threshold: self.threshold(file.contact.threshold)?,
            contacts_found_in: file.contact.found_in,
            false_alarms: self.false_alarms(file.contact.false_alarms)?,
            averaging: self.averaging(file.contact.averaging.as_ref())?,
            drift_time: self.drift_time(file.contact.drift_time.as_ref())?,
            calibration: self.calibration(&file.calibration)?,
            reflexes: self.reflexes(&file.reflexes)?,
            pose: self.pose(file.pose.as_ref())?,
        })
    }

    fn sheet(&self, file: &File, electrodes: &Electrodes) -> Result<(Described, EdgeLengths), SkinError> {
        let (outline, embedding) = self.surface(&file.shape)?;
        let edges = self.edges(file.mesh.as_ref(), &outline, &embedding)?;
        let places = self.places(&file.electrodes, &outline, &embedding, electrodes)?;
        Ok((Described::Sheet(Sheet { outline, embedding, places }), edges))
    }

    fn name(&self, name: &str) -> Result<String, SkinError> {
        if is_name(name) {
            Ok(name.to_owned())
        } else {
            self.refuse(
                "name",
                format!("{name:?}"),
                "1 to 32 letters, digits, \"-\" or \"_\" (it names the patch file)",
            )
        }
    }

    fn required(
        &self,
        field: &'static str,
        written: Option<&Quantity>,
        kind: Kind,
    ) -> Result<f64, SkinError> {
        match written {
            Some(quantity) => self.positive(field, quantity, kind),
            None => self.refuse(field, "missing".into(), &format!("a value above zero in {}", kind.units())),
        }
    }

    fn absent(&self, field: &'static str, written: Option<&Quantity>, hint: &str) -> Result<(), SkinError> {
        written.map_or(Ok(()), |quantity| self.refuse(field, quantity.to_string(), hint))
    }

    fn positive(&self, field: &'static str, written: &Quantity, kind: Kind) -> Result<f64, SkinError> {
        match kind.read(written) {
            Some(value) if value > 0.0 && !USABLE.contains(&value) => {
                let (least, most) = USABLE.into_inner();
                self.refuse(field, format!("{value:e}"), &format!("{least:e} to {most:e} ({})", kind.si()))
            }
            Some(value) if value > 0.0 => Ok(value),
            _ => {
                let allowed = format!("a number above zero ({}), or text in {}", kind.si(), kind.units());
                self.refuse(field, written.to_string(), &allowed)
            }
        }
    }

    fn finite(&self, field: &'static str, written: &Quantity, kind: Kind) -> Result<f64, SkinError> {
        match kind.read(written) {
            Some(value) if value.is_finite() => Ok(value),
            _ => {
                let allowed = format!("a number ({}), or text in {}", kind.si(), kind.units());
                self.refuse(field, written.to_string(), &allowed)
            }
        }
    }

    fn positive_number(&self, field: &'static str, value: f64) -> Result<f64, SkinError> {
        let fits = value > 0.0 && value.is_finite();
        if fits { Ok(value) } else { self.refuse(field, value.to_string(), "a number above zero") }
    }

    fn count(&self, field: &'static str, value: i64, min: usize, max: usize) -> Result<u8, SkinError> {
        match u8::try_from(value) {
            Ok(count) if (min..=max).contains(&usize::from(count)) => Ok(count),
            _ => self.refuse(field, value.to_string(), &format!("{min} to {max}")),
        }
    }

    fn refuse<T>(&self, field: &'static str, value: String, allowed: &str) -> Result<T, SkinError> {
        Err(SkinError::Value { path: self.path.to_owned(), field, value, allowed: allowed.to_owned() })
    }
}

/// Whether a text may name a skin.
#[must_use]
pub fn is_name(name: &str) -> bool {
    let allowed = |c: char| c.is_ascii_alphanumeric() || matches!(c, '-' | '_');
    (1..=32).contains(&name.len()) && name.chars().all(allowed)
}
