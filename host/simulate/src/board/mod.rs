//! Simulated board: the board's own state machine behind a real byte stream.
//!
//! [`SimulatedBoard`] runs [`Device`], the code the firmware runs, on a thread of its own and
//! serves one host at a time over TCP. Its measurements come from an [`Instrument`].
//!
//! Two clocks: *board time* counts the frames scanned, at the patch's frame rate, and stamps the
//! frames. *Script time* counts only the frames streamed, and tells the source how far its script
//! (who presses where) has come. Frames are scanned only while something uses them, a tare or a
//! stream, so what a host sees follows from script and seed alone and not from wall time.

mod client;
mod for_skin;
mod next_host;
pub mod patch_store;
mod recorded;

use self::{
    client::{Client, Input},
    next_host::NextHost,
    patch_store::{FilePatchStore, OpenError},
};
use crate::{
    instrument::{Instrument, Recalled, ScanTable},
    rig::Scanner,
};
use dermatome_link::{Link, LinkError};
use dermatome_shared::{
    MAX_ELECTRODES,
    acquire::FrontEnd,
    device::{Arrival, BoardFacts, Device, PatchStore},
    drive::Drive,
    frame::Frame,
    patch::PatchView,
    pipeline::{PipelineState, reflex::Watch},
    protocol::{FrameSource, Identity, Request, RequestPacket, Selection},
    restart::Restart,
};
pub use for_skin::{DEFAULT_NOISE, SimulationError, board_for_skin};
pub use recorded::{ReplayError, board_for_items, board_for_recording};
use std::{
    io::{self, ErrorKind},
    net::{Ipv4Addr, SocketAddr, TcpListener},
    path::PathBuf,
    sync::{
        Arc,
        atomic::{AtomicBool, Ordering},
    },
    thread::{self, JoinHandle},
    time::{Duration, Instant},
};

/// How often the board looks for a new host.
const ACCEPT_INTERVAL: Duration = Duration::from_millis(5);
/// Longest the board waits without looking whether it should stop.
const STOP_INTERVAL: Duration = Duration::from_millis(100);
/// How often an unpaced board looks whether its host has made room.
const ROOM_INTERVAL: Duration = Duration::from_micros(200);
/// A board that was held up catches up on at most this much.
const MAX_BACKLOG: Duration = Duration::from_millis(100);
/// Longest time between frames; slower frame rates count as this.
const MAX_PERIOD: Duration = Duration::from_secs(3600);

/// How long a host that says nothing keeps its place when another wants it. One that streams says something every
/// [`dermatome_shared::device::HOST_INTERVAL_US`].
pub const DEFAULT_LEASE: Duration = Duration::from_secs(10);

/// How fast frames come.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Pace {
    /// At the patch's frame rate, or as fast as the source can. A host that reads too slowly loses
    /// events, as with a real board.
    #[default]
    FrameRate,
    /// As fast as the source can and the host reads; nothing is lost. For tests and benchmarks.
    Unpaced,
}

/// How a simulated board starts.
#[derive(Clone, Debug)]
pub struct BoardOptions {
    /// Where it listens; port 0 takes any free one.
    pub listen: SocketAddr,
    /// Electrodes wired to the board.
    pub electrodes: u8,
    /// Patch in use from the start, unless the store holds one.
    pub patch: Option<Vec<u8>>,
    /// File that keeps the uploaded patch.
    pub store: Option<PathBuf>,
    /// How fast frames come.
    pub pace: Pace,
    /// The board ends its stream after this many streamed frames, and itself when its host leaves.
    pub max_frames: Option<u64>,
    /// How long a host that says nothing keeps its place when another wants it.
    pub lease: Duration,
    /// What it says that it is, and where its frames come from.
    pub name: &'static str,
    /// Likewise.
    pub frame_source: FrameSource,
    /// How the skin is driven from the start, unless as the patch says.
    pub drive: Option<Drive>,
}

impl Default for BoardOptions {
    fn default() -> Self {
        Self {
            listen: (Ipv4Addr::LOCALHOST, 0).into(),
            electrodes: MAX_ELECTRODES as u8,
            patch: None,
            store: None,
            pace: Pace::default(),
            max_frames: None,
            lease: DEFAULT_LEASE,
            name: "simulated",
            frame_source: FrameSource::Simulated,
            drive: None,
        }
    }
}

