//! Views: images and contacts for people.
#![forbid(unsafe_code)]

pub mod canvas;
pub mod colour;
pub mod live;
pub mod map;
pub mod picture;
pub mod placed;
pub mod plot;
pub mod sheet;
pub mod terminal;
pub mod trace;
