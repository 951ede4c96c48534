//! Views: images and contacts for people.

pub mod colour;
pub mod picture;
pub mod sheet;
