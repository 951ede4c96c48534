//! Track: contacts of one image after another, with identities that stay.
//!
//! Each track is expected where its velocity takes it; the pairs of a track and a contact that lie closest
//! belong together, closest first, unless they lie farther apart than a finger moves between frames. A
//! contact without a track starts one. A track without a contact waits, and ends when it has waited too long, so
//! that a contact that is lost for a few frames keeps its number.

use crate::{contact::Contact, limits::MAX_CONTACTS};
use heapless::Vec;

/// Most tracks: those that touch, and as many that wait.
pub const MAX_TRACKS: usize = 2 * MAX_CONTACTS;
/// A velocity is that of about this time, s; of all frames as long as a track is younger.
const VELOCITY_TIME: f32 = 0.06;
/// Fastest that a contact may move off where it is expected, m/s: fingers swipe with 1.5 m/s and more.
const FASTEST: f32 = 1.75;
/// Frames that are farther apart than this do not let it move any farther, s.
const LONGEST: f32 = 0.03;

/// One contact through time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Track {
    /// Its number; never used again by the same tracker.
    pub id: u32,
    /// The latest contact.
    pub contact: Contact,
    /// Velocity, m/s.
    pub velocity: [f32; 3],
    /// Frames in which it was seen.
    pub frames: u32,
    /// When it began, us.
    pub since_us: u64,
    /// When it was last seen, us.
    pub seen_us: u64,
}

/// Gives contacts their numbers.
#[derive(Clone, Debug, PartialEq)]
pub struct Tracker {
    /// How far a contact may lie from where it is expected, m; farther where frames are rare.
    pub reach: f32,
    /// How long a track waits for its contact, us.
    pub timeout_us: u64,
    tracks: Vec<Track, MAX_TRACKS>,
    next_id: u32,
}

impl Tracker {
    /// A tracker without tracks.
    #[must_use]
    pub const fn new(reach: f32, timeout_us: u64) -> Self {
        Self { reach, timeout_us, tracks: Vec::new(), next_id: 1 }
    }

    /// Takes the contacts of the image of this time; gives all tracks, those that wait as well.
    pub fn update(&mut self, now_us: u64, contacts: &[Contact]) -> &[Track] {
        let timeout_us = self.timeout_us;
        self.tracks.retain(|track| now_us.saturating_sub(track.seen_us) <= timeout_us);
        let mut free: Vec<Contact, MAX_CONTACTS> = contacts.iter().copied().take(MAX_CONTACTS).collect();
        let mut waiting: Vec<usize, MAX_TRACKS> = (0..self.tracks.len()).collect();
        while let Some((place, index)) = self.closest(now_us, &waiting, &free) {
            let (track, contact) = (waiting.swap_remove(place), free.swap_remove(index));
            if let Some(track) = self.tracks.get_mut(track) {
                track.follow(now_us, contact);
            }
        }
        for contact in free {
            self.begin(now_us, contact);
        }
        &self.tracks
    }

    /// The tracks that are touched at this time.
    pub fn touching(&self, now_us: u64) -> impl Iterator<Item = &Track> {
        self.tracks.iter().filter(move |track| track.seen_us == now_us)
    }

    /// The closest pair of a waiting track and a free contact: their places in the lists.
    fn closest(&self, now_us: u64, waiting: &[usize], free: &[Contact]) -> Option<(usize, usize)> {
        let mut closest = None;
        let mut least = f32::INFINITY;
        for (place, &track) in waiting.iter().enumerate() {
            let Some(track) = self.tracks.get(track) else { continue };
            let expected = track.expected(now_us);
            let reach = self.reach.max(FASTEST * track.unseen(now_us).min(LONGEST));
            for (index, contact) in free.iter().enumerate() {
                let apart = contact.position.iter().zip(expected).map(|(there, here)| there - here);
                let square = apart.map(|way| way * way).sum::<f32>();
                if square <= reach * reach && square < least {
                    (least, closest) = (square, Some((place, index)));
                }
            }
        }
        closest
    }

    fn begin(&mut self, now_us: u64, contact: Contact) {
        let track = Track {
            id: self.next_id,
            contact,
            velocity: [0.0; 3],
            frames: 1,
            since_us: now_us,
            seen_us: now_us,
        };
        if self.tracks.is_full() {
            // Of those that wait, the one that has done so longest.
            let Some(longest) = (0..self.tracks.len()).min_by_key(|&index| self.tracks[index].seen_us) else {
                return;
            };
            self.tracks.swap_remove(longest);
        }
        let _ = self.tracks.push(track);
        self.next_id = self.next_id.wrapping_add(1);
    }
}

impl Track {
    /// Where the contact should be by now, m.
    fn expected(&self, now_us: u64) -> [f32; 3] {
        let seconds = self.unseen(now_us);
        [0, 1, 2].map(|axis| self.contact.position[axis] + self.velocity[axis] * seconds)
    }

    /// Time since it was seen, s.
    fn unseen(&self, now_us: u64) -> f32 {
        now_us.saturating_sub(self.seen_us) as f32 * 1e-6
    }

