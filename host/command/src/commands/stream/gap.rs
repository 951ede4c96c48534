//! Gap: the time in which the board was lost.

use super::session::Restored;
use serde::Serialize;
use std::time::Duration;

/// From the last frame before the board was lost to the first one after.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub(super) struct Gap {
    /// Sequence number of the last frame before, if there was one.
    pub(super) after_sequence: Option<u32>,
    /// How long it was.
    pub(super) seconds: f64,
    /// Frames that the board would have made meanwhile, about.
    pub(super) frames_missed: u64,
    /// Whether the drive was set again.
    drive_restored: bool,
    /// Whether the board made a new reference.
    tared: bool,
}

impl Gap {
    pub(super) fn new(
        after_sequence: Option<u32>,
        length: Duration,
        frame_rate: f64,
        restored: Restored,
    ) -> Self {
        let seconds = length.as_secs_f64();
        // One of them is the frame that has come.
        let frames_missed = (seconds * frame_rate - 1.0).round().max(0.0) as u64;
        let Restored { drive, tared } = restored;
        Self { after_sequence, seconds, frames_missed, drive_restored: drive, tared }
    }

    /// A line for whoever reads contacts as text.
    pub(super) fn line(&self) -> String {
        let after = self.after_sequence.map_or(String::new(), |sequence| format!(" after frame {sequence}"));
        let tared = if self.tared { ", with a new reference" } else { "" };
        format!("# gap of {:.3} s{after}: about {} frames missed{tared}", self.seconds, self.frames_missed)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_frame_after_a_gap_is_not_missed() {
        let restored = Restored { drive: false, tared: true };
        let gap = Gap::new(Some(7), Duration::from_millis(1200), 50.0, restored);
        assert_eq!(
            gap.line(),
            "# gap of 1.200 s after frame 7: about 59 frames missed, with a new reference"
        );
        assert_eq!(Gap::new(None, Duration::ZERO, 50.0, Restored::default()).frames_missed, 0);
    }
}
