//! Track: contacts of one frame after another, with identities that stay.
//!
//! Each track is expected where its velocity takes it. The pairs of a track and a contact that lie closest belong
//! together, closest first, unless they lie farther apart than a finger moves between frames; then two tracks exchange
//! their contacts where that makes the sum of the squares of both distances less. A contact without a track starts one. A
//! track without a contact waits, and ends when it has waited too long, so that a contact that is lost for a few frames
//! keeps its number.
//!
//! Contacts that come too close are one: the sheet cannot tell them apart. A track whose contact is lost beside another
//! one, which became stronger by as much, has *merged* with it. Where one comes out of it again, soon enough for
//! both to be where their velocities took them, it is the one that merged; later it is a new one that *split* from it,
//! since nobody knows which is which.

use super::{Contact, Contacts};
use crate::{image::surface::square_distance, limits::MAX_CONTACTS};
use heapless::Vec;
use postcard_schema::Schema;
use serde::{Deserialize, Serialize};

/// Most tracks: those that touch, and as many that wait.
const MAX_TRACKS: usize = 2 * MAX_CONTACTS;
/// A velocity is that of about this time, s; of all frames as long as a track is younger.
const VELOCITY_TIME: f32 = 0.06;
/// Fastest that a contact may move off where it is expected, m/s: fingers swipe with 1.5 m/s and more.
const FASTEST: f32 = 1.75;
/// Frames that are farther apart than this do not let it move any farther, s.
const LONGEST: f32 = 0.03;
/// How long a track waits for its contact, s; at least until the next frame.
const TIMEOUT: f32 = 0.3;
/// How far a contact may lie from where it is expected, in radii of the standard press; farther where frames are rare.
const REACH: f32 = 2.65;
/// Contacts closer than this may have been one in the frame before, or may be in the next, in radii of the standard press.
const ONE: f32 = 5.0;
/// One that merges brings as much as this share of its strength to the other, and takes it along where it splits.
const BRINGS: f32 = 0.5;
/// Radius where a patch has no standard press, m.
const RADIUS: f32 = 0.0095;

/// Which contact it is, through time.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, Schema)]
pub struct Identity {
    /// Its number; no other contact gets it until the board restarts.
    pub number: u32,
    /// Velocity, m/s.
    pub velocity: [f32; 3],
    /// Number of the contact that became one with it, as long as they are one; of several the last.
    pub merged: Option<u32>,
    /// Number of the contact that it came out of.
    pub split_from: Option<u32>,
}

/// One contact through time.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Track {
    number: u32,
    /// The one that merged with it last.
    merged: Option<u32>,
    /// The one that it came out of.
    split_from: Option<u32>,
    /// The one that it merged with.
    into: Option<u32>,
    motion: Motion,
    /// The same before the latest frame, or before another one merged with it.
    before: Motion,
    strength: f32,
    /// By how much that grew in the latest frame.
    growth: f32,
    /// Frames in which it was seen.
    frames: u32,
    /// Its contact in the latest frame.
    contact: Option<usize>,
}

/// Where a contact was last seen, and how it moved.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Motion {
    /// m.
    position: [f32; 3],
    /// m/s.
    velocity: [f32; 3],
    seen_us: u64,
}

/// Gives contacts their identities.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Tracker {
    tracks: Vec<Track, MAX_TRACKS>,
    /// Number of the latest new one.
    number: u32,
    frame_us: u64,
}

impl Tracker {
    /// Forgets all contacts, but not which numbers were given.
    pub fn forget(&mut self) {
        self.tracks.clear();
    }

