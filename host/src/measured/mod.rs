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

use dermatome_shared::{image::Geometry, stimulation::Step};

/// What reconstruction needs of a skin's model.
pub struct Model<'a> {
    /// All steps of the drive pattern in canonical order.
    pub steps: &'a [Step],
    /// Electrodes on the rim.
    pub electrodes: u8,
    /// Voltages of the untouched skin, with sign, for 1 A and a sheet conductivity of 1 S: `[step]`.
    pub voltages: &'a [f64],
    /// Where the pixels lie.
    pub geometry: Geometry,
    /// Electrodes in the grid's frame, m, x and y: `[electrode]`, for pictures; may be empty.
    pub rim: &'a [[f64; 2]],
    /// From difference data `[step]`, in units of `voltages`, to relative conductivity `[pixel]`.
    pub matrix: &'a dyn Fn(&[f64]) -> Vec<f64>,
}
