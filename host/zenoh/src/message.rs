//! Message: what skins tell over the network, in postcard encoding.
//!
//! Each is accompanied by a [`Stamp`] (Zenoh's *attachment*), which begins with a [`Version`] whose encoding stays, so that
//! any two versions can tell each other apart. Places and forces are in the link's frame; times are by the clock of the
//! computer that holds the board, ns since 1970. Whoever decodes takes nothing for granted: bytes may be a stranger's.

use dermatome_body::{
    Report,
    asking::Outcome,
    contact::SkinContact,
    keeper::{Phase, Reference},
};
use dermatome_messages::dermatome::DriveRequest;
use dermatome_shared::{
    contact::Contact,
    health::{self, Vitals},
    limits::{MAX_CONTACTS, MAX_MEASUREMENTS, MAX_PIXELS},
    protocol::{FrameStamp, PackedImage},
};
use postcard_schema::key::hash::fnv1a64;
use serde::{Deserialize, Serialize, de::DeserializeOwned};
use std::fmt;

/// Version of the messages below. Grows with every change of them.
pub const MESSAGES: u16 = 1;
/// Most bytes of a message.
pub const MOST_BYTES: usize = 1 << 20;
/// Most letters of a text.
const MOST_OF_TEXT: usize = 500;

/// Which messages a program speaks.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Version {
    /// [`MESSAGES`]
    pub messages: u16,
    /// Hash of the types in them that boards speak too.
    pub types: [u8; 8],
}

impl Version {
    /// Of this program.
    pub const OURS: Self = Self {
        messages: MESSAGES,
        types: fnv1a64::hash_ty_path::<(FrameStamp, Contact, PackedImage, health::Health, Vitals)>("zenoh"),
    };
}

impl fmt::Display for Version {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}/{:016x}", self.messages, u64::from_be_bytes(self.types))
    }
}

/// What accompanies each message.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Stamp {
    /// Of the program that sent it.
    pub version: Version,
    /// Which run of the program.
    pub run: u64,
    /// Running number of this run's messages under this key: what is lost shows as a gap.
    pub number: u64,
}

/// Contacts of one frame.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Contacts {
    /// The frame, by the board.
    pub at: FrameStamp,
    /// When the scan ended.
    pub ended_ns: u64,
    /// Frames of the board that have not come to its computer.
    pub missing: u64,
    /// Strongest first.
    pub contacts: Vec<SkinContact>,
}

/// The image of one frame.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Image {
    /// The frame, by the board.
    pub at: FrameStamp,
    /// When the scan ended.
    pub ended_ns: u64,
    /// `[pixel]`; where they lie says [`Skin`].
    pub image: PackedImage,
}

/// What one frame says about the board and its skin.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Health {
    /// The frame, by the board.
    pub at: FrameStamp,
    /// Electrodes and current.
    pub health: health::Health,
    /// The board itself.
    pub vitals: Vitals,
    /// Drift of all voltages that is taken out of the images, relative.
    pub drift: f32,
    /// Times since the board's start at which samples were lost.
    pub missed: u32,
}

/// How a board stands.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct State {
    /// Name of its computer.
    pub computer: String,
    /// In one word.
    pub phase: Phase,
    /// Why, in words.
    pub text: String,
    /// Frames that have come.
    pub frames: u64,
    /// Frames that have not come.
    pub missing: u64,
    /// Times that the board was lost.
    pub losses: u64,
}

/// A skin and where it lies.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Skin {
    /// The skin file's text.
    pub file: String,
    /// The skin's origin on its link, m.
    pub position: [f64; 3],
    /// Turn from the skin's frame to the link's, a unit quaternion x, y, z, w.
    pub orientation: [f64; 4],
    /// Centres of its pixels on the link, m: `[pixel]`; empty before its board has shown its patch.
    pub centres: Vec<[f32; 3]>,
}

/// The reference that a board compares frames with.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Tare {
    /// When it was made; none where the board had it before.
    pub made_ns: Option<u64>,
    /// What the untouched skin measured, in codes: `[measurement]`.
    pub voltages: Vec<f64>,
}

impl Contacts {
    /// Of a frame as a body has it.
    #[must_use]
    pub fn new(report: &Report, missing: u64) -> Self {
        Self { at: report.at, ended_ns: report.time_ns, missing, contacts: report.contacts.clone() }
    }
}

impl From<&Reference> for Tare {
    fn from(reference: &Reference) -> Self {
        Self { made_ns: reference.made_ns, voltages: reference.voltages.clone() }
    }
}

/// Why bytes are no message.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum DecodeError {
    /// The sender speaks another version.
    #[error("messages of version {theirs}, where this program speaks {}", Version::OURS)]
    Version {
        /// The sender's.
        theirs: Version,
    },
    /// They are no such message, or too long.
    #[error("{0} bytes that are no such message")]
    Damaged(usize),
    /// A number or list in it is out of range.
    #[error("`{field}` is out of range")]
    Value {
        /// Which.
        field: &'static str,
    },
}

