//! What Dermatome's sensor board and its host must agree on, bit for bit.
//!
//! One frame travels like this, one call per step:
//!
//! ```text
//! samples -> demodulate -> acquire -> frame
//! frame -> number, time, flags (health) -> pipeline -> events                        (inside device)
//! frame -> reference -> drift -> reconstruct -> contact -> hysteresis -> calibration (inside pipeline)
//! frame -> noise; reference -> drift -> detect -> hysteresis -> calibration          (with places in the patch)
//! request packet -> protocol -> device -> protocol -> reply packet
//! events -> protocol -> event packets
//! ```
//!
//! Nothing here knows a clock, an executor, an allocator or any hardware, and nothing in the
//! frame path can panic. The firmware and the simulated board run this same code; the f64 solvers of
//! the host are its independent oracle.
//!
//! Modules use those above them in this list, and none below:
//!
//! | module       | holds                                                                            |
//! |--------------|----------------------------------------------------------------------------------|
//! | [`limits`]   | sizes that fix memory                                                            |
//! | [`units`]    | raw codes with their conversions                                                 |
//! | [`drive`]    | how a skin is driven; its [`stimulation`] pattern                                |
//! | [`frame`]    | one full scan                                                                    |
//! | [`image`]    | relative conductivity per pixel, and the [`surface`] that the pixels lie on      |
//! | [`contact`]  | contacts, in an image; their [`hysteresis`], [`calibration`] and tracks ([`track`]) |
//! | [`patch`]    | everything a board needs to sense one skin                                       |
//! | [`acquire`]  | samples to frames: [`scan`], [`demodulate`], front end, scope                    |
//! | [`health`]   | what a frame says about the wiring, and why the board started ([`restart`])      |
//! | [`pipeline`] | frames to contacts: [`mod@reference`], drift, [`reconstruct`]; noise, detection    |
//! | [`protocol`] | messages on the wire, and their framing                                          |
//! | [`device`]   | the board's state machine, and where it keeps its patch                          |
#![no_std]

#[cfg(test)]
extern crate std;

pub mod acquire;
pub mod contact;
pub mod device;
pub mod drive;
pub mod frame;
pub mod health;
pub mod image;
pub mod limits;
pub mod patch;
pub mod pipeline;
pub mod protocol;
pub mod units;

// One level of names outside, whatever rooms there are inside.
pub use acquire::{demodulate, scan, trigonometry};
pub use contact::{calibration, hysteresis, track};
pub use device::flash_slots;
pub use drive::stimulation;
pub use health::restart;
pub use image::surface;
pub use limits::*;
pub use pipeline::{reconstruct, reference};
