//! The board of Dermatome's firmware: its table of hardware and its drivers.
//!
//! Each program in this package gets the chip from here, and with it what happens after a crash
//! ([`drivers::crash`]) and on a read of damaged flash ([`drivers::flash`]).
#![no_std]

pub mod board;
pub mod drivers;
