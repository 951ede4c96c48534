//! Script: where fingers press a simulated skin, and when.

use crate::skin::outline::Outline;
use nalgebra::{Point2, Vector2};
use serde::Deserialize;
use std::{
    collections::BTreeMap,
    f64::consts::TAU,
    path::{Path, PathBuf},
    str::FromStr,
};

/// One finger on the skin.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Press {
    /// Centre, m, in the skin's frame, as seen from above: the finger comes down along z.
    pub position: [f64; 2],
    /// Radius of the touched disc, m.
    pub radius: f64,
    /// Relative conductivity change at the centre; it falls to zero at the radius like the
    /// pressure of a ball on a plane (Hertz).
    pub depth: f64,
}

impl Press {
    /// Relative conductivity change at a point of a flat skin.
    #[must_use]
    pub fn change_at(&self, point: [f64; 2]) -> f64 {
        self.change_over((point[0] - self.position[0]).hypot(point[1] - self.position[1]))
    }

    /// Relative conductivity change so far from the centre, m.
    #[must_use]
    pub fn change_over(&self, distance: f64) -> f64 {
        self.depth * (1.0 - (distance / self.radius).powi(2)).max(0.0).sqrt()
    }

    /// Whether the numbers make sense on a skin.
    pub fn check(&self, outline: &Outline) -> Result<(), ScriptError> {
        let refuse =
            |field, value, allowed: &str| Err(ScriptError::Press { field, value, allowed: allowed.into() });
        let [x, y] = self.position;
        let on_skin = outline.depth(Point2::new(x, y)) >= 0.0;
        if !on_skin {
            let [low, high] = outline.bounds();
            let allowed = format!(
                "a point on the skin, which lies between {} and {} m in x, {} and {} m in y",
                low.x, high.x, low.y, high.y
            );
            return refuse("x,y", format!("{x},{y} m"), &allowed);
        }
        if !(self.radius > 0.0 && self.radius.is_finite()) {
            return refuse("radius", format!("{} m", self.radius), "a length above zero, in m");
        }
        if !(-0.99..=1000.0).contains(&self.depth) {
            return refuse("depth", self.depth.to_string(), "-0.99 to 1000 (1 doubles the conductivity)");
        }
        Ok(())
    }
}

impl FromStr for Press {
    type Err = ScriptError;

    /// `x,y,radius,depth`, lengths in m.
    fn from_str(text: &str) -> Result<Self, ScriptError> {
        let parse = |part: &str| part.trim().parse::<f64>().ok();
        let numbers: Option<Vec<f64>> = text.split(',').map(parse).collect();
        match numbers.as_deref() {
            Some(&[x, y, radius, depth]) => Ok(Self { position: [x, y], radius, depth }),
            _ => Err(ScriptError::Press {
                field: "press",
                value: format!("{text:?}"),
                allowed: "four numbers x,y,radius,depth (m, m, m, relative), as in 0.03,-0.02,0.01,1".into(),
            }),
        }
    }
}

/// Fingers moving over time; the script starts again when its last moment has passed.
#[derive(Clone, Debug, PartialEq)]
pub struct Script {
    /// Moments of each finger, by time.
    fingers: Vec<Vec<Moment>>,
    duration: f64,
}

/// Where one finger is at one time; between moments it moves steadily.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Moment {
    /// Time, s.
    pub time: f64,
    /// The finger.
    pub press: Press,
}

impl Script {
    /// A script of these fingers' moments.
    pub fn new(fingers: Vec<Vec<Moment>>, outline: &Outline) -> Result<Self, ScriptError> {
        for moment in fingers.iter().flatten() {
            moment.press.check(outline)?;
        }
        let infinite = |moments: &Vec<Moment>| moments.iter().map(|m| m.time).find(|time| !time.is_finite());
        if let Some(time) = fingers.iter().find_map(infinite) {
            return Err(ScriptError::NotFinite { time });
        }
        let disorder = |moments: &Vec<Moment>| {
            moments.windows(2).find(|pair| pair[0].time >= pair[1].time).map(|pair| pair[1].time)
        };
        if let Some(time) = fingers.iter().find_map(disorder) {
            return Err(ScriptError::Time { time });
        }
        let duration = fingers.iter().flatten().map(|moment| moment.time).fold(0.0, f64::max);
        Ok(Self { fingers, duration })
    }

    /// One finger that stays.
    pub fn still(presses: &[Press], outline: &Outline) -> Result<Self, ScriptError> {
        Self::new(presses.iter().map(|&press| vec![Moment { time: 0.0, press }]).collect(), outline)
    }

