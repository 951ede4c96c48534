//! Felt: the contacts of the arm's skins against what touched them.

use super::{SECONDS, Trail};
use dermatome_body::Report;
use nalgebra::Point3;
use serde::Serialize;

/// Time after which a contact has to be there, s.
const SETTLED: f64 = 0.4;
/// A contact this near to a touch is of it, m.
const NEAR: f64 = 15e-3;
/// A touch is felt if so many of its frames have it.
const ENOUGH: f64 = 0.9;

/// What one skin feels.
#[derive(Clone, Debug)]
pub(crate) struct Felt {
    trail: Trail,
    frame_rate: f64,
    /// Number of the stream's first frame.
    first: Option<u32>,
    /// Script time of the last frame since it began, s.
    time: f64,
    /// Frames of all streams.
    frames: u64,
    tallies: Vec<Tally>,
    /// Contacts where nothing touched.
    ghosts: u64,
}

#[derive(Clone, Copy, Debug, Default)]
struct Tally {
    frames: u64,
    felt: u64,
    error_sum: f64,
    error_max: f64,
}

/// How a touch was felt.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub(crate) struct TouchScore {
    pub(crate) patch: String,
    pub(crate) link: String,
    /// In the link's frame, where it begins and ends.
    pub(crate) place_mm: [[f64; 3]; 2],
    /// Frames in which it should be felt.
    pub(crate) frames: u64,
    /// Those in which it was.
    pub(crate) frames_felt: u64,
    /// From its place in the link's frame; none where it was never felt.
    pub(crate) error_mm_mean: Option<f64>,
    pub(crate) error_mm_max: Option<f64>,
}

/// How all touches were felt.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub(crate) struct Scores {
    pub(crate) touches: Vec<TouchScore>,
    /// Contacts where nothing touched.
    pub(crate) contacts_of_nothing: u64,
}

impl Felt {
    /// Of a skin with such touches, whose board makes so many frames a second.
    pub(crate) fn new(trail: Trail, frame_rate: f64) -> Self {
        let tallies = vec![Tally::default(); trail.len()];
        Self { trail, frame_rate, first: None, time: 0.0, frames: 0, tallies, ghosts: 0 }
    }

    /// A new stream has begun, and with it the script.
    pub(crate) fn begin(&mut self) {
        self.first = None;
    }

    /// Script time that has been seen, s.
    pub(crate) fn seen(&self) -> f64 {
        self.time
    }

    /// Frames that have come.
    pub(crate) fn frames(&self) -> u64 {
        self.frames
    }

    /// Takes the contacts of a frame.
    pub(crate) fn take(&mut self, report: &Report) {
        self.frames += 1;
        let first = *self.first.get_or_insert(report.at.sequence);
        self.time = f64::from(report.at.sequence.wrapping_sub(first)) / self.frame_rate;
        let time = self.time % SECONDS;
        let contacts: Vec<[f64; 3]> =
            report.contacts.iter().map(|contact| contact.contact.position.map(f64::from)).collect();
        for touch in 0..self.trail.len() {
            self.score(touch, time, &contacts);
        }
        let is_of_nothing =
            |contact: &&[f64; 3]| !(0..self.trail.len()).any(|touch| self.explains(touch, time, contact));
        self.ghosts += contacts.iter().filter(is_of_nothing).count() as u64;
    }

    fn score(&mut self, touch: usize, time: f64, contacts: &[[f64; 3]]) {
        let [begin, _] = self.trail.times(touch);
        let Some(place) = self.trail.place(touch, time).filter(|_| time >= begin + SETTLED) else { return };
        let tally = &mut self.tallies[touch];
        tally.frames += 1;
        let nearest = contacts.iter().map(|contact| distance(*contact, place)).min_by(f64::total_cmp);
        if let Some(error) = nearest.filter(|error| *error < NEAR) {
            tally.felt += 1;
            tally.error_sum += error;
            tally.error_max = tally.error_max.max(error);
        }
    }

    /// Whether a touch is there, or was a moment ago, where a contact is.
    fn explains(&self, touch: usize, time: f64, contact: &[f64; 3]) -> bool {
        let [_, end] = self.trail.times(touch);
        let lasting = if (end..end + SETTLED).contains(&time) { end } else { time };
        self.trail.place(touch, lasting).is_some_and(|place| distance(*contact, place) < NEAR)
    }

