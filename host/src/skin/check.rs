//! Checks a skin file table by table: what a person wrote -> [`Skin`].

use super::{
    Drive, Inverse, Prior, Skin, SkinError,
    electrodes::{ElectrodeModel, Electrodes},
    file::{DriveTable, ElectrodeTable, File, InverseTable, OneOrEach, Shape},
    outline::Outline,
    quantity::{self, Kind, Quantity},
};
use dermatome_shared::{MAX_ELECTRODES, MAX_GRID_SIDE, patch::Difference};
use std::path::Path;

/// Turns each table into its checked form; knows the file for error messages.
pub(super) struct Checker<'a> {
    pub(super) path: &'a Path,
}

impl Checker<'_> {
    pub(super) fn skin(&self, file: &File) -> Result<Skin, SkinError> {
        let outline = self.outline(&file.shape)?;
        let edge_length = self.positive("mesh.edge_length", &file.mesh.edge_length, quantity::LENGTH)?;
        self.edge_length_fits(&outline, &file.mesh.edge_length, edge_length)?;
        let conductivity = &file.material.sheet_conductivity;
        Ok(Skin {
            name: self.name(&file.name)?,
            outline,
            edge_length,
            sheet_conductivity: self.positive(
                "material.sheet_conductivity",
                conductivity,
                quantity::SHEET_CONDUCTIVITY,
            )?,
            electrodes: self.electrodes(&file.electrodes, &outline)?,
            drive: self.drive(&file.drive, file.electrodes.count)?,
            inverse: self.inverse(&file.inverse)?,
            image_columns: self.count("image.columns", file.image.columns, 4, MAX_GRID_SIDE)?,
            contact_threshold: self.threshold(file.contact.threshold)?,
        })
    }

    fn name(&self, name: &str) -> Result<String, SkinError> {
        let allowed = |c: char| c.is_ascii_alphanumeric() || matches!(c, '-' | '_');
        let fits = (1..=32).contains(&name.len()) && name.chars().all(allowed);
        if fits {
            Ok(name.to_owned())
        } else {
            self.refuse(
                "name",
                format!("{name:?}"),
                "1 to 32 letters, digits, \"-\" or \"_\" (it names the patch file)",
            )
        }
    }

    fn outline(&self, shape: &Shape) -> Result<Outline, SkinError> {
        match shape.kind.as_str() {
            "disc" => {
                self.absent("shape.width", shape.width.as_ref(), "nothing (a disc has a `diameter`)")?;
                self.absent("shape.height", shape.height.as_ref(), "nothing (a disc has a `diameter`)")?;
                let diameter = self.required("shape.diameter", shape.diameter.as_ref(), quantity::LENGTH)?;
                Ok(Outline::Disc { radius: diameter / 2.0 })
            }
            "rectangle" => {
                let hint = "nothing (a rectangle has `width` and `height`)";
                self.absent("shape.diameter", shape.diameter.as_ref(), hint)?;
                let width = self.required("shape.width", shape.width.as_ref(), quantity::LENGTH)?;
                let height = self.required("shape.height", shape.height.as_ref(), quantity::LENGTH)?;
                if !(0.01..=100.0).contains(&(height / width)) {
                    return self.refuse(
                        "shape.height",
                        format!("{height} m"),
                        "a hundredth to a hundred times `width`",
                    );
                }
                Ok(Outline::Rectangle { width, height })
            }
            other => self.refuse("shape.kind", format!("{other:?}"), "\"disc\" or \"rectangle\""),
        }
    }

    /// Between a handful of elements and a million.
    fn edge_length_fits(&self, outline: &Outline, written: &Quantity, edge: f64) -> Result<(), SkinError> {
        let [x, y] = outline.half_size();
        let longest = x.min(y) / 2.0;
        let shortest = (outline.area() / 5e5).sqrt();
        if (shortest..=longest).contains(&edge) {
            return Ok(());
        }
        let allowed = format!("{:.3} mm to {:.3} mm for this shape", shortest * 1e3, longest * 1e3);
        self.refuse("mesh.edge_length", written.to_string(), &allowed)
    }

    fn electrodes(&self, table: &ElectrodeTable, outline: &Outline) -> Result<Electrodes, SkinError> {
        let count = self.count("electrodes.count", table.count, 4, MAX_ELECTRODES)?;
        let ground = self.count("electrodes.ground", table.ground, 1, usize::from(count))?;
        let electrodes = Electrodes {
            centres: self.centres(table, outline, count)?,
            model: self.electrode_model(table, usize::from(count))?,
            ground: usize::from(ground) - 1,
        };
        self.electrodes_fit(table, &electrodes, outline)?;
        Ok(electrodes)
    }

    fn centres(&self, table: &ElectrodeTable, outline: &Outline, count: u8) -> Result<Vec<f64>, SkinError> {
        let sign = match table.direction.as_str() {
            "clockwise" => -1.0,
            "counter-clockwise" => 1.0,
            other => {
                let allowed = "\"clockwise\" or \"counter-clockwise\"";
                return self.refuse("electrodes.direction", format!("{other:?}"), allowed);
            }
        };
        let angle = self.finite("electrodes.first", &table.first, quantity::ANGLE)?;
        let first = outline.rim_position(angle);
        match table.placement.as_str() {
            "rim" => {
                self.absent(
                    "electrodes.pitch",
                    table.pitch.as_ref(),
                    "nothing (only placement \"sides\" has it)",
                )?;
                let spacing = outline.perimeter() / f64::from(count);
                Ok((0..count).map(|i| first + sign * f64::from(i) * spacing).collect())
            }
            "sides" => self.centres_on_sides(table, outline, count, first, sign),
            other => self.refuse("electrodes.placement", format!("{other:?}"), "\"rim\" or \"sides\""),
        }
    }

    /// A quarter of the electrodes on each side of a rectangle, `pitch` apart, in the middle of
    /// the side; electrode 1 is the first one met from `first` on.
    fn centres_on_sides(
        &self,
        table: &ElectrodeTable,
        outline: &Outline,
        count: u8,
        first: f64,
        sign: f64,
    ) -> Result<Vec<f64>, SkinError> {
        let corners = outline.corners();
        if corners.is_empty() {
            return self.refuse("electrodes.placement", "\"sides\"".into(), "\"rim\" for a disc");
        }
        if !count.is_multiple_of(4) {
            return self.refuse(
                "electrodes.count",
                count.to_string(),
                "a multiple of 4 with placement \"sides\"",
            );
        }
        let pitch = self.required("electrodes.pitch", table.pitch.as_ref(), quantity::LENGTH)?;
        let perimeter = outline.perimeter();
        let on_side = |side: usize| {
            let from = corners[side];
            let length = (corners[(side + 1) % 4] - from).rem_euclid(perimeter);
            let offset = move |i: u8| (f64::from(i) - f64::from(count / 4 - 1) / 2.0) * pitch;
            (0..count / 4).map(move |i| from + length / 2.0 + offset(i))
        };
        let mut centres: Vec<f64> = (0..4).flat_map(on_side).collect();
        // A tiny allowance, so that an electrode exactly at `first` comes first.
        let ahead = |s: f64| (sign * (s - first) + 1e-9 * perimeter).rem_euclid(perimeter);
        centres.sort_by(|&a, &b| ahead(a).total_cmp(&ahead(b)));
        self.side_fits(table, outline, count, pitch)?;
        Ok(centres)
    }

    fn side_fits(
        &self,
        table: &ElectrodeTable,
        outline: &Outline,
        count: u8,
        pitch: f64,
    ) -> Result<(), SkinError> {
        let [x, y] = outline.half_size();
        let width = match &table.width {
            Some(width) => self.positive("electrodes.width", width, quantity::LENGTH)?,
            None => 0.0,
        };
        let needed = f64::from(count / 4 - 1) * pitch + width;
        if needed <= 2.0 * x.min(y) * (1.0 + 1e-9) {
            return Ok(());
        }
        let longest = (2.0 * x.min(y) - width) / f64::from((count / 4).max(2) - 1);
        let allowed = format!("at most {:.3} mm, so that no electrode lies outside its side", longest * 1e3);
        self.refuse("electrodes.pitch", format!("{:.3} mm", pitch * 1e3), &allowed)
    }

    fn electrode_model(&self, table: &ElectrodeTable, count: usize) -> Result<ElectrodeModel, SkinError> {
        match table.model.as_str() {
            "point" => {
                let hint = "nothing (point electrodes have none)";
                self.absent("electrodes.width", table.width.as_ref(), hint)?;
                if table.contact_impedance.is_some() {
                    return self.refuse("electrodes.contact_impedance", "given".into(), hint);
                }
                Ok(ElectrodeModel::Point)
            }
            "complete" => Ok(ElectrodeModel::Complete {
                width: self.required("electrodes.width", table.width.as_ref(), quantity::LENGTH)?,
                contact_impedance: self.contact_impedance(table.contact_impedance.as_ref(), count)?,
            }),
            other => self.refuse("electrodes.model", format!("{other:?}"), "\"point\" or \"complete\""),
        }
    }

    fn contact_impedance(&self, written: Option<&OneOrEach>, count: usize) -> Result<Vec<f64>, SkinError> {
        const FIELD: &str = "electrodes.contact_impedance";
        let read = |quantity| self.positive(FIELD, quantity, quantity::CONTACT_IMPEDANCE);
        match written {
            None => self.refuse(FIELD, "missing".into(), "one value, or one for each electrode"),
            Some(OneOrEach::One(quantity)) => Ok(vec![read(quantity)?; count]),
            Some(OneOrEach::Each(each)) if each.len() == count => each.iter().map(read).collect(),
            Some(OneOrEach::Each(each)) => {
                let value = format!("a list of {}", each.len());
                self.refuse(FIELD, value, &format!("one value, or a list of {count}"))
            }
        }
    }

    fn electrodes_fit(
        &self,
        table: &ElectrodeTable,
        electrodes: &Electrodes,
        outline: &Outline,
    ) -> Result<(), SkinError> {
        let (a, b, gap) = electrodes.tightest_gap(outline.perimeter());
        if gap > 1e-9 * outline.perimeter() {
            return Ok(());
        }
        let room = (gap + electrodes.width()) * 1e3;
        let allowed = format!("less than {room:.3} mm, or electrodes {} and {} overlap", a + 1, b + 1);
        match (&table.width, &table.pitch) {
            (Some(width), _) => self.refuse("electrodes.width", width.to_string(), &allowed),
            (None, Some(pitch)) => {
                self.refuse("electrodes.pitch", pitch.to_string(), "a pitch that keeps electrodes apart")
            }
            (None, None) => {
                self.refuse("electrodes.count", table.count.to_string(), "electrodes that lie apart")
            }
        }
    }

    fn drive(&self, table: &DriveTable, electrodes: i64) -> Result<Drive, SkinError> {
        let (drive_distance, sense_distance) = self.pattern(&table.pattern, electrodes)?;
        let combine_reciprocal = match table.reciprocal.as_str() {
            "combined" => true,
            "kept" => false,
            other => {
                return self.refuse("drive.reciprocal", format!("{other:?}"), "\"combined\" or \"kept\"");
            }
        };
        Ok(Drive {
            drive_distance,
            sense_distance,
            combine_reciprocal,
            frequency: self.positive("drive.frequency", &table.frequency, quantity::FREQUENCY)?,
            amplitude: self.positive("drive.amplitude", &table.amplitude, quantity::CURRENT)?,
            frame_rate: self.positive("drive.frame_rate", &table.frame_rate, quantity::FREQUENCY)?,
        })
    }

    fn pattern(&self, pattern: &str, electrodes: i64) -> Result<(u8, u8), SkinError> {
        let skipped = pattern.strip_prefix("skip-").and_then(|n| n.parse::<u8>().ok());
        match (pattern, skipped) {
            ("adjacent", _) => Ok((1, 1)),
            ("opposite", _) if electrodes % 2 == 0 && electrodes >= 6 => Ok(((electrodes / 2) as u8, 1)),
            (_, Some(n)) if (0..electrodes / 2 - 1).contains(&i64::from(n)) => Ok((n + 1, n + 1)),
            _ => {
                let most = electrodes / 2 - 2;
                let allowed = format!(
                    "\"adjacent\", \"opposite\" (even count from 6 on), or \"skip-0\" to \"skip-{most}\""
                );
                self.refuse("drive.pattern", format!("{pattern:?}"), &allowed)
            }
        }
    }

    fn inverse(&self, table: &InverseTable) -> Result<Inverse, SkinError> {
        let prior = match table.prior.as_str() {
            "laplace" => Prior::Laplace,
            "tikhonov" => Prior::Tikhonov,
            "noser" => Prior::Noser,
            other => {
                let allowed = "\"laplace\", \"tikhonov\" or \"noser\"";
                return self.refuse("inverse.prior", format!("{other:?}"), allowed);
            }
        };
        Ok(Inverse {
            prior,
            hyperparameter: self.positive_number("inverse.hyperparameter", table.hyperparameter)?,
            difference: if table.normalised { Difference::Normalised } else { Difference::Plain },
        })
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
            Some(value) if value > 0.0 && value.is_finite() => Ok(value),
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

    /// At least one step of the board's image.
    fn threshold(&self, value: f64) -> Result<f64, SkinError> {
        let fits = (1e-6..=1000.0).contains(&value);
        if fits { Ok(value) } else { self.refuse("contact.threshold", value.to_string(), "0.000001 to 1000") }
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
