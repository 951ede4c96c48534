//! `[[reflexes]]`.

use super::Checker;
use crate::skin::{
    SkinError,
    file::ReflexTable,
    quantity::{AREA, FORCE, LENGTH, Quantity, TIME},
    reflex::{Reflex, Region},
};
use dermatome_shared::{
    REFLEX_PINS,
    patch::reflexes::{Limit, MAX_REFLEXES, REFLEX_NAME_BYTES},
};
use nalgebra::Point3;

/// Share of the limit below which a rule is released unless the file says another.
const RELEASE: f64 = 0.8;
/// Frames above the limit that trip it unless the file says: one alone may be of a press that came within the scan.
const FRAMES: i64 = 2;
/// How long one stays tripped at least, s, unless the file says.
const HOLD: f64 = 0.1;
/// Longest time that it may say, s.
const LONGEST_HOLD: f64 = 3600.0;

impl Checker<'_> {
    pub(super) fn reflexes(&self, tables: &[ReflexTable]) -> Result<Vec<Reflex>, SkinError> {
        if tables.len() > MAX_REFLEXES {
            let given = format!("{} rules", tables.len());
            return self.refuse("reflexes", given, &format!("at most {MAX_REFLEXES}"));
        }
        let reflexes: Vec<Reflex> =
            tables.iter().map(|table| self.reflex(table)).collect::<Result<_, _>>()?;
        let names = || reflexes.iter().map(|reflex| &reflex.name);
        match names().enumerate().find(|(number, name)| names().take(*number).any(|other| other == *name)) {
            Some((_, name)) => {
                self.refuse("reflexes.name", format!("{name:?} twice"), "another name for each rule")
            }
            None => Ok(reflexes),
        }
    }

    fn reflex(&self, table: &ReflexTable) -> Result<Reflex, SkinError> {
        Ok(Reflex {
            name: self.reflex_name(&table.name)?,
            pin: self.count("reflexes.pin", table.pin, 1, REFLEX_PINS.into())?,
            limit: self.limit(table)?,
            region: self.region(table)?,
            release: self.release(table.release.unwrap_or(RELEASE))?,
            frames: self.count("reflexes.frames", table.frames.unwrap_or(FRAMES), 1, u8::MAX.into())?,
            hold: self.hold(table.hold.as_ref())?,
            trips_blind: self.trips_blind(table.when_blind.as_deref())?,
        })
    }

    fn reflex_name(&self, name: &str) -> Result<String, SkinError> {
        if super::is_name(name) && name.len() <= REFLEX_NAME_BYTES {
            return Ok(name.to_owned());
        }
        let allowed = format!("1 to {REFLEX_NAME_BYTES} letters, digits, \"-\" or \"_\"");
        self.refuse("reflexes.name", format!("{name:?}"), &allowed)
    }

    fn limit(&self, table: &ReflexTable) -> Result<Limit, SkinError> {
        let pressed = |strength: Option<f64>| match strength {
            Some(strength) => self.positive_number("reflexes.pressed_above", strength),
            None => {
                let allowed = "the strength from which a part of the area counts";
                self.refuse("reflexes.pressed_above", "missing".into(), allowed)
            }
        };
        match (&table.force, table.strength, &table.area) {
            (Some(force), None, None) => {
                Ok(Limit::Force(self.positive("reflexes.force", force, FORCE)? as f32))
            }
            (None, Some(strength), None) => {
                Ok(Limit::Strength(self.positive_number("reflexes.strength", strength)? as f32))
            }
            (None, None, Some(area)) => Ok(Limit::Area {
                area: self.positive("reflexes.area", area, AREA)? as f32,
                strength: pressed(table.pressed_above)? as f32,
            }),
            _ => {
                let limits = [table.force.is_some(), table.strength.is_some(), table.area.is_some()];
                let given = limits.into_iter().filter(|given| *given).count();
                let allowed = "one of `force`, `strength` and `area` for each rule";
                self.refuse("reflexes", format!("{given} limits of {:?}", table.name), allowed)
            }
        }
    }

    fn region(&self, table: &ReflexTable) -> Result<Region, SkinError> {
        let (centre, radius) = match (&table.centre, &table.radius) {
            (None, None) => return Ok(Region::Whole),
            (Some(centre), Some(radius)) => (centre, radius),
            (centre, _) => {
                let missing = if centre.is_some() { "reflexes.radius" } else { "reflexes.centre" };
                return self.refuse(missing, "missing".into(), "`centre` with `radius`, or neither");
            }
        };
        let coordinate = |written: &Quantity| self.finite("reflexes.centre", written, LENGTH);
        let at: Vec<f64> = centre.iter().map(coordinate).collect::<Result<_, _>>()?;
        let centre = match at[..] {
            [x, y] => Point3::new(x, y, 0.0),
            [x, y, z] => Point3::new(x, y, z),
            _ => {
                let given = format!("{} coordinates", at.len());
                return self.refuse("reflexes.centre", given, "2 of a flat skin, or 3");
            }
        };
        Ok(Region::Around { centre, radius: self.positive("reflexes.radius", radius, LENGTH)? })
    }

    fn release(&self, share: f64) -> Result<f64, SkinError> {
        let fits = (0.0..=1.0).contains(&share);
        if fits {
            Ok(share)
        } else {
            self.refuse("reflexes.release", share.to_string(), "0 to 1, of the limit")
        }
    }

    fn hold(&self, written: Option<&Quantity>) -> Result<f64, SkinError> {
        let Some(written) = written else { return Ok(HOLD) };
        match TIME.read(written) {
            Some(seconds) if (0.0..=LONGEST_HOLD).contains(&seconds) => Ok(seconds),
            _ => self.refuse("reflexes.hold", written.to_string(), "0 s to 3600 s"),
        }
    }

    fn trips_blind(&self, word: Option<&str>) -> Result<bool, SkinError> {
        match word {
            None | Some("trip") => Ok(true),
            Some("stay") => Ok(false),
            Some(other) => self.refuse("reflexes.when_blind", format!("{other:?}"), "\"trip\" or \"stay\""),
        }
    }
}
