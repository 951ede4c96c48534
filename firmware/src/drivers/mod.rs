//! Drivers: one device each.

pub mod crash;
pub mod flash;
pub mod front_end;
pub mod link;
pub mod vitals;
