//! What Dermatome's sensor board and its host must agree on, bit for bit.
//!
//! One frame travels like this, one call per step:
//!
//! ```text
//! samples -> demodulate -> acquire -> frame
//! frame -> health -> reference -> drift -> reconstruct -> contact -> hysteresis -> calibration    (inside pipeline)
//! request packet -> protocol -> device -> protocol -> reply packet
//! frame -> device -> pipeline -> events -> protocol -> event packets
//! ```
//!
//! Nothing here knows a clock, an executor, an allocator or any hardware, and nothing in the
//! frame path can panic. The firmware and the simulated board run this same code; the f64 solvers of
//! the host are its independent oracle.
#![no_std]

#[cfg(test)]
extern crate std;

pub mod acquire;
pub mod calibration;
pub mod contact;
pub mod demodulate;
pub mod device;
pub mod drift;
pub mod drive;
pub mod frame;
pub mod health;
pub mod hysteresis;
pub mod image;
pub mod patch;
pub mod pipeline;
pub mod protocol;
pub mod reconstruct;
pub mod reference;
pub mod restart;
pub mod scan;
pub mod slots;
pub mod stimulation;
pub mod surface;
pub mod synthetic;
pub mod track;
pub mod trigonometry;
pub mod units;

/// Most electrodes a board can switch: one nibble of the multiplexer word each.
pub const MAX_ELECTRODES: usize = 16;
/// Most stimulation steps in one frame (16 drives, 16 sense pairs each).
pub const MAX_STEPS: usize = 256;
/// Most measurements, after reciprocal steps are combined.
pub const MAX_MEASUREMENTS: usize = 256;
/// Most image pixels.
pub const MAX_PIXELS: usize = 1024;
/// Most columns, and most rows, of the pixel grid.
pub const MAX_GRID_SIDE: usize = 64;
/// Most contacts reported for one image.
pub const MAX_CONTACTS: usize = 8;
/// Longest patch a board can hold, bytes: one of its two flash slots, without the record of its commit.
pub const MAX_PATCH_BYTES: usize = slots::SLOT_BYTES - slots::RECORD_BYTES;
