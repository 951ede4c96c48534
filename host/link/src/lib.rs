//! The link to a sensor board: requests and replies, and frames, contacts and health as they come.
//!
//! [`open`] a [`Port`], then [`Link::subscribe`] to what is wanted: whole frames, until the subscription is dropped or
//! [stopped](Subscription::stop), which ends the board's stream. [`contacts`] gives them in the frame of a robot's link.
#![forbid(unsafe_code)]

pub mod assemble;
pub mod contacts;
pub mod devices;
mod error;
pub mod health;
mod link;
mod port;
#[cfg(feature = "program")]
pub mod program;
pub mod scope;
mod subscription;
pub mod trim;
pub mod words;

pub use assemble::{ScanFrame, Totals};
pub use dermatome_patch::{pose, tables};
pub use dermatome_shared as shared;
pub use error::{Damage, LinkError, LinkErrorKind, Overload};
pub use link::{
    Link, REPLY_TIMEOUT, Transport, Untouched, UploadError, is_tared, open, tare, tare_timeout, upload,
};
pub use port::{Adapter, Bus, Port, PortError};
pub use subscription::{NotBegun, PolledStream, Subscription, frame_timeout, silence_timeout};
