//! The analogue world: what lies between the emulated chip's DAC, its multiplexer pins and its converter.
//!
//! ```text
//! DAC steps -> coupling -> current source -> I+, I- -> skin -> V+, V- -> amplifier -> filter -> PGA -> ADC
//! ```
//!
//! [`parameters`] says what the parts are like, from a rig's file. [`skin`] solves the true skin, on a mesh
//! that no image is made with, and reduces it to what 16 leads see; [`network`] joins it with leads and
//! switches; [`modes`] takes that apart into exponentials, exactly; [`front_end`] steps them from event to
//! event. The [`handle`] is for cases: presses, drift, noise, temperature, [`fault`]s, and what
//! is true. [`expected`] computes the demodulated voltage another way, by frequencies, and [`readings`] what a board's
//! acquisition makes of it. [`Analogue::drawn`] gives front ends as their parts' tolerances make them.

mod error;
pub mod expected;
pub mod fault;
pub mod front_end;
pub mod handle;
pub mod modes;
pub mod multiplexers;
pub mod network;
mod noise;
pub mod parameters;
mod range;
pub mod readings;
pub mod skin;
mod tolerances;

pub use error::WorldError;
pub use expected::{Carrier, Response};
pub use fault::Fault;
pub use front_end::AnalogueWorld;
pub use handle::{Setup, WorldHandle};
pub use parameters::Analogue;

#[cfg(test)]
mod tests;