/// A message that may hold only some values.
pub trait Message: Serialize + DeserializeOwned {
    /// The first field that holds what it may not.
    fn fault(&self) -> Option<&'static str>;
}

impl Message for Contacts {
    fn fault(&self) -> Option<&'static str> {
        if self.contacts.len() > MAX_CONTACTS {
            return Some("contacts");
        }
        self.contacts.iter().find_map(fault_of_contact)
    }
}

fn fault_of_contact(it: &SkinContact) -> Option<&'static str> {
    let wrench = it.wrench.unwrap_or_default();
    let of_contact = it.contact.position.iter().chain(&it.contact.normal).all(|value| value.is_finite());
    let of_link = [it.geometric_centre, wrench.force, wrench.moment];
    if !of_contact || !of_link.iter().flatten().all(|value| value.is_finite()) {
        return Some("contacts");
    }
    (it.pixels.len() > MAX_PIXELS).then_some("pixels")
}

impl Message for Image {
    fn fault(&self) -> Option<&'static str> {
        None
    }
}

impl Message for Health {
    fn fault(&self) -> Option<&'static str> {
        None
    }
}

impl Message for State {
    fn fault(&self) -> Option<&'static str> {
        let is_long = |text: &str| text.len() > 4 * MOST_OF_TEXT;
        is_long(&self.computer).then_some("computer").or_else(|| is_long(&self.text).then_some("text"))
    }
}

impl Message for Skin {
    fn fault(&self) -> Option<&'static str> {
        (self.centres.len() > MAX_PIXELS).then_some("centres")
    }
}

impl Message for Tare {
    fn fault(&self) -> Option<&'static str> {
        (self.voltages.len() > MAX_MEASUREMENTS).then_some("voltages")
    }
}

impl Message for DriveRequest {
    fn fault(&self) -> Option<&'static str> {
        // What is not allowed depends on the board.
        None
    }
}

impl Message for Outcome {
    fn fault(&self) -> Option<&'static str> {
        (self.message.len() > 4 * MOST_OF_TEXT).then_some("message")
    }
}

/// The computer's time, ns since 1970.
impl Message for u64 {
    fn fault(&self) -> Option<&'static str> {
        None
    }
}

/// As much of a text as a message holds.
pub(crate) fn shortened(text: &str) -> String {
    text.chars().take(MOST_OF_TEXT).collect()
}

/// A message or stamp as bytes.
#[must_use]
pub fn encode(message: &impl Serialize) -> Vec<u8> {
    // Nothing in a message has an encoding that fails, and a vector takes all.
    postcard::to_extend(message, Vec::new()).unwrap_or_default()
}

/// The stamp that accompanies a message.
pub fn stamp(bytes: &[u8]) -> Result<Stamp, DecodeError> {
    let damaged = DecodeError::Damaged(bytes.len());
    let (version, _) = postcard::take_from_bytes::<Version>(bytes).map_err(|_| damaged.clone())?;
    if version != Version::OURS {
        return Err(DecodeError::Version { theirs: version });
    }
    whole(bytes).ok_or(damaged)
}

/// The message that these bytes are.
pub fn decode<M: Message>(bytes: &[u8]) -> Result<M, DecodeError> {
    let message: M = whole(bytes).ok_or(DecodeError::Damaged(bytes.len()))?;
    message.fault().map_or(Ok(message), |field| Err(DecodeError::Value { field }))
}

fn whole<T: DeserializeOwned>(bytes: &[u8]) -> Option<T> {
    if bytes.len() > MOST_BYTES {
        return None;
    }
    let (value, rest) = postcard::take_from_bytes(bytes).ok()?;
    rest.is_empty().then_some(value)
}

#[cfg(test)]
mod tests {
    use super::*;
    use dermatome_body::contact::Wrench;
    use dermatome_shared::frame::FrameFlags;
    use proptest::prelude::*;

    fn at() -> FrameStamp {
        FrameStamp { sequence: 300, timestamp_us: 70_000, flags: FrameFlags::SATURATED }
    }

    fn contact() -> SkinContact {
        let contact = Contact {
            position: [0.5, 0.0, 0.0],
            normal: [0.0, 0.0, 1.0],
            area: 1.0,
            strength: 0.5,
            peak: 1.0,
            pressure: Some(2.0),
            load_area: None,
            evidence: None,
            identity: None,
        };
        let wrench = Some(Wrench { force: [0.0, 0.0, -2.0], moment: [0.0; 3] });
        SkinContact { contact, geometric_centre: [0.5, 0.0, 0.0], wrench, pixels: vec![1, 300] }
    }