/// Why a simulated board does not run.
#[derive(Debug, thiserror::Error)]
pub enum BoardError {
    /// Another program listens there.
    #[error("cannot listen at {address}: the port is in use by another program, or by another board")]
    PortInUse {
        /// Where the board was to listen.
        address: SocketAddr,
    },
    /// The system does not let it listen there, for another reason.
    #[error("cannot listen at {address}: {reason}")]
    Listen {
        /// Where the board was to listen.
        address: SocketAddr,
        /// What the system says.
        reason: io::Error,
    },
    /// Its patch, or the file that holds it, is not usable.
    #[error(transparent)]
    Patch(#[from] OpenError),
    /// Its patch, given or stored, is for another skin.
    #[error("the board's patch is for {patch} electrodes, the board has {board}")]
    Electrodes {
        /// Electrodes of the patch.
        patch: u8,
        /// Electrodes of the board.
        board: u8,
    },
    /// The system gives it no thread.
    #[error("cannot start the board's thread: {reason}")]
    Thread {
        /// What the system says.
        reason: io::Error,
    },
    /// Its instrument panicked.
    #[error("the simulated board crashed")]
    Crashed,
}

/// A running board. Dropping it stops it.
#[derive(Debug)]
pub struct SimulatedBoard {
    address: SocketAddr,
    stop: Arc<AtomicBool>,
    thread: Option<JoinHandle<()>>,
}

impl SimulatedBoard {
    /// Starts a board with this instrument.
    pub fn start(options: BoardOptions, instrument: impl Instrument + 'static) -> Result<Self, BoardError> {
        let facts = facts(&options, instrument.front_end());
        let store = FilePatchStore::open(options.store, options.patch)?;
        check_electrodes(&store, options.electrodes)?;
        let listener = listen(options.listen)?;
        let address = listener.local_addr().map_err(|reason| listen_error(options.listen, reason))?;
        let stop = Arc::new(AtomicBool::new(false));
        let mut device = Device::new(facts, store, PipelineState::default());
        if options.drive.is_some() {
            let request = Request::Drive(options.drive);
            let _ = device.handle(&RequestPacket { sequence: 0, request }, 0);
        }
        let worker = Worker {
            device,
            watch: Box::default(),
            table: None,
            scanner: Scanner::new(Box::new(instrument)),
            pace: options.pace,
            stop: stop.clone(),
            started: Instant::now(),
            script_frame: 0,
            frames_left: options.max_frames,
            lease: options.lease,
            next_host: NextHost::default(),
        };
        let thread = thread::Builder::new().name("board".to_owned()).spawn(move || worker.run(&listener));
        let thread = thread.map_err(|reason| BoardError::Thread { reason })?;
        Ok(Self { address, stop, thread: Some(thread) })
    }

    /// A link to the board, which lives as long as the link. `port` names it in errors.
    pub fn connect(self, port: impl Into<String>) -> Result<Link, LinkError> {
        Ok(Link::over_tcp(port, self.address)?.with_companion(self))
    }

    /// Where it listens.
    #[must_use]
    pub fn address(&self) -> SocketAddr {
        self.address
    }

    /// Whether the board has ended: it has streamed its frames, and its host has left.
    #[must_use]
    pub fn is_finished(&self) -> bool {
        self.thread.as_ref().is_none_or(JoinHandle::is_finished)
    }

    /// Stops the board, and with it the link of its host.
    pub fn stop(mut self) -> Result<(), BoardError> {
        self.end()
    }

