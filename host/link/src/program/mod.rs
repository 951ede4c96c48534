//! What a board's program is: the firmware's ELF, its log, and debug probes that write it.

pub mod firmware;
#[cfg(feature = "logs")]
pub mod log;
pub mod probe;