    fn contacts() -> Contacts {
        Contacts { at: at(), ended_ns: 1 << 60, missing: 2, contacts: vec![contact()] }
    }

    fn state() -> State {
        let text = "averaging".to_owned();
        State { computer: "left".to_owned(), phase: Phase::Taring, text, frames: 1, missing: 2, losses: 300 }
    }

    fn hex(bytes: &[u8]) -> String {
        bytes.iter().map(|byte| format!("{byte:02x}")).collect()
    }

    /// What other programs read. Where this changes, [`MESSAGES`] grows.
    #[test]
    fn the_messages_of_this_version_have_these_bytes() {
        assert_eq!(MESSAGES, 1);
        let stamp = Stamp { version: Version { messages: 1, types: [7; 8] }, run: 300, number: 5 };
        assert_eq!(hex(&encode(&stamp)), "010707070707070707ac0205");
        let float = "0000003f";
        let one = "0000803f";
        let contact = format!(
            "{float}{zero}{zero}{zero}{zero}{one}{one}{float}{one}01{two}000000\
             {half}{none}{none}01{none}{none}{down}{none}{none}{none}0201ac02",
            zero = "00000000",
            two = "00000040",
            half = "000000000000e03f",
            none = "0000000000000000",
            down = "00000000000000c0",
        );
        let frame = "ac02f0a20401";
        assert_eq!(hex(&encode(&contacts())), format!("{frame}8080808080808080100201{contact}"));
        let drive = DriveRequest { frame_rate: 0.5, ..DriveRequest::AS_IT_IS };
        assert_eq!(hex(&encode(&drive)), format!("0000c07f0000c07f{float}ff"));
        assert_eq!(hex(&encode(&Outcome::refused("no"))), "00026e6f");
        assert_eq!(hex(&encode(&state())), "046c6566740509617665726167696e670102ac02");
    }

    #[test]
    fn another_version_is_told_from_damage_and_both_are_named() {
        let theirs = Version { messages: 2, ..Version::OURS };
        let mut bytes = encode(&Stamp { version: theirs, run: 1, number: 1 });
        // Whatever else a later version says.
        bytes.extend([9; 30]);
        let error = stamp(&bytes).unwrap_err();
        assert_eq!(error, DecodeError::Version { theirs });
        let words = error.to_string();
        assert!(words.contains(&theirs.to_string()) && words.contains(&Version::OURS.to_string()), "{words}");
        assert_eq!(stamp(&[1, 2, 3]), Err(DecodeError::Damaged(3)));
    }

    #[test]
    fn what_is_out_of_range_is_named() {
        let mut far = contacts();
        far.contacts[0].geometric_centre[1] = f64::NAN;
        assert_eq!(decode::<Contacts>(&encode(&far)), Err(DecodeError::Value { field: "contacts" }));
        let many = Contacts { contacts: vec![contact(); MAX_CONTACTS + 1], ..contacts() };
        assert_eq!(decode::<Contacts>(&encode(&many)), Err(DecodeError::Value { field: "contacts" }));
        let long = State { text: "x".repeat(9000), ..state() };
        assert_eq!(decode::<State>(&encode(&long)), Err(DecodeError::Value { field: "text" }));
        let endless = vec![0; MOST_BYTES + 1];
        assert_eq!(decode::<Skin>(&endless), Err(DecodeError::Damaged(MOST_BYTES + 1)));
    }

    /// All that a stranger's bytes may be taken for.
    fn decode_all(bytes: &[u8]) {
        let _ = (stamp(bytes), decode::<Contacts>(bytes), decode::<Image>(bytes), decode::<Health>(bytes));
        let _ = (decode::<Outcome>(bytes), decode::<DriveRequest>(bytes));
        let _ = (decode::<State>(bytes), decode::<Skin>(bytes), decode::<Tare>(bytes), decode::<u64>(bytes));
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(2000))]
        #[test]
        fn no_bytes_panic(bytes in prop::collection::vec(any::<u8>(), 0..400)) {
            decode_all(&bytes);
        }

        #[test]
        fn no_change_of_a_message_panics(place in 0_usize..200, byte: u8, length in 0_usize..200) {
            for mut bytes in [encode(&contacts()), encode(&state())] {
                let length = length.min(bytes.len());
                let place = place % bytes.len();
                bytes[place] = byte;
                decode_all(&bytes);
                decode_all(&bytes[..length]);
            }
        }

        #[test]
        fn a_message_comes_back(number: u64, run: u64) {
            let sent = Stamp { version: Version::OURS, run, number };
            prop_assert_eq!(stamp(&encode(&sent)), Ok(sent));
            prop_assert_eq!(decode::<Contacts>(&encode(&contacts())), Ok(contacts()));
            prop_assert_eq!(decode::<State>(&encode(&state())), Ok(state()));
        }
    }
}
