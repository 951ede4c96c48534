//! The patch of a board as programs own it: what it holds, how it is written, the pose of its skin, and files written
//! whole or not at all.
#![forbid(unsafe_code)]

pub mod layout;
pub mod matrix;
#[cfg(feature = "files")]
pub mod output;
pub mod places;
pub mod pose;
pub mod tables;
pub mod write;
