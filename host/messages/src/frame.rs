//! Frame: a scan as messages, and back.

use crate::{
    cdr,
    clock::Clock,
    dermatome::{Contact, ContactArray, Health, Image, Measurements, Scope, Stamp},
    standard::{Header, Time},
    topic::{Packed, Topic},
};
use dermatome_link::{
    ScanFrame,
    assemble::{self, HealthReport},
    pose::Pose,
};
use dermatome_shared::{
    contact::{self, Evidence},
    frame::FrameFlags,
    protocol::{FrameStamp, PackedImage, SlotSamples},
    track::Identity,
};
use serde::Serialize;

/// In whose frame a skin's places are given.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Place {
    /// Name of the frame: the robot link's, or the skin's own.
    pub frame_id: String,
    /// Where the skin lies on the link; none where places are in the skin's own frame.
    pub pose: Option<Pose>,
}

/// How the scope's samples lie in time.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ScopeTiming {
    /// Samples at the start that are left out.
    pub settling: u16,
    /// Samples of a carrier period.
    pub period: u16,
    /// 1/s
    pub sample_rate: u32,
}

/// Makes messages of a board's frames.
#[derive(Clone, Debug, Default)]
pub struct Outlook {
    /// Where the skin lies.
    pub place: Place,
    /// Of the drive in effect.
    pub scope: ScopeTiming,
    clock: Clock,
}

impl Place {
    /// On a link, or by itself under the skin's name.
    #[must_use]
    pub fn of(skin: &str, pose: Option<&Pose>) -> Self {
        let frame_id = pose.map_or(skin, |pose| pose.link.as_str()).to_owned();
        Self { frame_id, pose: pose.cloned() }
    }

    /// A point of the skin's frame, m.
    #[must_use]
    pub fn point(&self, point: [f64; 3]) -> [f64; 3] {
        self.pose.as_ref().map_or(point, |pose| pose.point(point))
    }

    /// A contact of the skin's frame.
    #[must_use]
    pub fn contact(&self, contact: &contact::Contact) -> contact::Contact {
        self.pose.as_ref().map_or(*contact, |pose| pose.contact(contact))
    }

    /// A header of now.
    #[must_use]
    pub fn header(&self, time_ns: u64) -> Header {
        Header { stamp: Time::of_nanoseconds(time_ns), frame_id: self.frame_id.clone() }
    }
}

impl Outlook {
    /// For a skin that lies there.
    #[must_use]
    pub fn new(place: Place) -> Self {
        Self { place, ..Self::default() }
    }

    /// The messages that somebody wants of a frame that has come at this time, ns since 1970.
    pub fn messages(&mut self, frame: &ScanFrame, now_ns: u64, wants: impl Fn(Topic) -> bool) -> Vec<Packed> {
        let mut packed = Vec::new();
        let taken = frame.at.map_or(now_ns, |at| self.clock.host_time(at.timestamp_us, now_ns));
        let mut put = |topic, bytes: Vec<u8>| {
            packed.push(Packed { topic, log_time: now_ns, publish_time: taken, bytes: bytes.into() });
        };
        let header = self.place.header(taken);
        if let Some(samples) = frame.scope.as_ref().filter(|_| wants(Topic::Scope)) {
            put(Topic::Scope, cdr::encode(&self.scope(samples, &header)));
        }
        let Some(at) = frame.at else { return packed };
        let stamp = || Stamp {
            header: header.clone(),
            sequence: at.sequence,
            device_time_us: at.timestamp_us,
            flags: at.flags.0,
        };
        if let Some(measurements) = frame.measurements.as_ref().filter(|_| wants(Topic::Measurements)) {
            put(Topic::Measurements, cdr::encode(&Measurements::new(stamp(), measurements)));
        }
        if let Some(report) = frame.health.as_ref().filter(|_| wants(Topic::Health)) {
            put(Topic::Health, cdr::encode(&Health::new(stamp(), report)));
        }
        if let Some(image) = frame.image.as_ref().filter(|_| wants(Topic::Image)) {
            put(Topic::Image, encode_image(stamp(), image));
        }
        if let Some(contacts) = frame.contacts.as_ref().filter(|_| wants(Topic::Contacts)) {
            let contacts = contacts.iter().map(|contact| Contact::new(&self.place.contact(contact)));
            let array = ContactArray { stamp: stamp(), contacts: contacts.collect() };
            put(Topic::Contacts, cdr::encode(&array));
        }
        packed
    }

