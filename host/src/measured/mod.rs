//! Frames measured by other people's instruments, reconstructed with this skin's model.
//!
//! [`read`] a file of frames -> [`order`]: which measurement belongs to which step of the model,
//! which [`diagnose`] checks -> [`difference`] data -> [`reconstruct`]: images, and what they show.

pub mod diagnose;
pub mod difference;
mod npy;
mod npz;
pub mod order;
pub mod read;
pub mod reconstruct;
mod table;
