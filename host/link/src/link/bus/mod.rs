//! Bus: boards that share a line of RS-485 or a CAN FD bus, each behind a transport of its own.
//!
//! A thread or two have the bus for as long as a board on it is open in this program.

mod can;
mod load;
mod rs485;
mod seat;

pub(super) use load::Demand;
pub(super) use seat::{Place, Seat};

use crate::{error::LinkError, port::Bus};
use load::Medium;

/// Takes the place of a board on a bus, which is opened if it is not yet in this program; `name` is the board's port, for
/// errors.
pub(super) fn take_seat(name: &str, bus: &Bus, address: u8) -> Result<Seat, LinkError> {
    let medium = match bus {
        Bus::Rs485(_) => Medium::Rs485,
        Bus::Slcan(_) | Bus::SocketCan(_) => Medium::Can,
    };
    seat::take(name, bus, address, medium, |seats| match bus {
        Bus::Rs485(adapter) => rs485::start(name, adapter, seats),
        Bus::Slcan(adapter) => can::start_slcan(name, adapter, seats),
        Bus::SocketCan(interface) => can::start_socket(name, interface, seats),
    })
}
