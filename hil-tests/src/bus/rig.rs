//! Rig: what boards that share a line or a bus are made of.

use super::{Bus, can::CanBus};
use crate::{
    chip::flash::Flash,
    machine::{Halt, Options},
    probe::emulated,
};
use dermatome::link::program::firmware::Firmware;
use std::sync::Arc;

/// What boards share.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Shared {
    /// A line on which one speaks at a time (RS-485).
    Line,
    /// A bus of CAN FD.
    Can,
}

/// What emulated boards that share a line or a bus are made of.
#[derive(Clone, Debug)]
pub struct BusRig {
    /// Which of both.
    pub shared: Shared,
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
        Bus::start(self.boards(addresses, flash))
    }

    /// The same on a CAN bus.
    pub fn start_can(&self, addresses: &[u8], flash: &Flash) -> Result<CanBus, Halt> {
        CanBus::start(self.boards(addresses, flash))
    }

    fn boards(&self, addresses: &[u8], flash: &Flash) -> Vec<(u8, Flash, Options)> {
        let board = |(place, &address): (u64, &u8)| {
            let options = Options { seed: self.options.seed + place, ..self.options.clone() };
            (address, flash.clone(), options)
        };
        (0..).zip(addresses).map(board).collect()
    }
}
