//! The demo: what it plays, and how it scores what it sees. [`crate::cli`] runs and shows it.

mod path;
mod picture;
mod score;
mod watch;

pub use path::{FRAMES, script};
pub use picture::picture;
pub use score::{Figures, FrameRecord, RadiusBand, Scorer};
pub use watch::{Watched, reference, watch};

/// The skin the demo uses; built in, so that the command works from any folder.
pub const SKIN: &str = include_str!("../../../models/disc-210mm/skin.toml");
/// Where that skin file lives, for messages.
pub const SKIN_PATH: &str = "models/disc-210mm/skin.toml";
