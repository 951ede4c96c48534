//! The material file, as a person writes it, and its checks.

use super::{
    Creep, Material, MaterialError, Scatter,
    curve::{Loading, Release},
    preisach::Everett,
};
use dermatome_model::skin::{
    quantity::{self, Kind, Quantity},
    syntax::in_words,
};
use serde::Deserialize;
use std::{path::Path, sync::Arc};

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct File {
    name: String,
    #[serde(default)]
    description: String,
    loading: LoadingTable,
    release: ReleaseTable,
    creep: CreepTable,
    scatter: ScatterTable,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct LoadingTable {
    range: Quantity,
    change: f64,
    #[serde(default)]
    touch: f64,
    touch_pressure: Option<Quantity>,
    bend: f64,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct ReleaseTable {
    reversible: f64,
    shape: [f64; 2],
    residual: f64,
    recovery: Quantity,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct CreepTable {
    share: f64,
    times: [Quantity; 2],
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct ScatterTable {
    place: f64,
    press: f64,
    drift: f64,
}

pub(super) fn parse(path: &Path, text: &str) -> Result<Material, MaterialError> {
    let syntax =
        |error: toml::de::Error| MaterialError::Syntax { path: path.to_owned(), message: in_words(&error) };
    let file: File = toml::from_str(text).map_err(syntax)?;
    Checker { path }.material(file)
}

struct Checker<'a> {
    path: &'a Path,
}

impl Checker<'_> {
    fn material(&self, file: File) -> Result<Material, MaterialError> {
        let range = self.positive("loading.range", &file.loading.range, quantity::PRESSURE)?;
        let loading = self.loading(&file.loading, range)?;
        let release = self.release(&file.release)?;
        Ok(Material {
            name: file.name,
            description: file.description,
            range_kpa: range / 1e3,
            full_change: self.change(file.loading.change)?,
            residual: self.within("release.residual", file.release.residual, 0.0, 0.9)?,
            recovery_s: self.positive("release.recovery", &file.release.recovery, quantity::TIME)?,
            creep: self.creep(&file.creep)?,
            scatter: self.scatter(&file.scatter)?,
            everett: Arc::new(Everett::new(loading, release)),
        })
    }

    fn loading(&self, table: &LoadingTable, range: f64) -> Result<Loading, MaterialError> {
        let touch = self.within("loading.touch", table.touch, 0.0, 0.95)?;
        let touch_pressure = match &table.touch_pressure {
            Some(written) => self.positive("loading.touch_pressure", written, quantity::PRESSURE)? / range,
            None if touch == 0.0 => 1.0,
            None => {
                let allowed = "a pressure above zero, because `loading.touch` is not 0";
                return self.refuse("loading.touch_pressure", "missing".into(), allowed);
            }
        };
        Ok(Loading { touch, touch_pressure, bend: self.within("loading.bend", table.bend, -10.0, 20.0)? })
    }

    fn change(&self, change: f64) -> Result<f64, MaterialError> {
        let change = self.within("loading.change", change, -0.99, 1000.0)?;
        let is_nothing = change == 0.0;
        if is_nothing {
            self.refuse("loading.change", "0".into(), "a change that is not 0")
        } else {
            Ok(change)
        }
    }

    fn release(&self, table: &ReleaseTable) -> Result<Release, MaterialError> {
        let reversible = self.within("release.reversible", table.reversible, 0.0, 1.0)?;
        for value in table.shape {
            self.within("release.shape", value, 0.05, 100.0)?;
        }
        Ok(Release { reversible, shape: table.shape })
    }

    fn creep(&self, table: &CreepTable) -> Result<Creep, MaterialError> {
        let time = |written| self.positive("creep.times", written, quantity::TIME);
        let times_s = [time(&table.times[0])?, time(&table.times[1])?];
        Ok(Creep { share: self.within("creep.share", table.share, 0.0, 0.9)?, times_s })
    }

    fn scatter(&self, table: &ScatterTable) -> Result<Scatter, MaterialError> {
        Ok(Scatter {
            place: self.within("scatter.place", table.place, 0.0, 0.5)?,
            press: self.within("scatter.press", table.press, 0.0, 0.5)?,
            drift: self.within("scatter.drift", table.drift, 0.0, 0.5)?,
        })
    }

    fn positive(&self, field: &'static str, written: &Quantity, kind: Kind) -> Result<f64, MaterialError> {
        match kind.read(written) {
            Some(value) if value > 0.0 && value.is_finite() => Ok(value),
            _ => {
                let allowed = format!("a number above zero ({}), or text in {}", kind.si(), kind.units());
                self.refuse(field, written.to_string(), &allowed)
            }
        }
    }

    fn within(&self, field: &'static str, value: f64, low: f64, high: f64) -> Result<f64, MaterialError> {
        let fits = (low..=high).contains(&value);
        if fits { Ok(value) } else { self.refuse(field, value.to_string(), &format!("{low} to {high}")) }
    }

    fn refuse<T>(&self, field: &'static str, value: String, allowed: &str) -> Result<T, MaterialError> {
        Err(MaterialError::Value { path: self.path.to_owned(), field, value, allowed: allowed.to_owned() })
    }
}
