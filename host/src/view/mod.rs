//! Views: images and contacts for people.

pub mod colour;
pub mod live;
pub mod picture;
pub mod sheet;
pub mod terminal;