    fn scope(&self, samples: &SlotSamples, header: &Header) -> Scope {
        let ScopeTiming { settling, period, sample_rate } = self.scope;
        Scope {
            header: header.clone(),
            slot: samples.slot,
            gain: samples.gain,
            settling,
            period,
            sample_rate,
            samples: samples.samples.to_vec(),
        }
    }
}

/// As [`Image`], without a copy of it.
fn encode_image(stamp: Stamp, image: &PackedImage) -> Vec<u8> {
    #[derive(Serialize)]
    struct Borrowed<'a> {
        stamp: Stamp,
        exponent: i8,
        mantissas: &'a [i16],
    }
    cdr::encode(&Borrowed { stamp, exponent: image.exponent, mantissas: &image.mantissas })
}

impl Stamp {
    /// As a board gives it.
    #[must_use]
    pub fn at(&self) -> FrameStamp {
        FrameStamp {
            sequence: self.sequence,
            timestamp_us: self.device_time_us,
            flags: FrameFlags(self.flags),
        }
    }
}

impl Image {
    /// The image as it came; none where it has more pixels than a board makes.
    #[must_use]
    pub fn packed(&self) -> Option<PackedImage> {
        let mantissas = self.mantissas.as_slice().try_into().ok()?;
        Some(PackedImage { exponent: self.exponent, mantissas })
    }
}

impl Measurements {
    fn new(stamp: Stamp, measurements: &assemble::Measurements) -> Self {
        let codes = |codes: &[dermatome_shared::units::AdcCode]| codes.iter().map(|code| code.0).collect();
        Self { stamp, in_phase: codes(&measurements.codes), quadrature: codes(&measurements.quadrature) }
    }
}

/// NaN for what is not known.
fn or_nan(value: Option<f32>) -> f32 {
    value.unwrap_or(f32::NAN)
}

/// None for NaN.
fn unless_nan(value: f32) -> Option<f32> {
    (!value.is_nan()).then_some(value)
}

impl Health {
    fn new(stamp: Stamp, report: &HealthReport) -> Self {
        let HealthReport { health, vitals, drift, missed } = report;
        Self {
            stamp,
            contact_impedance: health.contact_impedance.to_vec(),
            open: health.open.0,
            shorted: health.shorted.0,
            worse: health.worse.0,
            reciprocity_error: or_nan(health.reciprocity_error),
            temperature: or_nan(vitals.temperature),
            load: vitals.load,
            free_stack: vitals.free_stack,
            drift: *drift,
            missed: *missed,
        }
    }
}

impl Contact {
    /// Of a contact as a board gives it.
    #[must_use]
    pub fn new(contact: &contact::Contact) -> Self {
        let (identity, evidence) = (contact.identity, contact.evidence);
        Self {
            is_tracked: identity.is_some(),
            id: identity.map_or(0, |identity| identity.number),
            merged: identity.and_then(|identity| identity.merged).unwrap_or(0),
            split_from: identity.and_then(|identity| identity.split_from).unwrap_or(0),
            position: contact.position.into(),
            normal: contact.normal.into(),
            velocity: identity.map_or([0.0; 3], |identity| identity.velocity).into(),
            area: contact.area,
            strength: contact.strength,
            peak: contact.peak,
            pressure: or_nan(contact.pressure),
            force: or_nan(contact.force()),
            load_area: or_nan(contact.load_area),
            significance: or_nan(evidence.map(|it| it.significance)),
            position_deviation: or_nan(evidence.map(|it| it.position_deviation)),
            strength_deviation: or_nan(evidence.map(|it| it.strength_deviation)),
        }
    }

