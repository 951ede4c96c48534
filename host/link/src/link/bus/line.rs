//! Line: who is on it, and whose turn it is.

use super::{
    super::transport::{READ_TIMEOUT, Transport, may_retry, open_serial, open_tcp, write_all},
    load::{BYTE, Demand, Shares},
};
use crate::{
    error::{LinkError, LinkErrorKind, Overload},
    port,
};
use dermatome_shared::protocol::{
    MAX_PACKET_BYTES, Selection,
    bus::{ADDRESSES, Ear, Heard, Mark, TURN_LAPSES_MS},
};
use std::{
    collections::{BTreeMap, VecDeque},
    io::{self, ErrorKind, Read, Write},
    sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError},
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
/// Most bytes kept for somebody who does not read; until they are read, the board gets no turn.
const MOST_UNREAD: usize = 1 << 18;

/// Lines that are or were open in this program, by their port.
static LINES: Mutex<BTreeMap<port::Line, Arc<Mutex<Opened>>>> = Mutex::new(BTreeMap::new());

/// What became of opening a line's port.
#[derive(Default)]
struct Opened {
    line: Option<Arc<Line>>,
    /// When that failed last, and how: who has waited meanwhile has failed as well.
    failed: Option<(Instant, ErrorKind, String)>,
}

/// A line with boards on it.
struct Line {
    state: Mutex<State>,
    /// Something was said, is to be sent, or somebody has left.
    changed: Condvar,
}

struct State {
    boards: [Option<Board>; ADDRESSES as usize],
    /// Also of those that nobody has open.
    turns: [Turns; ADDRESSES as usize],
    /// Until then no absent board has a turn.
    silent_until: Instant,
    shares: Shares,
    /// Why the line is dead.
    failed: Option<(ErrorKind, String)>,
}

/// What the line knows of a board that is open.
struct Board {
    /// For the board; whole packets.
    to_board: Vec<u8>,
    /// From it; packets, as over a line of its own.
    from_board: VecDeque<u8>,
}

/// Turns of an address.
#[derive(Clone, Copy)]
struct Turns {
    /// Those in a row in which nothing was heard; more by [`LAPSES`] of one that has never answered.
    silences: u32,
    /// When the next one is.
    due: Instant,
}

/// Where a board is: on which line, and its address there.
#[derive(Clone)]
pub(in crate::link) struct Place {
    line: Arc<Line>,
    address: u8,
}

/// One board's transport.
pub(in crate::link) struct Seat {
    place: Place,
    waits: bool,
}

/// Takes the place of a board on a line, which is opened if it is not yet in this program; `name` is the board's port, for
/// errors.
pub(in crate::link) fn take_seat(name: &str, port: &port::Line, address: u8) -> Result<Seat, LinkError> {
    let asked = Instant::now();
    let opened = lock(&LINES).entry(port.clone()).or_default().clone();
    let mut slot = lock(&opened);
    let line = match slot.line.as_ref().filter(|line| line.lock().failed.is_none()) {
        Some(line) => line.clone(),
        None => {
            if let Some((_, kind, words)) = slot.failed.as_ref().filter(|(when, ..)| *when >= asked) {
                return Err(LinkError::on_open(name, io::Error::new(*kind, words.clone())));
            }
            let wire = open(name, port).inspect_err(|error| {
                if let LinkErrorKind::Open(reason) = &error.kind {
                    slot.failed = Some((Instant::now(), reason.kind(), reason.to_string()));
                }
            })?;
            let line =
                Line::start(port, opened.clone(), wire).map_err(|error| LinkError::on_open(name, error))?;
            slot.line.insert(line).clone()
        }
    };
    let mut state = line.lock();
    let board = &mut state.boards[usize::from(address)];
    if board.is_some() {
        return Err(LinkError::new(name, LinkErrorKind::InUse));
    }
    *board = Some(Board {
        to_board: Vec::with_capacity(MAX_PACKET_BYTES),
        from_board: VecDeque::with_capacity(MAX_PACKET_BYTES),
    });
    drop(state);
    line.changed.notify_all();
    Ok(Seat { place: Place { line, address }, waits: true })
}

