//! Views: images and contacts for people.

pub mod colour;
pub mod terminal;
