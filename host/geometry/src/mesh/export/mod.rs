//! Meshes as files for other programs: Gmsh's MSH 4.1 as text, binary PLY with values, and binary STL.
//!
//! The first two hold every coordinate in full, so that [`import`](super::import) reads the same mesh again.

mod msh;
mod ply;
mod stl;

pub use msh::msh;
pub use ply::{On, PlyError, Scalars, ply};
pub use stl::{IN_METRES, stl, stl_in_metres};

#[cfg(test)]
mod tests;
