//! The patch of a board as programs own it: what it holds, how it is written, the pose of its skin, files written whole or
//! not at all, and read up to a bound.
#![forbid(unsafe_code)]

pub mod input;
pub mod layout;
pub mod matrix;
#[cfg(feature = "files")]
pub mod output;
pub mod places;
pub mod pose;
pub mod reflexes;
pub mod tables;
pub mod write;
