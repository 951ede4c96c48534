//! Protocol: every message on the wire, and its framing.
//!
//! A packet is a message in postcard encoding, followed by its CRC-32 (ISO-HDLC, little-endian),
//! the whole COBS-encoded and ended by a zero byte. The first exchange is `Hello`; the request, its
//! reply and its refusal for the version keep their encoding for ever, so that any two versions can
//! tell each other apart.
//! On a line of several boards a packet has a mark before it: see [`bus`].
//! Requests carry a sequence number and get exactly one reply with the same number. Events carry
//! a running number of their own, so that a lost event shows as a gap.

pub mod bus;
pub mod can;
mod packet;
mod queue;

pub use crate::acquire::{MAX_SCOPE_SAMPLES, SlotSamples};
pub use packet::{PacketError, PacketReader, decode, encode};
pub use queue::{EventQueue, PacketQueue};

use crate::{
    acquire::{FrontEnd, trim::Trim},
    contact::Contacts,
    drive::Drive,
    frame::FrameFlags,
    health::{Health, Vitals, restart::Restart},
    image::Image,
    limits::{MAX_MEASUREMENTS, MAX_PIXELS, MAX_STEPS},
    pipeline::reflex::Reflexes,
    units::{AdcCode, RelativeConductivity},
};
use heapless::{String, Vec};
use postcard_schema::{Schema, key::hash::fnv1a64};
use serde::{Deserialize, Serialize};

/// Version of the messages below. Grows with every incompatible change.
pub const PROTOCOL_VERSION: u16 = 14;
/// Longest packet on the wire, with its framing, bytes.
pub const MAX_PACKET_BYTES: usize = 4096;
/// Longest piece of a patch in one request, bytes.
pub const MAX_CHUNK_BYTES: usize = 512;

/// Hash of all message types: two builds with the same hash understand each other.
#[must_use]
pub const fn schema_hash() -> [u8; 8] {
    // Constants, or the names of all types and fields come to lie in a board's flash.
    const REQUESTS: [u8; 8] = fnv1a64::hash_ty_path::<RequestPacket>("request");
    const FROM_BOARD: [u8; 8] = fnv1a64::hash_ty_path::<BoardPacket>("board");
    let (requests, from_board) = (REQUESTS, FROM_BOARD);
    (u64::from_le_bytes(requests) ^ u64::from_le_bytes(from_board).rotate_left(1)).to_le_bytes()
}

/// From the host: one request.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, Schema)]
pub struct RequestPacket {
    /// Chosen by the host, repeated in the reply. A host begins at a number that it draws, so that no reply to the host
    /// before passes for one to it.
    pub sequence: u16,
    /// What is asked.
    pub request: Request,
}

/// What a host can ask of a board.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, Schema)]
#[expect(clippy::large_enum_variant, reason = "there is no allocator to box with")]
pub enum Request {
    /// Who are you, and do we speak the same language?
    Hello(Version),
    /// What do you hold and do?
    Info,
    /// A patch of this length and checksum will follow.
    BeginUpload {
        /// Length of the whole patch, bytes.
        length: u32,
        /// CRC-32 the patch ends with.
        crc: u32,
    },
    /// The next piece of the patch.
    UploadChunk {
        /// Where it belongs; must be where the last piece ended.
        offset: u32,
        /// The piece.
        bytes: Vec<u8, MAX_CHUNK_BYTES>,
    },
    /// The patch is complete: check it and use it from now on.
    CommitUpload,
    /// Average this many frames of the untouched skin as the new reference.
    Tare {
        /// Frames to average.
        frames: u16,
    },
    /// What does the patch in use hold from here on? Its start says where the pixels lie.
    ReadPatch {
        /// First byte wanted.
        offset: u32,
    },
    /// Which reference are frames compared with?
    Reference,
    /// Send these events from now on, and no others.
    Stream(Selection),
    /// Drive the skin like this from now on, until the next patch or reset; none: as the patch says.
    Drive(Option<Drive>),
    /// Keep this trim, and measure with it from now on; the one in force is in [`Info::front_end`].
    Trim(Trim),
}

/// A protocol version and schema hash; see [`PROTOCOL_VERSION`] and [`schema_hash`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub struct Version {
    /// Version of the messages.
    pub protocol: u16,
    /// Hash of all message types.
    pub schema: [u8; 8],
}

impl Version {
    /// The version this build speaks.
    #[must_use]
    pub fn current() -> Self {
        Self { protocol: PROTOCOL_VERSION, schema: schema_hash() }
    }
}

/// Which events a host wants: each number is every how many frames, 0 for never.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub struct Selection {
    /// [`Event::Image`].
    pub images: u16,
    /// [`Event::Contacts`].
    pub contacts: u16,
    /// [`Event::Measurements`].
    pub measurements: u16,
    /// [`Event::Health`].
    pub health: u16,
    /// [`Event::Scope`].
    pub scope: u16,
    /// Slot of the scan that the scope shows: the patch's steps, then a test of each electrode.
    pub scope_slot: u16,
}