    /// As a board gives it.
    #[must_use]
    pub fn contact(&self) -> contact::Contact {
        let known = |number: u32| (number > 0).then_some(number);
        let evidence = unless_nan(self.significance).map(|significance| Evidence {
            significance,
            position_deviation: self.position_deviation,
            strength_deviation: self.strength_deviation,
        });
        let identity = self.is_tracked.then(|| Identity {
            number: self.id,
            velocity: self.velocity.narrow(),
            merged: known(self.merged),
            split_from: known(self.split_from),
        });
        contact::Contact {
            position: self.position.narrow(),
            normal: self.normal.narrow(),
            area: self.area,
            strength: self.strength,
            peak: self.peak,
            pressure: unless_nan(self.pressure),
            load_area: unless_nan(self.load_area),
            evidence,
            identity,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use dermatome_link::assemble::Measurements as Codes;
    use dermatome_shared::units::AdcCode;
    use proptest::prelude::*;

    fn contact(number: u32, strength: f32, with: bool) -> contact::Contact {
        contact::Contact {
            position: [0.01, -0.002, strength],
            normal: [0.0, 0.0, 1.0],
            area: 4e-6,
            strength,
            peak: 2.0 * strength,
            pressure: with.then_some(1234.5),
            load_area: with.then_some(1e-4),
            evidence: with.then_some(Evidence {
                significance: 7.5,
                position_deviation: 1e-3,
                strength_deviation: 0.1,
            }),
            identity: with.then_some(Identity {
                number,
                velocity: [0.1, 0.2, 0.3],
                merged: Some(number + 1),
                split_from: None,
            }),
        }
    }

    proptest! {
        #[test]
        fn a_frame_comes_back_bit_for_bit(
            codes in prop::collection::vec(any::<i32>(), 0..208),
            mantissas in prop::collection::vec(any::<i16>(), 0..1024),
            exponent in 3_i8..20,
            number in 1_u32..u32::MAX,
            strength in -1.0_f32..1.0,
            with: bool,
        ) {
            let at = FrameStamp { sequence: 7, timestamp_us: 1_250_000, flags: FrameFlags(0x0a05) };
            let image = PackedImage { exponent, mantissas: mantissas.as_slice().try_into().unwrap() };
            let contacts = [contact(number, strength, with)];
            let codes: Vec<AdcCode> = codes.into_iter().map(AdcCode).collect();
            let frame = ScanFrame {
                at: Some(at),
                measurements: Some(Codes { codes: codes.clone(), quadrature: Vec::new() }),
                image: Some(image.clone()),
                contacts: Some(contacts.into_iter().collect()),
                ..ScanFrame::default()
            };
            let messages = Outlook::new(Place::of("palm", None)).messages(&frame, 1_700_000_000_000_000_001, |_| true);
            let of = |topic| messages.iter().find(|message| message.topic == topic).unwrap();
            let back: Image = cdr::decode(&of(Topic::Image).bytes).unwrap();
            prop_assert_eq!(back.packed(), Some(image));
            prop_assert_eq!(back.stamp.at(), at);
            let back: Measurements = cdr::decode(&of(Topic::Measurements).bytes).unwrap();
            prop_assert_eq!(back.in_phase, codes.iter().map(|code| code.0).collect::<Vec<_>>());
            let back: ContactArray = cdr::decode(&of(Topic::Contacts).bytes).unwrap();
            prop_assert_eq!(back.contacts[0].contact(), contacts[0]);
            prop_assert_eq!(of(Topic::Image).log_time, 1_700_000_000_000_000_001);
        }

        #[test]
        fn bytes_that_are_no_message_are_an_error(bytes in prop::collection::vec(any::<u8>(), 0..200)) {
            let _ = cdr::decode::<ContactArray>(&bytes);
            let mut framed = vec![0, 1, 0, 0];
            framed.extend_from_slice(&bytes);
            let _ = cdr::decode::<ContactArray>(&framed);
            let _ = cdr::decode::<Image>(&framed);
        }
    }
}
