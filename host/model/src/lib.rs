//! From a skin's description to its reconstruction matrix.
//!
//! Data flows one way: [`skin`] file -> mesh -> [`forward`] model -> [`jacobian`] -> [`inverse`] (reconstruction
//! matrix) -> [`quantize`] (patch). [`model`] takes a skin through all of it.
#![forbid(unsafe_code)]

pub mod forward;
pub mod indenter;
pub mod inverse;
pub mod jacobian;
pub mod metrics;
pub mod model;
pub mod multi_contact;
pub mod pixels;
pub mod prior;
pub mod quantize;

pub mod skin;
pub mod stimulation;
