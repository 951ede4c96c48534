//! Bus: emulated boards on one line that only one of them drives at a time (RS-485), and its host's end.
//!
//! One thread owns all machines, and lets them run side by side in slices of [`SLICE`]. Between two slices it carries
//! what each of them sent to all others, with its times: a byte reaches the boards [`LATENCY`] after its stop bit, and
//! the host with the end of its slice, never in another order. So nothing depends on how fast the machine is.
//!
//! Where two drive the line at once, their bytes are damaged for all who listen. A transceiver whose receiver is tied to
//! its driver hears nothing while it drives; another one hears itself.

mod board;
pub mod can;
pub mod master;
mod owner;
pub mod record;
mod rig;

pub use rig::{BusRig, Shared};

use crate::{
    board::START_TIME,
    chip::{Chip, flash::Flash, time::Time, usart::Symbol},
    machine::{Halt, Machine, Options},
};
use board::Board;
use owner::Owner;
use rand::{Rng, SeedableRng};
use rand_pcg::Pcg64;
use record::{Record, Speaker};

/// Boards run alone for so long.
pub const SLICE: Time = Time::from_micros(40);
/// A byte at the line's speed.
const BYTE: Time = Time::from_micros(5);
/// How much later a byte reaches a board than on a real line: by then all boards have come to where it began.
pub const LATENCY: Time = Time::from_micros(45);
/// The host drives the line so long after it has heard something, at the least.
const TURNAROUND: Time = Time::from_micros(2);
/// Boards on one line. It ends when the last handle is dropped.
#[derive(Clone, Debug)]
pub struct Bus(Owner<Line>);

/// The line, for whoever runs in its thread.
#[derive(Debug)]
pub struct Line {
    boards: Vec<Board>,
    /// Boards whose receiver is on while their driver is.
    hear_themselves: Vec<bool>,
    now: Time,
    /// What the host still sends, and when each byte is complete.
    host: Vec<(Time, u8)>,
    host_free: Time,
    /// What the host hears.
    heard: Vec<(Time, u8)>,
    /// When each speaker drove the line, as far as that still matters.
    drives: Vec<(Speaker, Time, Option<Time>)>,
    last_damaged: Time,
    noise: Option<(Pcg64, u32)>,
    record: Option<Record>,
}

impl Bus {
    /// Switches boards on that have this in their flash and these addresses, and waits until they have started.
    pub fn start(boards: Vec<(u8, Flash, Options)>) -> Result<Self, Halt> {
        Owner::start(|| Line::new(boards)).map(Self)
    }

    /// Lets the line's thread do something with it, and waits for the result.
    pub fn with<T: Send + 'static>(&self, work: impl FnOnce(&mut Line) -> T + Send + 'static) -> T {
        self.0.with(work)
    }

    /// Lets virtual time pass.
    pub fn run(&self, time: Time) -> Result<(), Halt> {
        self.with(move |line| line.run_until(line.now + time))
    }
}

