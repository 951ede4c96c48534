//! Drivers: one device each.

pub mod crash;
pub mod flash;
pub mod link;
