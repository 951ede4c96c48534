//! Frames: the messages of a recording, joined to the frames that a board sent.

use crate::read::{Problem, ReadError, Recording};
use dermatome_link::{ScanFrame, assemble::HealthReport};
use dermatome_messages::{
    Packed, Topic, cdr,
    dermatome::{ContactArray, Health, Image, Measurements, Reference, Stamp},
};
use dermatome_shared::{
    contact::Contact,
    frame::Frame,
    health::{self, ElectrodeSet, Vitals},
    protocol::{FrameStamp, PackedImage},
    units::AdcCode,
};

/// One frame of a recording.
#[derive(Clone, Debug, PartialEq)]
pub struct RecordedFrame {
    /// Which.
    pub at: FrameStamp,
    /// When it came, by the host's clock, ns since 1970.
    pub log_time: u64,
    /// Raw codes, in phase and in quadrature; none where they were not recorded.
    pub codes: Option<[Vec<AdcCode>; 2]>,
    /// What it says of the board and its skin.
    pub health: Option<HealthReport>,
    /// The image that the board made.
    pub image: Option<PackedImage>,
    /// The contacts that the board found, in the recording's frame of places.
    pub contacts: Option<Vec<Contact>>,
}

/// What a recording holds, in order.
#[derive(Clone, Debug, PartialEq)]
pub enum Item {
    /// A new reference begins with the next frame.
    Reference(Reference),
    /// A frame.
    Frame(Box<RecordedFrame>),
}

impl RecordedFrame {
    /// Of a frame that has come from a board at this time, ns since 1970; none of samples of the scope alone.
    #[must_use]
    pub fn of(frame: &ScanFrame, log_time: u64) -> Option<Self> {
        let codes = frame.measurements.as_ref();
        Some(Self {
            at: frame.at?,
            log_time,
            codes: codes.map(|of| [of.codes.clone(), of.quadrature.clone()]),
            health: frame.health.clone(),
            image: frame.image.clone(),
            contacts: frame.contacts.as_ref().map(|contacts| contacts.to_vec()),
        })
    }

    fn new(stamp: &Stamp, log_time: u64) -> Self {
        Self { at: stamp.at(), log_time, codes: None, health: None, image: None, contacts: None }
    }

    /// As a pipeline takes it; none where its raw codes are not there, or are more than a frame has.
    #[must_use]
    pub fn raw(&self) -> Option<Frame> {
        let [codes, quadrature] = self.codes.as_ref()?;
        Some(Frame {
            sequence: self.at.sequence,
            timestamp_us: self.at.timestamp_us,
            flags: self.at.flags,
            codes: codes.as_slice().try_into().ok()?,
            quadrature: quadrature.as_slice().try_into().ok()?,
            ..Frame::default()
        })
    }

    /// The health that the board found; of a board that tells none, nothing is wrong.
    #[must_use]
    pub fn health(&self) -> health::Health {
        self.health.as_ref().map(|report| report.health.clone()).unwrap_or_default()
    }
}

/// Parts of frames.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Parts {
    /// Raw codes.
    pub codes: bool,
    /// Health.
    pub health: bool,
    /// Images.
    pub images: bool,
    /// Contacts.
    pub contacts: bool,
}

impl Parts {
    /// All of them.
    pub const ALL: Self = Self { codes: true, health: true, images: true, contacts: true };
    /// None: which frames there are, and when.
    pub const NONE: Self = Self { codes: false, health: false, images: false, contacts: false };
}

/// The frames of a recording.
pub struct Frames {
    recording: Recording,
    wanted: Parts,
    arriving: Option<Box<RecordedFrame>>,
    /// What came after the frame that was given last.
    next: Option<Item>,
}

impl Frames {
    /// Of a recording from its start on.
    #[must_use]
    pub fn of(recording: Recording) -> Self {
        Self { recording, wanted: Parts::ALL, arriving: None, next: None }
    }

    /// With these parts alone: the others stay none, and their messages are not decoded.
    #[must_use]
    pub fn only(self, wanted: Parts) -> Self {
        Self { wanted, ..self }
    }

