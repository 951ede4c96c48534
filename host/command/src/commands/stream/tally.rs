//! Tally: frames received, lost, and how fast they came.

use dermatome_shared::{frame::FrameFlags, protocol::FrameStamp};
use std::time::Instant;

/// Counts the frames of one stream by their sequence numbers.
#[derive(Debug, Default)]
pub(super) struct Tally {
    next: u32,
    received: u64,
    lost: u64,
    /// Frames with each flag, in the order of [`FrameFlags::ALL`].
    flagged: [u64; FrameFlags::ALL.len()],
    first_and_last: Option<[Instant; 2]>,
}

impl Tally {
    /// The stream starts with this frame.
    pub(super) fn start(&mut self, first_sequence: u32) {
        self.next = first_sequence;
    }

    /// A frame has come; gives what is wrong with it and was not with any before, in words.
    pub(super) fn count(&mut self, at: FrameStamp, now: Instant) -> Vec<&'static str> {
        let sequence = at.sequence;
        let mut new = Vec::new();
        for (count, (flag, words)) in self.flagged.iter_mut().zip(FrameFlags::ALL) {
            let is_set = at.flags.contains(flag);
            if is_set && *count == 0 {
                new.push(words);
            }
            *count += u64::from(is_set);
        }
        self.lost += u64::from(sequence.wrapping_sub(self.next));
        self.next = sequence.wrapping_add(1);
        self.received += 1;
        let [first, _] = self.first_and_last.unwrap_or([now; 2]);
        self.first_and_last = Some([first, now]);
        new
    }

    pub(super) fn received(&self) -> u64 {
        self.received
    }

    pub(super) fn lost(&self) -> u64 {
        self.lost
    }

    /// What was wrong with frames, in words, each with the number of frames.
    pub(super) fn flagged(&self) -> impl Iterator<Item = (&'static str, u64)> {
        let words = FrameFlags::ALL.map(|(_, words)| words);
        words.into_iter().zip(self.flagged).filter(|&(_, frames)| frames > 0)
    }

    /// Frames per second, from the first to the last; `None` for fewer than two.
    pub(super) fn per_second(&self) -> Option<f64> {
        let [first, last] = self.first_and_last?;
        let seconds = (last - first).as_secs_f64();
        (seconds > 0.0).then(|| (self.received - 1) as f64 / seconds)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::time::Duration;

    #[test]
    fn gaps_count_as_lost_from_the_first_frame_on_and_across_the_wrap() {
        let mut tally = Tally::default();
        let start = Instant::now();
        tally.start(u32::MAX - 3);
        for (i, sequence) in [u32::MAX - 1, u32::MAX, 2].into_iter().enumerate() {
            let flags = if i == 1 { FrameFlags::HOT } else { FrameFlags::default() };
            let at = FrameStamp { sequence, timestamp_us: 0, flags };
            let new = tally.count(at, start + Duration::from_millis(500 * i as u64));
            assert_eq!(new.is_empty(), i != 1);
        }
        assert_eq!((tally.received(), tally.lost()), (3, 2 + 2));
        assert_eq!(tally.flagged().collect::<Vec<_>>(), [("chip too hot", 1)]);
        assert_eq!(tally.per_second(), Some(2.0));
    }

    #[test]
    fn one_frame_has_no_rate() {
        let mut tally = Tally::default();
        assert_eq!(tally.per_second(), None);
        let at = FrameStamp { sequence: 0, timestamp_us: 0, flags: FrameFlags::default() };
        tally.count(at, Instant::now());
        assert_eq!(tally.per_second(), None);
    }
}
