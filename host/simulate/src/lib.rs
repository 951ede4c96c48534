//! Simulation: a skin that is solved for, not read off the model it will be imaged with.
//!
//! Its mesh is finer than the reconstruction's and turned against it, so that the two never share
//! a node (sharing one would be the inverse crime); every frame is a true forward solution, with
//! seeded noise and the rounding of the converter.
#![forbid(unsafe_code)]

pub mod board;
mod converter;
pub mod instrument;
pub mod material;
pub mod noise;
pub mod port;
pub mod rig;
pub mod script;
pub mod sheet;
pub mod skin;
pub mod truth;
pub mod wiring;

pub use dermatome_model::indenter::{self, Footprint, Load, Press};
pub use noise::Noise;
pub use rig::Rig;
pub use script::{Hand, HandError, Script, ScriptError};
pub use sheet::{ScriptedSheet, Sheet};
pub use skin::SimulatedSkin;
pub use truth::TrueSkin;
pub use wiring::{Fault, TimedFault};
