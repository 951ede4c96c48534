//! Runs the firmware against a rig, which is an emulated board or a real one.
//!
//! [`chip`] is an STM32G474 without its CPU, one file for each peripheral; [`machine`] adds the CPU and
//! virtual time. The firmware's ELF runs on it byte for byte. [`board`] is such a machine with
//! a link, [`bus`] several of them on one line; [`rig`] puts it, or a real board with its debug [`probe`], behind one interface; [`cases`] are what
//! runs against that. [`world`] is the analogue circuit and the skin that an emulated board measures.
//! [`fault`] is what can go wrong on purpose, [`waves`] shows what happened. [`mutants`] are faults of the firmware
//! that the cases must notice.

pub mod board;
pub mod bus;
pub mod cases;
pub mod chip;
pub mod fault;
pub mod machine;
pub mod mutants;
pub mod probe;
pub mod rig;
pub mod waves;
pub mod world;
