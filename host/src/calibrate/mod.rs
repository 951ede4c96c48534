//! Calibration: what a skin reads under known loads -> its curve, its hysteresis, and the plays against it.
//!
//! Readings of a loading machine become [`Trial`]s (up and down again); their loading branches make the
//! curve with its uncertainty ([`Curve`]); the first trial identifies the plays ([`identify`]) that the board
//! takes hysteresis out with ([`dermatome_shared::hysteresis`]); the other trials judge them.

mod curve;
mod file;
mod identify;
mod loading;
mod measure;
mod network;
pub mod patch;
mod plot;
pub mod stored;

pub use curve::{Curve, CurvePoint, isotonic};
pub use file::{FileError, Hold, read_loads, read_readings};
pub use identify::{compensated, identify};
pub use loading::{Reading, Trial, hysteresis, repeatability, trials};
pub use measure::{MeasureError, measure};
pub use network::Network;
pub use plot::svg;

#[cfg(test)]
mod tests;
