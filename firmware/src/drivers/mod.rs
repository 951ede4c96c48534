//! Drivers: one device each.

pub(crate) mod flash_store;
pub(crate) mod link;
