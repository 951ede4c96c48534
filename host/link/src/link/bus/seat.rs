//! Seat: a board's transport on a bus that this program has open once, whoever of its boards is open.
//!
//! What drives the bus takes what is for a board and hands over what the board says; it ends once nobody is seated any
//! more, or when the bus fails.

use super::{
    super::transport::{READ_TIMEOUT, Transport, may_retry},
    load::{Demand, Medium, Shares},
};
use crate::{
    error::{LinkError, LinkErrorKind, Overload},
    port,
};
use dermatome_shared::protocol::{MAX_PACKET_BYTES, Selection, bus::ADDRESSES};
use std::{
    collections::{BTreeMap, VecDeque},
    io::{self, ErrorKind, Read, Write},
    sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError},
    time::{Duration, Instant},
};

/// Most bytes kept for somebody who does not read.
const MOST_UNREAD: usize = 1 << 18;

/// How long a bus may take to be closed.
const CLOSING: Duration = Duration::from_millis(100);

/// Buses that are or were open in this program.
static BUSES: Mutex<BTreeMap<port::Bus, Arc<Mutex<Opened>>>> = Mutex::new(BTreeMap::new());

/// What became of opening a bus.
#[derive(Default)]
struct Opened {
    bus: Option<Arc<Bus>>,
    /// When that failed last, and how: who has waited meanwhile has failed as well.
    failed: Option<(Instant, ErrorKind, String)>,
}

/// A bus with boards on it.
struct Bus {
    state: Mutex<State>,
    /// Something was said, is to be sent, or somebody has left.
    changed: Condvar,
}

/// Who is seated, and what waits for them.
pub(super) struct State {
    boards: [Option<Board>; ADDRESSES as usize],
    pub(super) shares: Shares,
    /// Why the bus is dead.
    failed: Option<(ErrorKind, String)>,
}

/// What is known of a board that is open.
pub(super) struct Board {
    /// For the board; whole packets.
    pub(super) to_board: Vec<u8>,
    /// From it; packets, as over a line of its own.
    from_board: VecDeque<u8>,
}

impl Board {
    /// Whether there is no room for more of what it says.
    pub(super) fn is_full(&self) -> bool {
        self.from_board.len() >= MOST_UNREAD
    }
}

impl State {
    /// Those that are seated, with their addresses.
    pub(super) fn boards(&mut self) -> impl Iterator<Item = (u8, &mut Board)> {
        (0..).zip(&mut self.boards).filter_map(|(address, board)| Some((address, board.as_mut()?)))
    }

    pub(super) fn board(&mut self, address: u8) -> Option<&mut Board> {
        self.boards[usize::from(address)].as_mut()
    }

    fn is_empty(&self) -> bool {
        self.boards.iter().all(Option::is_none)
    }
}

impl Bus {
    fn new(medium: Medium) -> Self {
        let state =
            State { boards: [const { None }; ADDRESSES as usize], shares: Shares::new(medium), failed: None };
        Self { state: Mutex::new(state), changed: Condvar::new() }
    }

    fn lock(&self) -> MutexGuard<'_, State> {
        lock(&self.state)
    }
}

fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

/// A bus as what drives it sees it.
pub(super) struct Seats {
    bus: Arc<Bus>,
    opened: Arc<Mutex<Opened>>,
}

/// Whatever ends what drives it: whoever reads or writes learns that the bus is dead.
impl Drop for Seats {
    fn drop(&mut self) {
        self.fail(ErrorKind::BrokenPipe, "nobody has the bus any more".to_owned());
    }
}

impl Seats {
    pub(super) fn lock(&self) -> MutexGuard<'_, State> {
        self.bus.lock()
    }

    /// Waits until something has changed, for so long at most.
    pub(super) fn wait(&self, state: MutexGuard<'_, State>, time: Option<Duration>) {
        match time {
            Some(time) => drop(self.bus.changed.wait_timeout(state, time)),
            None => drop(self.bus.changed.wait(state)),
        }
    }

    /// Whoever reads the board gets what it has said.
    pub(super) fn hand_over(&self, address: u8, said: &[u8]) {
        if let Some(board) = self.lock().board(address) {
            board.from_board.extend(said);
        }
        // Who waits for the rest of a packet looks again soon enough.
        if said.contains(&0) {
            self.bus.changed.notify_all();
        }
    }

    /// If nobody is seated, closes the bus and says so: who comes meanwhile waits for that.
    pub(super) fn close_if_left(&self, close: impl FnOnce()) -> bool {
        let mut opened = lock(&self.opened);
        if !self.lock().is_empty() {
            return false;
        }
        opened.bus = None;
        close();
        true
    }

    /// The bus is dead. The first reason counts.
    pub(super) fn fail(&self, kind: ErrorKind, words: String) {
        self.lock().failed.get_or_insert((kind, words));
        self.bus.changed.notify_all();
    }

    /// The bus is dead: who waits for bytes that will never come is to know it.
    pub(super) fn fail_with(&self, error: &io::Error) {
        let kind = if may_retry(error) { ErrorKind::BrokenPipe } else { error.kind() };
        self.fail(kind, error.to_string());
    }

    /// Whoever waits looks again.
    pub(super) fn wake(&self) {
        // Who has just looked waits by the time that the lock is free.
        drop(self.lock());
        self.bus.changed.notify_all();
    }
}

