//! Link: requests to a board, its replies and its events.
//!
//! Opening a link sends one zero byte, which ends any line noise, then `Hello`: board and host
//! compare protocol version and schema hash before anything else is said. One request is under
//! way at a time. Events that arrive in between are kept, in order.
//! Nothing is lost silently: see [`Link::events_lost`] and [`Link::packets_damaged`].

mod bus;
mod hello;
mod order;
mod sequence;
mod sound;
mod tare;
mod transport;
mod untouched;
mod upload;
mod wire;

pub use tare::{is_tared, tare, tare_timeout};
pub use transport::{REPLY_TIMEOUT, Transport};
pub use untouched::Untouched;
pub use upload::{UploadError, upload};

use crate::{
    error::{LinkError, LinkErrorKind},
    port::{Bus, Port},
};
use bus::Demand;
use dermatome_patch::tables::SurfaceTables;
use dermatome_shared::{
    limits::MAX_PATCH_BYTES,
    patch::{CombinedInto, PatchError, PatchView},
    protocol::{
        BoardPacket, Event, Identity, Info, MAX_CHUNK_BYTES, Reply, Request, RequestPacket, Selection,
    },
    stimulation::Step,
};
use order::Order;
use std::{collections::VecDeque, net::ToSocketAddrs, time::Duration};
use wire::Wire;

/// Most events kept for a host that asks much and listens little; older ones count as lost.
const MAX_QUEUED_EVENTS: usize = 4096;

/// Events that come in order at once, at most, if each is fetched.
const EVENTS_AT_ONCE: usize = 32;

/// After this time without an answer a request is sent again, with the number that it had: it or its reply may be lost.
const ASK_AGAIN: Duration = Duration::from_millis(500);

/// What others have waited for so long, or what has not come after so much silence, will not come.
pub(crate) const PARTS_TIMEOUT: Duration = Duration::from_secs(1);

/// An event with its running number.
pub(crate) type Numbered = (u32, Event);

/// What a board has sent.
pub(crate) enum Arrived {
    /// An event with its running number, in its turn.
    Event(u32, Event),
    /// A reply with the number of its request.
    Reply(u16, Reply),
    /// Nothing more so far.
    Nothing,
}

/// A link to one board.
pub struct Link {
    wire: Wire,
    identity: Identity,
    last_sequence: u16,
    order: Order,
    /// In order.
    events: VecDeque<Numbered>,
    /// Events of which there were more than are kept.
    events_forgotten: u64,
    /// Where it is on a bus with other boards.
    place: Option<bus::Place>,
    /// Dropped after the wire, so that a simulated board sees its client leave.
    _companion: Option<Box<dyn Send>>,
}

/// Opens a board's `port`.
pub fn open(port: &Port) -> Result<Link, LinkError> {
    let name = port.to_string();
    match port {
        Port::Serial(path) => {
            let serial = transport::open_serial(&name, path)?;
            Link::connect(name, serial)
        }
        Port::Tcp(address) => Link::over_tcp(name, address.as_str()),
        Port::Bus(bus, address) => Link::on_bus(name, bus, *address),
    }
}

impl Link {
    /// Says hello over `transport` and checks that board and host understand each other.
    /// `port` names the transport in errors.
    pub fn connect(port: impl Into<String>, transport: impl Transport + 'static) -> Result<Self, LinkError> {
        let mut wire = Wire::new(port.into().into(), Box::new(transport));
        let identity = hello::hello(&mut wire)?;
        // What came in before was not meant for this link.
        wire.forget_damage();
        Ok(Self {
            wire,
            identity,
            last_sequence: sequence::begin(),
            order: Order::default(),
            // As many as come at once when one that others have waited for is there, or is given up.
            events: VecDeque::with_capacity(EVENTS_AT_ONCE),
            events_forgotten: 0,
            place: None,
            _companion: None,
        })
    }

    /// Connects to a board that listens at a TCP address; `port` names it in errors.
    pub fn over_tcp(port: impl Into<String>, address: impl ToSocketAddrs) -> Result<Self, LinkError> {
        let port = port.into();
        let transport = transport::open_tcp(&port, address)?;
        Self::connect(port, transport)
    }

    /// Opens the bus of several boards, unless this program has it open already, and connects to the one at `address`.
    fn on_bus(port: String, bus: &Bus, address: u8) -> Result<Self, LinkError> {
        let seat = bus::take_seat(&port, bus, address)?;
        let place = seat.place();
        Ok(Self { place: Some(place), ..Self::connect(port, seat)? })
    }

