//! Views: images and contacts for people.

pub mod colour;
pub mod live;
pub mod terminal;