    fn follow(&mut self, now_us: u64, contact: Contact) {
        let seconds = self.unseen(now_us);
        let expected = self.expected(now_us);
        if seconds > 0.0 {
            let gain = (seconds / VELOCITY_TIME).max(1.0 / self.frames as f32).min(1.0);
            for (axis, velocity) in self.velocity.iter_mut().enumerate() {
                *velocity += gain * (contact.position[axis] - expected[axis]) / seconds;
            }
        }
        self.frames = self.frames.saturating_add(1);
        (self.contact, self.seen_us) = (contact, now_us);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::vec::Vec;

    const FRAME_US: u64 = 20_000;

    fn at(x: f32, y: f32) -> Contact {
        Contact {
            position: [x, y, 0.0],
            normal: [0.0, 0.0, 1.0],
            area: 1e-4,
            strength: 0.5,
            peak: 1.0,
            pressure: None,
            load_area: None,
            evidence: None,
        }
    }

    fn tracker() -> Tracker {
        Tracker::new(0.03, 5 * FRAME_US)
    }

    /// Numbers of the tracks that touch, in the order of the contacts.
    fn ids(tracker: &Tracker, now_us: u64, contacts: &[Contact]) -> Vec<u32> {
        let of = |contact: &Contact| {
            tracker.touching(now_us).find(|track| track.contact == *contact).map_or(0, |track| track.id)
        };
        contacts.iter().map(of).collect()
    }

    #[test]
    fn fingers_that_pass_each_other_keep_their_numbers() {
        let mut tracker = tracker();
        for frame in 0..100_u16 {
            let x = -0.05 + 0.001 * f32::from(frame);
            // Listed the other way round in every second frame, as the strongest comes first.
            let mut contacts = [at(x, 0.004), at(-x, -0.004)];
            let now = u64::from(frame) * FRAME_US;
            if frame % 2 == 1 {
                contacts.reverse();
            }
            tracker.update(now, &contacts);
            let mut seen = ids(&tracker, now, &contacts);
            if frame % 2 == 1 {
                seen.reverse();
            }
            assert_eq!(seen, [1, 2], "frame {frame}");
        }
    }

    #[test]
    fn a_short_loss_keeps_the_number_and_a_long_one_does_not() {
        let mut tracker = tracker();
        let mut now = 0;
        let mut show = |tracker: &mut Tracker, contacts: &[Contact], frames: u64| {
            for _ in 0..frames {
                now += FRAME_US;
                tracker.update(now, contacts);
            }
            ids(tracker, now, contacts)
        };
        let finger = [at(0.01, 0.02)];
        assert_eq!(show(&mut tracker, &finger, 3), [1]);
        show(&mut tracker, &[], 4);
        assert_eq!(show(&mut tracker, &finger, 1), [1]);
        show(&mut tracker, &[], 6);
        assert_eq!(show(&mut tracker, &finger, 1), [2]);
    }

    #[test]
    fn a_finger_elsewhere_is_another_one() {
        let mut tracker = tracker();
        tracker.update(0, &[at(0.0, 0.0)]);
        tracker.update(FRAME_US, &[at(0.05, 0.0)]);
        assert_eq!(ids(&tracker, FRAME_US, &[at(0.05, 0.0)]), [2]);
        assert_eq!(tracker.touching(FRAME_US).count(), 1);
    }

    #[test]
    fn a_fast_swipe_is_one_finger_at_any_rate() {
        for (frame_us, speed) in [(20_000, 1.5), (2_500, 3.0), (2_500, 0.3), (100_000, 0.2)] {
            let mut tracker = Tracker::new(0.025, 300_000);
            let step = speed * frame_us as f32 * 1e-6;
            for frame in 0..8_u16 {
                tracker.update(u64::from(frame) * frame_us, &[at(step * f32::from(frame), 0.0)]);
            }
            assert_eq!(tracker.tracks.len(), 1, "{speed} m/s, {frame_us} us");
        }
    }

    #[test]
    fn fingers_that_were_one_contact_where_they_passed_keep_their_numbers() {
        for frame_us in [2_500, 20_000] {
            let mut tracker = Tracker::new(0.025, 300_000);
            let mut seen = Vec::new();
            for frame in 0..(400_000 / frame_us) {
                let now = frame * frame_us;
                let x = -0.05 + 0.25 * now as f32 * 1e-6;
                // 1 mm of jitter, and no telling them apart below 30 mm.
                let jitter = if frame % 2 == 0 { 5e-4 } else { -5e-4 };
                let contacts = if x.abs() < 0.0125 {
                    std::vec![at(jitter, jitter)]
                } else {
                    std::vec![at(x + jitter, 0.008 - jitter), at(-x - jitter, -0.008)]
                };
                tracker.update(now, &contacts);
                seen = ids(&tracker, now, &contacts);
            }
            assert_eq!(seen, [1, 2], "{frame_us} us");
        }
    }

    #[test]
    fn velocity_is_that_of_the_finger() {
        let mut tracker = tracker();
        for frame in 0..30_u16 {
            tracker.update(u64::from(frame) * FRAME_US, &[at(0.002 * f32::from(frame), 0.0)]);
        }
        let [x, y, z] = tracker.tracks[0].velocity;
        assert!((x - 0.1).abs() < 1e-3 && y.abs() < 1e-6 && z == 0.0, "{x} {y} {z}");
    }

    #[test]
    fn more_contacts_than_fit_never_lose_a_track_that_touches() {
        let mut tracker = Tracker::new(0.001, u64::MAX);
        for frame in 0..10_u16 {
            let contacts: Vec<_> =
                (0..8_u16).map(|i| at(0.01 * f32::from(i), 0.01 * f32::from(frame))).collect();
            let now = u64::from(frame) * FRAME_US;
            assert!(tracker.update(now, &contacts).len() <= MAX_TRACKS);
            assert_eq!(tracker.touching(now).count(), 8);
        }
    }

    #[test]
    fn a_clock_that_stands_still_or_nonsense_places_do_no_harm() {
        let mut tracker = tracker();
        for contact in [at(0.0, 0.0), at(0.001, 0.0), at(f32::NAN, 0.0), at(f32::INFINITY, 0.0)] {
            tracker.update(7, &[contact]);
        }
        tracker.update(0, &[at(0.0, 0.0)]);
        assert!(tracker.tracks.len() <= MAX_TRACKS);
    }
}
