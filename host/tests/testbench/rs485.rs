//! A line of several boards behind TCP, as an adapter for RS-485 has it: simulated boards speak in their turn only.

use dermatome_shared::protocol::bus::{ADDRESSES, Ear, Heard, Mark, TURN_BYTES};
use std::{
    io::{ErrorKind, Read, Write},
    net::{SocketAddr, TcpListener, TcpStream},
    sync::{
        Arc, Mutex,
        atomic::{AtomicBool, AtomicU32, Ordering},
    },
    thread,
    time::Duration,
};

/// What a test does to a line, and what it saw.
#[derive(Default)]
pub(crate) struct Line {
    /// Bytes that come before the next answers.
    pub(crate) noise: Mutex<Vec<u8>>,
    /// The board at this address is without power while its bit is set.
    pub(crate) off: AtomicU32,
    /// The adapter is unplugged.
    pub(crate) is_cut: AtomicBool,
    /// Turns that each board had.
    pub(crate) turns: Mutex<[u32; ADDRESSES as usize]>,
}

/// One board at its end of the line.
struct Board {
    address: u8,
    stream: TcpStream,
    request: Vec<u8>,
    /// What it has to say.
    waiting: Vec<u8>,
}

/// A line with these boards; gives where an adapter's TCP port is. It takes hosts one after the other.
pub(crate) fn line(boards: &[(u8, SocketAddr)]) -> (SocketAddr, Arc<Line>) {
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let (address, line) = (listener.local_addr().unwrap(), Arc::<Line>::default());
    let (boards, shared) = (boards.to_vec(), line.clone());
    thread::spawn(move || {
        for host in listener.incoming() {
            let boards = boards.iter().map(|&(address, at)| Board::new(address, at)).collect();
            serve(host.unwrap(), boards, &shared);
        }
    });
    (address, line)
}

fn serve(mut host: TcpStream, mut boards: Vec<Board>, line: &Line) {
    host.set_nodelay(true).unwrap();
    host.set_read_timeout(Some(Duration::from_millis(5))).unwrap();
    let (mut ear, mut buffer) = (Ear::default(), [0; 4096]);
    while !line.is_cut.load(Ordering::Relaxed) {
        let length = match host.read(&mut buffer) {
            Ok(0) => return,
            Ok(length) => length,
            Err(error) if matches!(error.kind(), ErrorKind::WouldBlock | ErrorKind::TimedOut) => 0,
            Err(_) => return,
        };
        for heard in buffer[..length].iter().filter_map(|&byte| ear.hear(byte)) {
            let (Heard::Byte { address, .. } | Heard::Token { address, .. }) = heard;
            let is_off = line.off.load(Ordering::Relaxed) >> address & 1 == 1;
            let Some(board) = boards.iter_mut().find(|it| it.address == address && !is_off) else { continue };
            match heard {
                Heard::Byte { mark: Mark::Request, byte, .. } => board.hear(byte),
                Heard::Token { mark: Mark::Turn, .. } => {
                    line.turns.lock().unwrap()[usize::from(address)] += 1;
                    let noise = std::mem::take(&mut *line.noise.lock().unwrap());
                    let said = [noise, board.speak()].concat();
                    if host.write_all(&said).is_err() {
                        return;
                    }
                }
                _ => {}
            }
        }
    }
}

impl Board {
    fn new(address: u8, at: SocketAddr) -> Self {
        let stream = super::raw(at);
        stream.set_nonblocking(true).unwrap();
        Self { address, stream, request: Vec::new(), waiting: Vec::new() }
    }

    fn hear(&mut self, byte: u8) {
        self.request.push(byte);
        if byte == 0 {
            self.stream.set_nonblocking(false).unwrap();
            let _ = self.stream.write_all(&std::mem::take(&mut self.request));
            self.stream.set_nonblocking(true).unwrap();
        }
    }

    /// What it says in a turn.
    fn speak(&mut self) -> Vec<u8> {
        let mut buffer = [0; 4096];
        // What a board has not sent yet makes it wait, as a queue does.
        while self.waiting.len() < 2 * TURN_BYTES {
            match self.stream.read(&mut buffer) {
                Ok(length) if length > 0 => self.waiting.extend_from_slice(&buffer[..length]),
                _ => break,
            }
        }
        let (mut said, mut taken) = (Vec::new(), 0);
        while let Some(length) = self.waiting[taken..].iter().position(|&byte| byte == 0) {
            if taken >= TURN_BYTES {
                break;
            }
            said.extend_from_slice(&Mark::Said.head(self.address));
            said.extend_from_slice(&self.waiting[taken..=taken + length]);
            taken += length + 1;
        }
        self.waiting.drain(..taken);
        said.extend_from_slice(&Mark::End.block(self.address));
        said
    }
}
