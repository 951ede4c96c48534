//! A robot's body of skins.
//!
//! A [`mod@file`] says which skins a robot wears, and where. A [`keeper::Keeper`] each holds one skin's board, through lost
//! cables and restarts, and tells what it sends; [`Body::take`] makes [`contact::SkinContact`]s of that, in the frames
//! of the robot's links and by this computer's clock, and sums up what presses on each link ([`contact::Wrench`]).
#![forbid(unsafe_code)]

pub mod asking;
mod body;
pub mod contact;
pub mod driven;
pub mod file;
pub mod keeper;
mod placed;
pub mod surface;

pub use body::{Body, Report, Sense};
pub use placed::PlacedSkin;
