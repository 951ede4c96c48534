//! Rig: what boards on one line are made of.

use super::Bus;
use crate::{
    chip::flash::Flash,
    machine::{Halt, Options},
    probe::emulated,
};
use dermatome::link::program::firmware::Firmware;
use std::sync::Arc;

/// What emulated boards on one line are made of.
#[derive(Clone, Debug)]
pub struct BusRig {
    /// Their firmware.
    pub firmware: Arc<Firmware>,
    /// How they run.
    pub options: Options,
}

impl BusRig {
    /// A flash with the firmware and nothing else.
    #[must_use]
    pub fn flash(&self) -> Flash {
        let mut flash = Flash::default();
        emulated::program(&mut flash, &self.firmware);
        flash
    }

    /// Boards at these addresses with this in their flash, switched on. What is random differs from one to the other.
    pub fn start(&self, addresses: &[u8], flash: &Flash) -> Result<Bus, Halt> {
        let board = |(place, &address): (u64, &u8)| {
            let options = Options { seed: self.options.seed + place, ..self.options.clone() };
            (address, flash.clone(), options)
        };
        Bus::start((0..).zip(addresses).map(board).collect())
    }
}
