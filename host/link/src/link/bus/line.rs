//! Line: who is on it, and whose turn it is.

use super::{
    super::{
        transport::{READ_TIMEOUT, Transport, open_serial, open_tcp},
        wire::REPLY_TIMEOUT,
    },
    load::{Demand, Overload, Shares},
};
use crate::{
    error::{LinkError, LinkErrorKind},
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

/// Longest that the line is given to a board which says nothing, adapters' delays included (16 ms each way is usual).
const SILENCE: Duration = Duration::from_millis(TURN_LAPSES_MS + 30);
/// Longest turn, whatever is said.
const LONGEST_TURN: Duration = Duration::from_millis(200);
/// Until a board that had nothing to say gets its next turn.
const IDLE: Duration = Duration::from_millis(1);
/// Until one that did not answer does, which doubles up to the longest.
const FIRST_ABSENCE: Duration = Duration::from_millis(20);
const LONGEST_ABSENCE: Duration = Duration::from_millis(1000);
/// Most bytes kept for somebody who does not read; until they are read, the board gets no turn.
const MOST_UNREAD: usize = 1 << 18;

/// Lines that are open in this program, by their port.
static LINES: Mutex<BTreeMap<port::Line, Arc<Line>>> = Mutex::new(BTreeMap::new());

/// A line with boards on it.
struct Line {
    port: port::Line,
    state: Mutex<State>,
    /// Something was said, is to be sent, or somebody has left.
    changed: Condvar,
}

struct State {
    boards: [Option<Board>; ADDRESSES as usize],
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
    /// Turns in a row in which nothing was heard.
    silences: u32,
    /// When it gets its next turn.
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
    let mut lines = lock(&LINES);
    let line = match lines.get(port).filter(|line| line.lock().failed.is_none()) {
        Some(line) => line.clone(),
        None => {
            let line =
                Line::start(port, open(name, port)?).map_err(|error| LinkError::on_open(name, error))?;
            lines.insert(port.clone(), line.clone());
            line
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
        silences: 0,
        due: Instant::now(),
    });
    drop(state);
    line.changed.notify_all();
    Ok(Seat { place: Place { line, address }, waits: true })
}

fn open(name: &str, port: &port::Line) -> Result<Box<dyn Transport>, LinkError> {
    Ok(match port {
        port::Line::Serial(path) => Box::new(open_serial(path)?),
        port::Line::Tcp(address) => Box::new(open_tcp(name, address.as_str())?),
    })
}

fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

impl Line {
    fn start(port: &port::Line, wire: Box<dyn Transport>) -> io::Result<Arc<Self>> {
        let state =
            State { boards: [const { None }; ADDRESSES as usize], shares: Shares::default(), failed: None };
        let line = Arc::new(Self { port: port.clone(), state: Mutex::new(state), changed: Condvar::new() });
        let host = Host { line: line.clone(), wire, ear: Ear::default() };
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
        let boards = (0..).zip(&self.boards);
        let waiting = boards.filter_map(|(address, board)| {
            let board = board.as_ref()?;
            (board.from_board.len() < MOST_UNREAD).then_some((board.due, address))
        });
        match waiting.min() {
            Some((due, address)) if due <= Instant::now() => Ok(address),
            other => Err(other.map(|(due, _)| due)),
        }
    }

    fn board(&mut self, address: u8) -> Option<&mut Board> {
        self.boards[usize::from(address)].as_mut()
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
    wire: Box<dyn Transport>,
    ear: Ear,
}

impl Host {
    /// Gives boards the line until all have left, or until it fails.
    fn give_turns(mut self) {
        let line = self.line.clone();
        // Ends what somebody before has left unfinished.
        let mut failed = self.send(&[0]).err();
        while failed.is_none() {
            let Some(address) = self.wait() else { break };
            failed = self.turn(address).err();
        }
        if let Some(error) = failed {
            line.lock().failed = Some((error.kind(), error.to_string()));
            line.changed.notify_all();
        }
    }

    /// Waits until a board is to have the line; none once nobody has one open.
    fn wait(&self) -> Option<u8> {
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
    fn leave(&self) -> bool {
        let mut lines = lock(&LINES);
        if self.line.lock().boards.iter().any(Option::is_some) {
            return false;
        }
        if lines.get(&self.line.port).is_some_and(|line| Arc::ptr_eq(line, &self.line)) {
            lines.remove(&self.line.port);
        }
        true
    }

    /// Sends a board what is for it, and hears it out.
    fn turn(&mut self, address: u8) -> io::Result<()> {
        let Some(requests) = self.line.lock().board(address).map(|board| std::mem::take(&mut board.to_board))
        else {
            return Ok(());
        };
        let mut blocks = Vec::with_capacity(requests.len() + 8);
        for packet in requests.split(|&byte| byte == 0).filter(|packet| !packet.is_empty()) {
            blocks.push(Mark::Request.byte(address));
            blocks.extend_from_slice(packet);
            blocks.push(0);
        }
        blocks.extend_from_slice(&Mark::Turn.block(address));
        self.send(&blocks)?;
        let turn = self.listen(address)?;
        let mut state = self.line.lock();
        if let Some(board) = state.board(address) {
            board.silences = if turn == Turn::Silent { board.silences + 1 } else { 0 };
            let pause = match turn {
                Turn::Said => Duration::ZERO,
                Turn::Idle => IDLE,
                Turn::Silent => (FIRST_ABSENCE * (1 << (board.silences - 1).min(10))).min(LONGEST_ABSENCE),
            };
            board.due = Instant::now() + pause;
        }
        Ok(())
    }

    fn send(&mut self, mut bytes: &[u8]) -> io::Result<()> {
        let deadline = Instant::now() + REPLY_TIMEOUT;
        while !bytes.is_empty() {
            match self.wire.write(bytes) {
                Ok(0) => return Err(ErrorKind::BrokenPipe.into()),
                Ok(written) => bytes = &bytes[written..],
                Err(error) if !may_pass(&error) => return Err(error),
                Err(_) if Instant::now() >= deadline => return Err(ErrorKind::TimedOut.into()),
                Err(_) => {}
            }
        }
        Ok(())
    }

    /// Hears a board until its turn ends, or has lapsed.
    fn listen(&mut self, address: u8) -> io::Result<Turn> {
        let (given, mut heard) = (Instant::now(), Instant::now());
        let (mut buffer, mut said) = ([0; 2048], Vec::new());
        let (mut answered, mut has_said, mut is_over) = (false, false, false);
        while !is_over && heard.elapsed() < SILENCE && given.elapsed() < LONGEST_TURN {
            let length = match self.wire.read(&mut buffer) {
                Ok(0) => return Err(ErrorKind::UnexpectedEof.into()),
                Ok(length) => length,
                Err(error) if may_pass(&error) => continue,
                Err(error) => return Err(error),
            };
            heard = Instant::now();
            for &byte in &buffer[..length] {
                match self.ear.hear(byte) {
                    Some(Heard::Byte { mark: Mark::Said, address: from, byte }) if from == address => {
                        said.push(byte)
                    }
                    Some(Heard::Token { mark: Mark::End, address: from }) if from == address => {
                        is_over = true
                    }
                    _ => continue,
                }
                if !std::mem::replace(&mut answered, true) {
                    self.line.lock().shares.answered(given.elapsed());
                }
            }
            has_said |= !said.is_empty();
            self.hand_over(address, &mut said);
        }
        Ok(match (answered, has_said) {
            (false, _) => Turn::Silent,
            (true, false) => Turn::Idle,
            (true, true) => Turn::Said,
        })
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

fn may_pass(error: &io::Error) -> bool {
    matches!(error.kind(), ErrorKind::TimedOut | ErrorKind::WouldBlock | ErrorKind::Interrupted)
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
        state.shares.boards = state.shares.boards.max(open);
        state.shares.fit(self.address, selection, demand)
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
                return board.from_board.read(buffer);
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
        if board.silences == 0 {
            board.due = Instant::now();
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
