//! Table `[material]`.

use super::{Checker, beside::TableField};
use crate::skin::{
    ConductivityMap, Described, Material, SkinError,
    file::{MapTable, MaterialTable},
    quantity::{self, Quantity},
    table::Columns,
};
use nalgebra::Point3;
use serde::Deserialize;
use std::{ops::RangeInclusive, path::Path};

/// Points of a conductivity map at most.
const MOST_POINTS: usize = 1000;
/// How far conductivities may lie from `sheet_conductivity`, as a factor.
const RATIOS: RangeInclusive<f64> = 0.01..=100.0;

const MAP_FILE: TableField<'_> = TableField {
    field: "material.conductivity_map",
    else_allowed: "rows",
    columns: Columns { required: &["x_m", "y_m", "relative"], optional: &["z_m"] },
    most: MOST_POINTS,
};

/// A row of a map's CSV file.
#[derive(Deserialize)]
struct MapRow {
    x_m: f64,
    y_m: f64,
    z_m: Option<f64>,
    relative: f64,
}

impl MapRow {
    fn point(&self) -> (Point3<f64>, f64) {
        (Point3::new(self.x_m, self.y_m, self.z_m.unwrap_or(0.0)), self.relative)
    }
}

/// Places of a map further from the skin's middle than so many times its size are in another unit.
const FARTHEST: f64 = 10.0;

impl Checker<'_> {
    /// The material of a skin of this shape.
    pub(super) fn material_of(
        &self,
        table: &MaterialTable,
        shape: &Described,
    ) -> Result<Material, SkinError> {
        let material = self.material(table)?;
        let (Some(map), Described::Sheet(sheet)) = (&material.map, shape) else { return Ok(material) };
        let [low, high] = sheet.outline.bounds();
        let (middle, farthest) = (nalgebra::center(&low, &high), FARTHEST * sheet.outline.diameter());
        let is_far = |place: &&Point3<f64>| (place.xy() - middle).norm() > farthest;
        let far = map.places().find(is_far).map(show);
        let Some(place) = far else { return Ok(material) };
        let allowed = format!("places within {:.0} mm of the skin's middle. Are they in m?", farthest * 1e3);
        self.refuse_map(format!("given at {place}"), &allowed)
    }

    fn material(&self, table: &MaterialTable) -> Result<Material, SkinError> {
        let conductivity = &table.sheet_conductivity;
        let sheet_conductivity =
            self.positive("material.sheet_conductivity", conductivity, quantity::SHEET_CONDUCTIVITY)?;
        let sheet_capacitance = match &table.sheet_capacitance {
            Some(written) => self.positive("material.sheet_capacitance", written, quantity::CAPACITANCE)?,
            None => 0.0,
        };
        Ok(Material {
            sheet_conductivity,
            across: self.across(table, sheet_conductivity)?,
            grain: self.grain(table)?,
            map: table.conductivity_map.as_ref().map(|map| self.map(map)).transpose()?,
            sheet_capacitance,
        })
    }

    /// Conductivity across the grain over that along it.
    fn across(&self, table: &MaterialTable, along: f64) -> Result<Option<f64>, SkinError> {
        let field = "material.sheet_conductivity_across";
        let Some(written) = &table.sheet_conductivity_across else { return Ok(None) };
        let across = self.positive(field, written, quantity::SHEET_CONDUCTIVITY)? / along;
        if RATIOS.contains(&across) {
            return Ok(Some(across));
        }
        self.refuse(field, written.to_string(), "0.01 to 100 times `sheet_conductivity`")
    }

    fn grain(&self, table: &MaterialTable) -> Result<f64, SkinError> {
        match (&table.grain, &table.sheet_conductivity_across) {
            (None, _) => Ok(0.0),
            (Some(written), Some(_)) => self.finite("material.grain", written, quantity::ANGLE),
            (Some(written), None) => {
                let allowed = "nothing (only with `sheet_conductivity_across` is there a grain)";
                self.refuse("material.grain", written.to_string(), allowed)
            }
        }
    }

    fn map(&self, table: &MapTable) -> Result<ConductivityMap, SkinError> {
        let rows = match table {
            MapTable::Inline(rows) => rows.iter().map(|row| self.map_row(row)).collect::<Result<_, _>>()?,
            MapTable::File(file) => self.map_file(file)?,
        };
        if !(1..=MOST_POINTS).contains(&rows.len()) {
            let allowed = format!("1 to {MOST_POINTS} points");
            return self.refuse_map(format!("{} points", rows.len()), &allowed);
        }
        if let Some((point, value)) = rows.iter().find(|(_, value)| !RATIOS.contains(value)) {
            return self.refuse_map(format!("{value} at {}", show(point)), "0.01 to 100");
        }
        let twice = |(i, (point, _)): &(usize, &(Point3<f64>, f64))| {
            rows[..*i].iter().any(|(before, _)| before == point)
        };
        let second = rows.iter().enumerate().find(twice).map(|(_, (point, _))| show(point));
        match ConductivityMap::new(rows) {
            Some(map) => Ok(map),
            None => self.refuse_map(second.unwrap_or_default(), "each point once"),
        }
    }

    /// Coordinates, then the conductivity there.
    fn map_row(&self, row: &[Quantity]) -> Result<(Point3<f64>, f64), SkinError> {
        let field = "material.conductivity_map";
        let (coordinates, value) = match row {
            [coordinates @ .., Quantity::Number(value)] if matches!(coordinates.len(), 2 | 3) => {
                (coordinates, *value)
            }
            _ => {
                let row: Vec<_> = row.iter().map(Quantity::to_string).collect();
                let allowed = "rows of x, y, on a curved skin z, and a number: times `sheet_conductivity`";
                return self.refuse_map(format!("[{}]", row.join(", ")), allowed);
            }
        };
        let mut point = Point3::origin();
        for (axis, written) in coordinates.iter().enumerate() {
            point[axis] = self.finite(field, written, quantity::LENGTH)?;
        }
        Ok((point, value))
    }

    /// Rows of a CSV file with the columns `x_m,y_m,relative`, on a curved skin `z_m` as well.
    fn map_file(&self, file: &Path) -> Result<Vec<(Point3<f64>, f64)>, SkinError> {
        let rows: Vec<MapRow> = self.table(file, &MAP_FILE)?;
        let is_finite =
            |row: &MapRow| [row.x_m, row.y_m, row.z_m.unwrap_or(0.0)].iter().all(|at| at.is_finite());
        match rows.iter().find(|row| !is_finite(row)) {
            Some(MapRow { x_m, y_m, .. }) => self.refuse_map(
                format!("at {x_m}, {y_m} m in {:?}", file.display().to_string()),
                "finite coordinates",
            ),
            None => Ok(rows.iter().map(MapRow::point).collect()),
        }
    }

    fn refuse_map<T>(&self, value: String, allowed: &str) -> Result<T, SkinError> {
        self.refuse("material.conductivity_map", value, allowed)
    }
}

fn show(point: &Point3<f64>) -> String {
    let [x, y, z] = [point.x, point.y, point.z].map(|value| value * 1e3);
    format!("{x}, {y}, {z} mm")
}
