//! Table `[electrodes]`.

mod places;

use super::Checker;
use crate::skin::{
    SkinError,
    electrodes::Electrodes,
    file::{ElectrodeTable, OneOrEach},
    quantity::{self, Kind},
};
use dermatome_geometry::sheet::ElectrodeModel;

/// Electrodes that a model may have; a board may take fewer.
const MOST_ELECTRODES: usize = 250;

impl Checker<'_> {
    pub(super) fn electrodes(&self, table: &ElectrodeTable) -> Result<Electrodes, SkinError> {
        let count = self.count("electrodes.count", table.count, 4, MOST_ELECTRODES)?;
        let ground = self.count("electrodes.ground", table.ground, 1, usize::from(count))?;
        let model = self.electrode_model(table, usize::from(count))?;
        Ok(Electrodes { count, model, ground: usize::from(ground) - 1 })
    }

    fn electrode_model(&self, table: &ElectrodeTable, count: usize) -> Result<ElectrodeModel, SkinError> {
        match table.model.as_str() {
            "point" => {
                let hint = "nothing (point electrodes have none)";
                if table.width.is_some() {
                    return self.refuse("electrodes.width", "given".into(), hint);
                }
                if table.contact_impedance.is_some() {
                    return self.refuse("electrodes.contact_impedance", "given".into(), hint);
                }
                Ok(ElectrodeModel::Point)
            }
            "complete" => Ok(ElectrodeModel::Complete {
                width: self.widths(table, count)?,
                contact_impedance: self.each(
                    "electrodes.contact_impedance",
                    table.contact_impedance.as_ref(),
                    count,
                    quantity::CONTACT_IMPEDANCE,
                )?,
            }),
            other => self.refuse("electrodes.model", format!("{other:?}"), "\"point\" or \"complete\""),
        }
    }

    /// Widths of electrodes; zero where the groups of a mesh file say how wide they are.
    fn widths(&self, table: &ElectrodeTable, count: usize) -> Result<Vec<f64>, SkinError> {
        match (&table.width, table.placement.as_str()) {
            (Some(_), "groups") => {
                self.refuse("electrodes.width", "given".into(), "nothing (the groups of the mesh say it)")
            }
            (None, "groups") => Ok(vec![0.0; count]),
            (width, _) => self.each("electrodes.width", width.as_ref(), count, quantity::LENGTH),
        }
    }

    /// One value for all electrodes, or one for each: `[electrode]`.
    fn each(
        &self,
        field: &'static str,
        written: Option<&OneOrEach>,
        count: usize,
        kind: Kind,
    ) -> Result<Vec<f64>, SkinError> {
        let read = |quantity| self.positive(field, quantity, kind);
        match written {
            None => self.refuse(field, "missing".into(), "one value, or one for each electrode"),
            Some(OneOrEach::One(quantity)) => Ok(vec![read(quantity)?; count]),
            Some(OneOrEach::Each(each)) if each.len() == count => each.iter().map(read).collect(),
            Some(OneOrEach::Each(each)) => {
                let value = format!("a list of {}", each.len());
                self.refuse(field, value, &format!("one value, or a list of {count}"))
            }
        }
    }
}
