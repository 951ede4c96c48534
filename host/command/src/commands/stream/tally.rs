//! Tally: frames received, lost, and how fast they came.

use dermatome_link::{ScanFrame, Totals};
use dermatome_shared::frame::FrameFlags;
use std::time::{Duration, Instant};

/// Counts the frames of one stream; those that count have their contacts.
#[derive(Debug, Default)]
pub(super) struct Tally {
    received: u64,
    /// Frames that came without their contacts.
    without_contacts: u64,
    /// Frames of which nothing came.
    missing: u64,
    /// Those of streams before this one.
    missing_before: u64,
    /// Frames with each flag, in the order of [`FrameFlags::ALL`].
    flagged: [u64; FrameFlags::ALL.len()],
    first_and_last: Option<[Instant; 2]>,
    /// Time from the first to the last frame of each stream before this one, and the frames after their first.
    before: (Duration, u64),
    /// Frames of this stream.
    streamed: u64,
}

impl Tally {
    /// The board is asked to stream once more.
    pub(super) fn begin(&mut self) {
        self.missing_before += std::mem::take(&mut self.missing);
        self.before = self.time_and_frames();
        (self.first_and_last, self.streamed) = (None, 0);
    }

    /// A frame has come; gives what is wrong with it and was not with any before, in words.
    pub(super) fn count(&mut self, frame: &ScanFrame, totals: Totals, now: Instant) -> Vec<&'static str> {
        self.missing = totals.frames_missing;
        let Some(at) = frame.at.filter(|_| frame.contacts.is_some()) else {
            self.without_contacts += 1;
            return Vec::new();
        };
        let mut new = Vec::new();
        for (count, (flag, words)) in self.flagged.iter_mut().zip(FrameFlags::ALL) {
            let is_set = at.flags.contains(flag);
            if is_set && *count == 0 {
                new.push(words);
            }
            *count += u64::from(is_set);
        }
        self.received += 1;
        self.streamed += 1;
        let [first, _] = self.first_and_last.unwrap_or([now; 2]);
        self.first_and_last = Some([first, now]);
        new
    }

    pub(super) fn received(&self) -> u64 {
        self.received
    }

    pub(super) fn lost(&self) -> u64 {
        self.missing_before + self.missing + self.without_contacts
    }

    /// What was wrong with frames, in words, each with the number of frames.
    pub(super) fn flagged(&self) -> impl Iterator<Item = (&'static str, u64)> {
        let words = FrameFlags::ALL.map(|(_, words)| words);
        words.into_iter().zip(self.flagged).filter(|&(_, frames)| frames > 0)
    }

    /// Frames per second, from the first to the last of each stream; `None` for fewer than two.
    pub(super) fn per_second(&self) -> Option<f64> {
        let (time, frames) = self.time_and_frames();
        let seconds = time.as_secs_f64();
        (seconds > 0.0).then(|| frames as f64 / seconds)
    }

    fn time_and_frames(&self) -> (Duration, u64) {
        let (time, frames) = self.before;
        let here = self.first_and_last.map_or(Duration::ZERO, |[first, last]| last - first);
        (time + here, frames + self.streamed.saturating_sub(1))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use dermatome_shared::{contact::Contacts, protocol::FrameStamp};

    fn frame(flags: FrameFlags, contacts: Option<Contacts>) -> ScanFrame {
        let at = Some(FrameStamp { sequence: 7, timestamp_us: 0, flags });
        ScanFrame { at, contacts, ..ScanFrame::default() }
    }

    #[test]
    fn frames_without_contacts_and_frames_of_which_nothing_came_are_lost() {
        let mut tally = Tally::default();
        let start = Instant::now();
        let totals = Totals { frames_missing: 4, ..Totals::default() };
        for i in 0..3 {
            let flags = if i == 1 { FrameFlags::HOT } else { FrameFlags::default() };
            let now = start + Duration::from_millis(500 * i);
            let new = tally.count(&frame(flags, Some(Contacts::new())), totals, now);
            assert_eq!(new.is_empty(), i != 1);
        }
        assert_eq!((tally.received(), tally.lost()), (3, 4));
        assert_eq!(tally.flagged().collect::<Vec<_>>(), [("chip too hot", 1)]);
        assert_eq!(tally.per_second(), Some(2.0));
        assert!(tally.count(&frame(FrameFlags::SATURATED, None), totals, start).is_empty());
        assert_eq!((tally.received(), tally.lost()), (3, 5));
        tally.begin();
        tally.count(&frame(FrameFlags::default(), Some(Contacts::new())), Totals::default(), start);
        assert_eq!((tally.received(), tally.lost()), (4, 5));
    }

    #[test]
    fn one_frame_has_no_rate() {
        let mut tally = Tally::default();
        assert_eq!(tally.per_second(), None);
        tally.count(&frame(FrameFlags::default(), Some(Contacts::new())), Totals::default(), Instant::now());
        assert_eq!(tally.per_second(), None);
    }
}
