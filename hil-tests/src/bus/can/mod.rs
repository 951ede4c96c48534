//! CAN: emulated boards on one bus of CAN FD, and a host's adapter beside them.
//!
//! One thread owns all machines, and lets them run side by side in slices of [`SLICE`], which is shorter than any frame.
//! Between two slices it looks who wants to send. What was asked for by the time at which the bus fell idle takes part in the
//! arbitration of that time, so frames lie where they do on a real bus, to the bit; and what becomes of one is decided
//! before the slice in which it ends, whose nodes hear of it at their own exact time.
//!
//! **A frame** goes on with the lowest identifier. Where two of the same begin at once, the first bit that differs is an
//! error for the one whose bit was recessive. A frame that nobody acknowledges, that is damaged on its way, or whose sender
//! is reset, ends in an error frame, for all who notice. Who is error passive does not make others notice.

pub mod adapter;
pub mod host;
pub mod slcan;
mod wire;

pub use wire::{Traffic, Wire};

use super::owner::Owner;
use crate::{
    chip::{
        fdcan::frame::{Frame, Rates},
        flash::Flash,
        time::Time,
    },
    machine::{Halt, Options},
};
use adapter::Adapter;

/// Boards run alone for so long.
pub const SLICE: Time = Time::from_micros(20);

/// Boards on one CAN bus. It ends when the last handle is dropped.
#[derive(Clone, Debug)]
pub struct CanBus(Owner<Wire>);

impl CanBus {
    /// Switches boards on that have this in their flash and these addresses, and waits until they have started. The host's
    /// adapter is there, on the bus.
    pub fn start(boards: Vec<(u8, Flash, Options)>) -> Result<Self, Halt> {
        Owner::start(|| Wire::new(boards)).map(Self)
    }

    /// Lets the bus' thread do something with it, and waits for the result.
    pub fn with<T: Send + 'static>(&self, work: impl FnOnce(&mut Wire) -> T + Send + 'static) -> T {
        self.0.with(work)
    }

    /// Lets virtual time pass.
    pub fn run(&self, time: Time) -> Result<(), Halt> {
        self.with(move |wire| wire.run_until(wire.now() + time))
    }
}
