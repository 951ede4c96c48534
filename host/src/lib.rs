//! Dermatome's host side: models of skins, reconstruction matrices, patches, and the link to the board.
//!
//! Data flows one way: [`skin`] file -> [`mesh`] -> [`forward`] model -> [`jacobian`] -> [`inverse`]
//! (reconstruction matrix) -> [`quantize`] (patch) -> [`link`] -> [`board`] -> image -> contacts.
#![forbid(unsafe_code)]

pub mod board;
pub mod calibrate;
pub mod cli;
pub mod cut;
pub mod demo;
pub mod evaluate;
pub mod experiment;
pub mod forward;
pub mod health;
pub mod interchange;
pub mod inverse;
pub mod jacobian;
pub mod learn;
pub mod link;
pub mod material;
pub mod measured;
pub mod mesh;
pub mod metrics;
pub mod model;
pub mod output;
pub mod pixels;
pub mod prior;
pub mod quantize;
pub mod resolve;
pub mod scenes;
pub mod scope;
pub mod simulate;
pub mod skin;
pub mod stimulation;
pub mod view;
