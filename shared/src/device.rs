//! Device: the board's state machine. Requests and frames in, replies and events out.
//!
//! It knows no executor and no hardware: whoever owns it moves packets and frames.

use crate::{
    MAX_PATCH_BYTES,
    frame::Frame,
    patch::PatchView,
    pipeline::{self, Outcome, PipelineState},
    protocol::{
        BoardPacket, Event, FrameStamp, Identity, Info, PROTOCOL_VERSION, PackedImage, PatchInfo, Refusal,
        Reply, Request, RequestPacket, Selection, Version,
    },
};

/// Most frames averaged in one tare.
pub const MAX_TARE_FRAMES: u16 = 1000;

/// Where a board keeps its patch: one slot in use, one being filled.
///
/// Until [`PatchStore::commit`] returns, the slot in use must survive anything, power cuts included.
pub trait PatchStore {
    /// Bytes of the patch in use.
    fn active(&self) -> Option<&[u8]>;
    /// Prepares the other slot for a patch of `length` bytes.
    fn begin(&mut self, length: usize) -> Result<(), StoreError>;
    /// Writes the next bytes into the other slot.
    fn append(&mut self, bytes: &[u8]) -> Result<(), StoreError>;
    /// What the other slot holds so far.
    fn staged(&self) -> &[u8];
    /// Makes the other slot the one in use.
    fn commit(&mut self) -> Result<(), StoreError>;
}

/// Why a patch store did not do what was asked.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum StoreError {
    /// This board has no storage.
    Unsupported,
    /// Writing failed.
    Failed,
}

impl From<StoreError> for Refusal {
    fn from(error: StoreError) -> Self {
        match error {
            StoreError::Unsupported => Self::Unsupported,
            StoreError::Failed => Self::Storage,
        }
    }
}

/// The state of a board.
#[derive(Debug)]
pub struct Device<S> {
    identity: Identity,
    electrodes: u8,
    store: S,
    /// Whether the patch in use passed all checks, so that every later look at it can be quick.
    patch_is_valid: bool,
    upload: Option<Upload>,
    pipeline: PipelineState,
    tare_frames: u16,
    streaming: Selection,
    next_frame: u32,
    next_event: u32,
}

#[derive(Clone, Copy, Debug)]
struct Upload {
    length: u32,
    received: u32,
    crc: u32,
}

impl<S: PatchStore> Device<S> {
    /// A board that has just started and has `electrodes` wired. A stored patch that is not valid,
    /// or needs more electrodes, counts as none.
    pub fn new(identity: Identity, electrodes: u8, store: S) -> Self {
        let is_usable =
            |bytes| PatchView::validate(bytes).is_ok_and(|patch| patch.header.electrodes <= electrodes);
        let patch_is_valid = store.active().is_some_and(is_usable);
        Self {
            identity,
            electrodes,
            store,
            patch_is_valid,
            upload: None,
            pipeline: PipelineState::default(),
            tare_frames: 0,
            streaming: Selection::default(),
            next_frame: 0,
            next_event: 0,
        }
    }