impl Selection {
    /// Whether anything is wanted.
    #[must_use]
    pub fn any(self) -> bool {
        [self.images, self.contacts, self.measurements, self.health, self.scope]
            .iter()
            .any(|&every| every > 0)
    }
}

/// From the board: a reply or an event.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, Schema)]
pub enum BoardPacket {
    /// The answer to one request.
    Reply {
        /// Sequence number of the request.
        sequence: u16,
        /// The answer.
        reply: Reply,
    },
    /// Something that happened.
    Event {
        /// Running number of events since the board started.
        number: u32,
        /// What happened.
        event: Event,
    },
}

/// Answers.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, Schema)]
#[expect(clippy::large_enum_variant, reason = "there is no allocator to box with")]
pub enum Reply {
    /// To [`Request::Hello`].
    Hello {
        /// The version the board speaks.
        version: Version,
        /// Who it is.
        identity: Identity,
    },
    /// Not done, to any request.
    Refused(Refusal),
    /// To [`Request::Info`].
    Info(Info),
    /// To [`Request::ReadPatch`]: as many bytes as fit, fewer only at the patch's end.
    Patch {
        /// The bytes.
        bytes: Vec<u8, MAX_CHUNK_BYTES>,
    },
    /// To [`Request::Reference`].
    Reference {
        /// Frames averaged.
        frames: u16,
        /// Sum of codes over those frames: `[measurement]`.
        sums: Vec<i64, MAX_MEASUREMENTS>,
    },
    /// To [`Request::Stream`]: the sequence number of the first frame that will be streamed.
    Streaming {
        /// Sequence number of that frame.
        first_sequence: u32,
    },
    /// Done, and nothing more to say.
    Done,
}

/// Who a board is.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub struct Identity {
    /// Kind of board, e.g. "nucleo-g474re" or "simulated".
    pub board: String<32>,
    /// Version of its firmware.
    pub firmware: String<16>,
}

/// What a board holds and does.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, Schema)]
pub struct Info {
    /// Electrodes wired to the board.
    pub electrodes: u8,
    /// Longest patch it can store, bytes.
    pub max_patch_bytes: u32,
    /// Where its frames come from.
    pub frame_source: FrameSource,
    /// Its analogue front end, if it has one.
    pub front_end: Option<FrontEnd>,
    /// How the skin is driven, with a patch.
    pub drive: Option<Drive>,
    /// Why it started last.
    pub started_after: Restart,
    /// How long ago it started, milliseconds.
    pub uptime_ms: u64,
    /// The patch in use.
    pub patch: Option<PatchInfo>,
    /// Whether there is a reference, so that images can be made.
    pub tared: bool,
    /// Events being streamed.
    pub streaming: Selection,
}

/// Where a board's frames come from.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub enum FrameSource {
    /// Measured on a skin.
    Skin,
    /// Computed from a simulated skin.
    Simulated,
    /// Numbers without meaning: the board cannot measure yet.
    Synthetic,
}

/// The patch a board uses.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, Schema)]
pub struct PatchInfo {
    /// Its checksum, which identifies it.
    pub crc: u32,
    /// Name of the skin.
    pub skin: String<32>,
    /// Electrodes.
    pub electrodes: u8,
    /// Steps in a frame.
    pub steps: u16,
    /// Measurements after reciprocal steps are combined.
    pub measurements: u16,
    /// Pixels of the image.
    pub pixels: u16,
    /// How the skin is driven.
    pub drive: Drive,
}

/// Why a board did not do what was asked.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, Schema, thiserror::Error)]
pub enum Refusal {
    /// The host speaks another version.
    #[error(
        "the board speaks protocol version {board}; this host speaks another (update the older of the two)"
    )]
    Version {
        /// The version the board speaks.
        board: u16,
    },
    /// Nothing can be measured or drawn without a patch.
    #[error("the board holds no patch (send one with `dermatome flash`)")]
    NoPatch,
    /// Nothing can be streamed without a reference.
    #[error("the board has no reference frame (make one with `dermatome tare`)")]
    NotTared,
    /// The patch does not fit.
    #[error("the patch holds {length} bytes, the board stores at most {max}")]
    TooLong {
        /// Length of the patch.
        length: u32,
        /// Most the board stores.
        max: u32,
    },
    /// No upload is under way.
    #[error("no upload is under way on the board")]
    NoUpload,
    /// A piece came out of turn.
    #[error("the board expected the patch to continue at byte {expected}")]
    OutOfOrder {
        /// Where the next piece must start.
        expected: u32,
    },
    /// The uploaded patch is damaged or not one this board can use; the old one stays.
    #[error(
        "the board checked the uploaded patch and found it damaged or unusable; it keeps the patch it had"
    )]
    BadPatch,
    /// The uploaded patch is for another skin; the old one stays.
    #[error("the patch is for {patch} electrodes, the board has {board}; it keeps the patch it had")]
    Electrodes {
        /// Electrodes of the patch.
        patch: u8,
        /// Electrodes of the board.
        board: u8,
    },
    /// The board could not write its storage; the old patch stays.
    #[error("the board could not write its patch storage; it keeps the patch it had")]
    Storage,
    /// A number in the request is out of range.
    #[error("the board does not accept that number of frames (allowed are 1 to {max})")]
    TareFrames {
        /// Most frames.
        max: u16,
    },
    /// This board cannot do that.
    #[error("this board does not support that yet")]
    Unsupported,
    /// The board cannot drive a skin like that.
    #[error(
        "the board cannot drive a skin like that: it does 12.5, 20, 50, 100 and 200 kHz with up to \
         {max_microamperes} uA and a gain that is automatic or a power of two up to {max_gain}"
    )]
    Drive {
        /// Largest amplitude, uA.
        max_microamperes: u32,
        /// Largest gain.
        max_gain: u8,
    },
    /// Factors that no part within its limits can need.
    #[error("the board does not accept that trim: a factor is further than 0.9 from 1, or not a number")]
    Trim,
    /// A slot of the scan that does not exist.
    #[error("the scan has slots 0 to {last}")]
    Slot {
        /// The last one.
        last: u16,
    },
    /// Another host is served.
    #[error(
        "busy: the board serves another host, and takes the next one when that leaves or has been silent for some seconds"
    )]
    Busy,
}

