//! Where electrodes lie on a sheet: equally spaced, on sides, or at given points.

use super::Checker;
use crate::skin::{SkinError, electrodes::Electrodes, file::ElectrodeTable, quantity};
use dermatome_geometry::sheet::Place;
use dermatome_geometry::{embedding::Embedding, outline::Outline, sheet::ElectrodeModel};
use nalgebra::{Point2, Point3};
use std::f64::consts::FRAC_PI_2;

/// Free sheet between an electrode inside and a rim or another electrode inside, in its widths: the
/// polygon round it reaches out of its circle, and the mesh generator fails below 0.004.
const LEAST_GAP: f64 = 0.02;

/// The sheet on which electrodes are placed.
struct Ground<'a> {
    table: &'a ElectrodeTable,
    outline: &'a Outline,
    embedding: &'a Embedding,
    electrodes: &'a Electrodes,
}

impl Checker<'_> {
    /// Where each electrode lies on a sheet: `[electrode]`.
    pub(in crate::skin::check) fn places(
        &self,
        table: &ElectrodeTable,
        outline: &Outline,
        embedding: &Embedding,
        electrodes: &Electrodes,
    ) -> Result<Vec<Place>, SkinError> {
        let ground = Ground { table, outline, embedding, electrodes };
        self.only_fields_of_placement(table)?;
        let places = match table.placement.as_str() {
            "rim" => self.along_rim(&ground)?,
            "sides" => self.on_sides(&ground)?,
            _ => self.at_points(&ground)?,
        };
        self.lie_apart(&ground, &places)?;
        Ok(places)
    }

    pub(in crate::skin::check) fn is_placement(
        &self,
        table: &ElectrodeTable,
        allowed: &[&str],
    ) -> Result<(), SkinError> {
        if allowed.contains(&table.placement.as_str()) {
            return Ok(());
        }
        let words: Vec<_> = allowed.iter().map(|word| format!("{word:?}")).collect();
        self.refuse("electrodes.placement", format!("{:?}", table.placement), &words.join(", "))
    }

    pub(in crate::skin::check) fn only_fields_of_placement(
        &self,
        table: &ElectrodeTable,
    ) -> Result<(), SkinError> {
        self.is_placement(table, &["rim", "sides", "points"])?;
        let (sides, points) = (table.placement == "sides", table.placement == "points");
        if !sides {
            let hint = "nothing (only placement \"sides\" has it)";
            self.absent("electrodes.pitch", table.pitch.as_ref(), hint)?;
        }
        if points {
            let hint = "nothing (`positions` say where electrodes lie)";
            self.absent("electrodes.first", table.first.as_ref(), hint)?;
            if table.direction.is_some() {
                return self.refuse("electrodes.direction", "given".into(), hint);
            }
        } else if table.positions.is_some() {
            let hint = "nothing (only placement \"points\" has it)";
            return self.refuse("electrodes.positions", "given".into(), hint);
        }
        Ok(())
    }

    /// Arc length of `first`, and the sign of the direction in which electrodes are numbered.
    fn first(&self, ground: &Ground<'_>) -> Result<(f64, f64), SkinError> {
        let (angle, sign) = self.first_angle(ground.table)?;
        Ok((ground.outline.rim_position(angle), sign))
    }

    pub(in crate::skin::check) fn first_angle(
        &self,
        table: &ElectrodeTable,
    ) -> Result<(f64, f64), SkinError> {
        let sign = match table.direction.as_deref().unwrap_or("clockwise") {
            "clockwise" => -1.0,
            "counter-clockwise" => 1.0,
            other => {
                let allowed = "\"clockwise\" or \"counter-clockwise\"";
                return self.refuse("electrodes.direction", format!("{other:?}"), allowed);
            }
        };
        let angle = match &table.first {
            Some(first) => self.finite("electrodes.first", first, quantity::ANGLE)?,
            None => FRAC_PI_2,
        };
        Ok((angle, sign))
    }

    fn along_rim(&self, ground: &Ground<'_>) -> Result<Vec<Place>, SkinError> {
        let (first, sign) = self.first(ground)?;
        let count = ground.electrodes.count;
        let spacing = ground.outline.perimeter() / f64::from(count);
        Ok((0..count).map(|i| Place::Rim(first + sign * f64::from(i) * spacing)).collect())
    }

    /// The same number of electrodes on each side, `pitch` apart, in the middle of the side;
    /// electrode 1 is the first one met from `first` on.
    fn on_sides(&self, ground: &Ground<'_>) -> Result<Vec<Place>, SkinError> {
        let Ground { table, outline, electrodes, .. } = ground;
        let (first, sign) = self.first(ground)?;
        let (corners, perimeter) = (outline.corners(), outline.perimeter());
        if corners.is_empty() {
            let allowed = "\"rim\" or \"points\" for a disc, an ellipse or a hemisphere";
            return self.refuse("electrodes.placement", "\"sides\"".into(), allowed);
        }
        let count = usize::from(electrodes.count);
        if !count.is_multiple_of(corners.len()) {
            let allowed = format!("a multiple of {} with placement \"sides\"", corners.len());
            return self.refuse("electrodes.count", count.to_string(), &allowed);
        }
        let pitch = self.required("electrodes.pitch", table.pitch.as_ref(), quantity::LENGTH)?;
        let on_side = count / corners.len();
        let mut centres = Vec::new();
        for (side, &from) in corners.iter().enumerate() {
            let length = match corners.get(side + 1) {
                Some(to) => to - from,
                None => corners[0] + perimeter - from,
            };
            self.side_fits(electrodes, length, on_side, pitch)?;
            let offset = |i: usize| (i as f64 - (on_side - 1) as f64 / 2.0) * pitch;
            centres.extend((0..on_side).map(|i| from + length / 2.0 + offset(i)));
        }
        // A tiny allowance, so that an electrode exactly at `first` comes first.
        let ahead = |s: f64| (sign * (s - first) + 1e-9 * perimeter).rem_euclid(perimeter);
        centres.sort_by(|&a, &b| ahead(a).total_cmp(&ahead(b)));
        Ok(centres.into_iter().map(Place::Rim).collect())
    }

    fn side_fits(
        &self,
        electrodes: &Electrodes,
        length: f64,
        on_side: usize,
        pitch: f64,
    ) -> Result<(), SkinError> {
        let widths = (0..usize::from(electrodes.count)).map(|e| electrodes.model.width(e));
        let width = widths.fold(0.0, f64::max);
        let needed = (on_side - 1) as f64 * pitch + width;
        if needed <= length * (1.0 + 1e-9) {
            return Ok(());
        }
        let longest = (length - width) / (on_side.max(2) - 1) as f64;
        let allowed = format!("at most {:.3} mm, so that no electrode lies outside its side", longest * 1e3);
        self.refuse("electrodes.pitch", format!("{:.3} mm", pitch * 1e3), &allowed)
    }

    fn at_points(&self, ground: &Ground<'_>) -> Result<Vec<Place>, SkinError> {
        let rows = self.positions(ground.table, usize::from(ground.electrodes.count))?;
        rows.iter().enumerate().map(|(electrode, row)| self.at_point(ground, electrode, row)).collect()
    }

    /// One row of coordinates for each electrode.
    pub(in crate::skin::check) fn positions<'t>(
        &self,
        table: &'t ElectrodeTable,
        count: usize,
    ) -> Result<&'t [Vec<quantity::Quantity>], SkinError> {
        match table.positions.as_deref() {
            Some(rows) if rows.len() == count => Ok(rows),
            Some(rows) => {
                let allowed = format!("one position for each of {count} electrodes");
                self.refuse("electrodes.positions", format!("a list of {}", rows.len()), &allowed)
            }
            None => {
                let allowed = "the coordinates of each electrode, one row each";
                self.refuse("electrodes.positions", "missing".into(), allowed)
            }
        }
    }

    /// On the rim if the electrode reaches it, else inside.
    fn at_point(
        &self,
        ground: &Ground<'_>,
        electrode: usize,
        row: &[quantity::Quantity],
    ) -> Result<Place, SkinError> {
        let axes = if *ground.embedding == Embedding::Flat { 2 } else { 3 };
        let position = self.position(axes, electrode, row)?;
        let point = ground.embedding.flatten(position);
        let off = (ground.embedding.lay(point) - position).norm();
        let (rim, depth) = (ground.outline.rim().nearest(point), ground.outline.depth(point));
        let reach = ground.reach(electrode, point);
        let refuse = |distance: f64, what: &str| {
            let value = format!("electrode {} {:.3} mm {what}", electrode + 1, distance * 1e3);
            let allowed =
                format!("at most {:.3} mm from the skin, and as much clear of its holes", reach * 1e3);
            self.refuse("electrodes.positions", value, &allowed)
        };
        if off > reach {
            refuse(off, "above or below the skin")
        } else if rim.distance <= reach {
            Ok(Place::Rim(rim.arc_length))
        } else if depth < 0.0 {
            refuse(-depth, "outside the skin")
        } else if depth <= reach {
            refuse(depth, "from the rim of a hole")
        } else if depth <= reach + ground.least_gap(electrode, point) {
            self.refuse_near_rim(ground, electrode, point)
        } else {
            Ok(Place::Inside(point))
        }
    }

    fn refuse_near_rim<T>(
        &self,
        ground: &Ground<'_>,
        electrode: usize,
        point: Point2<f64>,
    ) -> Result<T, SkinError> {
        let [depth, reach, gap] =
            [ground.outline.depth(point), ground.reach(electrode, point), ground.least_gap(electrode, point)]
                .map(|length| length * 1e3);
        let value = format!("electrode {} {depth:.3} mm from a rim", electrode + 1);
        let allowed = format!(
            "more than {:.3} mm, or at most {reach:.3} mm from the outer rim, which puts it there",
            reach + gap
        );
        self.refuse("electrodes.positions", value, &allowed)
    }

    /// The point with so many coordinates, z = 0 where it has two.
    pub(in crate::skin::check) fn position(
        &self,
        axes: usize,
        electrode: usize,
        row: &[quantity::Quantity],
    ) -> Result<Point3<f64>, SkinError> {
        if row.len() != axes {
            let value = format!("electrode {} with {} coordinates", electrode + 1, row.len());
            let allowed = format!("{axes} coordinates for this shape");
            return self.refuse("electrodes.positions", value, &allowed);
        }
        let mut position = Point3::origin();
        for (axis, written) in row.iter().enumerate() {
            position[axis] = self.finite("electrodes.positions", written, quantity::LENGTH)?;
        }
        Ok(position)
    }

    fn lie_apart(&self, ground: &Ground<'_>, places: &[Place]) -> Result<(), SkinError> {
        let gap = ground.tightest_gap(places);
        if gap.free > 1e-6 * ground.outline.perimeter() {
            return Ok(());
        }
        let table = ground.table;
        let model = &ground.electrodes.model;
        let [a, b] = gap.electrodes;
        let room = (gap.free + (model.width(a) + model.width(b)) / 2.0) * 1e3;
        let allowed = format!("less than {room:.3} mm, or electrodes {} and {} overlap", a + 1, b + 1);
        let width = table.width.as_ref().and_then(|width| width.of(a));
        match (width, &table.pitch, &table.positions) {
            (Some(width), ..) => self.refuse("electrodes.width", width.to_string(), &allowed),
            (None, Some(pitch), _) => {
                self.refuse("electrodes.pitch", pitch.to_string(), "a pitch that keeps electrodes apart")
            }
            (None, None, Some(_)) => {
                let value = format!("the same for electrodes {} and {}", a + 1, b + 1);
                self.refuse("electrodes.positions", value, "positions that lie apart")
            }
            (None, None, None) => {
                self.refuse("electrodes.count", table.count.to_string(), "electrodes that lie apart")
            }
        }
    }
}

