//! Drivers: one device each.

pub(crate) mod crash;
pub(crate) mod flash;
pub(crate) mod link;
