//! A skin's model for other software, and numbers from it.
//!
//! [`export`] writes everything that is computed for a skin as [`variable`]s into NumPy's files and one of MATLAB's,
//! see [`crate::array`]; [`conductivity`] reads conductivities to solve for. docs/interchange.md describes the files.

pub mod conductivity;
pub mod contents;
pub mod export;
pub mod variable;