    /// The link with something that lives as long as it does and is dropped after it: a simulated board.
    #[must_use]
    pub fn with_companion(self, companion: impl Send + 'static) -> Self {
        Self { _companion: Some(Box::new(companion)), ..self }
    }

    /// The link with requests that count from the one after `sequence`, instead of from a number that is drawn: for boards
    /// whose every byte is to be the same each time.
    #[must_use]
    pub fn counting_from(self, sequence: u16) -> Self {
        Self { last_sequence: sequence, ..self }
    }

    /// The port as written.
    #[must_use]
    pub fn port(&self) -> &str {
        &self.wire.port
    }

    /// Who the board is.
    #[must_use]
    pub fn identity(&self) -> &Identity {
        &self.identity
    }

    /// Events the board sent and this link did not get, by the gaps in their running number.
    ///
    /// Counted from the first event received.
    #[must_use]
    pub fn events_lost(&self) -> u64 {
        self.order.lost() + self.events_forgotten
    }

    /// Packets received that were not readable.
    #[must_use]
    pub fn packets_damaged(&self) -> u64 {
        self.wire.damaged()
    }

    /// Asks the board and waits for its reply, at most [`REPLY_TIMEOUT`]. A refusal is an error.
    pub fn request(&mut self, request: &Request) -> Result<Reply, LinkError> {
        self.request_within(request, REPLY_TIMEOUT)
    }

    /// As [`Self::request`], for what takes a board longer.
    pub fn request_within(&mut self, request: &Request, timeout: Duration) -> Result<Reply, LinkError> {
        let damaged_before = self.wire.damaged();
        let asked = self.wire.time();
        self.send(request)?;
        let deadline = asked + timeout;
        let mut ask_again = asked + ASK_AGAIN;
        while self.wire.time() < deadline {
            match self.wire.receive(deadline.min(ask_again))? {
                Some(BoardPacket::Reply { sequence, reply }) if sequence == self.last_sequence => {
                    log::debug!(
                        "asked {}, answered after {:.1} ms",
                        name(request),
                        1e3 * (self.wire.time() - asked).as_secs_f64()
                    );
                    return self.unless_refused(reply);
                }
                // A late reply to a request that was given up, or to another host.
                Some(BoardPacket::Reply { .. }) => {}
                Some(BoardPacket::Event { number, event }) => self.keep(number, event),
                None if may_be_repeated(request) => {
                    self.wire
                        .send(&RequestPacket { sequence: self.last_sequence, request: request.clone() })?;
                    ask_again = self.wire.time() + ASK_AGAIN;
                }
                None => ask_again = deadline,
            }
        }
        Err(self.wire.no_answer(timeout, damaged_before))
    }

    /// Asks for something and does not wait, so that the board knows that a host is there
    /// ([`dermatome_shared::device::HOST_TIMEOUT_MS`]). The reply counts as a late one.
    pub(crate) fn show_presence(&mut self) -> Result<(), LinkError> {
        self.send(&Request::Info)
    }

    fn send(&mut self, request: &Request) -> Result<(), LinkError> {
        let packet = self.numbered(request);
        self.wire.send(&packet)
    }

    /// A request with the next number.
    fn numbered(&mut self, request: &Request) -> RequestPacket {
        self.last_sequence = sequence::next(self.last_sequence);
        RequestPacket { sequence: self.last_sequence, request: request.clone() }
    }

    /// What the board holds and does.
    pub fn info(&mut self) -> Result<Info, LinkError> {
        match self.request(&Request::Info)? {
            Reply::Info(info) => Ok(info),
            _ => Err(self.wrong_reply("Info")),
        }
    }

    /// Which pixels the board's images have, and where: read back from the start of its patch.
    pub fn surface(&mut self) -> Result<SurfaceTables, LinkError> {
        self.start_of_patch(SurfaceTables::read)
    }

    /// The steps of a frame: read back from the start of the board's patch.
    pub fn steps(&mut self) -> Result<Vec<Step>, LinkError> {
        self.start_of_patch(|patch| patch.steps().collect())
    }

    /// Relative conductivity change that is a contact in the image.
    pub fn contact_threshold(&mut self) -> Result<f64, LinkError> {
        self.start_of_patch(|patch| patch.header.contact_threshold.to_f64())
    }

