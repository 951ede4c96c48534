//! Wire: the bus itself, and who is on it.

use super::{Adapter, Frame, Rates, SLICE};
use crate::{
    board::START_TIME,
    bus::board::Board,
    chip::{
        fdcan::{
            frame::{AFTER_CRC, ERROR, INTERMISSION},
            node::{LineError, News},
        },
        flash::Flash,
        time::Time,
    },
    machine::{Halt, Machine, Options},
};
use rand::{Rng, SeedableRng, seq::IndexedRandom};
use rand_pcg::Pcg64;

/// Until two of the same identifier that differ notice it, at the least: an identifier, control bits and a byte.
const COLLISION: u64 = 33;

/// A node of the bus.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Node {
    Host,
    Board(usize),
}

/// What becomes of a frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Outcome {
    Sent,
    Failed(LineError, Option<Node>),
    /// All bits are recessive, so that the sender alone notices.
    Shorted,
}

/// A frame on the bus.
#[derive(Debug)]
struct Underway {
    frame: Frame,
    senders: Vec<Node>,
    rates: Rates,
    begun: Time,
    /// When it is known what becomes of it, unless it is.
    decided_at: Time,
    outcome: Option<Outcome>,
    /// When it has ended, if that is known.
    ends: Time,
    /// A passive node that alone does not understand it.
    misses: Option<Node>,
}

/// What went over a bus.
#[derive(Clone, Copy, Debug, Default)]
pub struct Traffic {
    /// Frames that were acknowledged.
    pub frames: usize,
    /// Bytes of their data.
    pub bytes: usize,
    /// Frames that met an error, those that nobody acknowledged included.
    pub errors: usize,
    /// Of these, those that differed from another one of the same identifier.
    pub collisions: usize,
    /// Frames that a passive node alone did not understand.
    pub missed: usize,
    /// How long the bus was not idle.
    pub busy: Time,
}

/// The bus, for whoever runs in its thread.
#[derive(Debug)]
pub struct Wire {
    boards: Vec<Board>,
    /// The host's node.
    pub host: Adapter,
    now: Time,
    under: Option<Underway>,
    idle_from: Time,
    noise: Option<(Pcg64, u32)>,
    is_shorted: bool,
    traffic: Traffic,
}

impl Wire {
    pub(super) fn new(boards: Vec<(u8, Flash, Options)>) -> Result<Self, Halt> {
        let mut wire = Self {
            boards: boards.into_iter().map(Board::new).collect::<Result<_, _>>()?,
            host: Adapter::default(),
            now: Time::ZERO,
            under: None,
            idle_from: Time::ZERO,
            noise: None,
            is_shorted: false,
            traffic: Traffic::default(),
        };
        wire.run_until(START_TIME)?;
        Ok(wire)
    }

    /// Virtual time.
    #[must_use]
    pub fn now(&self) -> Time {
        self.now
    }

    /// The machine of a board, from 0 on in the order in which they were given.
    pub fn machine(&mut self, board: usize) -> &mut Machine {
        &mut self.boards[board].machine
    }

    /// What went over the bus since this was asked last.
    pub fn take_traffic(&mut self) -> Traffic {
        std::mem::take(&mut self.traffic)
    }

    /// From now on one frame in so many is damaged on its way to one of the nodes; none for 0.
    pub fn disturb(&mut self, one_in: u32, seed: u64) {
        self.noise = (one_in > 0).then(|| (Pcg64::seed_from_u64(seed), one_in));
    }

    /// From now on the two wires of the bus touch, or no longer do.
    pub fn short(&mut self, is_shorted: bool) {
        self.is_shorted = is_shorted;
    }

    /// A board's power fails. Without power it is not on the bus, and its time stands still.
    pub fn cut_power(&mut self, board: usize) -> Result<(), Halt> {
        self.boards[board].has_power = false;
        self.boards[board].machine.cut_power()
    }

    /// And comes back.
    pub fn restore_power(&mut self, board: usize) {
        self.boards[board].has_power = true;
    }

    /// Lets virtual time pass, in whole slices.
    pub fn run_until(&mut self, deadline: Time) -> Result<(), Halt> {
        while self.now < deadline {
            self.run_slice()?;
        }
        Ok(())
    }

    /// Lets one slice pass.
    pub fn run_slice(&mut self) -> Result<(), Halt> {
        let end = self.now + SLICE;
        self.decide(end);
        if self.under.as_ref().is_some_and(|under| under.ends <= end) {
            self.finish();
        }
        for board in &mut self.boards {
            board.run_until(end)?;
        }
        self.now = end;
        self.break_off();
        if self.under.is_none() {
            self.pass_quiet(SLICE, end);
            self.begin();
        }
        Ok(())
    }

