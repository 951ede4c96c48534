//! USB: the full-speed device (RM0440, "Universal serial bus full-speed device interface"), its packet memory, and the
//! host at the other end of the cable.
//!
//! The host ([`host`]) makes what happens on the bus: it asks the device for each packet, and the device answers as its
//! endpoint registers say (`device`). Modelled are control, bulk and interrupt endpoints with one buffer for each direction.

mod device;
pub mod host;
mod memory;
mod registers;
#[cfg(test)]
mod tests;

pub use memory::PacketMemory;

use super::{
    bank::Bank,
    map::Register,
    misuse::Misuse,
    peripheral::{Moment, Peripheral},
    time::Time,
    trace::Event,
};
use device::Device;
use host::Host;

/// Device and host.
#[derive(Clone, Debug, Default)]
pub struct Usb {
    device: Device,
    host: Host,
}

/// Clocks of the device.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct UsbClocks {
    /// Kernel clock, Hz; 0 for none.
    pub kernel: u64,
    /// Whether it is within the 0.25 % that a device may be off: from a crystal, or from the HSI48 as the CRS trims it by
    /// the host's frames.
    pub is_exact: bool,
    /// APB1, Hz.
    pub bus: u64,
}

impl Usb {
    /// How its clocks run from now on.
    pub fn run_at(&mut self, clocks: UsbClocks) {
        self.device.clocks = clocks;
    }

    /// Whether its pins are its own.
    #[must_use]
    pub fn is_powered(&self) -> bool {
        self.device.is_powered()
    }

    /// The packet memory.
    #[must_use]
    pub fn memory(&self) -> &PacketMemory {
        &self.device.memory
    }

    /// The packet memory, for the bus.
    pub fn memory_mut(&mut self) -> &mut PacketMemory {
        &mut self.device.memory
    }

    /// The host, and what it has seen.
    #[must_use]
    pub fn host(&self) -> &Host {
        &self.host
    }

    /// Somebody does something with the host or the cable.
    pub fn host_mut(&mut self) -> &mut Host {
        &mut self.host
    }

    /// Bytes of bulk packets that came or went since this was asked last.
    pub fn take_passed(&mut self) -> Vec<(Time, Event)> {
        self.host.take_passed()
    }
}

impl Peripheral for Usb {
    fn bank(&self) -> &Bank {
        &self.device.bank
    }

    fn bank_mut(&mut self) -> &mut Bank {
        &mut self.device.bank
    }

    fn models(&self, register: &Register) -> bool {
        register.name != "LPMCSR"
    }

    fn clears_flags(&self, register: &Register) -> bool {
        register.name == "ISTR"
    }

    fn read(&mut self, register: &Register, _: Moment) -> u32 {
        match register.name.as_str() {
            "ISTR" => self.device.status(),
            _ => self.device.bank.value(register),
        }
    }

    fn write(&mut self, register: &Register, value: u32, at: Moment) -> Result<(), Misuse> {
        self.device.write(register, value, at.now)?;
        self.host.look(&self.device, at.now);
        Ok(())
    }

    fn next_event(&self) -> Time {
        self.device.next_event().min(self.host.next_event())
    }

    fn advance(&mut self, at: Moment) -> Result<(), Misuse> {
        self.device.advance(at.now);
        self.host.advance(&mut self.device, at.now)
    }

    fn interrupts(&self, signal: &str) -> bool {
        signal == "LP" && self.device.interrupts()
    }

    /// The device starts anew, without its pull-up; cable and host stay.
    fn reset(&mut self) {
        self.device = self.device.after_reset();
        self.host.look_again(&self.device);
    }
}
