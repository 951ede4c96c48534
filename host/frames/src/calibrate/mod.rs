//! Calibration: what a skin reads under known loads -> its curve, its hysteresis, and the play operators against it.
//!
//! Readings of a loading machine become [`Trial`]s (up and down again); their loading branches make the
//! curve with its uncertainty ([`Curve`]); the first trial identifies the play operators ([`identify`]) that the board
//! takes hysteresis out with ([`dermatome_shared::hysteresis`]); the other trials judge them. The indenter's known
//! area says how much of a contact's area its pressure acts on ([`load_share`]). [`Fit`] is all of it. Readings at several
//! places ([`at_places`]) first give a smooth field of gain ([`Field`]), which is taken out of them.

mod curve;
mod field;
mod file;
mod fit;
mod identify;
mod indenter;
mod loading;
mod measure;
mod network;
mod pairing;
mod places;
mod plot;
mod recording;

pub use curve::{Curve, CurvePoint, isotonic};
pub use field::{Field, NoField};
pub use file::{FileError, Hold, TAKEN_IN, read_loads, read_readings, units_of};
pub use fit::{Compensation, Fit, FitError, Loop};
pub use identify::{compensated, identify};
pub use indenter::load_share;
pub use loading::{Reading, Trial, hysteresis, repeatability, trials};
pub use measure::{MeasureError, measure};
pub use network::Network;
pub use pairing::{NoFrames, Pairing, Strongest};
pub use places::{OffSkin, at_places};
use places::{centres, size};
pub use plot::svg;
pub use recording::{Recording, RecordingError};

#[cfg(test)]
mod field_tests;
#[cfg(test)]
mod tests;
