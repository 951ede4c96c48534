//! Tables `[contact]` and `[calibration]`.

use super::Checker;
use crate::skin::{
    SkinError,
    file::CalibrationTable,
    quantity::{self, Quantity},
};
use dermatome_shared::calibration::{Calibration, CalibrationPoint, MAX_POINTS};

/// False contacts an hour on an untouched skin unless the file says others.
const FALSE_ALARMS: f64 = 1.0;
/// Longest time over which still frames are averaged, s.
const LONGEST_AVERAGING: f64 = 10.0;
/// Longest time in which the reference may follow the untouched skin, s: a day.
const LONGEST_DRIFT_TIME: f64 = 86_400.0;

impl Checker<'_> {
    /// At least one step of the board's image.
    pub(super) fn threshold(&self, value: f64) -> Result<f64, SkinError> {
        let fits = (1e-6..=1000.0).contains(&value);
        if fits { Ok(value) } else { self.refuse("contact.threshold", value.to_string(), "0.000001 to 1000") }
    }

    pub(super) fn false_alarms(&self, written: Option<f64>) -> Result<f64, SkinError> {
        match written.unwrap_or(FALSE_ALARMS) {
            rate if (1e-6..=3600.0).contains(&rate) => Ok(rate),
            rate => self.refuse("contact.false_alarms", rate.to_string(), "0.000001 to 3600 an hour"),
        }
    }

    pub(super) fn averaging(&self, written: Option<&Quantity>) -> Result<Option<f64>, SkinError> {
        let Some(written) = written else { return Ok(None) };
        match quantity::TIME.read(written) {
            Some(seconds) if (0.0..=LONGEST_AVERAGING).contains(&seconds) => Ok(Some(seconds)),
            _ => self.refuse("contact.averaging", written.to_string(), "0 s to 10 s"),
        }
    }

    pub(super) fn drift_time(&self, written: Option<&Quantity>) -> Result<Option<f64>, SkinError> {
        let Some(written) = written else { return Ok(None) };
        match quantity::TIME.read(written) {
            Some(seconds) if seconds == 0.0 || (1.0..=LONGEST_DRIFT_TIME).contains(&seconds) => {
                Ok(Some(seconds))
            }
            _ => self.refuse("contact.drift_time", written.to_string(), "1 s to 86400 s, or 0 for never"),
        }
    }

    pub(super) fn calibration(&self, table: &CalibrationTable) -> Result<Calibration, SkinError> {
        let (strengths, pressures) = (&table.strength, &table.pressure);
        if strengths.len() > MAX_POINTS {
            let given = format!("{} points", strengths.len());
            return self.refuse("calibration.strength", given, &format!("at most {MAX_POINTS}"));
        }
        if pressures.len() != strengths.len() {
            let given = format!("{} points", pressures.len());
            let allowed = format!("as many as `calibration.strength` has, {}", strengths.len());
            return self.refuse("calibration.pressure", given, &allowed);
        }
        let mut last = [0.0; 2];
        let mut point = |(&strength, written): (&f64, &Quantity)| {
            let pressure = self.positive("calibration.pressure", written, quantity::PRESSURE)?;
            self.rises("calibration.strength", strength, last[0])?;
            self.rises("calibration.pressure", pressure, last[1])?;
            last = [strength, pressure];
            Ok(CalibrationPoint { strength: strength as f32, pressure: pressure as f32 })
        };
        let points = strengths.iter().zip(pressures).map(&mut point).collect::<Result<_, _>>()?;
        Ok(Calibration { points, load_share: self.load_share(table.load_share)? })
    }

    /// Also in the single precision of the board.
    fn load_share(&self, written: Option<f64>) -> Result<Option<f32>, SkinError> {
        match written {
            Some(share) if !(1e-6..=1e6).contains(&share) => {
                self.refuse("calibration.load_share", share.to_string(), "0.000001 to 1000000")
            }
            share => Ok(share.map(|share| share as f32)),
        }
    }

    /// Also in the single precision of the board.
    fn rises(&self, field: &'static str, value: f64, before: f64) -> Result<(), SkinError> {
        let rises = value as f32 > before as f32 && (value as f32).is_finite();
        let allowed = || format!("numbers that rise from point to point: here more than {before}");
        if rises { Ok(()) } else { self.refuse(field, value.to_string(), &allowed()) }
    }
}
