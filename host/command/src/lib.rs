//! The command line of Dermatome: arguments in, library calls, words and reports out.
#![forbid(unsafe_code)]

mod commands;
mod demo;

pub use commands::{command, main};
