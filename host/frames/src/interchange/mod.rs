//! A skin's model for other software, and numbers from it.
//!
//! [`export`] writes everything that is computed for a skin as [`mod@array`]s into [`npy`] files and one
//! MATLAB file ([`mat`]); [`conductivity`] reads conductivities to solve for. docs/interchange.md
//! describes the files.

pub mod array;
pub mod conductivity;
pub mod contents;
pub mod export;
pub mod mat;
pub mod npy;