    /// The patch in use.
    pub fn patch(&self) -> Option<PatchView<'_>> {
        valid_patch(&self.store, self.patch_is_valid)
    }

    /// State of the pipeline, with the latest image and contacts.
    pub fn pipeline(&self) -> &PipelineState {
        &self.pipeline
    }

    /// Which events go out with every frame.
    pub fn streaming(&self) -> Selection {
        self.streaming
    }

    /// Stops streaming and forgets an unfinished upload: the host has gone.
    pub fn disconnect(&mut self) {
        self.streaming = Selection::default();
        self.upload = None;
    }

    /// Answers one request.
    pub fn handle(&mut self, packet: &RequestPacket) -> BoardPacket {
        let reply = self.answer(&packet.request).unwrap_or_else(Reply::Refused);
        BoardPacket::Reply { sequence: packet.sequence, reply }
    }

    /// Takes one frame through the pipeline and hands each event that follows to `emit`.
    pub fn process(&mut self, frame: &Frame, mut emit: impl FnMut(BoardPacket)) {
        self.next_frame = frame.sequence.wrapping_add(1);
        let Some(patch) = valid_patch(&self.store, self.patch_is_valid) else { return };
        let outcome = pipeline::process(&patch, &mut self.pipeline, frame);
        let next_event = &mut self.next_event;
        let mut send = |event| {
            emit(BoardPacket::Event { number: *next_event, event });
            *next_event = next_event.wrapping_add(1);
        };
        let at =
            FrameStamp { sequence: frame.sequence, timestamp_us: frame.timestamp_us, flags: frame.flags };
        if outcome == Outcome::Tared {
            send(Event::Tared { frames: self.tare_frames });
        }
        if self.streaming.measurements && outcome != Outcome::WrongLength {
            send(Event::Measurements { at, codes: frame.codes.clone() });
        }
        if self.streaming.images && outcome == Outcome::Image {
            send(Event::Image { at, image: PackedImage::pack(self.pipeline.image()) });
        }
        if self.streaming.contacts && outcome == Outcome::Image {
            send(Event::Contacts { at, contacts: self.pipeline.contacts().clone() });
        }
    }

    fn answer(&mut self, request: &Request) -> Result<Reply, Refusal> {
        match request {
            Request::Hello(version) => self.hello(*version),
            Request::Info => Ok(Reply::Info(self.info())),
            Request::Geometry => Ok(Reply::Geometry(self.patch().ok_or(Refusal::NoPatch)?.geometry())),
            Request::Reference => self.reference(),
            Request::BeginUpload { length, crc } => self.begin_upload(*length, *crc),
            Request::UploadChunk { offset, bytes } => self.upload_chunk(*offset, bytes),
            Request::CommitUpload => self.commit_upload(),
            Request::Tare { frames } => self.tare(*frames),
            Request::Stream(selection) => self.stream(*selection),
        }
    }

    fn hello(&self, version: Version) -> Result<Reply, Refusal> {
        if version.protocol != PROTOCOL_VERSION {
            return Err(Refusal::Version { board: PROTOCOL_VERSION });
        }
        Ok(Reply::Hello { version: Version::current(), identity: self.identity.clone() })
    }

    fn info(&self) -> Info {
        Info {
            electrodes: self.electrodes,
            max_patch_bytes: MAX_PATCH_BYTES as u32,
            patch: self.patch().map(|patch| PatchInfo {
                crc: patch.crc(),
                electrodes: patch.header.electrodes,
                steps: patch.header.steps,
                measurements: patch.header.measurements,
                pixels: patch.header.pixels,
                drive: patch.header.drive,
                skin: patch.header.skin,
            }),
            tared: self.pipeline.reference().is_some(),
            streaming: self.streaming,
        }
    }

    fn reference(&self) -> Result<Reply, Refusal> {
        let reference = self.pipeline.reference().ok_or(Refusal::NotTared)?;
        let sums = reference.sums().iter().copied().collect();
        Ok(Reply::Reference { frames: reference.frames(), sums })
    }

    fn begin_upload(&mut self, length: u32, crc: u32) -> Result<Reply, Refusal> {
        self.upload = None;
        if length as usize > MAX_PATCH_BYTES {
            return Err(Refusal::TooLong { length, max: MAX_PATCH_BYTES as u32 });
        }
        self.store.begin(length as usize)?;
        self.upload = Some(Upload { length, received: 0, crc });
        Ok(Reply::Done)
    }

    fn upload_chunk(&mut self, offset: u32, bytes: &[u8]) -> Result<Reply, Refusal> {
        let upload = self.upload.as_mut().ok_or(Refusal::NoUpload)?;
        let end = upload.received.saturating_add(bytes.len() as u32);
        if offset != upload.received || end > upload.length {
            return Err(Refusal::OutOfOrder { expected: upload.received });
        }
        self.store.append(bytes)?;
        upload.received = end;
        Ok(Reply::Done)
    }

    fn commit_upload(&mut self) -> Result<Reply, Refusal> {
        let upload = self.upload.take().ok_or(Refusal::NoUpload)?;
        if upload.received != upload.length {
            return Err(Refusal::OutOfOrder { expected: upload.received });
        }
        let staged = PatchView::validate(self.store.staged()).map_err(|_| Refusal::BadPatch)?;
        if staged.crc() != upload.crc {
            return Err(Refusal::BadPatch);
        }
        if staged.header.electrodes > self.electrodes {
            return Err(Refusal::Electrodes { patch: staged.header.electrodes, board: self.electrodes });
        }
        self.store.commit()?;
        self.patch_is_valid = true;
        self.pipeline = PipelineState::default();
        self.streaming = Selection::default();
        Ok(Reply::Done)
    }

    fn tare(&mut self, frames: u16) -> Result<Reply, Refusal> {
        self.patch().ok_or(Refusal::NoPatch)?;
        if !(1..=MAX_TARE_FRAMES).contains(&frames) {
            return Err(Refusal::TareFrames { max: MAX_TARE_FRAMES });
        }
        self.tare_frames = frames;
        self.pipeline.start_tare(frames);
        Ok(Reply::Done)
    }

    fn stream(&mut self, selection: Selection) -> Result<Reply, Refusal> {
        self.patch().ok_or(Refusal::NoPatch)?;
        if (selection.images || selection.contacts) && self.pipeline.reference().is_none() {
            return Err(Refusal::NotTared);
        }
        self.streaming = selection;
        Ok(Reply::Streaming { first_sequence: self.next_frame })
    }
}

