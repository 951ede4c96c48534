//! Node: what an FDCAN does on its bus: joins it, sends, receives, counts errors, leaves it (RM0440 44.3.4 to 44.3.6).
//!
//! The bus itself is outside. It looks whether a node takes part and what it wants to send, and brings news, each with its
//! time: what became of a frame, and how long the bus was quiet.

use super::{
    Fdcan, PROTOCOL_NAMES,
    frame::{Frame, Rates},
    memory::FRAMES,
};
use crate::chip::{time::Time, trace::Event};

/// Recessive bits in a row after which a node takes part.
const JOINS_AFTER: u64 = 11;
/// How often those must have come before a node that went off the bus takes part again.
const RECOVERS_AFTER: u64 = 129 * JOINS_AFTER;
/// Bits that a passive node waits for after a frame that it sent.
const SUSPENDED: u64 = 8;

/// What happens on the bus, as a node sees it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum News {
    /// The frame that it sent was acknowledged.
    Sent,
    /// The frame that it sent met an error.
    Failed(LineError),
    /// Another one's frame came.
    Received(Frame),
    /// Another one's frame met an error; whether this node noticed it first.
    Disturbed(bool),
    /// The bus was recessive for so long.
    Quiet(Time),
}

/// What was wrong with a frame, by the code of PSR.LEC.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LineError {
    /// Nobody acknowledged it.
    Acknowledge = 3,
    /// A bit on the bus was dominant, which was sent as recessive.
    Bit = 4,
    /// A checksum or stuff bits were wrong.
    Crc = 6,
}

/// How far a node is from the bus.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Presence {
    /// CCCR.INIT is 1.
    Off,
    /// It waits until the bus has been quiet for so long.
    Joining(Time),
    /// It takes part.
    On,
}

/// A FIFO of frames: where the first one lies, and how many there are.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Fifo {
    pub(super) first: usize,
    pub(super) fill: usize,
}

/// A transmit buffer that is to be sent.
#[derive(Clone, Copy, Debug)]
pub(super) struct Request {
    pub(super) buffer: usize,
    since: Time,
    pub(super) is_cancelled: bool,
}

impl Fdcan {
    /// Whether it takes part in the bus: it acknowledges what it hears, and may send.
    #[must_use]
    pub fn is_on(&self) -> bool {
        self.presence == Presence::On && self.wired == [true; 2]
    }

    /// Whether it waits for the bus to be quiet.
    #[must_use]
    pub fn is_joining(&self) -> bool {
        matches!(self.presence, Presence::Joining(_))
    }

    /// Whether its error flags are recessive, so that nobody else notices them.
    #[must_use]
    pub fn is_passive(&self) -> bool {
        self.counters.is_passive()
    }

    /// Whether it sends a frame.
    #[must_use]
    pub fn is_sending(&self) -> bool {
        self.sending.is_some()
    }

    /// Bits per second that its registers ask for.
    #[must_use]
    pub fn rates(&self) -> Rates {
        let clock = self.clock.hertz / u64::from((2 * self.bank.get("CKDIV", "PDIV")).max(1));
        let rate = |register, [divider, before, after]: [&str; 3]| {
            let get = |field| u64::from(self.bank.get(register, field)) + 1;
            clock / (get(divider) * (1 + get(before) + get(after)))
        };
        let nominal = rate("NBTP", ["NBRP", "NTSEG1", "NTSEG2"]).max(1);
        Rates { nominal, data: rate("DBTP", ["DBRP", "DTSEG1", "DTSEG2"]).max(1) }
    }

    /// The frame that it would send next, and since when.
    #[must_use]
    pub fn request(&self) -> Option<(Time, Frame)> {
        let request = self.next_request().filter(|_| self.is_on())?;
        let frame = self.ram.to_send(request.buffer).ok()?;
        Some((request.since.max(self.not_before), frame))
    }

    /// What it requests goes over the bus from now on.
    pub fn begin(&mut self) {
        self.sending = self.next_request().map(|request| request.buffer);
    }

    /// News come at this time, which is still to come.
    pub fn hear(&mut self, at: Time, news: News) {
        self.news.push_back((at, news));
    }

    /// Frames that it put into its FIFOs since its power came up or it was reset.
    #[must_use]
    pub fn received(&self) -> usize {
        self.received
    }

    /// Frames for which its FIFOs had no room, since then.
    #[must_use]
    pub fn lost(&self) -> usize {
        self.lost
    }

    /// What it sent and received since this was asked last.
    pub fn take_passed(&mut self) -> Vec<(Time, Event)> {
        std::mem::take(&mut self.passed)
    }

    /// The board has no power: what was on its way is lost.
    pub fn unplug(&mut self) {
        self.news.clear();
    }

    /// In the order in which they were asked for, or the lowest identifier first.
    fn next_request(&self) -> Option<Request> {
        if !self.is_queue() {
            return self.requests.front().copied();
        }
        let identifier = |request: &&Request| {
            (self.ram.to_send(request.buffer).map_or(u16::MAX, |frame| frame.identifier), request.buffer)
        };
        self.requests.iter().min_by_key(identifier).copied()
    }

    pub(super) fn ask(&mut self, buffer: usize, since: Time) {
        self.requests.push_back(Request { buffer, since, is_cancelled: false });
        self.ram.pending[buffer] = true;
    }

    /// A buffer is no longer to be sent.
    pub(super) fn forget(&mut self, buffer: usize) {
        self.requests.retain(|request| request.buffer != buffer);
        self.ram.pending[buffer] = false;
    }

