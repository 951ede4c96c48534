//! Tests of the joined chip: accesses as the CPU makes them, by address.

pub(crate) mod bus;
mod joined;
mod outside;
pub(crate) mod probe;
mod scan;
