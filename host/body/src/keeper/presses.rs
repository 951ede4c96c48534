//! Presses: whether something is on a skin, by the frames that come. Where none come, nothing is known to have left it.

use dermatome_link::ScanFrame;
use std::time::{Duration, Instant};

/// Time without a contact after which a skin is free.
const FREE: Duration = Duration::from_millis(500);

/// What frames have told of a skin since one came.
pub(super) struct Presses {
    free: Duration,
    /// When the last frame came that tells of contacts.
    seen: Option<Instant>,
    /// Since when they have none.
    untouched: Option<Instant>,
    /// Since when they have none but such that something is known to be wrong with.
    unpressed: Option<Instant>,
}

impl Presses {
    /// Nothing is known yet of a skin that is scanned so often, Hz.
    pub(super) fn new(frame_rate: f32) -> Self {
        Self { free: free_time(frame_rate), seen: None, untouched: None, unpressed: None }
    }

    /// A frame has come.
    pub(super) fn take(&mut self, frame: &ScanFrame, now: Instant) {
        let Some(contacts) = &frame.contacts else { return };
        let is_touched = !contacts.is_empty();
        let is_pressed = is_touched && frame.at.is_some_and(|at| at.flags.leaves_contacts_valid());
        // What was between frames that lie far apart nobody knows.
        let goes_on = self.tells(now);
        let since =
            |before: Option<Instant>, is_so: bool| is_so.then(|| before.filter(|_| goes_on).unwrap_or(now));
        self.seen = Some(now);
        self.untouched = since(self.untouched, !is_touched);
        self.unpressed = since(self.unpressed, !is_pressed);
    }

    /// Whether the last frame has contacts.
    pub(super) fn is_touched(&self) -> bool {
        self.seen.is_some() && self.untouched.is_none()
    }

    /// Whether it has contacts that nothing is known to be wrong with: a new drive, which may mend what is wrong, waits for these
    /// alone.
    pub(super) fn is_pressed(&self) -> bool {
        self.seen.is_some() && self.unpressed.is_none()
    }

    /// Whether frames have come for long without any contact, until now.
    pub(super) fn is_untouched(&self, now: Instant) -> bool {
        self.is_long(self.untouched, now)
    }

    /// The same of contacts that nothing is known to be wrong with.
    pub(super) fn is_free(&self, now: Instant) -> bool {
        self.is_long(self.unpressed, now)
    }

    fn is_long(&self, since: Option<Instant>, now: Instant) -> bool {
        let seen = self.seen.filter(|_| self.tells(now));
        seen.zip(since).is_some_and(|(seen, since)| seen.duration_since(since) >= self.free)
    }

    /// Whether the last frame is not long ago.
    fn tells(&self, now: Instant) -> bool {
        self.seen.is_some_and(|seen| now.duration_since(seen) <= self.free)
    }
}

/// The time at this rate: two frames at least.
fn free_time(frame_rate: f32) -> Duration {
    let frames = Duration::try_from_secs_f64(2.0 / f64::from(frame_rate));
    frames.unwrap_or(FREE).max(FREE)
}

#[cfg(test)]
mod tests {
    use super::*;
    use dermatome_shared::{contact::Contact, frame::FrameFlags, protocol::FrameStamp};

    const CONTACT: Contact = Contact {
        position: [0.0; 3],
        normal: [0.0, 0.0, 1.0],
        area: 1e-4,
        strength: 0.5,
        peak: 0.5,
        pressure: None,
        load_area: None,
        evidence: None,
        identity: None,
    };

    /// A skin of which frames have come, each after so many ms with so many contacts and these flags, and when the last one came.
    fn after(frame_rate: f32, frames: &[(u64, Option<usize>, FrameFlags)]) -> (Presses, Instant) {
        let begun = Instant::now();
        let mut presses = Presses::new(frame_rate);
        let mut now = begun;
        for &(ms, contacts, flags) in frames {
            let contacts = contacts.map(|count| (0..count).map(|_| CONTACT).collect());
            let at = Some(FrameStamp { sequence: 0, timestamp_us: 0, flags });
            now = begun + Duration::from_millis(ms);
            presses.take(&ScanFrame { at, contacts, ..ScanFrame::default() }, now);
        }
        (presses, now)
    }

    fn is_free(frame_rate: f32, frames: &[(u64, Option<usize>)]) -> bool {
        let frames: Vec<_> = frames.iter().map(|&(ms, count)| (ms, count, FrameFlags::default())).collect();
        let (presses, now) = after(frame_rate, &frames);
        assert_eq!(presses.is_free(now), presses.is_untouched(now));
        presses.is_free(now)
    }

    #[test]
    fn a_skin_is_free_once_frames_without_contacts_have_come_for_half_a_second() {
        assert!(!is_free(50.0, &[]), "nothing is known");
        assert!(!is_free(50.0, &[(0, Some(0)), (480, Some(0))]));
        assert!(is_free(50.0, &[(0, Some(0)), (480, Some(0)), (500, Some(0))]));
        assert!(!is_free(50.0, &[(300, Some(1)), (320, Some(0)), (800, Some(0))]));
        assert!(is_free(50.0, &[(300, Some(1)), (320, Some(0)), (820, Some(0))]));
        // Of one frame a second two more are needed.
        assert!(!is_free(1.0, &[(1000, Some(1)), (2000, Some(0)), (3000, Some(0))]));
        assert!(is_free(1.0, &[(1000, Some(1)), (2000, Some(0)), (3000, Some(0)), (4000, Some(0))]));
    }

    #[test]
    fn frames_that_do_not_come_or_have_lost_their_contacts_free_no_skin() {
        // A finger rests, and nothing comes for three seconds.
        assert!(!is_free(50.0, &[(100, Some(1)), (3100, Some(1))]));
        assert!(!is_free(50.0, &[(100, Some(1)), (3100, Some(0))]));
        assert!(!is_free(50.0, &[(100, Some(1)), (400, None), (800, None)]));
        assert!(!is_free(50.0, &[(100, Some(0)), (400, None), (800, None)]));
        // Nothing is known of the second between two frames.
        assert!(!is_free(50.0, &[(100, Some(0)), (1100, Some(0))]));
        // A skin that was free, of which nothing has come for long.
        let (presses, now) =
            after(50.0, &[(0, Some(0), FrameFlags::default()), (500, Some(0), FrameFlags::default())]);
        assert!(presses.is_free(now + Duration::from_millis(500)));
        let late = now + Duration::from_millis(501);
        assert!(!presses.is_free(late) && !presses.is_untouched(late));
    }

    #[test]
    fn contacts_that_something_is_wrong_with_keep_a_tare_waiting_but_no_drive() {
        let wrong = FrameFlags::SATURATED;
        let (presses, now) =
            after(50.0, &[(100, Some(1), wrong), (400, Some(1), wrong), (700, Some(1), wrong)]);
        assert!(presses.is_touched() && !presses.is_pressed());
        assert!(presses.is_free(now) && !presses.is_untouched(now));
    }

    #[test]
    fn what_is_not_known_is_not_said_to_press() {
        let (presses, _) = after(50.0, &[(100, None, FrameFlags::default())]);
        assert!(!presses.is_touched() && !presses.is_pressed());
    }
}
