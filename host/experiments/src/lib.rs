//! Experiments on simulated skins.
#![forbid(unsafe_code)]

pub mod evaluate;
pub mod experiment;
pub mod scenes;
pub mod trust;
