//! Client: the one host a simulated board serves at a time.
//!
//! Two threads do all reading and writing, so that the board never waits for its host: the reader
//! turns bytes into requests, and ends the channel when the host has gone; the writer empties the
//! outbox. What the host does not read stays in the outbox. There events have a limit, above which
//! whole events are dropped, and replies always find room.

use dermatome_shared::protocol::{BoardPacket, MAX_PACKET_BYTES, PacketReader, RequestPacket, encode};
use std::{
    collections::VecDeque,
    io::{self, Read, Write},
    net::{Shutdown, TcpStream},
    sync::{
        Arc, Condvar, Mutex, MutexGuard, PoisonError,
        mpsc::{Receiver, RecvTimeoutError, SyncSender, sync_channel},
    },
    thread::{self, JoinHandle},
    time::Duration,
};

/// Most events that wait for the host: a sixth of a second at 400 frames/s. A board's own hardware sends while this
/// computer is busy; the thread that stands for it must wait for its turn.
const MAX_EVENTS: usize = 256;
/// Room that one frame needs: tared, contacts, health, measurements, image, scope.
const EVENTS_OF_A_FRAME: usize = 6;
/// Most replies that wait: a host that asks this much without listening is cut off.
const MAX_REPLIES: usize = 1024;
/// Requests read ahead; further ones wait in the host.
const MAX_REQUESTS: usize = 16;

/// What came from the host.
pub(super) enum Input {
    Request(Box<RequestPacket>),
    Nothing,
    Gone,
}

/// A connected host. Dropping it closes the connection.
pub(super) struct Client {
    stream: TcpStream,
    requests: Option<Receiver<RequestPacket>>,
    outbox: Arc<Outbox>,
    threads: Vec<JoinHandle<()>>,
}

impl Client {
    pub(super) fn new(stream: TcpStream) -> io::Result<Self> {
        stream.set_nonblocking(false)?;
        stream.set_nodelay(true)?;
        let (reading, writing) = (stream.try_clone()?, stream.try_clone()?);
        let (sender, requests) = sync_channel(MAX_REQUESTS);
        let outbox = Arc::new(Outbox::default());
        let mut client =
            Self { stream, requests: Some(requests), outbox: outbox.clone(), threads: Vec::new() };
        client.spawn("board-read", move || read_requests(reading, &sender))?;
        client.spawn("board-write", move || write_packets(writing, &outbox))?;
        Ok(client)
    }

    /// The next request, waiting for it at most `timeout`.
    pub(super) fn receive(&self, timeout: Duration) -> Input {
        let Some(requests) = &self.requests else { return Input::Gone };
        match requests.recv_timeout(timeout) {
            Ok(request) => Input::Request(Box::new(request)),
            Err(RecvTimeoutError::Timeout) => Input::Nothing,
            Err(RecvTimeoutError::Disconnected) => Input::Gone,
        }
    }

    /// Sends a reply, or an event if there is room for it.
    pub(super) fn send(&self, packet: &BoardPacket) {
        if self.outbox.push(packet).is_err() {
            // The reader notices, and the board hears that the host has gone.
            let _ = self.stream.shutdown(Shutdown::Both);
        }
    }

    /// Whether all events of one more frame find room.
    pub(super) fn has_room(&self) -> bool {
        self.outbox.lock().events + EVENTS_OF_A_FRAME <= MAX_EVENTS
    }

    fn spawn(&mut self, name: &str, work: impl FnOnce() + Send + 'static) -> io::Result<()> {
        self.threads.push(thread::Builder::new().name(name.to_owned()).spawn(work)?);
        Ok(())
    }
}

impl Drop for Client {
    fn drop(&mut self) {
        self.outbox.close();
        // Ends blocking reads and writes; fails only if the host has already ended them.
        let _ = self.stream.shutdown(Shutdown::Both);
        self.requests = None;
        for thread in self.threads.drain(..) {
            let _ = thread.join();
        }
    }
}

