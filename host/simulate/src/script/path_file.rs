//! Path files: scripts as people write them, CSV with one row for each moment of an indenter.

use super::{Moment, Script, ScriptError};
use dermatome_geometry::outline::Outline;
use dermatome_model::{
    indenter::{Footprint, Load, Press},
    skin::table::{self, Columns},
};
use serde::Deserialize;
use std::{collections::BTreeMap, path::Path};

/// Rows of a file at most.
const MOST_ROWS: usize = 1_000_000;
const COLUMNS: Columns<'_> = Columns {
    required: &["time_s", "finger", "x_m", "y_m"],
    optional: &["radius_m", "shape", "inner_m", "angle_deg", "corners_m", "depth", "pressure_kpa", "force_n"],
};
/// Shapes, as the column `shape` names them.
const SHAPES: &str = "finger, disc, ring, square, corner, polygon";

impl Script {
    /// Reads a script; columns are documented in docs/cli.md.
    pub fn load(path: &Path, outline: &Outline) -> Result<Self, ScriptError> {
        let in_file = |message: String| ScriptError::File { path: path.to_owned(), message };
        let rows: Vec<(u64, Row)> =
            table::read(path, COLUMNS, MOST_ROWS).map_err(|error| in_file(error.to_string()))?;
        let mut fingers = BTreeMap::<u32, Vec<Moment>>::new();
        for (line, row) in rows {
            let moment = row.moment().map_err(|message| in_file(format!("line {line}, {message}")))?;
            fingers.entry(row.finger).or_default().push(moment);
        }
        if fingers.is_empty() {
            return Err(in_file("no rows".into()));
        }
        Self::new(fingers.into_values().collect(), outline).map_err(|error| in_file(error.to_string()))
    }
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Row {
    // A table has both; a press that is told as it happens has none.
    #[serde(default)]
    time_s: f64,
    #[serde(default)]
    finger: u32,
    x_m: f64,
    y_m: f64,
    radius_m: Option<f64>,
    shape: Option<String>,
    inner_m: Option<f64>,
    angle_deg: Option<f64>,
    corners_m: Option<String>,
    depth: Option<f64>,
    pressure_kpa: Option<f64>,
    force_n: Option<f64>,
}

impl Row {
    fn moment(&self) -> Result<Moment, String> {
        Ok(Moment { time: self.time_s, press: self.press()? })
    }

    pub(super) fn press(&self) -> Result<Press, String> {
        Ok(Press {
            position: [self.x_m, self.y_m],
            angle: self.angle_deg.unwrap_or(0.0).to_radians(),
            footprint: self.footprint()?,
            load: self.load()?,
        })
    }

    fn footprint(&self) -> Result<Footprint, String> {
        let shape = self.shape.as_deref().unwrap_or("finger");
        let size = |value: Option<f64>, column: &str| {
            value.ok_or_else(|| format!("column `{column}`: empty; allowed: a length in m, for a {shape}"))
        };
        let radius = || size(self.radius_m, "radius_m");
        let inner = || size(self.inner_m, "inner_m");
        let made = match shape {
            "finger" => Footprint::Finger { radius: radius()? },
            "disc" => Footprint::Disc { radius: radius()? },
            "ring" => Footprint::Ring { outer: radius()?, inner: inner()? },
            "square" => Footprint::Square { side: 2.0 * radius()? },
            "corner" => Footprint::Corner { length: 2.0 * radius()?, width: inner()? },
            "polygon" => Footprint::Polygon(corners(self.corners_m.as_deref().unwrap_or_default())?),
            _ => return Err(format!("column `shape`: {shape:?}; allowed: {SHAPES}")),
        };
        self.only_its_own(shape).map(|()| made)
    }

    /// A size that the shape does not have is a mistake.
    fn only_its_own(&self, shape: &str) -> Result<(), String> {
        let is_alien = |column| match column {
            "radius_m" => self.radius_m.is_some() && shape == "polygon",
            "inner_m" => self.inner_m.is_some() && !["ring", "corner"].contains(&shape),
            _ => self.corners_m.is_some() && shape != "polygon",
        };
        let alien = ["radius_m", "inner_m", "corners_m"].into_iter().find(|&column| is_alien(column));
        alien
            .map_or(Ok(()), |column| Err(format!("column `{column}`: given; allowed: nothing for a {shape}")))
    }

