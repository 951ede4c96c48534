//! A mesh that was made elsewhere, and where electrodes go on it: `shape.kind` = "mesh".

use super::Checker;
use crate::skin::{
    Described, MeshFile, Placement, SkinError, UNITS,
    file::{ElectrodeTable, File, ShapeTable},
};
use dermatome_geometry::sheet::EdgeLengths;
use std::path::Path;

impl Checker<'_> {
    /// What to read, with edges and, where groups are electrodes, widths of zero until it is.
    pub(super) fn mesh_file(&self, file: &File) -> Result<(Described, EdgeLengths), SkinError> {
        if file.mesh.is_some() {
            let allowed = "nothing (the mesh in `shape.file` is used as it is)";
            return self.refuse("mesh.edge_length", "given".into(), allowed);
        }
        let (written, unit) = self.file_and_unit(&file.shape)?;
        let described = MeshFile {
            skin_file: self.path.to_owned(),
            written: written.to_owned(),
            path: self.beside("shape.file", written)?,
            unit,
            weld: file.shape.weld,
            allow_cracks: file.shape.allow_cracks.unwrap_or(false),
            placement: self.placement(&file.electrodes)?,
        };
        Ok((Described::Mesh(described), EdgeLengths { skin: 0.0, electrodes: 0.0 }))
    }

    /// Name of the file, and length of its unit, m.
    fn file_and_unit<'t>(&self, table: &'t ShapeTable) -> Result<(&'t Path, f64), SkinError> {
        let Some(file) = &table.file else {
            return self.refuse("shape.file", "missing".into(), "an STL, OBJ, PLY, COLLADA or MSH file");
        };
        let units: Vec<_> = UNITS.iter().map(|(name, _)| format!("{name:?}")).collect();
        let Some(unit) = &table.unit else {
            return self.refuse("shape.unit", "missing".into(), &units.join(", "));
        };
        match UNITS.iter().find(|(name, _)| name == unit) {
            Some((_, metres)) => Ok((file, *metres)),
            None => self.refuse("shape.unit", format!("{unit:?}"), &units.join(", ")),
        }
    }

    fn placement(&self, table: &ElectrodeTable) -> Result<Placement, SkinError> {
        self.is_placement(table, &["groups", "rim", "points"])?;
        match table.placement.as_str() {
            "groups" => self.only_groups(table).map(|()| Placement::Groups),
            "rim" => {
                self.only_fields_of_placement(table)?;
                let (first, turn) = self.first_angle(table)?;
                Ok(Placement::Rim { first, turn })
            }
            _ => {
                self.only_fields_of_placement(table)?;
                let rows = self.positions(table, table.count as usize)?.iter().enumerate();
                let axes = |row: &[_]| if row.len() == 2 { 2 } else { 3 };
                let points = rows.map(|(electrode, row)| self.position(axes(row), electrode, row));
                Ok(Placement::Points(points.collect::<Result<_, _>>()?))
            }
        }
    }

    fn only_groups(&self, table: &ElectrodeTable) -> Result<(), SkinError> {
        let given = [
            ("electrodes.pitch", table.pitch.is_some()),
            ("electrodes.positions", table.positions.is_some()),
            ("electrodes.first", table.first.is_some()),
            ("electrodes.direction", table.direction.is_some()),
        ];
        match given.into_iter().find(|(_, given)| *given) {
            Some((field, _)) => self.refuse(
                field,
                "given".into(),
                "nothing (the groups of the mesh say where electrodes lie)",
            ),
            None => Ok(()),
        }
    }
}
