//! Patience: how long to wait for a board that streams.

use dermatome_link::{Link, LinkError, LinkErrorKind, ScanFrame, tare_timeout};
use dermatome_shared::{protocol::PatchInfo, reference::DEFAULT_TARE_FRAMES};
use std::time::{Duration, Instant};

/// Frames that may fail to come before the board is asked whether it still streams.
const TIMEOUT_FRAMES: f64 = 5.0;

/// How long to wait for frames with contacts.
pub(super) struct Patience {
    /// Longest silence before the board is asked.
    pub(super) silence: Duration,
    /// Longest time without contacts: a board may be averaging a new reference.
    contacts: Duration,
    /// When the last contacts came, or the stream began.
    heard: Instant,
    /// Frames without contacts since.
    without: u64,
}

impl Patience {
    pub(super) fn new(patch: &PatchInfo) -> Self {
        let contacts = tare_timeout(patch, DEFAULT_TARE_FRAMES);
        Self { silence: frame_timeout(patch), contacts, heard: Instant::now(), without: 0 }
    }

    pub(super) fn see(&mut self, frame: &ScanFrame) {
        if frame.contacts.is_some() {
            (self.heard, self.without) = (Instant::now(), 0);
        } else {
            self.without += 1;
        }
    }

    /// The error of a board that says that it streams and does not.
    pub(super) fn check(&self, link: &Link) -> Result<(), LinkError> {
        if self.heard.elapsed() < self.contacts {
            return Ok(());
        }
        Err(link.error(LinkErrorKind::NoFrame { timeout: self.contacts, events: self.without }))
    }
}

/// Longest silence before the board is asked: five frames, and at least a second.
fn frame_timeout(patch: &PatchInfo) -> Duration {
    let least = Duration::from_secs(1);
    let frames = Duration::try_from_secs_f64(TIMEOUT_FRAMES / f64::from(patch.drive.frame_rate));
    frames.unwrap_or(least).clamp(least, Duration::from_secs(3600))
}

/// Longest silence where a board must send something: five frames, and at least five seconds.
pub(in crate::commands) fn silence_timeout(patch: &PatchInfo) -> Duration {
    frame_timeout(patch).max(Duration::from_secs(5))
}
