//! RS-485: a thread gives the boards on a line their turns ([`dermatome_shared::protocol::bus`]).
//!
//! Turn by turn it sends a board what is for it, lets it speak, and hands what it says to whoever reads that board.

use super::{
    super::transport::{Transport, may_retry, open_adapter, write_all},
    load::BYTE,
    seat::Seats,
};
use crate::{error::LinkError, port::Adapter};
use dermatome_shared::protocol::bus::{ADDRESSES, Ear, Heard, Mark, TURN_LAPSES_MS};
use std::{
    io::{self, ErrorKind},
    thread,
    time::{Duration, Instant},
};

/// Longest that the line is given to a board which says nothing, adapters' delays included (16 ms at most, as a rule).
const SILENCE: Duration = Duration::from_millis(TURN_LAPSES_MS + 30);
/// Longest turn, whatever is said.
const LONGEST_TURN: Duration = Duration::from_millis(200);
/// Until a board that had nothing to say gets its next turn.
const IDLE: Duration = Duration::from_millis(1);
/// Turns that may lapse one after the other before a board that has answered counts as absent: flash stops its processor.
const LAPSES: u32 = 2;
/// Until one that is absent does, which doubles up to the longest.
const FIRST_ABSENCE: Duration = Duration::from_millis(20);
const LONGEST_ABSENCE: Duration = Duration::from_millis(1000);
/// Between two turns of boards that did not answer, whichever they are: those that do have the line meanwhile.
const BETWEEN_SILENCES: Duration = Duration::from_millis(200);

/// Turns of an address.
#[derive(Clone, Copy)]
struct Turns {
    /// Those in a row in which nothing was heard; more by [`LAPSES`] of one that has never answered.
    silences: u32,
    /// When the next one is.
    due: Instant,
}

impl Turns {
    fn is_absent(&self) -> bool {
        self.silences > LAPSES
    }
}

/// How a turn ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Turn {
    /// The board had something to say.
    Said,
    /// It had nothing to say.
    Idle,
    /// It did not answer.
    Silent,
}

/// The host's end of a line.
struct Host {
    /// As long as it has the line.
    wire: Option<Box<dyn Transport>>,
    /// `[address]`, also of those that nobody has open.
    turns: [Turns; ADDRESSES as usize],
    /// Until then no absent board has a turn.
    silent_until: Instant,
    ear: Ear,
    /// What is sent in a turn.
    blocks: Vec<u8>,
    /// Dropped after the wire: who learns that the line is dead finds its port closed.
    seats: Seats,
}

/// Opens a line, and gives turns from now on.
pub(super) fn start(name: &str, adapter: &Adapter, seats: Seats) -> Result<(), LinkError> {
    let now = Instant::now();
    let host = Host {
        wire: Some(open_adapter(name, adapter)?),
        turns: [Turns { silences: LAPSES, due: now }; ADDRESSES as usize],
        silent_until: now,
        ear: Ear::default(),
        blocks: Vec::new(),
        seats,
    };
    let thread = thread::Builder::new().name(format!("bus {adapter}"));
    thread.spawn(move || host.give_turns()).map_err(|error| LinkError::on_open(name, error))?;
    Ok(())
}

impl Host {
    /// Gives boards the line until all have left, or until it fails.
    fn give_turns(mut self) {
        // Ends what somebody before has left unfinished.
        let mut failed = self.wire().and_then(|wire| write_all(wire, &[0])).err();
        while failed.is_none() {
            let Some(address) = self.wait() else { return };
            failed = self.turn(address).err();
        }
        self.wire = None;
        if let Some(error) = failed {
            self.seats.fail_with(&error);
        }
    }

    /// Waits until a board is to have the line; none once nobody has one open.
    fn wait(&mut self) -> Option<u8> {
        loop {
            let mut state = self.seats.lock();
            let now = Instant::now();
            let seated = state.boards().map(|(address, board)| {
                let turns = self.turns[usize::from(address)];
                let due = match turns.is_absent() {
                    true => turns.due.max(self.silent_until),
                    false if board.to_board.is_empty() => turns.due,
                    false => turns.due.min(now),
                };
                ((!board.is_full()).then_some(due), address)
            });
            let seated: Vec<_> = seated.collect();
            let next = seated.iter().filter_map(|(due, address)| Some((due.as_ref()?, address))).min();
            match next {
                Some((due, &address)) if *due <= now => return Some(address),
                Some((due, _)) => {
                    self.seats.wait(state, Some((*due - now).max(Duration::from_micros(100))));
                }
                None if !seated.is_empty() => self.seats.wait(state, None),
                None => {
                    drop(state);
                    if self.seats.close_if_left(|| self.wire = None) {
                        return None;
                    }
                }
            }
        }
    }