/// Two electrodes (zero-based) and the free sheet between them, m; negative if they overlap.
struct Gap {
    electrodes: [usize; 2],
    free: f64,
}

impl Ground<'_> {
    /// How far from the rim or off the surface an electrode may lie to be placed there: half its
    /// width, or a hundredth of the diameter if it is a point; on the flat sheet, m.
    fn reach(&self, electrode: usize, point: Point2<f64>) -> f64 {
        match self.electrodes.model {
            ElectrodeModel::Point => self.outline.diameter() / 100.0,
            ElectrodeModel::Complete { .. } => {
                self.electrodes.model.width(electrode) / 2.0 / self.embedding.scale(point)
            }
        }
    }

    /// Free sheet that an electrode inside needs round it, m; none for a point.
    fn least_gap(&self, electrode: usize, point: Point2<f64>) -> f64 {
        LEAST_GAP * self.electrodes.model.width(electrode) / self.embedding.scale(point)
    }

    /// Electrodes on the rim keep apart along it; those inside keep apart as the crow flies, and
    /// clear of the rim.
    fn tightest_gap(&self, places: &[Place]) -> Gap {
        let perimeter = self.outline.perimeter();
        let width = |e: usize| self.electrodes.model.width(e);
        let pairs = (0..places.len()).flat_map(|a| (0..a).map(move |b| [b, a]));
        let gap = |[a, b]: [usize; 2]| {
            let free = match (places[a], places[b]) {
                (Place::Rim(s), Place::Rim(t)) => {
                    let ahead = (s - t).rem_euclid(perimeter);
                    ahead.min(perimeter - ahead) - (width(a) + width(b)) / 2.0
                }
                (Place::Inside(p), Place::Inside(q)) => {
                    (p - q).norm()
                        - self.least_gap(a, p).max(self.least_gap(b, q))
                        - width(a) / 2.0 / self.embedding.scale(p)
                        - width(b) / 2.0 / self.embedding.scale(q)
                }
                _ => perimeter,
            };
            Gap { electrodes: [a, b], free }
        };
        let nothing = Gap { electrodes: [0, 0], free: perimeter };
        pairs.map(gap).fold(nothing, |least, gap| if gap.free < least.free { gap } else { least })
    }
}