impl Line {
    fn new(boards: Vec<(u8, Flash, Options)>) -> Result<Self, Halt> {
        let boards = boards.into_iter().map(Board::new).collect::<Result<Vec<_>, _>>()?;
        let mut line = Self {
            hear_themselves: vec![false; boards.len()],
            boards,
            now: Time::ZERO,
            host: Vec::new(),
            host_free: Time::ZERO,
            heard: Vec::new(),
            drives: Vec::new(),
            last_damaged: Time::ZERO,
            noise: None,
            record: None,
        };
        line.run_until(START_TIME)?;
        Ok(line)
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

    /// The host sends bytes, after those that it still sends.
    pub fn say(&mut self, bytes: &[u8]) {
        // A host that answers at once would meet a driver that is still to go off.
        let mut at = self.host_free.max(self.now + TURNAROUND);
        self.drives.push((Speaker::Host, at, Some(at + BYTE * bytes.len() as u64)));
        for &byte in bytes {
            at += BYTE;
            self.host.push((at, byte));
        }
        self.host_free = at;
    }

    /// When the host has sent all that it was to.
    #[must_use]
    pub fn host_free(&self) -> Time {
        self.host_free
    }

    /// What the host has heard since it was asked last, and when.
    pub fn take_heard(&mut self) -> Vec<(Time, u8)> {
        std::mem::take(&mut self.heard)
    }

    /// From now on keeps a record; gives what was recorded so far.
    pub fn take_record(&mut self) -> Record {
        self.record.replace(Record::default()).unwrap_or_default()
    }

    /// From now on one symbol in so many is damaged on its way to each listener; none for 0.
    pub fn disturb(&mut self, one_in: u32, seed: u64) {
        self.noise = (one_in > 0).then(|| (Pcg64::seed_from_u64(seed), one_in));
    }

    /// A board's power fails. Without power it drives nothing and its time stands still.
    pub fn cut_power(&mut self, board: usize) -> Result<(), Halt> {
        self.boards[board].has_power = false;
        self.boards[board].machine.cut_power()?;
        self.collect();
        Ok(())
    }

    /// And comes back.
    pub fn restore_power(&mut self, board: usize) {
        self.boards[board].has_power = true;
    }

    /// Whether a board's receiver is on while its driver is.
    pub fn let_hear_itself(&mut self, board: usize, hears: bool) {
        self.hear_themselves[board] = hears;
    }

    /// A board's CPU stands still for a while, as where its flash is erased; the rest of the chip goes on.
    pub fn stop_cpu(&mut self, board: usize, time: Time) {
        self.boards[board].stands_until = self.now + time;
    }

    /// Whether a board drives the line.
    #[must_use]
    pub fn drives(&mut self, board: usize) -> bool {
        self.boards[board].machine.chip(|chip| chip.usart1.drives())
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
        for board in &mut self.boards {
            board.run_until(end)?;
        }
        self.now = end;
        let mut said = self.collect();
        let still = self.host.partition_point(|&(at, _)| at <= end);
        said.extend(self.host.drain(..still).map(|(at, byte)| (at, Speaker::Host, byte)));
        said.sort_by_key(|&(at, speaker, _)| (at, speaker));
        for (at, speaker, byte) in said {
            self.carry(at, speaker, byte);
        }
        // A byte that is complete later began at most its own time before.
        self.drives.retain(|&(_, _, off)| off.is_none_or(|off| off + SLICE > end));
        Ok(())
    }

    /// What boards have sent, and when they drove the line.
    fn collect(&mut self) -> Vec<(Time, Speaker, u8)> {
        let mut said = Vec::new();
        for (place, board) in self.boards.iter_mut().enumerate() {
            let (speaker, behind) = (Speaker::Board(place), board.behind);
            let (edges, driven) = board.machine.chip(|chip| {
                // The same bytes, as a link of its own would carry them.
                chip.usart1.take_sent();
                (chip.usart1.take_edges(), chip.usart1.take_driven())
            });
            for (at, is_on) in edges.into_iter().map(|(at, is_on)| (at + behind, is_on)) {
                if is_on {
                    self.drives.push((speaker, at, None));
                } else if let Some((_, on, off)) =
                    self.drives.iter_mut().rev().find(|(who, _, off)| *who == speaker && off.is_none())
                {
                    *off = Some(at);
                    if let Some(record) = &mut self.record {
                        record.drove(speaker, *on, at);
                    }
                }
            }
            said.extend(driven.into_iter().map(|(at, byte)| (at + behind, speaker, byte)));
        }
        said
    }

    /// Brings one byte to all who listen.
    fn carry(&mut self, at: Time, speaker: Speaker, byte: u8) {
        let begun = at - BYTE;
        let collides = self.drivers(begun, at).any(|other| other != speaker);
        if let Some(record) = &mut self.record {
            record.said(speaker, at, byte, collides);
        }
        // What two say at once is one mess for those who listen.
        if collides && std::mem::replace(&mut self.last_damaged, at) > begun {
            return;
        }
        let symbol = Symbol { byte: if collides { byte ^ 0xA5 } else { byte }, damaged: collides };
        if speaker != Speaker::Host || collides {
            let Symbol { byte, .. } = self.on_the_way(symbol);
            self.heard.push((at, byte));
        }
        for place in 0..self.boards.len() {
            let drives = self.drivers(begun, at).any(|other| other == Speaker::Board(place));
            let board = &self.boards[place];
            if !board.has_power || drives && !self.hear_themselves[place] {
                continue;
            }
            let arrives = at + LATENCY - board.behind;
            let symbol = self.on_the_way(symbol);
            self.boards[place].machine.chip(|chip: &mut Chip| chip.usart1.hear(symbol, arrives));
        }
    }

    /// Who drove the line in this time.
    fn drivers(&self, from: Time, to: Time) -> impl Iterator<Item = Speaker> {
        let overlaps = move |(on, off): (Time, Option<Time>)| on < to && off.is_none_or(|off| off > from);
        self.drives.iter().filter(move |&&(_, on, off)| overlaps((on, off))).map(|&(speaker, _, _)| speaker)
    }

    fn on_the_way(&mut self, symbol: Symbol) -> Symbol {
        let Some((random, one_in)) = &mut self.noise else { return symbol };
        if random.random_range(0..*one_in) > 0 {
            return symbol;
        }
        let byte = symbol.byte ^ 1 << random.random_range(0..8);
        Symbol { byte, damaged: symbol.damaged || random.random() }
    }
}
