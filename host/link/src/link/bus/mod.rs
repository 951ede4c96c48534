//! Bus: boards that share one line, each behind a transport of its own ([`dermatome_shared::protocol::bus`]).
//!
//! A thread has the line for as long as a board on it is open in this program. Turn by turn it sends a board what is
//! for it, lets it speak, and hands what it says to whoever reads that board.

mod line;
mod load;

pub(super) use line::{Place, take_seat};
pub(super) use load::Demand;
