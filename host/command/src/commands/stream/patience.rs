//! Patience: how long to wait for a board that streams.

use dermatome_link::{Link, LinkError, LinkErrorKind, ScanFrame, frame_timeout, tare_timeout};
use dermatome_shared::{protocol::PatchInfo, reference::DEFAULT_TARE_FRAMES};
use std::time::{Duration, Instant};

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
