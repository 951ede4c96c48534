//! Recordings: what a board told, in an MCAP file, and what a board would tell of it again.
//!
//! A session's messages -> [`write::Recorder`] -> file -> [`read::Recording`] -> [`frames::Frames`] -> [`play::Player`],
//! which is a board's own pipeline: the same bits where patch and frames are the same.
#![forbid(unsafe_code)]

pub mod columns;
pub mod frames;
pub mod play;
pub mod read;
pub mod session;
mod whole;
pub mod write;
