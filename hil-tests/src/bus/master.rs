//! Master: a host's end of a bus, which sends requests and gives turns, as slowly as virtual time passes.
//!
//! It is as simple as can be, for cases: one turn after the other, to each address in order, and a pause where no
//! board had anything to say.

use super::{Bus, LATENCY, Line};
use crate::{chip::time::Time, machine::Halt};
use dermatome::link::{Link, LinkError, Transport};
use dermatome_shared::protocol::bus::{Ear, Heard, Mark, TURN_LAPSES_MS};
use std::{
    collections::VecDeque,
    io::{self, ErrorKind, Read, Write},
    sync::{Arc, Mutex, MutexGuard, PoisonError},
    time::Duration,
};

/// Longest that one read waits, in virtual time.
const READ_TIME: Time = Time::from_millis(20);
/// A turn in which nothing is heard for so long is over.
const PATIENCE: Time = Time::from_micros(1000 * TURN_LAPSES_MS + 1000);
/// Pause after a round in which no board had anything to say.
const REST: Time = Time::from_micros(300);

/// Gives the turns of a bus.
#[derive(Clone, Debug)]
pub struct Master(Arc<Mutex<State>>);

#[derive(Debug)]
struct State {
    bus: Bus,
    members: Vec<Member>,
    next: usize,
    /// Whether a board has said something in this round.
    is_busy: bool,
}

/// An address that has its turns.
#[derive(Debug)]
struct Member {
    address: u8,
    requests: Vec<u8>,
    /// Of packets that it has said.
    inbox: VecDeque<u8>,
    /// Turns that it did not answer.
    lapsed: usize,
}

/// The host's end of one board's link.
#[derive(Debug)]
pub struct Port {
    master: Master,
    place: usize,
    /// Of a request that is not whole yet.
    request: Vec<u8>,
}

impl Master {
    /// Of these addresses.
    #[must_use]
    pub fn new(bus: Bus, addresses: &[u8]) -> Self {
        let member = |&address| Member { address, requests: Vec::new(), inbox: VecDeque::new(), lapsed: 0 };
        let members = addresses.iter().map(member).collect();
        Self(Arc::new(Mutex::new(State { bus, members, next: 0, is_busy: false })))
    }

    /// A new link to an address, by its place among those of this master.
    pub fn link(&self, place: usize) -> Result<Link, LinkError> {
        let port = Port { master: self.clone(), place, request: Vec::new() };
        Ok(Link::connect(format!("bus#{place}"), port)?.counting_from(0))
    }

    /// Gives turns for a while.
    pub fn run(&self, time: Time) -> Result<(), Halt> {
        let mut state = self.state();
        let end = state.now() + time;
        while state.now() < end {
            state.turn()?;
        }
        Ok(())
    }

    /// How many turns an address, by its place, did not answer so far.
    #[must_use]
    pub fn lapsed(&self, place: usize) -> usize {
        self.state().members[place].lapsed
    }

    fn state(&self) -> MutexGuard<'_, State> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl State {
    fn now(&self) -> Time {
        self.bus.with(|line| line.now())
    }

    /// Sends what waits for the next address, and gives it the line.
    fn turn(&mut self) -> Result<(), Halt> {
        let member = &mut self.members[self.next];
        let address = member.address;
        let mut block = std::mem::take(&mut member.requests);
        block.push(0);
        block.extend(Mark::Turn.block(address));
        let turn = self.bus.with(move |line| Turn::give(line, address, &block, |_, _| ()))?;
        member.lapsed += usize::from(!turn.ended);
        self.is_busy |= !turn.heard.is_empty();
        member.inbox.extend(turn.heard);
        self.next = (self.next + 1) % self.members.len();
        if self.next == 0 && !std::mem::take(&mut self.is_busy) {
            self.bus.run(REST)?;
        }
        Ok(())
    }
}

/// What comes of a turn.
pub(crate) struct Turn {
    ear: Ear,
    /// Of packets.
    pub(crate) heard: Vec<u8>,
    quiet_since: Time,
    /// Whether the board said that it has ended.
    pub(crate) ended: bool,
    /// How many slices it took.
    pub(crate) slices: usize,
}

impl Turn {
    /// Says a block that gives an address the line, and waits until its turn is over. Each slice can be prepared, by its
    /// number.
    pub(crate) fn give(
        line: &mut Line,
        address: u8,
        block: &[u8],
        mut before_slice: impl FnMut(&mut Line, usize),
    ) -> Result<Self, Halt> {
        line.take_heard();
        line.say(block);
        let quiet_since = line.host_free();
        let mut turn = Self { ear: Ear::default(), heard: Vec::new(), quiet_since, ended: false, slices: 0 };
        while !turn.ended && line.now() < turn.quiet_since + LATENCY + PATIENCE {
            before_slice(line, turn.slices);
            line.run_slice()?;
            turn.slices += 1;
            line.take_heard().into_iter().for_each(|(at, byte)| turn.hear(address, at, byte));
        }
        Ok(turn)
    }

    fn hear(&mut self, address: u8, at: Time, byte: u8) {
        self.quiet_since = self.quiet_since.max(at);
        match self.ear.hear(byte) {
            Some(Heard::Byte { mark: Mark::Said, address: own, byte }) if own == address => {
                self.heard.push(byte);
            }
            Some(Heard::Token { mark: Mark::End, address: own }) if own == address => self.ended = true,
            _ => {}
        }
    }
}

impl Read for Port {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let mut state = self.master.state();
        let end = state.now() + READ_TIME;
        while state.members[self.place].inbox.is_empty() && state.now() < end {
            state.turn().map_err(io::Error::other)?;
        }
        match state.members[self.place].inbox.read(buffer)? {
            0 => Err(ErrorKind::TimedOut.into()),
            length => Ok(length),
        }
    }
}

impl Write for Port {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let mut state = self.master.state();
        let member = &mut state.members[self.place];
        for &byte in bytes {
            self.request.push(byte);
            if byte == 0 {
                let packet = std::mem::take(&mut self.request);
                if packet.len() > 1 {
                    member.requests.push(0);
                    member.requests.extend(Mark::Request.head(member.address));
                    member.requests.extend(packet);
                }
            }
        }
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

impl Transport for Port {
    fn time(&self) -> Option<Duration> {
        Some(self.master.state().now().into())
    }
}
