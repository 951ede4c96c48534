//! Recorded presses: where, how hard, and what was measured before and during each.
//!
//! An archive (`.npz`) holds `v_pressed`, `positions_m`, usually `v_unpressed`, and `force_n` if forces are known; a
//! table (`.csv`, `.txt`) one press a row: x and y in metres, on a skin that is not flat z as well, the force in newtons if
//! known, then the frame.

mod error;
pub mod place;
mod read;

use crate::recorded::{
    diagnose::dead_below,
    difference::{difference, signed_reference},
    order::{Arrangement, FileIndex},
    read::Frames,
};
use dermatome_model::{
    jacobian::combine_voltages,
    model::{Model, divisors},
};
pub use error::PressError;
use nalgebra::Point3;
use num_complex::Complex64;
use place::{Off, lay};
pub use read::Layout;

/// Array of an archive: frames of the pressed skin, one for each press.
pub const PRESSED: &str = "v_pressed";
/// Array of an archive: frames of the untouched skin, one for all or one for each press.
pub const UNPRESSED: &str = "v_unpressed";
/// Array of an archive: where each press was, m; x, y, and z, which a flat skin in the plane z = 0 does not use.
pub const POSITIONS: &str = "positions_m";
/// Array of an archive: force of each press, N.
pub const FORCES: &str = "force_n";

/// Presses as recorded.
#[derive(Clone, Debug, PartialEq)]
pub struct Recording {
    /// Frames during the presses.
    pub pressed: Frames,
    /// Frames of the untouched skin: one, or one for each press.
    pub unpressed: Frames,
    /// Where.
    pub positions: Positions,
    /// How hard, N: `[press]`.
    pub forces: Option<Vec<f64>>,
}

/// Where presses were, as recorded, m, in the skin's frame: `[press]`.
#[derive(Clone, Debug, PartialEq)]
pub enum Positions {
    /// x and y.
    FromAbove(Vec<[f64; 2]>),
    /// x, y and z.
    InSpace(Vec<[f64; 3]>),
}

impl Positions {
    /// x and y: `[press]`.
    #[must_use]
    pub fn from_above(&self) -> Vec<[f64; 2]> {
        match self {
            Self::FromAbove(places) => places.clone(),
            Self::InSpace(places) => places.iter().map(|&[x, y, _]| [x, y]).collect(),
        }
    }
}

/// Presses as a skin's model sees them.
#[derive(Clone, Debug, PartialEq)]
pub struct Presses {
    /// Difference data of the skin's kind: `[press][measurement]`.
    pub data: Vec<Vec<f64>>,
    /// Where on the skin, m: `[press]`.
    pub places: Vec<Point3<f64>>,
    /// How far off it they were recorded; none on a flat skin in the plane z = 0.
    pub off: Option<Off>,
    /// How hard, N, above zero: `[press]`.
    pub forces: Option<Vec<f64>>,
    /// What the difference data of the mean reference divide by, in the file's unit:
    /// `[measurement]`.
    pub mean_divisors: Vec<f64>,
    /// Mean frame of the untouched skin, in the file's order.
    pub mean_reference: Vec<Complex64>,
}

impl Recording {
    /// The presses as `model` sees them, once all of them are checked.
    pub fn on(&self, model: &Model, arrangement: &Arrangement) -> Result<Presses, PressError> {
        self.check()?;
        let laid = lay(model, &self.positions)?;
        let electrodes = model.mesh.electrodes.len() as u8;
        let map = arrangement.index_map(&model.steps, electrodes, self.pressed.measurements)?;
        let data = |(press, frame): (usize, &[Complex64])| {
            let reference = self.reference_of(press, &map);
            let signed = signed_reference(&reference, &map, &model.voltages);
            model.difference_data(&difference(&reference, frame, &map, &model.voltages), &signed)
        };
        let mean_reference = self.unpressed.mean();
        let signed = signed_reference(&mean_reference, &map, &model.voltages);
        Ok(Presses {
            data: self.pressed.iter().enumerate().map(data).collect(),
            places: laid.places,
            off: laid.off,
            forces: self.forces.clone(),
            mean_divisors: divisors(model.difference, &combine_voltages(&signed, &model.combination)),
            mean_reference,
        })
    }

    /// The frame that a press is compared with.
    fn reference_of(&self, press: usize, map: &[FileIndex]) -> Vec<Complex64> {
        let row = if self.unpressed.frames == 1 { 0 } else { press };
        let length = self.unpressed.measurements;
        let mut reference = self.unpressed.values[row * length..][..length].to_vec();
        // A dead measurement is exactly zero, and so counts as unchanged.
        let floor = dead_below(&reference, map);
        reference.iter_mut().filter(|v| v.norm() <= floor).for_each(|v| *v = Complex64::ZERO);
        reference
    }

    fn check(&self) -> Result<(), PressError> {
        let lengths = (self.pressed.measurements, self.unpressed.measurements);
        if lengths.0 != lengths.1 {
            return Err(PressError::Lengths { pressed: lengths.0, unpressed: lengths.1 });
        }
        if self.unpressed.frames != 1 && self.unpressed.frames != self.pressed.frames {
            return Err(PressError::Rows {
                what: "`v_unpressed`",
                found: self.unpressed.frames,
                presses: self.pressed.frames,
                allowed: "1, or one for each press",
            });
        }
        let mut forces = self.forces.iter().flatten().enumerate();
        match forces.find(|&(_, &force)| force <= 0.0) {
            Some((press, &force)) => Err(PressError::Force { press, force }),
            None => Ok(()),
        }
    }
}

impl Presses {
    /// Number of each press's place, from 0 in the order of their first presses: presses closer than `same`, m, to the
    /// first press of a place are at it.
    #[must_use]
    pub fn place_numbers(&self, same: f64) -> Vec<usize> {
        let mut firsts: Vec<Point3<f64>> = Vec::new();
        let number = |place: &Point3<f64>| {
            let near = firsts.iter().position(|first| (first - place).norm() < same);
            near.unwrap_or_else(|| {
                firsts.push(*place);
                firsts.len() - 1
            })
        };
        self.places.iter().map(number).collect()
    }

    /// How many there are.
    #[must_use]
    pub fn count(&self) -> usize {
        self.places.len()
    }

    /// Measurements of the skin.
    #[must_use]
    pub fn measurements(&self) -> usize {
        self.mean_divisors.len()
    }
}

#[cfg(test)]
mod tests;
