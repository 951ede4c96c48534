//! Sheet: a pressed skin's material, each place of it with its own history.

use crate::{
    material::{Material, Transducer},
    truth::{LEAST, TrueSkin},
};
use dermatome_model::indenter::Press;
use std::collections::BTreeMap;

/// The material of a whole skin.
///
/// Each element that was ever pressed has a [`Transducer`] of its own; all others are alike.
#[derive(Clone, Debug)]
pub struct Sheet {
    untouched: Transducer,
    /// By element.
    pressed: BTreeMap<usize, Transducer>,
}

impl Sheet {
    /// A sheet that was never pressed.
    #[must_use]
    pub fn new(material: &Material, seed: u64) -> Self {
        Self { untouched: Transducer::new(material, seed), pressed: BTreeMap::new() }
    }

    /// Relative conductivity after these pressures, Pa, were held for some seconds; both `[element]`.
    pub fn respond(&mut self, pressure: &[f64], seconds: f64) -> Vec<f64> {
        let new = pressure.iter().enumerate().filter(|(_, pressure)| **pressure > 0.0);
        for (element, _) in new {
            self.pressed.entry(element).or_insert_with(|| self.untouched.clone());
        }
        let untouched = self.untouched.respond(0.0, seconds);
        let mut conductivity = vec![(1.0 + untouched).max(LEAST); pressure.len()];
        for (&element, transducer) in &mut self.pressed {
            let change = transducer.respond(pressure[element] / 1e3, seconds);
            conductivity[element] = (1.0 + change).max(LEAST);
        }
        conductivity
    }
}

/// A sheet that a script presses; a script that begins anew finds one that was never pressed.
#[derive(Clone, Debug)]
pub struct ScriptedSheet {
    material: Material,
    seed: u64,
    sheet: Sheet,
    /// How far the script has come, s.
    time: f64,
}

impl ScriptedSheet {
    /// A sheet of a material, whose noise follows from `seed`.
    #[must_use]
    pub fn new(material: Material, seed: u64) -> Self {
        let sheet = Sheet::new(&material, seed);
        Self { material, seed, sheet, time: 0.0 }
    }

    /// Relative conductivity of each element of `truth` under presses held until a time of the script, s: `[element]`.
    pub fn conductivity(&mut self, truth: &TrueSkin, presses: &[Press], time: f64) -> Vec<f64> {
        let pressed = self.respond(&truth.pressure(presses), time);
        let changed = truth.conductivity(presses);
        pressed.iter().zip(changed).map(|(a, b)| (a + b - 1.0).max(LEAST)).collect()
    }

    fn respond(&mut self, pressure: &[f64], time: f64) -> Vec<f64> {
        if time < self.time {
            (self.sheet, self.time) = (Sheet::new(&self.material, self.seed), 0.0);
        }
        let seconds = time - self.time;
        self.time = time;
        self.sheet.respond(pressure, seconds)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_place_remembers_its_own_presses() {
        let material = Material::named("sample-1").unwrap();
        let mut sheet = Sheet::new(&material, 1);
        let rest = sheet.respond(&[0.0; 3], 10.0);
        let pressed = sheet.respond(&[20e3, 0.0, 5e3], 10.0);
        let released = sheet.respond(&[0.0; 3], 10.0);
        assert!(rest.iter().all(|value| (value - 1.0).abs() < 0.01), "{rest:?}");
        assert!(pressed[0] > pressed[2] && pressed[2] > 1.05 && (pressed[1] - 1.0).abs() < 0.01);
        // Sample 1 keeps a part of what was pressed into it (thesis figure 4.11).
        assert!(released[0] > 1.02 && (released[1] - 1.0).abs() < 0.01, "{released:?}");
    }
}
