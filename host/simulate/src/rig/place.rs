//! One place of a sheet under a loading machine, as a board reads it.

use crate::material::{Material, Transducer};
use rand::SeedableRng;
use rand_distr::{Distribution, StandardNormal};
use rand_pcg::Pcg64Mcg;

/// A place of a sheet, and an instrument that reads its strength with noise.
#[derive(Clone, Debug)]
pub struct PlaceRig {
    place: Transducer,
    /// Standard deviation of the noise of a frame's strength.
    noise: f64,
    random: Pcg64Mcg,
}

impl PlaceRig {
    /// A fresh place; `noise` is a share of the material's full change.
    #[must_use]
    pub fn new(material: &Material, noise: f64, seed: u64) -> Self {
        Self {
            place: Transducer::new(material, seed),
            noise: noise * material.full_change,
            random: Pcg64Mcg::seed_from_u64(seed.wrapping_add(1000)),
        }
    }

    /// Strengths (relative conductivity changes) of `frames` frames while a pressure, kPa, is held for some seconds.
    pub fn hold(&mut self, pressure_kpa: f64, seconds: f64, frames: usize) -> Vec<f64> {
        let frame = |_| {
            let normal: f64 = StandardNormal.sample(&mut self.random);
            let change = self.place.respond(pressure_kpa, seconds / frames as f64);
            change + self.noise * normal
        };
        (0..frames).map(frame).collect()
    }
}
