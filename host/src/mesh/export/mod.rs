//! Meshes as files for other programs: Gmsh's MSH 4.1 as text, and binary PLY with values.
//!
//! Both hold every coordinate in full, so that [`import`](super::import) reads the same mesh again.

mod msh;
mod ply;

pub use msh::msh;
pub use ply::{On, PlyError, Scalars, ply};

#[cfg(test)]
mod tests;