    /// A finger that goes round at half way to the rim, once in eight seconds; it lifts where there
    /// is no skin.
    #[must_use]
    pub fn round(outline: &Outline) -> Self {
        let ([x, y], middle) = (outline.half_size(), outline.middle());
        let at = |i: i32| {
            let angle = f64::from(i) / 64.0 * TAU;
            let position = middle + Vector2::new(0.5 * x * angle.cos(), 0.5 * y * angle.sin());
            let depth = if outline.depth(position) > 0.0 { 1.0 } else { 0.0 };
            Moment {
                time: f64::from(i) / 8.0,
                press: Press { position: position.into(), radius: 0.12 * x.min(y), depth },
            }
        };
        Self { fingers: vec![(0..=64).map(at).collect()], duration: 8.0 }
    }

    /// Reads a script from CSV with the columns time_s, finger, x_m, y_m, radius_m, depth.
    pub fn load(path: &Path, outline: &Outline) -> Result<Self, ScriptError> {
        let in_file = |message: String| ScriptError::File { path: path.to_owned(), message };
        let open = csv::ReaderBuilder::new().comment(Some(b'#')).trim(csv::Trim::All).from_path(path);
        let mut reader = open.map_err(|error| in_file(error.to_string()))?;
        let headers = reader.headers().map_err(|error| in_file(error.to_string()))?.clone();
        let mut fingers = BTreeMap::<u32, Vec<Moment>>::new();
        for row in reader.deserialize::<Row>() {
            let row = row.map_err(|error| in_file(explain(&error, &headers)))?;
            fingers.entry(row.finger).or_default().push(row.moment());
        }
        if fingers.is_empty() {
            return Err(in_file("no rows".into()));
        }
        Self::new(fingers.into_values().collect(), outline).map_err(|error| in_file(error.to_string()))
    }

    /// The fingers that touch the skin `time` seconds into the script.
    #[must_use]
    pub fn presses(&self, time: f64) -> Vec<Press> {
        let time = if self.duration > 0.0 { time % self.duration } else { 0.0 };
        self.fingers
            .iter()
            .filter_map(|moments| finger_at(moments, time))
            .filter(|press| press.depth != 0.0)
            .collect()
    }
}

/// Line, column and what is allowed, where the CSV reader knows them.
fn explain(error: &csv::Error, headers: &csv::StringRecord) -> String {
    let csv::ErrorKind::Deserialize { pos: Some(place), err } = error.kind() else {
        return error.to_string();
    };
    let column = err.field().and_then(|index| headers.get(index as usize));
    let column = column.map_or(String::new(), |column| format!(", column `{column}`"));
    let allowed = "numbers in the columns time_s, finger (a whole number), x_m, y_m, radius_m and depth";
    format!("line {}{column}: {}; allowed: {allowed}", place.line(), err.kind())
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Row {
    time_s: f64,
    finger: u32,
    x_m: f64,
    y_m: f64,
    radius_m: f64,
    depth: f64,
}

impl Row {
    fn moment(&self) -> Moment {
        let press = Press { position: [self.x_m, self.y_m], radius: self.radius_m, depth: self.depth };
        Moment { time: self.time_s, press }
    }
}

/// Before its first and after its last moment a finger is lifted, unless that is its only one.
fn finger_at(moments: &[Moment], time: f64) -> Option<Press> {
    if let [only] = moments {
        return Some(only.press);
    }
    let pair = moments.windows(2).find(|pair| pair[0].time <= time && time <= pair[1].time)?;
    let share = (time - pair[0].time) / (pair[1].time - pair[0].time);
    let (from, to) = (pair[0].press, pair[1].press);
    let mix = |a: f64, b: f64| a + (b - a) * share;
    Some(Press {
        position: [mix(from.position[0], to.position[0]), mix(from.position[1], to.position[1])],
        radius: mix(from.radius, to.radius),
        depth: mix(from.depth, to.depth),
    })
}

/// Why a script cannot be played.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ScriptError {
    /// A press makes no sense.
    #[error("press field `{field}` is {value}; allowed: {allowed}")]
    Press {
        /// Which number.
        field: &'static str,
        /// Its value.
        value: String,
        /// What it may be.
        allowed: String,
    },
    /// A moment that never comes.
    #[error("time {time} s is not a finite number; allowed: ascending times for each finger")]
    NotFinite {
        /// The time.
        time: f64,
    },
    /// Moments of a finger are not in order.
    #[error("time {time} s is not later than the moment before it; allowed: ascending times for each finger")]
    Time {
        /// The time.
        time: f64,
    },
    /// The file cannot be used.
    #[error("path script `{}`: {message}", path.display())]
    File {
        /// The file.
        path: PathBuf,
        /// Why.
        message: String,
    },
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
            ("0,1,NaN,0,0.01,1\n", "x,y"),
            ("1,1,0,0,0.01,1\n1,1,0,0,0.01,1\n", "time 1 s"),
            ("NaN,1,0,0,0.01,1\n0,1,0,0,0.01,1\n", "time NaN s"),
            ("0,1,0,0,0.01,1\ninf,1,0,0,0.01,1\n", "time inf s"),
            ("inf,1,0,0,0.01,1\n", "time inf s"),
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
}
