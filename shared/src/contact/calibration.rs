//! Calibration: strength of a contact -> pressure, and area of its region -> area that the pressure acts on.

use super::Contact;
use heapless::Vec;
use postcard_schema::Schema;
use serde::{Deserialize, Serialize};

/// Most points of a curve.
pub const MAX_POINTS: usize = 16;

/// One point of a calibration curve.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, Schema)]
pub struct CalibrationPoint {
    /// Strength of a contact: mean relative conductivity change over its region of interest.
    pub strength: f32,
    /// Pressure on it, Pa.
    pub pressure: f32,
}

/// Pressure by strength: straight lines between points that rise in both, the last two of them
/// carried on beyond the end. Before the first point the line starts at no pressure.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, Schema)]
pub struct Calibration {
    /// Points of the curve; empty if the skin is not calibrated.
    pub points: Vec<CalibrationPoint, MAX_POINTS>,
    /// Area of the indenter that the curve was measured with, over that of its region of interest, which
    /// the image's blur makes larger; none if nobody knows it.
    pub load_share: Option<f32>,
}

impl Calibration {
    /// Whether the curve rises from nothing, point by point, to finite values, and the share is one.
    #[must_use]
    pub fn is_valid(&self) -> bool {
        let mut last = ORIGIN;
        let is_share = self.load_share.is_none_or(|share| share > 0.0 && share.is_finite());
        is_share
            && self.points.iter().all(|point| {
                let before = core::mem::replace(&mut last, *point);
                let rises = point.strength > before.strength && point.pressure > before.pressure;
                rises && point.strength.is_finite() && point.pressure.is_finite()
            })
    }

    /// Gives contacts their pressures, by their strengths without hysteresis, `[contact]`, and the areas that
    /// those act on.
    pub fn apply(&self, contacts: &mut [Contact], strengths: &[f32]) {
        for (contact, &strength) in contacts.iter_mut().zip(strengths) {
            contact.pressure = self.pressure(strength);
            contact.load_area = self.load_share.map(|share| share * contact.area);
        }
    }

    /// Pressure at a strength, Pa; none without a curve.
    #[must_use]
    pub fn pressure(&self, strength: f32) -> Option<f32> {
        let end = self.points.iter().position(|point| point.strength >= strength);
        let end = end.unwrap_or(self.points.len().checked_sub(1)?);
        let to = self.points.get(end)?;
        let from = end.checked_sub(1).and_then(|start| self.points.get(start)).unwrap_or(&ORIGIN);
        let slope = (to.pressure - from.pressure) / (to.strength - from.strength);
        Some((from.pressure + (strength - from.strength) * slope).max(0.0))
    }
}

/// Where every curve starts.
const ORIGIN: CalibrationPoint = CalibrationPoint { strength: 0.0, pressure: 0.0 };

#[cfg(test)]
mod tests {
    use super::*;

    fn curve(points: &[(f32, f32)]) -> Calibration {
        let point = |&(strength, pressure): &(f32, f32)| CalibrationPoint { strength, pressure };
        Calibration { points: points.iter().map(point).collect(), load_share: None }
    }

    #[test]
    fn pressure_follows_the_lines_between_points_and_beyond() {
        let curve = curve(&[(0.1, 5e3), (0.2, 20e3)]);
        assert!(curve.is_valid());
        for (strength, expected) in [(0.0, 0.0), (0.05, 2.5e3), (0.1, 5e3), (0.15, 12.5e3), (0.3, 35e3)] {
            let pressure = curve.pressure(strength).unwrap();
            assert!((pressure - expected).abs() < 0.1, "{strength}: {pressure}");
        }
        assert_eq!(curve.pressure(-1.0), Some(0.0));
        assert_eq!(Calibration::default().pressure(0.1), None);
    }

    #[test]
    fn a_curve_that_does_not_rise_is_not_valid() {
        assert!(Calibration::default().is_valid());
        for points in
            [&[(0.0, 1.0)][..], &[(0.2, 1.0), (0.1, 2.0)], &[(0.1, 2.0), (0.2, 2.0)], &[(f32::NAN, 1.0)]]
        {
            assert!(!curve(points).is_valid(), "{points:?}");
        }
        for share in [0.0, -0.1, f32::NAN, f32::INFINITY] {
            assert!(!Calibration { load_share: Some(share), ..curve(&[]) }.is_valid(), "{share}");
        }
    }
}