/// Where a board is: on which bus, and its address there.
#[derive(Clone)]
pub(in crate::link) struct Place {
    bus: Arc<Bus>,
    address: u8,
}

/// One board's transport.
pub(in crate::link) struct Seat {
    place: Place,
    waits: bool,
}

/// Takes the place of a board on a bus, on which packets go over `medium`; if the bus is not open in this program, `start`
/// opens it and what drives it. `name` is the board's port, for errors.
pub(super) fn take(
    name: &str,
    port: &port::Bus,
    address: u8,
    medium: Medium,
    start: impl FnOnce(Seats) -> Result<(), LinkError>,
) -> Result<Seat, LinkError> {
    let asked = Instant::now();
    let opened = lock(&BUSES).entry(port.clone()).or_default().clone();
    let mut slot = lock(&opened);
    let bus = match slot.bus.as_ref().filter(|bus| bus.lock().failed.is_none()) {
        Some(bus) => bus.clone(),
        None => {
            if let Some((_, kind, words)) = slot.failed.as_ref().filter(|(when, ..)| *when >= asked) {
                return Err(LinkError::on_open(name, io::Error::new(*kind, words.clone())));
            }
            let bus = Arc::new(Bus::new(medium));
            start(Seats { bus: bus.clone(), opened: opened.clone() }).inspect_err(|error| {
                if let LinkErrorKind::Open(reason) = &error.kind {
                    slot.failed = Some((Instant::now(), reason.kind(), reason.to_string()));
                }
            })?;
            slot.bus.insert(bus).clone()
        }
    };
    let mut state = bus.lock();
    let board = &mut state.boards[usize::from(address)];
    if board.is_some() {
        return Err(LinkError::new(name, LinkErrorKind::InUse));
    }
    *board = Some(Board {
        to_board: Vec::with_capacity(MAX_PACKET_BYTES),
        from_board: VecDeque::with_capacity(MAX_PACKET_BYTES),
    });
    drop(state);
    bus.changed.notify_all();
    Ok(Seat { place: Place { bus, address }, waits: true })
}

impl Place {
    /// How many boards the bus is for, those included that are not open.
    pub(in crate::link) fn share_with(&self, boards: usize) {
        self.bus.lock().shares.boards = boards;
    }

    /// What of a selection fits the bus beside what goes over it for others: images less often where it must be.
    pub(in crate::link) fn fit(&self, selection: Selection, demand: &Demand) -> Result<Selection, Overload> {
        let mut state = self.bus.lock();
        let open = state.boards.iter().flatten().count();
        state.shares.fit(self.address, open, selection, demand)
    }

    /// Nothing of the board goes over the bus any more unless it is asked.
    pub(in crate::link) fn release(&self) {
        self.bus.lock().shares.leave(self.address);
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
        let mut state = self.place.bus.lock();
        loop {
            if let Some((kind, words)) = &state.failed {
                return Err(io::Error::new(*kind, words.clone()));
            }
            let Some(board) = state.board(self.place.address) else { return Ok(0) };
            if !board.from_board.is_empty() {
                let was_full = board.is_full();
                let length = board.from_board.read(buffer);
                if was_full {
                    self.place.bus.changed.notify_all();
                }
                return length;
            }
            let left = deadline.saturating_duration_since(Instant::now());
            if !self.waits || left.is_zero() {
                return Err(ErrorKind::WouldBlock.into());
            }
            let woken = self.place.bus.changed.wait_timeout(state, left);
            state = woken.unwrap_or_else(PoisonError::into_inner).0;
        }
    }
}

impl Write for Seat {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let mut state = self.place.bus.lock();
        if let Some((kind, words)) = &state.failed {
            return Err(io::Error::new(*kind, words.clone()));
        }
        let Some(board) = state.board(self.place.address) else { return Ok(0) };
        board.to_board.extend_from_slice(bytes);
        self.place.bus.changed.notify_all();
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

/// The last one waits until the bus is closed: its program may end after this.
impl Drop for Seat {
    fn drop(&mut self) {
        let Place { bus, address } = &self.place;
        let mut state = bus.lock();
        state.boards[usize::from(*address)] = None;
        state.shares.leave(*address);
        bus.changed.notify_all();
        let is_closing = |state: &mut State| state.is_empty() && state.failed.is_none();
        drop(bus.changed.wait_timeout_while(state, CLOSING, is_closing));
    }
}
