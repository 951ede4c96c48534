//! The demo: what it plays, and how it scores what it sees. [`crate::commands`] runs and shows it.

pub(crate) mod arm;
mod noisier;
mod path;
mod picture;
mod score;
mod watch;

pub(crate) use noisier::noisier;
pub(crate) use path::{FRAMES, script};
pub(crate) use picture::picture;
pub(crate) use score::{Figures, FrameRecord, Scorer};
pub(crate) use watch::{Watched, watch};

/// The skin the demo uses; built in, so that the command works from any folder.
pub(crate) const SKIN: &str = include_str!("../../../../models/disc-210mm/skin.toml");
/// Where that skin file lives, for messages.
pub(crate) const SKIN_PATH: &str = "models/disc-210mm/skin.toml";