fn read_requests(mut stream: TcpStream, requests: &SyncSender<RequestPacket>) {
    let mut reader = PacketReader::default();
    let mut buffer = [0; MAX_PACKET_BYTES];
    loop {
        let length = match stream.read(&mut buffer) {
            Ok(0) => return,
            Ok(length) => length,
            Err(error) if error.kind() == io::ErrorKind::Interrupted => continue,
            Err(_) => return,
        };
        // Damaged packets get no reply: nobody knows what they asked.
        for packet in buffer[..length].iter().filter_map(|&byte| reader.push(byte)?.ok()) {
            if requests.send(packet).is_err() {
                return;
            }
        }
    }
}

fn write_packets(mut stream: TcpStream, outbox: &Outbox) {
    while let Some(packet) = outbox.next() {
        if stream.write_all(&packet).is_err() {
            let _ = stream.shutdown(Shutdown::Both);
            return;
        }
    }
}

/// Packets that wait for the writer, in order.
#[derive(Default)]
struct Outbox {
    state: Mutex<Waiting>,
    changed: Condvar,
}

#[derive(Default)]
struct Waiting {
    packets: VecDeque<Outgoing>,
    events: usize,
    closed: bool,
}

struct Outgoing {
    is_event: bool,
    bytes: Vec<u8>,
}

/// The host has too many replies unread.
#[derive(Debug, PartialEq, Eq)]
struct TooManyReplies;

impl Outbox {
    /// Queues a packet; an event without room is dropped, and its number shows the gap.
    fn push(&self, packet: &BoardPacket) -> Result<(), TooManyReplies> {
        let is_event = matches!(packet, BoardPacket::Event { .. });
        let mut state = self.lock();
        if is_event && state.events >= MAX_EVENTS {
            return Ok(());
        }
        if !is_event && state.packets.len() - state.events >= MAX_REPLIES {
            return Err(TooManyReplies);
        }
        let mut buffer = [0; MAX_PACKET_BYTES];
        // Every message fits: a test of the protocol asserts it.
        let Ok(bytes) = encode(packet, &mut buffer) else { return Ok(()) };
        state.packets.push_back(Outgoing { is_event, bytes: bytes.to_vec() });
        state.events += usize::from(is_event);
        self.changed.notify_one();
        Ok(())
    }

    /// The next packet, waiting for it; `None` once the outbox is closed.
    fn next(&self) -> Option<Vec<u8>> {
        let idle = |state: &mut Waiting| state.packets.is_empty() && !state.closed;
        let waited = self.changed.wait_while(self.lock(), idle);
        let mut state = waited.unwrap_or_else(PoisonError::into_inner);
        let packet = if state.closed { None } else { state.packets.pop_front() }?;
        state.events -= usize::from(packet.is_event);
        Some(packet.bytes)
    }

    fn close(&self) {
        self.lock().closed = true;
        self.changed.notify_one();
    }

    /// No holder of the lock leaves the state half changed, not even one that panics.
    fn lock(&self) -> MutexGuard<'_, Waiting> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use dermatome_shared::protocol::{Event, Reply};

    fn event(number: u32) -> BoardPacket {
        BoardPacket::Event { number, event: Event::Tared { frames: 1 } }
    }

    #[test]
    fn a_full_outbox_drops_whole_events_and_takes_replies() {
        let outbox = Outbox::default();
        for number in 0..MAX_EVENTS as u32 + 5 {
            outbox.push(&event(number)).unwrap();
        }
        outbox.push(&BoardPacket::Reply { sequence: 1, reply: Reply::Done }).unwrap();
        assert_eq!(outbox.lock().packets.len(), MAX_EVENTS + 1);
        outbox.next().unwrap();
        outbox.push(&event(999)).unwrap();
        let state = outbox.lock();
        assert_eq!((state.events, state.packets.len()), (MAX_EVENTS, MAX_EVENTS + 1));
    }

    #[test]
    fn a_host_that_reads_no_reply_is_given_up_in_the_end() {
        let outbox = Outbox::default();
        let reply = BoardPacket::Reply { sequence: 1, reply: Reply::Done };
        for _ in 0..MAX_REPLIES {
            outbox.push(&reply).unwrap();
        }
        assert_eq!(outbox.push(&reply), Err(TooManyReplies));
    }

    #[test]
    fn a_closed_outbox_gives_nothing_more() {
        let outbox = Outbox::default();
        outbox.push(&event(0)).unwrap();
        outbox.close();
        assert_eq!(outbox.next(), None);
    }
}