    fn nodes(&self) -> impl Iterator<Item = Node> + use<> {
        [Node::Host].into_iter().chain((0..self.boards.len()).map(Node::Board))
    }

    fn is_on(&mut self, node: Node) -> bool {
        match node {
            Node::Host => self.host.is_on,
            Node::Board(place) => {
                let board = &mut self.boards[place];
                board.has_power && board.machine.chip(|chip| chip.fdcan.is_on())
            }
        }
    }

    fn is_passive(&mut self, node: Node) -> bool {
        match node {
            Node::Host => false,
            Node::Board(place) => self.boards[place].machine.chip(|chip| chip.fdcan.is_passive()),
        }
    }

    fn rates(&mut self, node: Node) -> Rates {
        match node {
            Node::Host => self.host.rates,
            Node::Board(place) => self.boards[place].machine.chip(|chip| chip.fdcan.rates()),
        }
    }

    fn request(&mut self, node: Node) -> Option<(Time, Frame)> {
        match node {
            Node::Host => self.host.request(),
            Node::Board(place) => {
                let board = &mut self.boards[place];
                let (since, frame) = board.machine.chip(|chip| chip.fdcan.request())?;
                board.has_power.then_some((since + board.behind, frame))
            }
        }
    }

    fn tell(&mut self, node: Node, at: Time, news: News) {
        match (node, news) {
            (Node::Host, News::Received(frame)) => self.host.hear(at, frame),
            (Node::Host, News::Sent) => self.host.note_sent(),
            (Node::Host, _) => {}
            (Node::Board(place), news) => {
                let board = &mut self.boards[place];
                let at = at - board.behind;
                board.machine.chip(|chip| chip.fdcan.hear(at, news));
            }
        }
    }

    /// Those who wait to join hear that the bus was quiet.
    fn pass_quiet(&mut self, span: Time, at: Time) {
        for place in 0..self.boards.len() {
            let board = &mut self.boards[place];
            if board.has_power && board.machine.chip(|chip| chip.fdcan.is_joining()) {
                self.tell(Node::Board(place), at, News::Quiet(span));
            }
        }
    }

    /// Whoever wants to send begins, once the bus is idle.
    fn begin(&mut self) {
        let mut wanting = Vec::new();
        for node in self.nodes() {
            wanting.extend(self.request(node).map(|(since, frame)| (since, node, frame)));
        }
        let Some(first) = wanting.iter().map(|(since, ..)| *since).min() else { return };
        let begun = first.max(self.idle_from);
        if begun > self.now {
            return;
        }
        wanting.retain(|(since, ..)| *since <= begun);
        let lowest = wanting.iter().map(|(.., frame)| frame.identifier).min();
        wanting.retain(|(.., frame)| Some(frame.identifier) == lowest);
        for (_, node, _) in &wanting {
            if let Node::Board(place) = *node {
                self.boards[place].machine.chip(|chip| chip.fdcan.begin());
            }
        }
        let dominant = |(.., frame): &&(Time, Node, Frame)| {
            wanting.iter().all(|(.., other)| frame.is_recessive_beside(other) != Some(true))
        };
        let Some(frame) = wanting.iter().find(dominant).map(|(.., frame)| frame.clone()) else { return };
        let senders: Vec<Node> = wanting.iter().map(|&(_, node, _)| node).collect();
        let losers: Vec<Node> =
            wanting.iter().filter(|(.., other)| *other != frame).map(|&(_, node, _)| node).collect();
        self.put(frame, senders, &losers, begun);
    }

    /// A frame is on the bus.
    fn put(&mut self, frame: Frame, mut senders: Vec<Node>, losers: &[Node], begun: Time) {
        let rates = self.rates(senders[0]);
        let collides_at = begun + rates.bits(COLLISION);
        let error_ends = collides_at + rates.bits(ERROR);
        let mut under = Underway {
            decided_at: begun + frame.until_acknowledged(rates),
            frame,
            senders: Vec::new(),
            rates,
            begun,
            outcome: None,
            ends: Time::NEVER,
            misses: None,
        };
        let loud = losers.iter().copied().find(|&node| !self.is_passive(node));
        if self.is_shorted {
            (under.outcome, under.ends) = (Some(Outcome::Shorted), error_ends);
        } else if let Some(loud) = loud {
            self.traffic.collisions += 1;
            (under.outcome, under.ends) = (Some(Outcome::Failed(LineError::Bit, Some(loud))), error_ends);
        } else {
            // Whose error flag nobody notices leaves the frame to the others.
            for &node in losers {
                self.tell(node, collides_at, News::Failed(LineError::Bit));
                self.traffic.collisions += 1;
            }
            senders.retain(|node| !losers.contains(node));
            self.damage(&mut under, &senders);
        }
        under.senders = senders;
        self.under = Some(under);
    }