fn open(name: &str, port: &port::Line) -> Result<Box<dyn Transport>, LinkError> {
    Ok(match port {
        port::Line::Serial(path) => Box::new(open_serial(name, path)?),
        port::Line::Tcp(address) => Box::new(open_tcp(name, address.as_str())?),
    })
}

fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

impl Line {
    fn start(
        port: &port::Line,
        opened: Arc<Mutex<Opened>>,
        wire: Box<dyn Transport>,
    ) -> io::Result<Arc<Self>> {
        let now = Instant::now();
        let state = State {
            boards: [const { None }; ADDRESSES as usize],
            turns: [Turns { silences: LAPSES, due: now }; ADDRESSES as usize],
            silent_until: now,
            shares: Shares::default(),
            failed: None,
        };
        let line = Arc::new(Self { state: Mutex::new(state), changed: Condvar::new() });
        let host = Host {
            line: line.clone(),
            opened,
            wire: Some(wire),
            ear: Ear::default(),
            blocks: Vec::new(),
            failed: None,
        };
        thread::Builder::new().name(format!("bus {port}")).spawn(move || host.give_turns())?;
        Ok(line)
    }

    fn lock(&self) -> MutexGuard<'_, State> {
        lock(&self.state)
    }
}

impl State {
    /// Who is to have the line now; or, where nobody is, when somebody will be.
    fn next(&self) -> Result<u8, Option<Instant>> {
        let boards = (0..).zip(self.boards.iter().zip(&self.turns));
        let waiting = boards.filter_map(|(address, (board, turns))| {
            let earliest = if turns.is_absent() { self.silent_until } else { turns.due };
            (board.as_ref()?.from_board.len() < MOST_UNREAD).then_some((turns.due.max(earliest), address))
        });
        match waiting.min() {
            Some((due, address)) if due <= Instant::now() => Ok(address),
            other => Err(other.map(|(due, _)| due)),
        }
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

    fn board(&mut self, address: u8) -> Option<&mut Board> {
        self.boards[usize::from(address)].as_mut()
    }
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
    line: Arc<Line>,
    opened: Arc<Mutex<Opened>>,
    /// As long as it has the line.
    wire: Option<Box<dyn Transport>>,
    ear: Ear,
    /// What is sent in a turn.
    blocks: Vec<u8>,
    /// Why the line is dead.
    failed: Option<(ErrorKind, String)>,
}

/// Whatever ends it: who opens the port again finds it closed, and whoever reads or writes learns that the line is dead.
impl Drop for Host {
    fn drop(&mut self) {
        self.wire = None;
        let failed =
            self.failed.take().unwrap_or((ErrorKind::BrokenPipe, "nobody has the line any more".to_owned()));
        self.line.lock().failed = Some(failed);
        self.line.changed.notify_all();
    }
}

impl Host {
    /// Gives boards the line until all have left, or until it fails.
    fn give_turns(mut self) {
        // Ends what somebody before has left unfinished.
        let mut failed = self.wire().and_then(|wire| write_all(wire, &[0])).err();
        while failed.is_none() {
            let Some(address) = self.wait() else { break };
            failed = self.turn(address).err();
        }
        // Who waits for bytes that will never come is to know it.
        let lasting = |error: &io::Error| if may_retry(error) { ErrorKind::BrokenPipe } else { error.kind() };
        self.failed = failed.map(|error| (lasting(&error), error.to_string()));
    }

    /// Waits until a board is to have the line; none once nobody has one open.
    fn wait(&mut self) -> Option<u8> {
        loop {
            let state = self.line.lock();
            match state.next() {
                Ok(address) => return Some(address),
                Err(Some(due)) => {
                    let time = due.saturating_duration_since(Instant::now()).max(Duration::from_micros(100));
                    drop(self.line.changed.wait_timeout(state, time));
                }
                Err(None) if state.boards.iter().any(Option::is_some) => drop(self.line.changed.wait(state)),
                Err(None) => {
                    drop(state);
                    if self.leave() {
                        return None;
                    }
                }
            }
        }
    }

