//! Experiments on simulated skins.
#![forbid(unsafe_code)]

mod deform;
pub mod evaluate;
pub mod experiment;
pub mod presses;
pub mod scenes;
pub mod trust;

pub use deform::DeformError;