    /// Noise, and nodes of other rates.
    fn damage(&mut self, under: &mut Underway, senders: &[Node]) {
        let mut listening = Vec::new();
        for node in self.nodes() {
            if self.is_on(node) {
                listening.push(node);
            }
        }
        let mut victim = None;
        for &node in listening.iter().filter(|node| !senders.contains(node)) {
            if !self.rates(node).agree(under.rates, under.frame.format) {
                victim = Some((node, 0.5));
            }
        }
        if let Some((random, one_in)) = &mut self.noise
            && random.random_range(0..*one_in) == 0
        {
            victim = listening.choose(random).map(|&node| (node, random.random_range(0.3..0.95)));
        }
        let Some((victim, part)) = victim else { return };
        if !senders.contains(&victim) && self.is_passive(victim) {
            under.misses = Some(victim);
            self.traffic.missed += 1;
            return;
        }
        let error = if senders.contains(&victim) { LineError::Bit } else { LineError::Crc };
        under.outcome = Some(Outcome::Failed(error, Some(victim)));
        let whole = under.frame.duration(under.rates).nanoseconds();
        let bits = under.rates.bits(COLLISION).max(Time::from_nanos((whole as f64 * part) as u64));
        under.ends = under.begun + bits + under.rates.bits(ERROR);
    }

    /// Whether somebody acknowledges the frame that is on the bus, if that is so by then.
    fn decide(&mut self, end: Time) {
        let Some(mut under) = self.under.take() else { return };
        if under.outcome.is_none() && under.decided_at <= end {
            let mut acknowledged = false;
            for node in self.nodes() {
                let listens = !under.senders.contains(&node) && under.misses != Some(node);
                acknowledged |= listens && self.is_on(node);
            }
            let (outcome, bits) = if acknowledged {
                (Outcome::Sent, AFTER_CRC)
            } else {
                (Outcome::Failed(LineError::Acknowledge, None), 1 + ERROR)
            };
            under.outcome = Some(outcome);
            under.ends = under.decided_at + under.rates.bits(bits);
        }
        self.under = Some(under);
    }

    /// A frame whose senders all fell silent ends in an error.
    fn break_off(&mut self) {
        let Some(mut under) = self.under.take() else { return };
        under.senders.retain(|&node| match node {
            Node::Host => true,
            Node::Board(place) => {
                let board = &mut self.boards[place];
                board.has_power && board.machine.chip(|chip| chip.fdcan.is_sending())
            }
        });
        if under.senders.is_empty() && under.outcome.is_none() {
            under.outcome = Some(Outcome::Failed(LineError::Crc, None));
            under.ends = self.now + under.rates.bits(ERROR);
        }
        self.under = Some(under);
    }

    /// All hear what became of the frame.
    fn finish(&mut self) {
        let Some(under) = self.under.take() else { return };
        let Underway { frame, senders, rates, begun, ends, misses, .. } = under;
        let outcome = under.outcome.unwrap_or(Outcome::Sent);
        for node in self.nodes() {
            if !self.is_on(node) {
                continue;
            }
            let is_sender = senders.contains(&node);
            match outcome {
                Outcome::Sent if is_sender => self.tell(node, ends, News::Sent),
                Outcome::Sent if misses == Some(node) => self.tell(node, ends, News::Disturbed(true)),
                Outcome::Sent => self.tell(node, ends, News::Received(frame.clone())),
                Outcome::Failed(error, _) if is_sender => self.tell(node, ends, News::Failed(error)),
                Outcome::Failed(LineError::Acknowledge, _) => {}
                Outcome::Failed(_, victim) => self.tell(node, ends, News::Disturbed(victim == Some(node))),
                Outcome::Shorted if is_sender => self.tell(node, ends, News::Failed(LineError::Bit)),
                Outcome::Shorted => {}
            }
        }
        self.pass_quiet(rates.bits(11), ends);
        self.idle_from = ends + rates.bits(INTERMISSION);
        self.traffic.busy += self.idle_from.since(begun);
        if outcome == Outcome::Sent {
            self.traffic.frames += 1;
            self.traffic.bytes += frame.data.len();
        } else {
            self.traffic.errors += 1;
        }
    }
}