fn valid_patch<S: PatchStore>(store: &S, is_valid: bool) -> Option<PatchView<'_>> {
    PatchView::open(store.active().filter(|_| is_valid)?).ok()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::patch::{
        Difference,
        tests::{flat_frame, small_patch},
    };
    use crate::protocol::MAX_CHUNK_BYTES;
    use std::vec::Vec;

    #[derive(Default)]
    struct Memory {
        active: Option<Vec<u8>>,
        staged: Vec<u8>,
    }

    impl PatchStore for Memory {
        fn active(&self) -> Option<&[u8]> {
            self.active.as_deref()
        }
        fn begin(&mut self, _: usize) -> Result<(), StoreError> {
            self.staged.clear();
            Ok(())
        }
        fn append(&mut self, bytes: &[u8]) -> Result<(), StoreError> {
            self.staged.extend(bytes);
            Ok(())
        }
        fn staged(&self) -> &[u8] {
            &self.staged
        }
        fn commit(&mut self) -> Result<(), StoreError> {
            self.active = Some(core::mem::take(&mut self.staged));
            Ok(())
        }
    }

    fn device() -> Device<Memory> {
        let identity = Identity { board: "test".try_into().unwrap(), firmware: "0".try_into().unwrap() };
        Device::new(identity, 16, Memory::default())
    }

    fn ask(device: &mut Device<Memory>, request: Request) -> Reply {
        match device.handle(&RequestPacket { sequence: 77, request }) {
            BoardPacket::Reply { sequence: 77, reply } => reply,
            other => panic!("{other:?}"),
        }
    }

    fn upload(device: &mut Device<Memory>, bytes: &[u8], crc: u32) -> Reply {
        let begin = Request::BeginUpload { length: bytes.len() as u32, crc };
        assert_eq!(ask(device, begin), Reply::Done);
        for (i, chunk) in bytes.chunks(MAX_CHUNK_BYTES).enumerate() {
            let bytes = heapless::Vec::from_slice(chunk).unwrap();
            let offset = (i * MAX_CHUNK_BYTES) as u32;
            assert_eq!(ask(device, Request::UploadChunk { offset, bytes }), Reply::Done);
        }
        ask(device, Request::CommitUpload)
    }

    fn upload_good(device: &mut Device<Memory>, difference: Difference) -> u32 {
        let bytes = small_patch(difference);
        let crc = PatchView::validate(&bytes).unwrap().crc();
        assert_eq!(upload(device, &bytes, crc), Reply::Done);
        crc
    }

    fn events(device: &mut Device<Memory>, frame: &Frame) -> Vec<(u32, Event)> {
        let mut seen = Vec::new();
        device.process(frame, |packet| match packet {
            BoardPacket::Event { number, event } => seen.push((number, event)),
            BoardPacket::Reply { .. } => panic!("a reply nobody asked for"),
        });
        seen
    }

    fn frame(sequence: u32, value: i32) -> Frame {
        Frame { sequence, ..flat_frame(value) }
    }

    #[test]
    fn a_host_of_another_protocol_version_is_refused() {
        let version = Version { protocol: 99, schema: [0; 8] };
        let reply = ask(&mut device(), Request::Hello(version));
        assert_eq!(reply, Reply::Refused(Refusal::Version { board: PROTOCOL_VERSION }));
        assert!(matches!(ask(&mut device(), Request::Hello(Version::current())), Reply::Hello { .. }));
    }

    #[test]
    fn a_board_without_a_patch_says_so() {
        let mut device = device();
        assert_eq!(ask(&mut device, Request::Tare { frames: 1 }), Reply::Refused(Refusal::NoPatch));
        assert_eq!(ask(&mut device, Request::Geometry), Reply::Refused(Refusal::NoPatch));
        let all = Selection { images: true, contacts: true, measurements: true };
        assert_eq!(ask(&mut device, Request::Stream(all)), Reply::Refused(Refusal::NoPatch));
        assert!(events(&mut device, &frame(0, 5)).is_empty());
    }

    #[test]
    fn upload_tare_and_stream_number_their_events_without_gaps() {
        let mut device = device();
        upload_good(&mut device, Difference::Plain);
        let wanted = Selection { images: true, contacts: true, measurements: false };
        assert_eq!(ask(&mut device, Request::Stream(wanted)), Reply::Refused(Refusal::NotTared));
        assert_eq!(ask(&mut device, Request::Tare { frames: 2 }), Reply::Done);
        assert!(events(&mut device, &frame(0, 100)).is_empty());
        assert_eq!(events(&mut device, &frame(1, 100)), [(0, Event::Tared { frames: 2 })]);
        let sums = (0..40).map(|_| 200).collect();
        assert_eq!(ask(&mut device, Request::Reference), Reply::Reference { frames: 2, sums });
        assert_eq!(ask(&mut device, Request::Stream(wanted)), Reply::Streaming { first_sequence: 2 });
        let seen = events(&mut device, &frame(2, 150));
        assert!(matches!(seen[0], (1, Event::Image { .. })));
        let (2, Event::Contacts { at, contacts }) = &seen[1] else { panic!("{seen:?}") };
        assert_eq!((at.sequence, contacts.len()), (2, 1));
        assert!((contacts[0].strength - 0.5).abs() < 1e-4);
    }

    #[test]
    fn a_damaged_upload_leaves_the_old_patch_in_use() {
        let mut device = device();
        let old = upload_good(&mut device, Difference::Plain);
        let mut bytes = small_patch(Difference::Normalised);
        let crc = PatchView::validate(&bytes).unwrap().crc();
        let middle = bytes.len() / 2;
        bytes[middle] ^= 4;
        assert_eq!(upload(&mut device, &bytes, crc), Reply::Refused(Refusal::BadPatch));
        assert_eq!(device.patch().unwrap().crc(), old);
    }

    #[test]
    fn a_link_cut_in_the_middle_of_an_upload_leaves_the_old_patch_in_use() {
        let mut device = device();
        let old = upload_good(&mut device, Difference::Plain);
        let bytes = small_patch(Difference::Normalised);
        ask(&mut device, Request::BeginUpload { length: bytes.len() as u32, crc: 1 });
        let piece = heapless::Vec::from_slice(&bytes[..100]).unwrap();
        assert_eq!(ask(&mut device, Request::UploadChunk { offset: 0, bytes: piece.clone() }), Reply::Done);
        device.disconnect();
        let next = Request::UploadChunk { offset: 100, bytes: piece };
        assert_eq!(ask(&mut device, next), Reply::Refused(Refusal::NoUpload));
        assert_eq!(device.patch().unwrap().crc(), old);
    }

    #[test]
    fn pieces_out_of_turn_and_patches_too_long_are_refused() {
        let mut device = device();
        let long = Request::BeginUpload { length: MAX_PATCH_BYTES as u32 + 1, crc: 0 };
        assert!(matches!(ask(&mut device, long), Reply::Refused(Refusal::TooLong { .. })));
        assert_eq!(ask(&mut device, Request::CommitUpload), Reply::Refused(Refusal::NoUpload));
        ask(&mut device, Request::BeginUpload { length: 10, crc: 0 });
        let bytes = heapless::Vec::from_slice(&[0; 11]).unwrap();
        let refused = Reply::Refused(Refusal::OutOfOrder { expected: 0 });
        assert_eq!(ask(&mut device, Request::UploadChunk { offset: 0, bytes: bytes.clone() }), refused);
        assert_eq!(ask(&mut device, Request::UploadChunk { offset: 4, bytes }), refused);
        assert_eq!(ask(&mut device, Request::CommitUpload), refused);
    }

    #[test]
    fn a_stored_patch_that_rotted_counts_as_none() {
        let mut bytes = small_patch(Difference::Plain);
        let middle = bytes.len() / 2;
        bytes[middle] ^= 1;
        let identity = Identity { board: "test".try_into().unwrap(), firmware: "0".try_into().unwrap() };
        let device = Device::new(identity, 16, Memory { active: Some(bytes), staged: Vec::new() });
        assert!(device.patch().is_none());
    }

    #[test]
    fn a_patch_for_more_electrodes_than_are_wired_is_refused() {
        let identity = device().identity;
        let mut device = Device::new(identity, 4, Memory::default());
        let bytes = small_patch(Difference::Plain);
        let crc = PatchView::validate(&bytes).unwrap().crc();
        let refused = Reply::Refused(Refusal::Electrodes { patch: 8, board: 4 });
        assert_eq!(upload(&mut device, &bytes, crc), refused);
        assert!(device.patch().is_none());
    }

    #[test]
    fn a_tare_of_no_frames_is_refused() {
        let mut device = device();
        upload_good(&mut device, Difference::Plain);
        let refused = Reply::Refused(Refusal::TareFrames { max: MAX_TARE_FRAMES });
        assert_eq!(ask(&mut device, Request::Tare { frames: 0 }), refused);
    }
}