    /// The recording.
    #[must_use]
    pub fn recording(&self) -> &Recording {
        &self.recording
    }

    /// The next reference or frame; none at the end.
    pub fn next_item(&mut self) -> Result<Option<Item>, ReadError> {
        if let Some(item) = self.next.take() {
            return Ok(Some(item));
        }
        while let Some(packed) = self.recording.message()? {
            let damaged = |reason: cdr::CdrError| {
                self.recording
                    .refuse(Problem::Message { topic: packed.topic.name(), reason: reason.to_string() })
            };
            if packed.topic == Topic::Reference {
                let reference = Item::Reference(cdr::decode(&packed.bytes).map_err(damaged)?);
                let Some(frame) = self.arriving.take() else { return Ok(Some(reference)) };
                self.next = Some(reference);
                return Ok(Some(Item::Frame(frame)));
            }
            let Some((stamp, part)) = part(&packed, self.wanted).map_err(damaged)? else { continue };
            let is_new = self.arriving.as_ref().is_none_or(|frame| frame.at != stamp.at());
            let begun = || Box::new(RecordedFrame::new(&stamp, packed.log_time));
            let complete = if is_new { self.arriving.replace(begun()) } else { None };
            if let Some(frame) = &mut self.arriving {
                part.put(frame);
            }
            if let Some(frame) = complete {
                return Ok(Some(Item::Frame(frame)));
            }
        }
        Ok(self.arriving.take().map(Item::Frame))
    }
}

/// A part of a frame.
enum Part {
    Measurements(Measurements),
    Health(Health),
    Image(Image),
    Contacts(ContactArray),
    /// One that is not wanted.
    Other,
}

fn part(packed: &Packed, wanted: Parts) -> Result<Option<(Stamp, Part)>, cdr::CdrError> {
    let bytes = &packed.bytes;
    Ok(match packed.topic {
        Topic::Measurements if wanted.codes => {
            let message: Measurements = cdr::decode(bytes)?;
            Some((message.stamp.clone(), Part::Measurements(message)))
        }
        Topic::Health if wanted.health => {
            let message: Health = cdr::decode(bytes)?;
            Some((message.stamp.clone(), Part::Health(message)))
        }
        Topic::Image if wanted.images => {
            let message: Image = cdr::decode(bytes)?;
            Some((message.stamp.clone(), Part::Image(message)))
        }
        Topic::Contacts if wanted.contacts => {
            let message: ContactArray = cdr::decode(bytes)?;
            Some((message.stamp.clone(), Part::Contacts(message)))
        }
        // Each begins with the frame that it belongs to.
        Topic::Measurements | Topic::Health | Topic::Image | Topic::Contacts => {
            Some((cdr::decode(bytes)?, Part::Other))
        }
        _ => None,
    })
}

impl Part {
    fn put(self, frame: &mut RecordedFrame) {
        match self {
            Self::Measurements(message) => {
                let codes = |codes: Vec<i32>| codes.into_iter().map(AdcCode).collect();
                frame.codes = Some([codes(message.in_phase), codes(message.quadrature)]);
            }
            Self::Health(message) => frame.health = Some(report(&message)),
            Self::Image(message) => frame.image = message.packed(),
            Self::Other => {}
            Self::Contacts(message) => {
                frame.contacts = Some(
                    message.contacts.iter().map(dermatome_messages::dermatome::Contact::contact).collect(),
                );
            }
        }
    }
}

fn report(message: &Health) -> HealthReport {
    let known = |value: f32| (!value.is_nan()).then_some(value);
    let health = health::Health {
        contact_impedance: message.contact_impedance.as_slice().try_into().unwrap_or_default(),
        open: ElectrodeSet(message.open),
        shorted: ElectrodeSet(message.shorted),
        worse: ElectrodeSet(message.worse),
        reciprocity_error: known(message.reciprocity_error),
    };
    let vitals = Vitals {
        temperature: known(message.temperature),
        load: message.load,
        free_stack: message.free_stack,
    };
    HealthReport { health, vitals, drift: message.drift, missed: message.missed }
}
