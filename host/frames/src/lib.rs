//! Frames that were recorded, by Dermatome boards or by other instruments: reading and checking them, learning
//! matrices and calibrations from them, and exchanging arrays with other programs.
#![forbid(unsafe_code)]

pub mod array;
pub mod calibrate;
pub mod interchange;
pub mod learn;
pub mod recorded;
