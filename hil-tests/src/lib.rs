//! Runs the firmware against a rig, which is an emulated board or a real one.
//!
//! [`chip`] is an STM32G474 without its CPU, one file for each peripheral; [`machine`] adds the CPU and
//! virtual time. The firmware's ELF ([`elf`]) runs on it byte for byte.

pub mod chip;
pub mod elf;
pub mod machine;
