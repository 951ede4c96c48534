//! Geometry of skins: outlines, the surfaces they are laid onto, triangle meshes, and skins cut out of robot links.
//!
//! Knows no skin file and no board. Lengths are in metres.
#![forbid(unsafe_code)]

pub mod cut;
pub mod embedding;
pub mod mesh;
pub mod outline;
pub mod shape;
pub mod sheet;
