//! Device: the board's state machine. Requests and frames in, replies and events out.
//!
//! It knows no executor and no hardware: whoever owns it moves packets and frames.

pub mod flash_slots;
mod reflexes;
mod store;

pub use store::{PatchStore, StoreError};

use crate::{
    acquire::{
        FrontEnd,
        scan::{self, Timing},
        trim::Trim,
    },
    drive::Drive,
    frame::{Frame, FrameFlags},
    health::{HOT, Health, Vitals, restart::Restart},
    limits::MAX_PATCH_BYTES,
    patch::{PatchHeader, PatchView},
    pipeline::{self, Outcome, PipelineState, reference::Reference, reflex::Reflexes},
    protocol::{
        BoardPacket, Event, FrameSource, FrameStamp, Identity, Info, MAX_CHUNK_BYTES, PROTOCOL_VERSION,
        PackedImage, PatchInfo, Refusal, Reply, Request, RequestPacket, Selection, SlotSamples, Version,
    },
};
use core::borrow::BorrowMut;
use heapless::Vec;

/// Most frames averaged in one tare.
pub const MAX_TARE_FRAMES: u16 = 1000;

/// What is fixed about a board from the moment it starts.
#[derive(Clone, Debug, PartialEq)]
pub struct BoardFacts {
    /// Who it is.
    pub identity: Identity,
    /// Electrodes wired to it.
    pub electrodes: u8,
    /// Where its frames come from.
    pub frame_source: FrameSource,
    /// Its analogue front end, if it has one.
    pub front_end: Option<FrontEnd>,
    /// Why it started.
    pub started_after: Restart,
    /// Whether its link tells when the host goes ([`Device::disconnect`]); if not, silence does.
    pub sees_host_go: bool,
}

/// A host that streams and has not asked for anything for so long has gone, ms: no current flows for nobody.
pub const HOST_TIMEOUT_MS: u64 = 30_000;
/// How often a host that streams asks for something, so that the board knows it is there, us.
pub const HOST_INTERVAL_US: u64 = 5_000_000;

/// What a frame does not know of itself when its last sample has come.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Arrival {
    /// When the scan ended, microseconds of the board's own clock.
    pub timestamp_us: u64,
    /// Whether the board lost samples between the frame before and this one.
    pub missed: bool,
    /// What the watch ([`crate::pipeline::reflex`]) said of it.
    pub reflexes: Reflexes,
}

/// The state of a board. The pipeline's, which is large, may lie elsewhere: a reference to it will do.
#[derive(Debug)]
pub struct Device<S, P = PipelineState> {
    facts: BoardFacts,
    store: S,
    /// Header of the patch in use, which has passed all checks: so every later look at it can be quick.
    header: Option<PatchHeader>,
    upload: Option<Upload>,
    pipeline: P,
    streaming: Selection,
    drive: Option<Drive>,
    scan: u32,
    health: Health,
    vitals: Vitals,
    missed: u32,
    /// Rules that are tripped, and whether the board is blind, as the host was told last.
    reflexes_told: Option<(u8, bool)>,
    next_frame: u32,
    next_event: u32,
    /// Uptime at the last request.
    heard_ms: u64,
}

#[derive(Clone, Copy, Debug)]
struct Upload {
    length: u32,
    received: u32,
    crc: u32,
}

impl<S: PatchStore, P: BorrowMut<PipelineState>> Device<S, P> {
    /// A board that has just started. A stored patch that is not valid, or needs more electrodes than
    /// the board has, counts as none.
    pub fn new(mut facts: BoardFacts, store: S, pipeline: P) -> Self {
        if let (Some(front_end), Some(trim)) = (&mut facts.front_end, store.trim()) {
            front_end.trim = trim;
        }
        let patch = store.active().and_then(|bytes| PatchView::validate(bytes).ok());
        let header = patch.map(|patch| patch.header).filter(|header| header.electrodes <= facts.electrodes);
        Self {
            facts,
            store,
            header,
            upload: None,
            pipeline,
            streaming: Selection::default(),
            drive: None,
            scan: 0,
            health: Health::default(),
            vitals: Vitals::default(),
            missed: 0,
            reflexes_told: None,
            next_frame: 0,
            next_event: 0,
            heard_ms: 0,
        }
    }

