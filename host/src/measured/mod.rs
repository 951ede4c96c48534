//! Frames measured by other people's instruments, reconstructed with this skin's model.

mod npy;
mod npz;
pub mod read;
mod table;