    fn end(&mut self) -> Result<(), BoardError> {
        self.stop.store(true, Ordering::Relaxed);
        let Some(thread) = self.thread.take() else { return Ok(()) };
        thread.join().map_err(|_| BoardError::Crashed)
    }
}

impl Drop for SimulatedBoard {
    fn drop(&mut self) {
        // A crash has already been printed by the thread.
        let _ = self.end();
    }
}

fn check_electrodes(store: &FilePatchStore, board: u8) -> Result<(), BoardError> {
    // What the store holds has been validated.
    let patch =
        store.active().and_then(|bytes| PatchView::open(bytes).ok()).map(|patch| patch.header.electrodes);
    match patch.filter(|&patch| patch > board) {
        Some(patch) => Err(BoardError::Electrodes { patch, board }),
        None => Ok(()),
    }
}

fn listen(address: SocketAddr) -> Result<TcpListener, BoardError> {
    let failed = |reason| listen_error(address, reason);
    let listener = TcpListener::bind(address).map_err(failed)?;
    listener.set_nonblocking(true).map_err(failed)?;
    Ok(listener)
}

fn listen_error(address: SocketAddr, reason: io::Error) -> BoardError {
    match reason.kind() {
        ErrorKind::AddrInUse => BoardError::PortInUse { address },
        _ => BoardError::Listen { address, reason },
    }
}

/// Names too long for their field come out empty; these two are not.
fn facts(options: &BoardOptions, front_end: Option<FrontEnd>) -> BoardFacts {
    let identity = Identity {
        board: options.name.try_into().unwrap_or_default(),
        firmware: env!("CARGO_PKG_VERSION").try_into().unwrap_or_default(),
    };
    BoardFacts {
        identity,
        electrodes: options.electrodes,
        frame_source: options.frame_source,
        front_end,
        started_after: Restart::PowerOn,
        // A pulled cable closes no connection.
        sees_host_go: false,
    }
}

/// What runs on the board's thread.
struct Worker {
    device: Device<FilePatchStore>,
    scanner: Scanner<Box<dyn Instrument>>,
    /// Looks at frames by the patch's reflexes.
    watch: Box<Watch>,
    /// What is scanned, with the number of the device's scan it was made for.
    table: Option<(u32, ScanTable)>,
    pace: Pace,
    stop: Arc<AtomicBool>,
    started: Instant,
    /// Frames of the present stream so far.
    script_frame: u64,
    /// Frames that may still be streamed, if there is a limit.
    frames_left: Option<u64>,
    lease: Duration,
    next_host: NextHost,
}

impl Worker {
    fn run(mut self, listener: &TcpListener) {
        while !self.should_stop() && self.frames_left != Some(0) {
            match self.next_host.take(listener).and_then(|stream| Client::new(stream).ok()) {
                Some(client) => self.serve(&client, listener),
                None => thread::sleep(ACCEPT_INTERVAL),
            }
        }
    }

    fn serve(&mut self, client: &Client, listener: &TcpListener) {
        let (mut due, mut heard) = (None, Instant::now());
        while !self.should_stop() && !self.next_host.takes_over(listener, heard.elapsed(), self.lease) {
            match client.receive(self.time_to_wait(client, &mut due)) {
                Input::Request(packet) => {
                    heard = Instant::now();
                    self.answer(client, &packet);
                }
                Input::Nothing if self.may_scan(client, due) => due = self.scan(client, due),
                Input::Nothing => {}
                Input::Gone => break,
            }
            self.device.check_host(self.uptime_ms());
        }
        self.device.disconnect();
    }

    fn should_stop(&self) -> bool {
        self.stop.load(Ordering::Relaxed)
    }

    /// How long to wait for a request before the next frame. `due` is when that frame is complete:
    /// the first one a period after it is needed.
    fn time_to_wait(&self, client: &Client, due: &mut Option<Instant>) -> Duration {
        if !self.device.needs_frames() {
            *due = None;
            return STOP_INTERVAL;
        }
        if self.pace == Pace::Unpaced {
            return if client.has_room() { Duration::ZERO } else { ROOM_INTERVAL };
        }
        let due = *due.get_or_insert_with(|| Instant::now() + self.period());
        due.saturating_duration_since(Instant::now()).min(STOP_INTERVAL)
    }

    fn may_scan(&self, client: &Client, due: Option<Instant>) -> bool {
        self.device.needs_frames()
            && match self.pace {
                Pace::Unpaced => client.has_room(),
                Pace::FrameRate => due.is_some_and(|due| due <= Instant::now()),
            }
    }

    /// Takes one frame through the device; gives the time when the next one is due.
    fn scan(&mut self, client: &Client, due: Option<Instant>) -> Option<Instant> {
        let period = self.period();
        // Without a reference the device begins a tare by itself.
        let pipeline = self.device.pipeline();
        let streamed = !pipeline.is_taring() && pipeline.reference().is_some();
        let Some(table) = self.scan_table() else { return due };
        let script_time = streamed.then_some(self.script_frame as f64 / self.frame_rate());
        match self.scanner.instrument_mut().recall(&table) {
            None => {}
            Some(recalled) => return self.replay(client, recalled, due, period),
        }
        let mut frame = self.scanner.scan(&table, script_time);
        let reflexes = self.watch.see(&frame, frame.timestamp_us);
        let arrival = Arrival { timestamp_us: frame.timestamp_us, missed: false, reflexes };
        self.device.process(&mut frame, &arrival, |packet| client.send(packet));
        self.device.brief(&mut self.watch);
        self.show_scope(client, &frame, &table, script_time);
        if streamed {
            self.count_streamed();
        }
        due.map(|due| (due + period).max(Instant::now().checked_sub(MAX_BACKLOG).unwrap_or(due)))
    }

