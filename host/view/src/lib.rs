//! Views: images and contacts for people.

pub mod colour;
pub mod layout;
pub mod live;
pub mod map;
pub mod picture;
pub mod plot;
pub mod sheet;
pub mod terminal;
pub mod trace;