    /// The patch in use.
    pub fn patch(&self) -> Option<PatchView<'_>> {
        patch_in_use(&self.store, &self.header)
    }

    /// State of the pipeline, with the latest image and contacts.
    pub fn pipeline(&self) -> &PipelineState {
        self.pipeline.borrow()
    }

    /// Which events go out with every frame.
    pub fn streaming(&self) -> Selection {
        self.streaming
    }

    /// Whether anybody uses a frame: a tare or a stream is under way, or the patch has reflexes. A tare that begins by
    /// itself in a stream ends with it, so that no current flows for nobody.
    pub fn needs_frames(&self) -> bool {
        self.has_reflexes() || self.pipeline().is_asked_to_tare() || self.streaming.any()
    }

    /// How the skin is driven: as the patch says, or as a host asked since.
    pub fn drive(&self) -> Option<Drive> {
        let patch = self.patch()?;
        Some(self.drive.unwrap_or(patch.header.drive))
    }

    /// The front end, if there is one, with the board's own trim.
    pub fn front_end(&self) -> Option<&FrontEnd> {
        self.facts.front_end.as_ref()
    }

    /// Number of the scan: whenever it changes, scanning begins anew, with gains found again.
    pub fn scan(&self) -> u32 {
        self.scan
    }

    /// What the latest frame says about electrodes and current, without their contact impedances.
    pub fn health(&self) -> &Health {
        &self.health
    }

    /// What the board knows of itself, to tell with the next health event.
    pub fn set_vitals(&mut self, vitals: Vitals) {
        self.vitals = vitals;
    }

    /// Does what the last request left undone. It may block for as long as the storage does, so call it
    /// once the reply is under way.
    pub fn settle(&mut self) {
        self.store.settle();
    }

    /// Stops streaming and forgets an unfinished upload: the host has gone.
    pub fn disconnect(&mut self) {
        self.streaming = Selection::default();
        self.upload = None;
    }

    /// Stops streaming if the host has been silent for [`HOST_TIMEOUT_MS`], where the link does not tell; says whether
    /// it did. Call it now and then.
    pub fn check_host(&mut self, uptime_ms: u64) -> bool {
        let silence = uptime_ms.saturating_sub(self.heard_ms);
        let has_gone = !self.facts.sees_host_go && self.streaming.any() && silence >= HOST_TIMEOUT_MS;
        if has_gone {
            self.streaming = Selection::default();
        }
        has_gone
    }

    /// Answers one request; `uptime_ms` is the time since the board started.
    pub fn handle(&mut self, packet: &RequestPacket, uptime_ms: u64) -> BoardPacket {
        self.heard_ms = uptime_ms;
        let reply = self.answer(&packet.request, uptime_ms).unwrap_or_else(Reply::Refused);
        BoardPacket::Reply { sequence: packet.sequence, reply }
    }

    /// Finishes one frame, takes it through the pipeline, and hands each event to `emit`, what is urgent first.
    pub fn process(&mut self, frame: &mut Frame, arrival: &Arrival, mut emit: impl FnMut(&BoardPacket)) {
        self.tell_reflexes(frame, arrival, &mut emit);
        if let Some(outcome) = self.finish(frame, arrival) {
            self.tell(frame, outcome, &mut emit);
        }
    }

    /// Takes a frame of a recording through the pipeline, as [`Self::process`] does one that was measured: with the time and
    /// the flags that it has, and with the health that was found in it then.
    pub fn replay(
        &mut self,
        frame: &mut Frame,
        health: Health,
        reflexes: Reflexes,
        mut emit: impl FnMut(&BoardPacket),
    ) {
        let arrival = Arrival { timestamp_us: frame.timestamp_us, missed: false, reflexes };
        self.tell_reflexes(frame, &arrival, &mut emit);
        frame.sequence = self.next_frame;
        self.next_frame = frame.sequence.wrapping_add(1);
        let Some(patch) = patch_in_use(&self.store, &self.header) else { return };
        pipeline::recall(self.pipeline.borrow_mut(), &health, frame);
        let outcome = pipeline::sense(&patch, self.pipeline.borrow_mut(), frame);
        frame.flags.insert(self.pipeline().flags());
        self.health = health;
        self.tell(frame, outcome, &mut emit);
    }

    /// Gives a frame all that it does not bring along: number, time, and the flags of board, wiring and pipeline;
    /// says what the pipeline made of it, with a patch.
    fn finish(&mut self, frame: &mut Frame, arrival: &Arrival) -> Option<Outcome> {
        frame.sequence = self.next_frame;
        self.next_frame = frame.sequence.wrapping_add(1);
        frame.timestamp_us = arrival.timestamp_us;
        frame.flags.insert_if(FrameFlags::MISSED, arrival.missed);
        self.missed += u32::from(arrival.missed);
        let is_hot = self.vitals.temperature.is_some_and(|celsius| celsius > HOT);
        frame.flags.insert_if(FrameFlags::HOT, is_hot);
        let patch = patch_in_use(&self.store, &self.header)?;
        if self.facts.front_end.is_some() {
            let frequency = self.drive.unwrap_or(patch.header.drive).frequency;
            self.health = pipeline::examine(&patch, self.pipeline.borrow_mut(), frequency, frame);
        }
        let outcome = pipeline::sense(&patch, self.pipeline.borrow_mut(), frame);
        frame.flags.insert(self.pipeline().flags());
        Some(outcome)
    }

    /// Whether the frame of this number is one whose scope a host wants.
    pub fn wants_scope(&self, sequence: u32) -> bool {
        is_every(self.streaming.scope, sequence)
    }

    /// Hands a scope event to `emit`.
    pub fn show_scope(&mut self, samples: &SlotSamples, mut emit: impl FnMut(&BoardPacket)) {
        emit(&BoardPacket::Event { number: self.take_number(), event: Event::Scope(samples.clone()) });
    }

    /// Number of the next event.
    fn take_number(&mut self) -> u32 {
        let number = self.next_event;
        self.next_event = number.wrapping_add(1);
        number
    }

    /// What the latest frame says, with contact impedances.
    fn whole_health(&self, frame: &Frame) -> Health {
        let mut health = self.health.clone();
        if let (Some(patch), Some(front_end), Some(drive)) =
            (self.patch(), &self.facts.front_end, self.drive())
        {
            health.measure_contacts(&patch, front_end.volts_per_code / drive.amplitude, &frame.tests);
        }
        health
    }

    /// Not inlined, so that the stack its events need is free while the frame is computed.
    #[inline(never)]
    fn tell(&mut self, frame: &Frame, outcome: Outcome, emit: &mut impl FnMut(&BoardPacket)) {
        let at =
            FrameStamp { sequence: frame.sequence, timestamp_us: frame.timestamp_us, flags: frame.flags };
        let wanted = |every| is_every(every, frame.sequence);
        let (streaming, is_image) = (self.streaming, outcome == Outcome::Image);
        if outcome == Outcome::Tared {
            let frames = self.pipeline().reference().map_or(0, Reference::frames);
            emit(&BoardPacket::Event { number: self.take_number(), event: Event::Tared { frames } });
        }
        if wanted(streaming.contacts) && is_image {
            let number = self.take_number();
            let contacts = self.pipeline().contacts().clone();
            emit(&BoardPacket::Event { number, event: Event::Contacts { at, contacts } });
        }
        if wanted(streaming.health) {
            let (health, drift) = (self.whole_health(frame), self.pipeline().common_drift());
            let (vitals, missed) = (self.vitals, self.missed);
            let event = Event::Health { at, health, vitals, drift, missed };
            emit(&BoardPacket::Event { number: self.take_number(), event });
        }
        if wanted(streaming.measurements) && outcome != Outcome::WrongLength {
            let (codes, quadrature) = (frame.codes.clone(), frame.quadrature.clone());
            let event = Event::Measurements { at, codes, quadrature };
            emit(&BoardPacket::Event { number: self.take_number(), event });
        }
        if wanted(streaming.images) && is_image {
            self.draw();
            let image = PackedImage::pack(self.pipeline().image());
            let event = Event::Image { at, image };
            emit(&BoardPacket::Event { number: self.take_number(), event });
        }
    }

    /// Makes the latest frame's image, if its contacts did without.
    fn draw(&mut self) {
        if self.header.as_ref().is_some_and(PatchHeader::has_places)
            && let Some(patch) = patch_in_use(&self.store, &self.header)
        {
            pipeline::draw(&patch, self.pipeline.borrow_mut());
        }
    }

    fn answer(&mut self, request: &Request, uptime_ms: u64) -> Result<Reply, Refusal> {
        match request {
            Request::Hello(version) => self.hello(*version),
            Request::Info => Ok(Reply::Info(self.info(uptime_ms))),
            Request::ReadPatch { offset } => self.read_patch(*offset),
            Request::Reference => self.reference(),
            Request::BeginUpload { length, crc } => self.begin_upload(*length, *crc),
            Request::UploadChunk { offset, bytes } => self.upload_chunk(*offset, bytes),
            Request::CommitUpload => self.commit_upload(),
            Request::Tare { frames } => self.tare(*frames),
            Request::Stream(selection) => self.stream(*selection),
            Request::Drive(drive) => self.set_drive(*drive),
            Request::Trim(trim) => self.keep_trim(trim),
        }
    }

    fn hello(&self, version: Version) -> Result<Reply, Refusal> {
        if version.protocol != PROTOCOL_VERSION {
            return Err(Refusal::Version { board: PROTOCOL_VERSION });
        }
        Ok(Reply::Hello { version: Version::current(), identity: self.facts.identity.clone() })
    }

    fn info(&self, uptime_ms: u64) -> Info {
        Info {
            electrodes: self.facts.electrodes,
            max_patch_bytes: MAX_PATCH_BYTES as u32,
            frame_source: self.facts.frame_source,
            front_end: self.facts.front_end,
            drive: self.drive(),
            started_after: self.facts.started_after.clone(),
            uptime_ms,
            patch: self.patch().map(|patch| PatchInfo {
                crc: patch.crc(),
                electrodes: patch.header.electrodes,
                steps: patch.header.steps,
                measurements: patch.header.measurements,
                pixels: patch.header.pixels,
                drive: patch.header.drive,
                skin: patch.header.skin,
            }),
            tared: self.pipeline().reference().is_some(),
            streaming: self.streaming,
        }
    }

    fn read_patch(&self, offset: u32) -> Result<Reply, Refusal> {
        let patch = self.patch().ok_or(Refusal::NoPatch)?;
        let rest = patch.bytes().get(offset as usize..).unwrap_or_default();
        let piece = &rest[..rest.len().min(MAX_CHUNK_BYTES)];
        Ok(Reply::Patch { bytes: Vec::from_slice(piece).unwrap_or_default() })
    }

    fn reference(&self) -> Result<Reply, Refusal> {
        let reference = self.pipeline().reference().ok_or(Refusal::NotTared)?;
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
        self.store.settle();
        let staged = PatchView::validate(self.store.staged()).map_err(|_| Refusal::BadPatch)?;
        if staged.crc() != upload.crc {
            return Err(Refusal::BadPatch);
        }
        let (patch, board) = (staged.header.electrodes, self.facts.electrodes);
        if patch > board {
            return Err(Refusal::Electrodes { patch, board });
        }
        self.check_drive(&staged.header.drive)?;
        let header = staged.header;
        self.store.commit()?;
        self.header = Some(header);
        self.streaming = Selection::default();
        self.drive = None;
        self.begin_scan();
        Ok(Reply::Done)
    }

    /// Everything measured so far counts no more.
    fn begin_scan(&mut self) {
        self.pipeline.borrow_mut().clear();
        self.scan = self.scan.wrapping_add(1);
    }

    fn set_drive(&mut self, drive: Option<Drive>) -> Result<Reply, Refusal> {
        self.patch().ok_or(Refusal::NoPatch)?;
        drive.map_or(Ok(()), |drive| self.check_drive(&drive))?;
        self.drive = drive;
        self.begin_scan();
        Ok(Reply::Done)
    }

    fn keep_trim(&mut self, trim: &Trim) -> Result<Reply, Refusal> {
        let front_end = self.facts.front_end.as_mut().ok_or(Refusal::Unsupported)?;
        if !trim.is_plausible() {
            return Err(Refusal::Trim);
        }
        self.store.keep_trim(trim)?;
        front_end.trim = *trim;
        self.begin_scan();
        Ok(Reply::Done)
    }

    /// Whether the front end, if there is one, can drive a skin like that.
    fn check_drive(&self, drive: &Drive) -> Result<(), Refusal> {
        let Some(front_end) = &self.facts.front_end else { return Ok(()) };
        let fits = drive.check().is_ok()
            && front_end.reaches(drive.amplitude)
            && drive.gain.is_within(front_end.largest_gain)
            && Timing::new(drive, front_end.sample_rate).is_some();
        let max_microamperes = (front_end.full_scale_current * 1e6) as u32;
        let max_gain = front_end.largest_gain;
        if fits { Ok(()) } else { Err(Refusal::Drive { max_microamperes, max_gain }) }
    }

    fn tare(&mut self, frames: u16) -> Result<Reply, Refusal> {
        self.patch().ok_or(Refusal::NoPatch)?;
        if !(1..=MAX_TARE_FRAMES).contains(&frames) {
            return Err(Refusal::TareFrames { max: MAX_TARE_FRAMES });
        }
        // Gains may be better now.
        self.begin_scan();
        self.pipeline.borrow_mut().start_tare(frames);
        Ok(Reply::Done)
    }

    fn stream(&mut self, selection: Selection) -> Result<Reply, Refusal> {
        let last = scan::slots(&self.patch().ok_or(Refusal::NoPatch)?).len().saturating_sub(1) as u16;
        if selection.scope > 0 && selection.scope_slot > last {
            return Err(Refusal::Slot { last });
        }
        self.streaming = selection;
        self.reflexes_told = None;
        Ok(Reply::Streaming { first_sequence: self.next_frame })
    }
}

/// Whether a frame is one of those that a stream of every so many takes; 0 takes none.
fn is_every(every: u16, sequence: u32) -> bool {
    every > 0 && sequence.is_multiple_of(every.into())
}

fn patch_in_use<'a, S: PatchStore>(store: &'a S, header: &Option<PatchHeader>) -> Option<PatchView<'a>> {
    PatchView::reopen(header.clone()?, store.active()?).ok()
}

#[cfg(test)]
mod tests;