    /// Takes what comes next of a recording; gives the time when the next frame is due.
    fn replay(
        &mut self,
        client: &Client,
        recalled: Recalled,
        due: Option<Instant>,
        period: Duration,
    ) -> Option<Instant> {
        match recalled {
            // A host that has asked for a tare has it, unless fewer frames of the recording are untouched.
            Recalled::Tare(frames)
                if self.device.pipeline().frames_asked_for().is_some_and(|asked| asked <= frames) =>
            {
                due
            }
            Recalled::Tare(frames) => {
                self.tell_itself(Request::Tare { frames });
                due
            }
            Recalled::Frame(of) => {
                let (mut frame, health, vitals) = *of;
                self.device.set_vitals(vitals);
                let reflexes = self.watch.see(&frame, frame.timestamp_us);
                self.device.replay(&mut frame, health, reflexes, |packet| client.send(packet));
                self.device.brief(&mut self.watch);
                self.script_frame += 1;
                due.map(|due| (due + period).max(Instant::now().checked_sub(MAX_BACKLOG).unwrap_or(due)))
            }
            // A stream that has just begun has not come to this end, the one before it has.
            Recalled::End if self.script_frame == 0 => due.map(|due| due + period),
            Recalled::End => {
                self.tell_itself(Request::Stream(Selection::default()));
                due
            }
        }
    }

    /// What is scanned: the patch's slots under the drive in effect, which change with the scan's number.
    fn scan_table(&mut self) -> Option<ScanTable> {
        let number = self.device.scan();
        if self.table.as_ref().is_none_or(|(of, _)| *of != number) {
            let table = ScanTable::new(&self.device.patch()?, self.device.drive()?);
            self.table = Some((number, table));
            self.device.begin_watch(&mut self.watch);
        }
        self.table.as_ref().map(|(_, table)| table.clone())
    }

    /// Sends the samples of the slot that the host watches, if this frame is one it wants.
    fn show_scope(
        &mut self,
        client: &Client,
        frame: &Frame,
        table: &ScanTable,
        script_time: Option<f64>,
    ) -> Option<()> {
        if !self.device.wants_scope(frame.sequence) {
            return None;
        }
        let slot = self.device.streaming().scope_slot;
        let samples = self.scanner.samples(table, slot, script_time)?;
        self.device.show_scope(&samples, |packet| client.send(packet));
        Some(())
    }

    fn count_streamed(&mut self) {
        self.script_frame += 1;
        if let Some(left) = &mut self.frames_left {
            *left = left.saturating_sub(1);
        }
        self.end_stream_if_over();
    }

    fn answer(&mut self, client: &Client, packet: &RequestPacket) {
        let was_streaming = self.device.streaming().any();
        client.send(&self.device.handle(packet, self.uptime_ms()));
        self.device.settle();
        if !was_streaming {
            self.script_frame = 0;
        }
        self.end_stream_if_over();
    }

    fn end_stream_if_over(&mut self) {
        if self.frames_left == Some(0) && self.device.streaming().any() {
            self.tell_itself(Request::Stream(Selection::default()));
        }
    }

    /// What no host asks for.
    fn tell_itself(&mut self, request: Request) {
        let _ = self.device.handle(&RequestPacket { sequence: 0, request }, self.uptime_ms());
    }

    fn uptime_ms(&self) -> u64 {
        self.started.elapsed().as_millis().try_into().unwrap_or(u64::MAX)
    }

    /// Time between frames, as the drive in effect has it.
    fn period(&self) -> Duration {
        Duration::try_from_secs_f64(1.0 / self.frame_rate()).unwrap_or(MAX_PERIOD).min(MAX_PERIOD)
    }

    /// Frames per second, as the drive in effect has it; there are no frames without one.
    fn frame_rate(&self) -> f64 {
        self.device.drive().map_or(1.0, |drive| drive.frame_rate.into())
    }
}