    /// Gives identities to the contacts of the frame of this time, on a skin whose standard press has this radius, m; 0
    /// where it has none.
    // Not inlined, so that what it needs of the stack is free again for all else.
    #[inline(never)]
    pub fn follow(&mut self, now_us: u64, radius: f32, contacts: &mut Contacts) {
        let radius = if radius > 0.0 { radius } else { RADIUS };
        let last_us = core::mem::replace(&mut self.frame_us, now_us);
        self.tracks
            .retain(|Track { motion, .. }| motion.seen_us >= last_us || motion.unseen(now_us) <= TIMEOUT);
        self.tracks.iter_mut().for_each(|track| track.contact = None);
        while let Some((track, contact)) = self.closest(now_us, radius, contacts) {
            self.tracks[track].contact = Some(contact);
        }
        self.take_back(radius, contacts);
        self.exchange(now_us, contacts);
        self.part();
        for track in &mut self.tracks {
            if let Some(contact) = track.contact {
                track.see(now_us, &contacts[contact]);
            }
        }
        self.merge(now_us, last_us, radius);
        for index in 0..contacts.len() {
            let owner = self.tracks.iter().find(|track| track.contact == Some(index)).map(Track::identity);
            contacts[index].identity = owner.or_else(|| self.begin(now_us, radius, &contacts[index]));
        }
    }

    /// The closest pair of a track and a contact that have no other.
    fn closest(&self, now_us: u64, radius: f32, contacts: &[Contact]) -> Option<(usize, usize)> {
        let mut closest = None;
        let mut least = f32::INFINITY;
        for (contact, at) in contacts.iter().enumerate().filter(|(contact, _)| self.is_free(*contact)) {
            for (track, Track { motion, .. }) in
                self.tracks.iter().enumerate().filter(|(_, track)| track.contact.is_none())
            {
                let reach = (REACH * radius).max(FASTEST * motion.unseen(now_us).min(LONGEST));
                let away = square_distance(motion.expected(now_us), at.position);
                if away <= reach * reach && away < least {
                    (least, closest) = (away, Some((track, contact)));
                }
            }
        }
        closest
    }

    fn is_free(&self, contact: usize) -> bool {
        self.tracks.iter().all(|track| track.contact != Some(contact))
    }

    /// Of a contact without a track, which comes out of another one: the track that merged with that one.
    fn take_back(&mut self, radius: f32, contacts: &[Contact]) {
        for track in 0..self.tracks.len() {
            let Track { into: Some(into), contact: None, .. } = self.tracks[track] else { continue };
            let Some(host) = self.tracks.iter().find(|track| track.number == into) else { continue };
            let Some(stays) = host.contact else { continue };
            let lost = host.strength - contacts[stays].strength;
            let comes_out =
                |contact: &usize| self.is_free(*contact) && host.is_beside(&contacts[*contact], lost, radius);
            self.tracks[track].contact = (0..contacts.len()).find(comes_out);
        }
    }

    /// Tracks exchange their contacts where that brings these closer to where they are expected.
    fn exchange(&mut self, now_us: u64, contacts: &[Contact]) {
        for one in 0..self.tracks.len() {
            for other in 0..one {
                let [a, b] = [self.tracks[one], self.tracks[other]];
                let (Some(of_a), Some(of_b)) = (a.contact, b.contact) else { continue };
                let expected =
                    [a.motion_beside(&b), b.motion_beside(&a)].map(|motion| motion.expected(now_us));
                let away = |track: usize, contact: usize| {
                    square_distance(expected[track], contacts[contact].position)
                };
                if away(0, of_b) + away(1, of_a) < away(0, of_a) + away(1, of_b) {
                    (self.tracks[one].contact, self.tracks[other].contact) = (Some(of_b), Some(of_a));
                }
            }
        }
    }

    /// Tracks that had merged with others and have contacts again move on by themselves, and so do those others.
    fn part(&mut self) {
        for track in 0..self.tracks.len() {
            let Track { into: Some(into), contact: Some(_), .. } = self.tracks[track] else { continue };
            self.tracks[track].into = None;
            if let Some(host) = self.tracks.iter_mut().find(|track| track.number == into) {
                (host.merged, host.motion) = (None, host.before);
            }
        }
    }

