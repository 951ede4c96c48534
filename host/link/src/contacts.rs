//! Contacts: those of a frame in the frame of a robot's link, each with a number that stays.

use crate::pose::Pose;
use dermatome_shared::{
    contact::{Contact, Contacts},
    protocol::FrameStamp,
    track::Tracker,
};
use serde::Serialize;

/// A contact farther than this from where the last one was going is another one, m.
const REACH: f32 = 0.025;
/// A contact that is lost for as long keeps its number, us.
const LOST_TIMEOUT_US: u64 = 300_000;

/// Takes contacts of one frame after another into the frame of the link that the skin lies on.
#[derive(Clone, Debug)]
pub struct ContactTracker {
    pose: Pose,
    tracker: Tracker,
}

/// The contacts of one scan, as robot software reads them.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct LinkFrame {
    /// Running number of the scan.
    pub sequence: u32,
    /// When the scan ended, s of the board's clock.
    pub time_s: f64,
    /// What was wrong with the scan, in words.
    pub flags: Vec<&'static str>,
    /// Name of the link's frame.
    pub link: String,
    /// Strongest first.
    pub contacts: Vec<LinkContact>,
    /// Fingers that were fitted to the scan's voltages; none where nobody looked for them.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub fingers: Option<Vec<LinkFinger>>,
}

/// A contact in the link's frame.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct LinkContact {
    /// Its number, the same from frame to frame.
    pub id: Option<u32>,
    /// Centre of pressure, m.
    pub position_m: [f32; 3],
    /// Unit normal of the skin there.
    pub normal: [f32; 3],
    /// Area, mm^2.
    pub area_mm2: f32,
    /// Mean relative conductivity change.
    pub strength: f32,
    /// Pressure, kPa; none on a skin that is not calibrated.
    pub pressure_kpa: Option<f32>,
    /// Force, N; none on a skin whose calibration does not tell it.
    pub force_n: Option<f32>,
    /// By how many standard deviations it is above the noise, if the skin's contacts are found in the voltages.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub significance: Option<f32>,
    /// Standard deviation of the position along the skin, m; likewise.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub position_deviation_m: Option<f32>,
    /// Standard deviation of the strength; likewise.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub strength_deviation: Option<f32>,
}

/// A finger in the link's frame.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct LinkFinger {
    /// Where it presses, m.
    pub position_m: [f64; 3],
    /// Relative conductivity change.
    pub strength: f64,
}

impl ContactTracker {
    /// For a skin of this pose.
    #[must_use]
    pub fn new(pose: Pose) -> Self {
        Self { pose, tracker: Tracker::new(REACH, LOST_TIMEOUT_US) }
    }

    /// The contacts of the scan `at`, which comes after those before.
    pub fn take(&mut self, at: FrameStamp, contacts: &Contacts) -> LinkFrame {
        let contacts: Contacts = contacts.iter().map(|contact| self.pose.contact(contact)).collect();
        self.tracker.update(at.timestamp_us, &contacts);
        let contact = |contact| LinkContact::new(contact, &self.tracker, at.timestamp_us);
        LinkFrame {
            sequence: at.sequence,
            time_s: at.timestamp_us as f64 / 1e6,
            flags: at.flags.words().collect(),
            link: self.pose.link.clone(),
            contacts: contacts.iter().map(contact).collect(),
            fingers: None,
        }
    }
}

impl LinkContact {
    fn new(contact: &Contact, tracker: &Tracker, now_us: u64) -> Self {
        let track = tracker.touching(now_us).find(|track| track.contact == *contact);
        Self {
            id: track.map(|track| track.id),
            position_m: contact.position,
            normal: contact.normal,
            area_mm2: contact.area * 1e6,
            strength: contact.strength,
            pressure_kpa: contact.pressure.map(|pressure| pressure * 1e-3),
            force_n: contact.force(),
            significance: contact.evidence.map(|evidence| evidence.significance),
            position_deviation_m: contact.evidence.map(|evidence| evidence.position_deviation),
            strength_deviation: contact.evidence.map(|evidence| evidence.strength_deviation),
        }
    }
}

impl LinkFinger {
    /// A finger of the skin's frame (m) in the link's.
    #[must_use]
    pub fn new(position: [f64; 3], strength: f64, pose: &Pose) -> Self {
        Self { position_m: pose.point(position), strength }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use dermatome_shared::frame::FrameFlags;

    #[test]
    fn a_contact_that_moves_keeps_its_number_and_is_given_on_the_link() {
        let pose =
            Pose { link: "palm".to_owned(), position: [0.0, 0.0, 1.0], orientation: [0.0, 0.0, 0.0, 1.0] };
        let mut tracker = ContactTracker::new(pose);
        let frame = |sequence: u32, x: f32| {
            let contact = Contact {
                position: [x, 0.0, 0.0],
                normal: [0.0, 0.0, 1.0],
                area: 4e-6,
                strength: 0.5,
                peak: 1.0,
                pressure: Some(2e3),
                load_area: None,
                evidence: None,
            };
            let at = FrameStamp {
                sequence,
                timestamp_us: u64::from(sequence) * 20_000,
                flags: FrameFlags::SATURATED,
            };
            (at, [contact].into_iter().collect::<Contacts>())
        };
        for (sequence, x, id) in [(1, 0.0, 1), (2, 0.01, 1), (3, 0.1, 2)] {
            let (at, contacts) = frame(sequence, x);
            let found = tracker.take(at, &contacts);
            assert_eq!((found.sequence, found.link.as_str()), (sequence, "palm"));
            assert_eq!(found.flags, ["saturated"]);
            let [contact] = found.contacts.as_slice() else { panic!("{found:?}") };
            assert_eq!((contact.id, contact.position_m), (Some(id), [x, 0.0, 1.0]));
            assert_eq!((contact.pressure_kpa, contact.force_n), (Some(2.0), None));
        }
    }
}