    /// Sends a board what is for it, and hears it out.
    fn turn(&mut self, address: u8) -> io::Result<()> {
        let mut blocks = std::mem::take(&mut self.blocks);
        blocks.clear();
        // Ends what a board that was cut off has left.
        blocks.push(0);
        match self.seats.lock().board(address) {
            None => return Ok(()),
            Some(board) => {
                for packet in board.to_board.split(|&byte| byte == 0).filter(|packet| !packet.is_empty()) {
                    blocks.extend_from_slice(&Mark::Request.head(address));
                    blocks.extend_from_slice(packet);
                    blocks.push(0);
                }
                board.to_board.clear();
            }
        }
        blocks.extend_from_slice(&Mark::Turn.block(address));
        write_all(self.wire()?, &blocks)?;
        let turn = self.listen(address, Duration::from_secs_f64(blocks.len() as f64 * BYTE))?;
        self.blocks = blocks;
        self.end_turn(address, turn);
        Ok(())
    }

    fn wire(&mut self) -> io::Result<&mut dyn Transport> {
        Ok(self.wire.as_mut().ok_or(ErrorKind::NotConnected)?.as_mut())
    }

    /// Hears a board until its turn ends, or has lapsed; what it was sent takes so long on the line.
    fn listen(&mut self, address: u8, sending: Duration) -> io::Result<Turn> {
        let given = Instant::now() + sending;
        let (mut heard, mut buffer, mut said) = (given, [0; 2048], Vec::new());
        let (mut turn, mut is_over, mut is_open) = (Turn::Silent, false, false);
        // What the turn before has left unfinished is nobody's.
        self.ear.hear(0);
        while !is_over && heard.elapsed() < SILENCE && given.elapsed() < LONGEST_TURN {
            let length = match self.wire()?.read(&mut buffer) {
                Ok(0) => return Err(ErrorKind::UnexpectedEof.into()),
                Ok(length) => length,
                Err(error) if may_retry(&error) => continue,
                Err(error) => return Err(error),
            };
            let before = turn;
            for event in buffer[..length].iter().filter_map(|&byte| self.ear.hear(byte)) {
                match event {
                    Heard::Byte { mark: Mark::Said, address: from, byte } if from == address => {
                        said.push(byte);
                        (turn, is_open) = (Turn::Said, byte != 0);
                    }
                    Heard::Token { mark: Mark::End, address: from } if from == address => {
                        is_over = true;
                        turn = if turn == Turn::Silent { Turn::Idle } else { turn };
                    }
                    _ => continue,
                }
                heard = Instant::now();
            }
            if before == Turn::Silent && turn != before {
                self.seats.lock().shares.answered(given.elapsed());
            }
            self.seats.hand_over(address, &said);
            said.clear();
        }
        if is_open {
            // The next packet does not begin with what there is of this one.
            self.seats.hand_over(address, &[0]);
        }
        Ok(turn)
    }

    /// A turn of a board has ended.
    fn end_turn(&mut self, address: u8, turn: Turn) {
        let now = Instant::now();
        let turns = &mut self.turns[usize::from(address)];
        turns.silences = if turn == Turn::Silent { turns.silences + 1 } else { 0 };
        let absence = FIRST_ABSENCE * (1 << turns.silences.saturating_sub(LAPSES + 1).min(10));
        turns.due = now
            + match turn {
                Turn::Idle => IDLE,
                Turn::Silent if turns.is_absent() => absence.min(LONGEST_ABSENCE),
                Turn::Said | Turn::Silent => Duration::ZERO,
            };
        if turns.is_absent() {
            self.silent_until = now + BETWEEN_SILENCES;
        }
    }
}