    /// Tracks that have just lost their contact beside one that grew by as much have merged with it.
    fn merge(&mut self, now_us: u64, last_us: u64, radius: f32) {
        for track in 0..self.tracks.len() {
            let lost = self.tracks[track];
            if lost.contact.is_some() || lost.motion.seen_us != last_us || now_us == last_us {
                continue;
            }
            let reach = ONE * ONE * radius * radius;
            let expected = lost.motion.expected(now_us);
            let is_host = |host: &&mut Track| {
                host.contact.is_some()
                    && host.growth >= BRINGS * lost.strength
                    && square_distance(host.motion.position, expected) < reach
            };
            if let Some(host) = self.tracks.iter_mut().find(is_host) {
                host.merged = Some(lost.number);
                for (both, own) in
                    host.motion.velocity.iter_mut().zip(host.before.velocity.iter().zip(lost.motion.velocity))
                {
                    *both = (own.0 + own.1) / 2.0;
                }
                self.tracks[track].into = Some(host.number);
            }
        }
    }

    /// A new track of a contact, perhaps one that came out of another; none if all touch.
    fn begin(&mut self, now_us: u64, radius: f32, contact: &Contact) -> Option<Identity> {
        if self.tracks.is_full() {
            // Of those that wait, the one that has done so longest.
            let longest = (0..MAX_TRACKS).min_by_key(|&track| self.tracks[track].motion.seen_us)?;
            self.tracks.swap_remove(longest);
        }
        let is_host =
            |track: &&mut Track| track.contact.is_some() && track.is_beside(contact, -track.growth, radius);
        let host = self.tracks.iter_mut().find(is_host);
        let split_from = host.map(|host| {
            host.merged = None;
            host.number
        });
        self.number = self.number.wrapping_add(1);
        let motion = Motion { position: contact.position, velocity: [0.0; 3], seen_us: now_us };
        let track = Track {
            number: self.number,
            merged: None,
            split_from,
            into: None,
            motion,
            before: motion,
            strength: contact.strength,
            growth: 0.0,
            frames: 1,
            contact: None,
        };
        self.tracks.push(track).ok().map(|()| track.identity())
    }
}

impl Track {
    fn identity(&self) -> Identity {
        let Self { number, merged, split_from, .. } = *self;
        Identity { number, velocity: self.motion.velocity, merged, split_from }
    }

    /// Whether a contact lies so close, and is so strong beside what this one has lost, that it may have come out of it.
    fn is_beside(&self, contact: &Contact, lost: f32, radius: f32) -> bool {
        lost >= BRINGS * contact.strength
            && square_distance(self.motion.position, contact.position) < ONE * ONE * radius * radius
    }

    /// Its motion where another one has a contact too: as long as they were one, it moved as both.
    fn motion_beside(&self, other: &Self) -> &Motion {
        if other.into == Some(self.number) { &self.before } else { &self.motion }
    }

    fn see(&mut self, now_us: u64, contact: &Contact) {
        if self.merged.is_none() {
            self.before = self.motion;
        }
        let seconds = self.motion.unseen(now_us);
        let expected = self.motion.expected(now_us);
        if seconds > 0.0 {
            let gain = (seconds / VELOCITY_TIME).max(1.0 / self.frames as f32).min(1.0);
            for (axis, velocity) in self.motion.velocity.iter_mut().enumerate() {
                *velocity += gain * (contact.position[axis] - expected[axis]) / seconds;
            }
        }
        (self.motion.position, self.motion.seen_us) = (contact.position, now_us);
        (self.growth, self.strength) = (contact.strength - self.strength, contact.strength);
        self.frames = self.frames.saturating_add(1);
    }
}

impl Motion {
    /// Where the contact should be by now, m.
    fn expected(&self, now_us: u64) -> [f32; 3] {
        let seconds = self.unseen(now_us);
        [0, 1, 2].map(|axis| self.position[axis] + self.velocity[axis] * seconds)
    }

    /// Time since it was seen, s.
    fn unseen(&self, now_us: u64) -> f32 {
        now_us.saturating_sub(self.seen_us) as f32 * 1e-6
    }
}

#[cfg(test)]
mod tests;
