//! The patch of a board as programs own it: what it holds, how it is written, and files written whole or not at all.
#![forbid(unsafe_code)]

pub mod layout;
pub mod output;
pub mod tables;
pub mod write;
