//! Contacts: those of a frame in the frame of a robot's link.

use crate::pose::Pose;
use dermatome_shared::{
    contact::{Contact, Contacts},
    pipeline::reflex::Reflexes,
    protocol::FrameStamp,
};
use serde::Serialize;

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
    /// What the patch's reflexes say; none without reflexes.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub reflexes: Option<LinkReflexes>,
}

/// What a patch's reflexes say.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct LinkReflexes {
    /// Rules that are tripped, from 1.
    pub tripped: Vec<usize>,
    /// Whether the board cannot tell.
    pub blind: bool,
    /// Loads, in strengths of the standard press, or pressed areas, m^2, when that changed: `[rule]`.
    pub values: Vec<f32>,
}

impl From<&Reflexes> for LinkReflexes {
    fn from(reflexes: &Reflexes) -> Self {
        let tripped = (0..reflexes.values.len()).filter(|&rule| reflexes.is_tripped(rule));
        Self {
            tripped: tripped.map(|rule| rule + 1).collect(),
            blind: reflexes.is_blind,
            values: reflexes.values.to_vec(),
        }
    }
}

/// A contact in the link's frame.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct LinkContact {
    /// Its number, the same from frame to frame.
    pub id: Option<u32>,
    /// Number of the contact that became one with it, as long as they are one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub merged: Option<u32>,
    /// Number of the contact that it came out of.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub split_from: Option<u32>,
    /// Centre of pressure, m.
    pub position_m: [f32; 3],
    /// Unit normal of the skin there.
    pub normal: [f32; 3],
    /// Velocity, m/s.
    pub velocity_m_s: Option<[f32; 3]>,
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

impl LinkFrame {
    /// The contacts of the scan `at`, in the skin's frame, on the link that it lies on with this pose.
    #[must_use]
    pub fn new(pose: &Pose, at: FrameStamp, contacts: &Contacts) -> Self {
        Self {
            sequence: at.sequence,
            time_s: at.timestamp_us as f64 / 1e6,
            flags: at.flags.words().collect(),
            link: pose.link.clone(),
            contacts: contacts.iter().map(|contact| LinkContact::new(pose.contact(contact))).collect(),
            fingers: None,
            reflexes: None,
        }
    }
}

impl LinkContact {
    /// A contact that is in the link's frame already.
    #[must_use]
    pub fn new(contact: Contact) -> Self {
        let Contact { identity, evidence, .. } = contact;
        Self {
            id: identity.map(|identity| identity.number),
            merged: identity.and_then(|identity| identity.merged),
            split_from: identity.and_then(|identity| identity.split_from),
            position_m: contact.position,
            normal: contact.normal,
            velocity_m_s: identity.map(|identity| identity.velocity),
            area_mm2: contact.area * 1e6,
            strength: contact.strength,
            pressure_kpa: contact.pressure.map(|pressure| pressure * 1e-3),
            force_n: contact.force(),
            significance: evidence.map(|evidence| evidence.significance),
            position_deviation_m: evidence.map(|evidence| evidence.position_deviation),
            strength_deviation: evidence.map(|evidence| evidence.strength_deviation),
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
    use dermatome_shared::{frame::FrameFlags, track::Identity};

    #[test]
    fn a_contact_is_given_on_the_link_with_who_it_is() {
        let pose =
            Pose { link: "palm".to_owned(), position: [0.0, 0.0, 1.0], orientation: [0.0, 0.0, 0.0, 1.0] };
        let contact = Contact {
            position: [0.01, 0.0, 0.0],
            normal: [0.0, 0.0, 1.0],
            area: 4e-6,
            strength: 0.5,
            peak: 1.0,
            pressure: Some(2e3),
            load_area: None,
            evidence: None,
            identity: Some(Identity {
                number: 4,
                velocity: [0.1, 0.0, 0.0],
                merged: Some(2),
                split_from: None,
            }),
        };
        let at = FrameStamp { sequence: 3, timestamp_us: 60_000, flags: FrameFlags::SATURATED };
        let found = LinkFrame::new(&pose, at, &[contact].into_iter().collect());
        assert_eq!((found.sequence, found.link.as_str(), found.time_s), (3, "palm", 0.06));
        assert_eq!(found.flags, ["saturated"]);
        let [contact] = found.contacts.as_slice() else { panic!("{found:?}") };
        assert_eq!((contact.id, contact.position_m), (Some(4), [0.01, 0.0, 1.0]));
        assert_eq!((contact.merged, contact.split_from), (Some(2), None));
        assert_eq!((contact.pressure_kpa, contact.force_n), (Some(2.0), None));
        assert_eq!(contact.velocity_m_s, Some([0.1, 0.0, 0.0]));
    }
}
