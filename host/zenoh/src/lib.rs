//! A robot's skins over several computers, by Zenoh.
//!
//! Each computer that holds boards [tells](Robot::tell) what its [`dermatome_body::Body`] has taken, under
//! `dermatome/ROBOT/LINK/PATCH`; a [`Listener`] hears any number of them, and a [`Merge`] makes one body of that; [`ask`]
//! has skins tared and driven. Keys, messages and quality of service are in docs/zenoh.md.
#![forbid(unsafe_code)]

mod asking;
pub mod key;
mod latency;
mod listener;
pub mod merge;
pub mod message;
mod offset;
mod outlet;
mod robot;
pub mod settings;

pub use asking::ask;
pub use listener::{Heard, Listener};
pub use merge::Merge;
pub use robot::Robot;
pub use settings::{Settings, ZenohError};
