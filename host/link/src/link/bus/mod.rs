//! Bus: boards that share a line of RS-485 or a CAN FD bus, each behind a transport of its own.
//!
//! A thread or two have the bus for as long as a board on it is open in this program.

mod can;
mod load;
mod rs485;
mod seat;

pub(super) use load::Demand;
pub(super) use seat::{Place, take_seat};
