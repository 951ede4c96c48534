//! Frames recorded by other people's instruments, reconstructed with this skin's model.
//!
//! [`read`] a file of frames -> [`order`]: which measurement belongs to which step of the model,
//! which [`diagnose`] checks -> [`difference`] data -> [`reconstruct`]: images, and what they show.
//! [`check`] looks at a file of frames as a whole and says what is wrong with it; [`replay`] takes frames through the
//! pipeline of a board.

pub mod check;
pub mod diagnose;
pub mod difference;
pub mod fit;
pub mod grain;
pub mod order;
pub mod read;
pub mod reconstruct;
pub mod replay;
pub mod statistics;
pub mod weights;
pub mod wording;
