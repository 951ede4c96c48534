//! A CAN FD bus of several boards behind TCP, as an adapter that speaks slcan has it: a frame after the other, each as long
//! as it takes at 1 and 2 Mbit/s, the lowest identifier first.

use dermatome_shared::protocol::can::{Carries, FRAME_BYTES, LENGTHS, filled};
use std::{
    collections::VecDeque,
    fmt::Write as _,
    io::{ErrorKind, Read, Write},
    net::{SocketAddr, TcpListener, TcpStream},
    sync::{
        Arc, Mutex,
        atomic::{AtomicBool, AtomicU32, Ordering},
    },
    thread,
    time::{Duration, Instant},
};

/// What a frame of 64 bytes takes as a rule, its stuff bits included.
const FRAME: Duration = Duration::from_micros(320);

/// What a test does to a bus, and what it saw.
#[derive(Default)]
pub(crate) struct Bus {
    /// Lines that come before the next frame.
    pub(crate) strangers: Mutex<Vec<u8>>,
    /// The board at this address is without power while its bit is set.
    pub(crate) off: AtomicU32,
    /// The adapter is unplugged.
    pub(crate) is_cut: AtomicBool,
    /// Commands that the adapter was given, one after the other.
    pub(crate) commands: Mutex<String>,
}

/// One board at its end of the bus.
struct Board {
    address: u8,
    stream: TcpStream,
    /// What it has to say.
    waiting: VecDeque<u8>,
}

/// A bus with these boards; gives where its adapter's TCP port is. It takes hosts one after the other.
pub(crate) fn bus(boards: &[(u8, SocketAddr)]) -> (SocketAddr, Arc<Bus>) {
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let (address, bus) = (listener.local_addr().unwrap(), Arc::<Bus>::default());
    let (boards, shared) = (boards.to_vec(), bus.clone());
    thread::spawn(move || {
        for host in listener.incoming() {
            let boards = boards.iter().map(|&(address, at)| Board::new(address, at)).collect();
            serve(host.unwrap(), boards, &shared);
        }
    });
    (address, bus)
}

fn serve(mut host: TcpStream, mut boards: Vec<Board>, bus: &Bus) {
    host.set_nodelay(true).unwrap();
    host.set_read_timeout(Some(Duration::from_millis(1))).unwrap();
    let (mut buffer, mut line, mut free) = ([0; 4096], Vec::new(), Instant::now());
    while !bus.is_cut.load(Ordering::Relaxed) {
        let length = match host.read(&mut buffer) {
            Ok(0) => return,
            Ok(length) => length,
            Err(error) if matches!(error.kind(), ErrorKind::WouldBlock | ErrorKind::TimedOut) => 0,
            Err(_) => return,
        };
        let off = bus.off.load(Ordering::Relaxed);
        let has_power = |board: &&mut Board| off >> board.address & 1 == 0;
        for &byte in &buffer[..length] {
            if byte != b'\r' {
                line.push(byte);
                continue;
            }
            let text = String::from_utf8(std::mem::take(&mut line)).unwrap();
            match request(&text) {
                None => bus.commands.lock().unwrap().push_str(&(text + " ")),
                Some((address, data)) => {
                    let board = boards.iter_mut().filter(has_power).find(|board| board.address == address);
                    board.into_iter().for_each(|board| board.hear(&data));
                    free = free.max(Instant::now()) + FRAME;
                }
            }
        }
        let mut said = std::mem::take(&mut *bus.strangers.lock().unwrap());
        while free < Instant::now() {
            let Some((address, data)) =
                boards.iter_mut().filter(has_power).find_map(|board| Some((board.address, board.speak()?)))
            else {
                free = Instant::now();
                break;
            };
            said.extend_from_slice(written(Carries::Said.identifier(address), &data).as_bytes());
            free += FRAME;
        }
        if !said.is_empty() && host.write_all(&said).is_err() {
            return;
        }
    }
}

/// Address and bytes of a request; none of another line.
fn request(line: &str) -> Option<(u8, Vec<u8>)> {
    let (identifier, data) = line.strip_prefix('b')?.split_at_checked(3)?;
    let (Carries::Request, address) = Carries::of(u16::from_str_radix(identifier, 16).unwrap())? else {
        panic!("a host says `{line}`")
    };
    let (length, digits) = data.split_at(1);
    let byte = |at: usize| u8::from_str_radix(&digits[2 * at..2 * at + 2], 16).unwrap();
    let data: Vec<u8> = (0..digits.len() / 2).map(byte).collect();
    assert_eq!(data.len(), LENGTHS[usize::from_str_radix(length, 16).unwrap()], "{line}");
    Some((address, data))
}

/// A frame as a line.
pub(crate) fn written(identifier: u16, data: &[u8]) -> String {
    let code = LENGTHS.iter().position(|&length| length == data.len()).unwrap();
    let mut line = format!("b{identifier:03X}{code:X}");
    data.iter().for_each(|byte| write!(line, "{byte:02X}").unwrap());
    line + "\r"
}

impl Board {
    fn new(address: u8, at: SocketAddr) -> Self {
        let stream = super::raw(at);
        stream.set_nonblocking(true).unwrap();
        Self { address, stream, waiting: VecDeque::new() }
    }

    fn hear(&mut self, data: &[u8]) {
        self.stream.set_nonblocking(false).unwrap();
        let _ = self.stream.write_all(data);
        self.stream.set_nonblocking(true).unwrap();
    }

    /// The data of its next frame: as many bytes of a packet as it holds.
    fn speak(&mut self) -> Option<Vec<u8>> {
        let mut buffer = [0; 4096];
        // What a board has not sent yet makes it wait, as a queue does.
        if self.waiting.len() < FRAME_BYTES
            && let Ok(length) = self.stream.read(&mut buffer)
        {
            self.waiting.extend(&buffer[..length]);
        }
        let packet = self.waiting.iter().position(|&byte| byte == 0).map(|end| end + 1);
        let length = packet.unwrap_or(self.waiting.len()).min(FRAME_BYTES);
        let bytes: Vec<u8> = self.waiting.drain(..length).collect();
        (!bytes.is_empty()).then(|| filled(&bytes, &mut [0; FRAME_BYTES]).to_vec())
    }
}