    /// Whether the board's patch was calibrated.
    pub fn is_calibrated(&mut self) -> Result<bool, LinkError> {
        self.start_of_patch(|patch| {
            !patch.header.calibration.points.is_empty() || patch.header.play_operators > 0
        })
    }

    /// What the sheet adds to each electrode's test by the patch's model, ohm: `[electrode]`; empty if unknown.
    pub fn test_resistances(&mut self) -> Result<Vec<f32>, LinkError> {
        self.start_of_patch(|patch| patch.header.test_resistances.to_vec())
    }

    /// Where the code of each step goes: `[step]`; read back from the start of the board's patch.
    pub fn combination(&mut self) -> Result<Vec<CombinedInto>, LinkError> {
        self.start_of_patch(|patch| patch.combination().collect())
    }

    /// The patch in use, whole, which takes as many requests as it has pieces.
    pub fn patch(&mut self) -> Result<Vec<u8>, LinkError> {
        let mut patch = Vec::new();
        loop {
            let piece = self.read_patch(patch.len() as u32)?;
            patch.extend_from_slice(&piece);
            if piece.len() < MAX_CHUNK_BYTES {
                break;
            }
            if patch.len() > MAX_PATCH_BYTES {
                return Err(self.wrong_reply("ReadPatch"));
            }
        }
        match PatchView::validate(&patch) {
            Ok(_) => Ok(patch),
            Err(_) => Err(self.wrong_reply("ReadPatch")),
        }
    }

