//! Dermatome's host side: models of skins, reconstruction matrices, patches, and the link to the board.
//!
//! Data flows one way: [`skin`] file -> [`mesh`] -> [`forward`] model -> [`jacobian`] -> [`inverse`]
//! (reconstruction matrix) -> [`quantize`] (patch) -> [`link`] -> [`board`] -> image -> contacts.

pub mod board;
pub mod cli;
pub mod link;
pub mod measured;
pub mod output;
pub mod view;