    /// Adds its touches to the scores, the skin being called so, on this link.
    pub(crate) fn score_into(&self, scores: &mut Scores, patch: &str, link: &str) {
        scores.contacts_of_nothing += self.ghosts;
        scores.touches.extend(self.tallies.iter().enumerate().map(|(touch, tally)| {
            let place = |time| self.trail.place(touch, time).unwrap_or_default().map(|metres| metres * 1e3);
            let mm = |metres: f64| (tally.felt > 0).then_some(metres * 1e3);
            TouchScore {
                patch: patch.to_owned(),
                link: link.to_owned(),
                place_mm: self.trail.times(touch).map(place),
                frames: tally.frames,
                frames_felt: tally.felt,
                error_mm_mean: mm(tally.error_sum / tally.felt as f64),
                error_mm_max: mm(tally.error_max),
            }
        }));
    }
}

impl TouchScore {
    /// Whether it was there long enough, and felt.
    pub(crate) fn is_felt(&self) -> bool {
        self.frames > 0 && self.frames_felt as f64 >= ENOUGH * self.frames as f64
    }
}

impl Scores {
    /// Touches that were not felt; those of which no frame was seen count where all of the script was to be seen.
    pub(crate) fn missed(&self, is_whole: bool) -> usize {
        let counts = |touch: &&TouchScore| is_whole || touch.frames > 0;
        self.touches.iter().filter(counts).filter(|touch| !touch.is_felt()).count()
    }
}

fn distance(a: [f64; 3], b: [f64; 3]) -> f64 {
    nalgebra::distance(&Point3::from(a), &Point3::from(b))
}

#[cfg(test)]
mod tests {
    use super::*;
    use dermatome_body::contact::SkinContact;
    use dermatome_geometry::outline::Outline;
    use dermatome_link::pose::Pose;
    use dermatome_shared::{contact::Contact, frame::FrameFlags, protocol::FrameStamp};

    const FRAME_RATE: f64 = 25.0;

    fn hand() -> Trail {
        let mut trail = Trail::of("hand", &Outline::disc(0.04));
        let pose =
            Pose { link: "hand".to_owned(), position: [0.0, 0.0, 0.1], orientation: [0.0, 0.0, 0.0, 1.0] };
        trail.lay(&pose, |[x, y]| Point3::new(x, y, 0.0));
        trail
    }

    fn contact(place: [f64; 3]) -> SkinContact {
        let contact = Contact {
            position: place.map(|metres| metres as f32),
            normal: [0.0, 0.0, 1.0],
            area: 1e-4,
            strength: 0.5,
            peak: 1.0,
            pressure: None,
            load_area: None,
            evidence: None,
            identity: None,
        };
        SkinContact { contact, geometric_centre: place, wrench: None, pixels: Vec::new() }
    }

    /// Scores of a whole script whose frames have these contacts, by the places that are touched.
    fn scores(contacts: impl Fn(Vec<[f64; 3]>) -> Vec<[f64; 3]>) -> Scores {
        let (trail, mut felt) = (hand(), Felt::new(hand(), FRAME_RATE));
        for frame in 0..(SECONDS * FRAME_RATE) as u32 {
            let time = f64::from(frame) / FRAME_RATE;
            let touched = (0..trail.len()).filter_map(|touch| trail.place(touch, time)).collect();
            let at = FrameStamp { sequence: 100 + frame, timestamp_us: 0, flags: FrameFlags::default() };
            let contacts = contacts(touched).into_iter().map(contact).collect();
            felt.take(&Report { at, time_ns: 0, received_ns: 0, contacts, image: None });
        }
        let mut scores = Scores::default();
        felt.score_into(&mut scores, "hand", "hand");
        scores
    }

    #[test]
    fn contacts_beside_what_touches_are_felt_with_their_error() {
        let aside = |places: Vec<[f64; 3]>| places.iter().map(|[x, y, z]| [x + 3e-3, *y, z + 4e-3]).collect();
        let scores = scores(aside);
        assert_eq!((scores.missed(true), scores.contacts_of_nothing, scores.touches.len()), (0, 0, 3));
        for touch in &scores.touches {
            assert!((touch.error_mm_max.unwrap() - 5.0).abs() < 1e-3, "{touch:?}");
            assert!(touch.frames > 20 && touch.frames_felt == touch.frames, "{touch:?}");
        }
    }

    #[test]
    fn touches_without_a_contact_near_them_are_missed_and_contacts_elsewhere_are_of_nothing() {
        let nothing = scores(|_| Vec::new());
        assert_eq!((nothing.missed(true), nothing.contacts_of_nothing), (3, 0));
        let elsewhere = scores(|_| vec![[0.0, 0.0, 0.2]]);
        assert_eq!((elsewhere.missed(true), elsewhere.contacts_of_nothing), (3, 250));
    }

    #[test]
    fn touches_that_were_not_played_are_missed_only_where_they_should_have_been() {
        let mut scores = Scores::default();
        Felt::new(hand(), FRAME_RATE).score_into(&mut scores, "hand", "hand");
        assert_eq!((scores.missed(false), scores.missed(true)), (0, 3));
    }
}