/// What a board tells unasked.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, Schema)]
pub enum Event {
    /// A tare is complete.
    Tared {
        /// Frames averaged.
        frames: u16,
    },
    /// Image of one frame.
    Image {
        /// Which frame.
        at: FrameStamp,
        /// The image.
        image: PackedImage,
    },
    /// Contacts of one frame.
    Contacts {
        /// Which frame.
        at: FrameStamp,
        /// The contacts, strongest first.
        contacts: Contacts,
    },
    /// Raw codes of one frame.
    Measurements {
        /// Which frame.
        at: FrameStamp,
        /// The part of each voltage that goes into the image: `[step]`.
        codes: Vec<AdcCode, MAX_STEPS>,
        /// The part in quadrature: `[step]`; empty where it is not measured.
        quadrature: Vec<AdcCode, MAX_STEPS>,
    },
    /// What one frame says about the board and its skin.
    Health {
        /// Which frame.
        at: FrameStamp,
        /// Electrodes and current.
        health: Health,
        /// The board itself.
        vitals: Vitals,
        /// Drift of all voltages that is taken out of the images, relative.
        drift: f32,
        /// Times since the start at which samples were lost.
        missed: u32,
    },
    /// What the scope saw.
    Scope(SlotSamples),
    /// What the rules of the patch say: when that changes, when a stream begins, and every 64th frame of it.
    Reflexes {
        /// Which frame; its flags are those that it came with.
        at: FrameStamp,
        /// What they say.
        reflexes: Reflexes,
    },
}

impl Event {
    /// Whether it is so long that short events are sent ahead of it.
    #[must_use]
    pub fn is_long(&self) -> bool {
        matches!(self, Self::Image { .. } | Self::Measurements { .. } | Self::Scope(_))
    }
}

/// Which frame an event belongs to.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub struct FrameStamp {
    /// Running number of the frame since the board started.
    pub sequence: u32,
    /// When the scan ended, microseconds of the board's clock.
    pub timestamp_us: u64,
    /// What was wrong with the frame.
    pub flags: FrameFlags,
}

/// An image for the wire: 16-bit mantissas with one exponent.
///
/// `value[pixel] = mantissas[pixel] * 2^-exponent`. Rounding is at most half a step, 2^-15 of the
/// largest value.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub struct PackedImage {
    /// Binary places after the point, 3 to 20.
    pub exponent: i8,
    /// Mantissas: `[pixel]`.
    pub mantissas: Vec<i16, MAX_PIXELS>,
}

impl PackedImage {
    /// Packs an image.
    #[must_use]
    pub fn pack(image: &Image) -> Self {
        let largest = image.iter().map(|value| value.0.unsigned_abs()).max().unwrap_or(0);
        // Bits beyond the 15 of a mantissa, with room for the rounding up.
        let shift = (33 - largest.saturating_add(largest >> 15).leading_zeros() as i32 - 16).max(0);
        let half = if shift > 0 { 1_i64 << (shift - 1) } else { 0 };
        let round = |value: &RelativeConductivity| ((i64::from(value.0) + half) >> shift) as i16;
        Self {
            exponent: (RelativeConductivity::FRACTION_BITS - shift) as i8,
            mantissas: image.iter().map(round).collect(),
        }
    }

    /// Relative conductivity of each pixel.
    pub fn values(&self) -> impl ExactSizeIterator<Item = f64> + '_ {
        let step = 1.0 / (1_u64 << self.exponent.clamp(0, 62)) as f64;
        self.mantissas.iter().map(move |&mantissa| f64::from(mantissa) * step)
    }
}

#[cfg(test)]
mod tests;
