//! One place of a sheet, with its history.

use super::{Material, Preisach, curve::felt};
use rand::SeedableRng;
use rand_distr::{Distribution, StandardNormal};
use rand_pcg::Pcg64Mcg;

/// Below this share of the range a place counts as not pressed.
const UNTOUCHED: f64 = 0.005;
/// Gains stay within this many standard deviations.
const MOST_DEVIATIONS: f64 = 3.0;

/// One place of a sheet: pressure over time -> change of sheet conductivity.
///
/// Places that lie under one indenter belong together: give them the same seed, because how a load sits
/// is common to all of them. Equal seeds, pressures and times give equal changes.
#[derive(Clone, Debug)]
pub struct Transducer {
    material: Material,
    random: Pcg64Mcg,
    contacts: Preisach,
    /// Share of the contacts that a press closed and that have not opened since.
    residual: f64,
    /// What the late parts have reached, share of all contacts.
    late: [f64; 2],
    is_pressed: bool,
    place_gain: f64,
    press_gain: f64,
    drift: f64,
}

impl Transducer {
    /// A place that was never pressed.
    #[must_use]
    pub fn new(material: &Material, seed: u64) -> Self {
        let mut random = Pcg64Mcg::seed_from_u64(seed);
        let place_gain = gain(&mut random, material.scatter.place);
        Self {
            material: material.clone(),
            random,
            contacts: Preisach::default(),
            residual: 0.0,
            late: [0.0; 2],
            is_pressed: false,
            place_gain,
            press_gain: 1.0,
            drift: 0.0,
        }
    }

    /// Relative change of sheet conductivity after this pressure was held for `seconds`.
    ///
    /// Pressure below zero, or not a number, counts as none.
    pub fn respond(&mut self, pressure_kpa: f64, seconds: f64) -> f64 {
        let seconds = seconds.max(0.0);
        let share = (pressure_kpa / self.material.range_kpa).max(0.0);
        self.notice_press(share > UNTOUCHED);
        let closed = self.closed(felt(share), seconds);
        self.wander(seconds);
        let change = self.creep(closed, seconds) * self.place_gain * self.press_gain + self.drift;
        (change * self.material.full_change).max(-0.99)
    }

    fn notice_press(&mut self, is_pressed: bool) {
        if is_pressed && !self.is_pressed {
            self.press_gain = gain(&mut self.random, self.material.scatter.press);
        }
        self.is_pressed = is_pressed;
    }

    /// Share of all contacts that are closed.
    fn closed(&mut self, felt: f64, seconds: f64) -> f64 {
        let material = &self.material;
        let held = material.everett.loading.closed(felt);
        let left = (self.residual - held).max(0.0) * (-seconds / material.recovery_s).exp();
        self.residual = held + left;
        let with_load = self.contacts.apply(&material.everett, felt);
        with_load * (1.0 - material.residual) + self.residual * material.residual
    }

    fn creep(&mut self, closed: f64, seconds: f64) -> f64 {
        let creep = self.material.creep;
        for (late, time) in self.late.iter_mut().zip(creep.times_s) {
            *late = closed + (*late - closed) * (-seconds / time).exp();
        }
        closed * (1.0 - creep.share) + creep.share * 0.5 * (self.late[0] + self.late[1])
    }

    fn wander(&mut self, seconds: f64) {
        let deviation = self.material.scatter.drift * (seconds / 60.0).sqrt();
        if deviation > 0.0 {
            let step: f64 = StandardNormal.sample(&mut self.random);
            self.drift += deviation * step;
        }
    }
}

/// A gain around 1.
fn gain(random: &mut Pcg64Mcg, deviation: f64) -> f64 {
    let normal: f64 = StandardNormal.sample(random);
    (deviation * normal.clamp(-MOST_DEVIATIONS, MOST_DEVIATIONS)).exp()
}