    /// It leaves the bus, in the middle of whatever it does.
    pub(super) fn leave(&mut self) {
        self.presence = Presence::Off;
        self.sending = None;
    }

    /// It takes part as soon as the bus has been quiet.
    pub(super) fn join(&mut self) {
        let bits = if self.is_off { RECOVERS_AFTER } else { JOINS_AFTER };
        self.presence = Presence::Joining(self.rates().bits(bits));
    }

    pub(super) fn take_news(&mut self, now: Time) {
        while self.news.front().is_some_and(|(at, _)| *at <= now) {
            let Some((at, news)) = self.news.pop_front() else { return };
            match news {
                News::Quiet(span) => self.pass_quiet(span),
                _ if self.presence != Presence::On => {}
                News::Sent => self.note_sent(at),
                News::Failed(error) => self.note_failed(error, at),
                News::Received(frame) => self.note_received(&frame, at),
                News::Disturbed(first) => {
                    self.count_errors(|counters| counters.disturbed(first));
                    self.note_error(LineError::Crc);
                }
            }
        }
    }

    fn pass_quiet(&mut self, span: Time) {
        let Presence::Joining(left) = self.presence else { return };
        self.presence = Presence::Joining(left - span);
        if left <= span {
            self.presence = Presence::On;
            if std::mem::take(&mut self.is_off) {
                self.counters = super::Counters::default();
                self.raise("BO");
            }
        }
    }

    fn note_sent(&mut self, at: Time) {
        let Some(buffer) = self.sending.take() else { return };
        let event = self.ram.to_send(buffer).map(|frame| framed(&frame, true));
        self.passed.extend(event.ok().map(|event| (at, event)));
        self.forget(buffer);
        self.suspend(at);
        self.count_errors(super::Counters::sent);
        self.bank.set("TXBTO", &format!("TO[{buffer}]"), 1);
        if self.bank.is_set("TXBTIE", &format!("TIE[{buffer}]")) {
            self.raise("TC");
        }
        if self.requests.is_empty() {
            self.raise("TFE");
        }
    }

    fn note_failed(&mut self, error: LineError, at: Time) {
        let Some(buffer) = self.sending.take() else { return };
        self.suspend(at);
        self.count_errors(|counters| counters.failed(error == LineError::Acknowledge));
        self.note_error(error);
        if self.requests.iter().any(|request| request.buffer == buffer && request.is_cancelled) {
            self.cancel(buffer);
        }
        if self.counters.is_off() {
            self.is_off = true;
            self.bank.set("CCCR", "INIT", 1);
            self.leave();
            self.raise("BO");
        }
    }

    /// A passive node lets others go first.
    fn suspend(&mut self, at: Time) {
        if self.is_passive() {
            self.not_before = at + self.rates().bits(super::frame::INTERMISSION + SUSPENDED);
        }
    }

    fn note_received(&mut self, frame: &Frame, at: Time) {
        self.count_errors(super::Counters::received);
        if frame.format != super::frame::Format::Classic {
            self.bank.set("PSR", "REDL", 1);
            self.bank.set("PSR", "RBRS", u32::from(frame.format == super::frame::Format::Switching));
        }
        let Some((fifo, filter)) = self.filtered(frame.identifier) else { return };
        let Fifo { first, fill } = self.fifos[fifo];
        if fill == FRAMES {
            self.lost += 1;
            self.raise(&format!("RFL[{fifo}]"));
            return;
        }
        self.ram.store(fifo, (first + fill) % FRAMES, frame, filter);
        self.fifos[fifo].fill += 1;
        self.received += 1;
        self.passed.push((at, framed(frame, false)));
        self.raise(&format!("RFN[{fifo}]"));
        if fill + 1 == FRAMES {
            self.raise(&format!("RFF[{fifo}]"));
        }
    }

    /// The FIFO that a frame goes to, and the filter that sends it there; none if it is dropped.
    fn filtered(&self, identifier: u16) -> Option<(usize, Option<usize>)> {
        for place in 0..self.bank.get("RXGFC", "LSS") as usize {
            let filter = self.ram.filter(place);
            let [first, second] = [filter >> 16, filter].map(|bits| (bits & 0x7FF) as u16);
            let matches = match filter >> 30 {
                0 => (first..=second).contains(&identifier),
                1 => [first, second].contains(&identifier),
                2 => (identifier ^ first) & second == 0,
                _ => false,
            };
            match filter >> 27 & 7 {
                action @ (1 | 2) if matches => return Some((action as usize - 1, Some(place))),
                3 if matches => return None,
                _ => {}
            }
        }
        match self.bank.get("RXGFC", "ANFS") {
            fifo @ (0 | 1) => Some((fifo as usize, None)),
            _ => None,
        }
    }

    /// Counts, and notes where that changes what the node may do.
    fn count_errors(&mut self, count: impl FnOnce(&mut super::Counters)) {
        let before = self.counters;
        count(&mut self.counters);
        let after = self.counters;
        if before.is_passive() != after.is_passive() {
            self.raise("EP");
        }
        if before.is_warned() != after.is_warned() {
            self.raise("EW");
        }
    }

    fn note_error(&mut self, error: LineError) {
        self.bank.set("PSR", "LEC", error as u32);
        let logged = self.bank.get("ECR", "CEL");
        self.bank.set("ECR", "CEL", (logged + 1).min(255));
        self.raise(PROTOCOL_NAMES[usize::from(error != LineError::Acknowledge)]);
    }
}

fn framed(frame: &Frame, is_sent: bool) -> Event {
    Event::Framed { is_sent, identifier: frame.identifier, bytes: frame.data.len() as u8 }
}
