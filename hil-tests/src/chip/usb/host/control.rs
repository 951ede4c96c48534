//! Control: one request to the device, as a host carries it out in stages (USB 2.0, 8.5.3).

use crate::chip::{time::Time, usb::device::Answer};

/// Bytes of a packet of endpoint 0.
const PACKET: usize = 64;
/// Longest that a request may take (USB 2.0, 9.2.6.1).
const LONGEST: Time = Time::from_millis(5000);
/// So often a packet that nobody answers is sent.
const ATTEMPTS: u32 = 3;

/// Why a request was not carried out.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum Refused {
    /// The device does not know it.
    #[error("it is refused (STALL)")]
    Stall,
    /// The device does not answer.
    #[error("nobody answers")]
    Silence,
    /// The device is not done after five seconds.
    #[error("it is not done in time")]
    Late,
    /// The device breaks the protocol.
    #[error("{0}")]
    Wrong(&'static str),
}

/// A request.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Request {
    /// What is asked.
    pub setup: [u8; 8],
    /// What goes with it.
    pub data: Vec<u8>,
}

impl Request {
    /// A request that takes no data along, or brings some.
    #[must_use]
    pub fn new(kind: u8, request: u8, value: u16, index: u16, length: u16) -> Self {
        let ([a, b], [c, d], [e, f]) = (value.to_le_bytes(), index.to_le_bytes(), length.to_le_bytes());
        Self { setup: [kind, request, a, b, c, d, e, f], data: Vec::new() }
    }

    /// A request that takes data along.
    #[must_use]
    pub fn with(kind: u8, request: u8, value: u16, index: u16, data: &[u8]) -> Self {
        Self { data: data.to_vec(), ..Self::new(kind, request, value, index, data.len() as u16) }
    }

    fn wanted(&self) -> usize {
        u16::from_le_bytes([self.setup[6], self.setup[7]]).into()
    }

    fn brings_data(&self) -> bool {
        self.setup[0] & 0x80 != 0 && self.wanted() > 0
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Stage {
    Setup,
    In,
    Out,
    StatusIn,
    StatusOut,
}

/// A request that is carried out.
#[derive(Clone, Debug)]
pub(super) struct Control {
    pub(super) request: Request,
    stage: Stage,
    toggle: bool,
    brought: Vec<u8>,
    taken: usize,
    unanswered: u32,
    deadline: Time,
}

/// The next packet of it.
pub(super) enum Packet {
    Setup([u8; 8]),
    Out(bool, Vec<u8>),
    In,
}

impl Control {
    pub(super) fn new(request: Request, now: Time) -> Self {
        let deadline = now + LONGEST;
        Self {
            request,
            stage: Stage::Setup,
            toggle: false,
            brought: Vec::new(),
            taken: 0,
            unanswered: 0,
            deadline,
        }
    }

    pub(super) fn packet(&self) -> Packet {
        match self.stage {
            Stage::Setup => Packet::Setup(self.request.setup),
            Stage::Out => {
                let end = self.request.data.len().min(self.taken + PACKET);
                Packet::Out(self.toggle, self.request.data[self.taken..end].to_vec())
            }
            Stage::StatusOut => Packet::Out(true, Vec::new()),
            Stage::In | Stage::StatusIn => Packet::In,
        }
    }

    /// Takes the device's answer; gives what came of it all when it is at its end.
    pub(super) fn take(&mut self, answer: Answer, now: Time) -> Option<Result<Vec<u8>, Refused>> {
        if now > self.deadline {
            return Some(Err(Refused::Late));
        }
        match answer {
            Answer::Silence => {
                self.unanswered += 1;
                return (self.unanswered == ATTEMPTS).then_some(Err(Refused::Silence));
            }
            Answer::Nak if self.stage == Stage::Setup => {
                return Some(Err(Refused::Wrong("a SETUP gets no ACK")));
            }
            Answer::Nak => return None,
            Answer::Stall => return Some(Err(Refused::Stall)),
            Answer::Ack | Answer::Data(..) => self.unanswered = 0,
        }
        match (self.stage, answer) {
            (Stage::Setup, _) => {
                self.toggle = true;
                self.stage = match (self.request.brings_data(), self.request.data.is_empty()) {
                    (true, _) => Stage::In,
                    (false, false) => Stage::Out,
                    (false, true) => Stage::StatusIn,
                };
            }
            (Stage::Out, _) => {
                self.taken += PACKET;
                self.toggle = !self.toggle;
                if self.taken >= self.request.data.len() {
                    self.stage = Stage::StatusIn;
                }
            }
            (Stage::In, Answer::Data(toggle, bytes)) if toggle == self.toggle => {
                self.toggle = !toggle;
                self.brought.extend_from_slice(&bytes);
                if self.brought.len() > self.request.wanted() {
                    return Some(Err(Refused::Wrong("it sends more than is asked for")));
                }
                if bytes.len() < PACKET || self.brought.len() == self.request.wanted() {
                    self.stage = Stage::StatusOut;
                }
            }
            (Stage::StatusIn, Answer::Data(true, bytes)) if bytes.is_empty() => return Some(Ok(Vec::new())),
            (Stage::StatusIn, _) => return Some(Err(Refused::Wrong("a status is no empty DATA1"))),
            (Stage::StatusOut, _) => return Some(Ok(std::mem::take(&mut self.brought))),
            // One that came before: it is acknowledged again, and dropped.
            (Stage::In, _) => {}
        }
        None
    }
}