    /// Something of the patch in use that lies before its matrix. No more is read than the board states, nor than
    /// the longest patch has.
    fn start_of_patch<T>(&mut self, read: impl Fn(&PatchView<'_>) -> T) -> Result<T, LinkError> {
        let mut start = Vec::new();
        loop {
            match PatchView::open_start(&start) {
                Ok((patch, _)) => return Ok(read(&patch)),
                Err(PatchError::Length { expected, .. })
                    if start.len() < expected && expected <= MAX_PATCH_BYTES =>
                {
                    let piece = self.read_patch(start.len() as u32)?;
                    start.extend_from_slice(&piece);
                    if piece.is_empty() {
                        return Err(self.wrong_reply("ReadPatch"));
                    }
                }
                Err(_) => return Err(self.wrong_reply("ReadPatch")),
            }
        }
    }

    /// Bytes of the patch in use from `offset` on, as many as one reply holds.
    fn read_patch(&mut self, offset: u32) -> Result<Vec<u8>, LinkError> {
        match self.request(&Request::ReadPatch { offset })? {
            Reply::Patch { bytes } => Ok(bytes.to_vec()),
            _ => Err(self.wrong_reply("ReadPatch")),
        }
    }

    /// How long no byte has come, not even of an event that is long.
    pub(crate) fn silence(&self) -> Duration {
        self.wire.silence()
    }

    /// The next event, or `None` if there is none within `timeout` (20 ms at least).
    pub(crate) fn next_event(&mut self, timeout: Duration) -> Result<Option<Numbered>, LinkError> {
        match self.events.pop_front() {
            Some(event) => Ok(Some(event)),
            None => self.wait_for(timeout, |_| true),
        }
    }

    /// From now on a request or an event is not waited for, or is again.
    pub(crate) fn set_waiting(&mut self, waits: bool) -> Result<(), LinkError> {
        self.wire.set_waiting(waits)
    }

    /// What becomes readable when bytes come.
    #[cfg(unix)]
    pub(crate) fn descriptor(&self) -> Option<std::os::fd::RawFd> {
        self.wire.descriptor()
    }

    /// What has come next; does not wait for anything.
    pub(crate) fn arrived(&mut self) -> Result<Arrived, LinkError> {
        while self.events.is_empty() {
            match self.wire.arrived()? {
                Some(BoardPacket::Event { number, event }) => self.keep(number, event),
                Some(BoardPacket::Reply { sequence, reply }) => return Ok(Arrived::Reply(sequence, reply)),
                None if self.order.waited(self.wire.time()) < PARTS_TIMEOUT => break,
                None => {
                    self.order.give_up(|event| self.events.push_back(event));
                    break;
                }
            }
        }
        Ok(self.events.pop_front().map_or(Arrived::Nothing, |(number, event)| Arrived::Event(number, event)))
    }

    /// Asks, and waits neither for the line to take the request nor for the reply; gives the number of the request.
    pub(crate) fn begin_to_ask(&mut self, request: &Request) -> Result<u16, LinkError> {
        let packet = self.numbered(request);
        self.wire.begin_to_send(&packet)?;
        Ok(self.last_sequence)
    }

    /// Sends more of what [`Self::begin_to_ask`] has begun; says whether all of it is sent.
    pub(crate) fn flush(&mut self) -> Result<bool, LinkError> {
        self.wire.flush()
    }

    /// Waits for a new event that is `wanted`, and keeps the others.
    fn wait_for(
        &mut self,
        timeout: Duration,
        wanted: impl Fn(&Event) -> bool,
    ) -> Result<Option<Numbered>, LinkError> {
        let deadline = self.wire.time() + timeout.max(transport::READ_TIMEOUT);
        loop {
            let packet = self.wire.receive(deadline)?;
            let is_silent = packet.is_none();
            let known = self.events.len().min(MAX_QUEUED_EVENTS - 1);
            match packet {
                Some(BoardPacket::Event { number, event }) => self.keep(number, event),
                Some(BoardPacket::Reply { .. }) => {}
                // A long event takes its time on the line.
                None if self.order.waited(self.wire.time()) < PARTS_TIMEOUT => {}
                None => self.order.give_up(|event| self.events.push_back(event)),
            }
            let place = self.events.iter().skip(known).position(|(_, event)| wanted(event));
            if let Some(place) = place {
                return Ok(self.events.remove(known + place));
            }
            if is_silent {
                return Ok(None);
            }
        }
    }

    fn keep(&mut self, number: u32, event: Event) {
        if self.events.len() >= MAX_QUEUED_EVENTS {
            self.events.pop_front();
            self.events_forgotten += 1;
        }
        let now = self.wire.time();
        self.order.take(number, event, now, |event| self.events.push_back(event));
    }

    /// On a bus with others: how many boards it is for, those included that are not open yet.
    pub fn share_bus(&self, boards: usize) {
        if let Some(place) = &self.place {
            place.share_with(boards);
        }
    }

    /// What of a selection goes over the link: on a bus with others, images are left out of frames until it fits.
    pub(crate) fn fitting(&mut self, selection: Selection) -> Result<Selection, LinkError> {
        let Some(place) = self.place.clone().filter(|_| selection.any()) else { return Ok(selection) };
        let info = self.info()?;
        let Some(patch) = info.patch else { return Ok(selection) };
        let demand = Demand::of(&patch, &info.drive.unwrap_or(patch.drive));
        place.fit(selection, &demand).map_err(|overload| self.error(LinkErrorKind::Overload(overload)))
    }

    /// Changes what the board streams, within `timeout`; gives the sequence number of the first frame of the new
    /// selection. Events that nobody fetched go to `left`.
    pub(crate) fn select(
        &mut self,
        selection: Selection,
        timeout: Duration,
        left: impl FnMut(Numbered),
    ) -> Result<u32, LinkError> {
        let reply = self.request_within(&Request::Stream(selection), timeout)?;
        if let Some(place) = self.place.as_ref().filter(|_| !selection.any()) {
            place.release();
        }
        let Reply::Streaming { first_sequence } = reply else { return Err(self.wrong_reply("Stream")) };
        self.order.begin(&selection, |event| self.events.push_back(event));
        self.events.drain(..).for_each(left);
        Ok(first_sequence)
    }

    pub(crate) fn unless_refused(&self, reply: Reply) -> Result<Reply, LinkError> {
        match reply {
            Reply::Refused(refusal) => Err(self.error(LinkErrorKind::Refused(refusal))),
            reply => Ok(reply),
        }
    }

    fn wrong_reply(&self, request: &'static str) -> LinkError {
        self.error(LinkErrorKind::WrongReply { request })
    }

    /// Something that went wrong at this link's port.
    #[must_use]
    pub fn error(&self, kind: LinkErrorKind) -> LinkError {
        self.wire.error(kind)
    }
}

/// Whether a board that gets a request twice is in the same state as after the first.
fn may_be_repeated(request: &Request) -> bool {
    matches!(request, Request::Info | Request::ReadPatch { .. } | Request::Reference | Request::Stream(_))
}

/// The name of a request, without what goes with it.
fn name(request: &Request) -> String {
    let all = format!("{request:?}");
    all.split(|c: char| !c.is_alphanumeric()).next().unwrap_or_default().to_owned()
}