    fn load(&self) -> Result<Load, String> {
        match (self.depth, self.pressure_kpa, self.force_n) {
            (Some(depth), None, None) => Ok(Load::Change(depth)),
            (None, Some(pressure), None) => Ok(Load::Pressure(pressure * 1e3)),
            (None, None, Some(force)) => Ok(Load::Force(force)),
            _ => {
                Err("columns `depth`, `pressure_kpa` and `force_n`: a number in exactly one is allowed"
                    .into())
            }
        }
    }
}

/// Corners as `x:y x:y x:y`, m.
fn corners(text: &str) -> Result<Vec<[f64; 2]>, String> {
    let corner = |pair: &str| {
        let (x, y) = pair.split_once(':')?;
        Some([x.parse().ok()?, y.parse().ok()?])
    };
    let read: Option<Vec<_>> = text.split_whitespace().map(corner).collect();
    read.ok_or_else(|| {
        format!("column `corners_m`: {text:?}; allowed: corners x:y in m, as in 0:0 0.01:0 0:0.01")
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn disc() -> Outline {
        Outline::disc(0.1)
    }

    fn write(text: &str) -> tempfile::NamedTempFile {
        let file = tempfile::NamedTempFile::new().unwrap();
        std::fs::write(file.path(), text).unwrap();
        file
    }

    #[test]
    fn a_finger_moves_steadily_between_its_moments_and_starts_again() {
        let file = write(
            "time_s,finger,x_m,y_m,radius_m,depth\n0,1,0,0,0.01,1\n2,1,0.05,0,0.01,1\n# second finger\n1,2,0,0.02,0.01,0.5\n4,2,0,0.02,0.01,0.5\n",
        );
        let script = Script::load(file.path(), &disc()).unwrap();
        assert_eq!(script.presses(1.0).len(), 2);
        assert!((script.presses(0.5)[0].position[0] - 0.0125).abs() < 1e-12);
        assert_eq!(script.presses(3.0).len(), 1);
        assert_eq!(script.presses(4.5), script.presses(0.5));
    }

    #[test]
    fn bad_scripts_name_file_field_and_what_is_allowed() {
        let header = "time_s,finger,x_m,y_m,radius_m,depth\n";
        for (rows, expected) in [
            ("0,1,0.2,0,0.01,1\n", "x,y"),
            ("0,1,0,0,-0.01,1\n", "radius"),
            ("0,1,0,0,0.01,-3\n", "depth"),
            ("0,1,NaN,0,0.01,1\n", "line 2, column `x_m`"),
            ("1,1,0,0,0.01,1\n1,1,0,0,0.01,1\n", "time 1 s"),
            ("NaN,1,0,0,0.01,1\n0,1,0,0,0.01,1\n", "line 2, column `time_s`"),
            ("0,1,0,0,0.01,1\ninf,1,0,0,0.01,1\n", "line 3, column `time_s` is \"inf\""),
            ("inf,1,0,0,0.01,1\n", "line 2, column `time_s` is \"inf\""),
            ("0,one,0,0,0.01,1\n", "finger"),
            ("", "no rows"),
        ] {
            let file = write(&format!("{header}{rows}"));
            let message = Script::load(file.path(), &disc()).unwrap_err().to_string();
            assert!(message.contains(expected), "{message}");
            assert!(message.contains(&*file.path().to_string_lossy()), "{message}");
        }
        assert!("1,2,3".parse::<Press>().unwrap_err().to_string().contains("x,y,radius,depth"));
    }

    #[test]
    fn shapes_and_loads_have_columns_of_their_own() {
        let file = write(
            "time_s,finger,shape,x_m,y_m,radius_m,inner_m,angle_deg,corners_m,depth,pressure_kpa,force_n\n\
             0,1,square,0,0,0.01,,90,,,35,\n0,2,ring,0,0,0.02,0.01,,,,,25\n0,3,,0.01,0,0.01,,,,1,,\n\
             0,4,polygon,0,0,,,,0:0 0.01:0 0:0.01,,,5\n0,5,corner,0,0,0.02,0.01,,,,,5\n",
        );
        let script = Script::load(file.path(), &disc()).unwrap();
        let presses = script.presses(0.0);
        let triangle = Footprint::Polygon(vec![[0.0, 0.0], [0.01, 0.0], [0.0, 0.01]]);
        let expected = [
            (Footprint::Square { side: 0.02 }, Load::Pressure(35e3)),
            (Footprint::Ring { outer: 0.02, inner: 0.01 }, Load::Force(25.0)),
            (Footprint::Finger { radius: 0.01 }, Load::Change(1.0)),
            (triangle, Load::Force(5.0)),
            (Footprint::Corner { length: 0.04, width: 0.01 }, Load::Force(5.0)),
        ];
        let read: Vec<_> = presses.iter().map(|press| (press.footprint.clone(), press.load)).collect();
        assert_eq!(read, expected);
        assert_eq!(presses[0].angle, std::f64::consts::FRAC_PI_2);
    }

    #[test]
    fn shapes_and_loads_that_make_no_sense_name_line_and_column() {
        let header = "time_s,finger,x_m,y_m,shape,radius_m,inner_m,corners_m,depth,force_n\n";
        for (row, expected) in [
            ("0,1,0,0,star,0.01,,,1,", "line 2, column `shape`: \"star\""),
            ("0,1,0,0,ring,0.01,,,1,", "line 2, column `inner_m`: empty"),
            ("0,1,0,0,disc,0.01,0.005,,1,", "column `inner_m`: given"),
            ("0,1,0,0,polygon,,,0:0 1,1,", "column `corners_m`: \"0:0 1\""),
            ("0,1,0,0,disc,0.01,,,1,2", "exactly one"),
            ("0,1,0,0,disc,0.01,,,,", "exactly one"),
            ("0,1,0,0,disc,0.01,,,,-2", "`force` is -2"),
        ] {
            let file = write(&format!("{header}{row}\n"));
            let message = Script::load(file.path(), &disc()).unwrap_err().to_string();
            assert!(message.contains(expected), "{message}");
        }
    }
}