    /// Gives the line up unless somebody has come meanwhile.
    fn leave(&mut self) -> bool {
        let mut opened = lock(&self.opened);
        if self.line.lock().boards.iter().any(Option::is_some) {
            return false;
        }
        opened.line = None;
        self.wire = None;
        true
    }

    /// Sends a board what is for it, and hears it out.
    fn turn(&mut self, address: u8) -> io::Result<()> {
        let mut blocks = std::mem::take(&mut self.blocks);
        blocks.clear();
        // Ends what a board that was cut off has left.
        blocks.push(0);
        match self.line.lock().board(address) {
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
        self.line.lock().end_turn(address, turn);
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
                self.line.lock().shares.answered(given.elapsed());
            }
            self.hand_over(address, &mut said);
        }
        if is_open {
            // The next packet does not begin with what there is of this one.
            self.hand_over(address, &mut vec![0]);
        }
        Ok(turn)
    }

    /// Whoever reads the board gets what it has said.
    fn hand_over(&self, address: u8, said: &mut Vec<u8>) {
        if said.is_empty() {
            return;
        }
        if let Some(board) = self.line.lock().board(address) {
            board.from_board.extend(said.drain(..));
        }
        said.clear();
        self.line.changed.notify_all();
    }
}

impl Place {
    /// How many boards the line is for, those included that are not open.
    pub(in crate::link) fn share_with(&self, boards: usize) {
        self.line.lock().shares.boards = boards;
    }

    /// What of a selection fits the line beside what goes over it for others: images less often where it must be.
    pub(in crate::link) fn fit(&self, selection: Selection, demand: &Demand) -> Result<Selection, Overload> {
        let mut state = self.line.lock();
        let open = state.boards.iter().flatten().count();
        state.shares.fit(self.address, open, selection, demand)
    }

    /// Nothing of the board goes over the line any more unless it is asked.
    pub(in crate::link) fn release(&self) {
        self.line.lock().shares.leave(self.address);
    }
}

impl Seat {
    /// Where the board is.
    pub(in crate::link) fn place(&self) -> Place {
        self.place.clone()
    }
}

impl Read for Seat {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let deadline = Instant::now() + READ_TIMEOUT;
        let mut state = self.place.line.lock();
        loop {
            if let Some((kind, words)) = &state.failed {
                return Err(io::Error::new(*kind, words.clone()));
            }
            let Some(board) = state.board(self.place.address) else { return Ok(0) };
            if !board.from_board.is_empty() {
                let was_full = board.from_board.len() >= MOST_UNREAD;
                let length = board.from_board.read(buffer);
                if was_full {
                    self.place.line.changed.notify_all();
                }
                return length;
            }
            let left = deadline.saturating_duration_since(Instant::now());
            if !self.waits || left.is_zero() {
                return Err(ErrorKind::WouldBlock.into());
            }
            let woken = self.place.line.changed.wait_timeout(state, left);
            state = woken.unwrap_or_else(PoisonError::into_inner).0;
        }
    }
}

impl Write for Seat {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let mut state = self.place.line.lock();
        if let Some((kind, words)) = &state.failed {
            return Err(io::Error::new(*kind, words.clone()));
        }
        let Some(board) = state.board(self.place.address) else { return Ok(0) };
        board.to_board.extend_from_slice(bytes);
        let turns = &mut state.turns[usize::from(self.place.address)];
        if !turns.is_absent() {
            turns.due = Instant::now();
        }
        self.place.line.changed.notify_all();
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

impl Transport for Seat {
    fn set_waiting(&mut self, waits: bool) -> io::Result<()> {
        self.waits = waits;
        Ok(())
    }
}

impl Drop for Seat {
    fn drop(&mut self) {
        let mut state = self.place.line.lock();
        state.boards[usize::from(self.place.address)] = None;
        state.shares.leave(self.place.address);
        self.place.line.changed.notify_all();
    }
}
