//! A cable that can be pulled and plugged in, and that can be a bad one.

use rand::{Rng, SeedableRng};
use rand_pcg::Pcg32;
use std::{
    io::{Read, Write},
    net::{Shutdown, SocketAddr, TcpListener, TcpStream},
    sync::{
        Arc, Mutex,
        atomic::{AtomicU8, Ordering},
    },
    thread,
    time::Duration,
};

/// What a cable does with what is sent.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub(crate) enum Carries {
    /// All of it, at once.
    All,
    /// Nothing: it is not plugged in.
    Nothing,
    /// All of it, later.
    Later,
    /// A byte each millisecond.
    Slowly,
    /// All of it, among bytes that nobody has sent.
    Noise,
}

/// Leads from an address of its own to a board's.
pub(crate) struct Cable {
    address: SocketAddr,
    state: Arc<AtomicU8>,
    ends: Arc<Mutex<Vec<TcpStream>>>,
}

impl Cable {
    pub(crate) fn to(board: SocketAddr) -> Self {
        let listener = TcpListener::bind("127.0.0.1:0").unwrap();
        let address = listener.local_addr().unwrap();
        let state = Arc::new(AtomicU8::new(Carries::All as u8));
        let ends = Arc::<Mutex<Vec<TcpStream>>>::default();
        let (carries, kept) = (state.clone(), ends.clone());
        // Ends with the test.
        thread::spawn(move || {
            for host in listener.incoming().map(Result::unwrap) {
                if carries.load(Ordering::SeqCst) == Carries::Nothing as u8 {
                    continue;
                }
                // No board is there while it restarts.
                let Ok(board) = TcpStream::connect(board) else { continue };
                copy(host.try_clone().unwrap(), board.try_clone().unwrap(), carries.clone());
                copy(board.try_clone().unwrap(), host.try_clone().unwrap(), carries.clone());
                kept.lock().unwrap().extend([host, board]);
            }
        });
        Self { address, state, ends }
    }

    pub(crate) fn address(&self) -> SocketAddr {
        self.address
    }

    pub(crate) fn pull(&self) {
        self.carry(Carries::Nothing);
        for end in self.ends.lock().unwrap().drain(..) {
            // Fails only if it is closed already.
            let _ = end.shutdown(Shutdown::Both);
        }
    }

    pub(crate) fn plug_in(&self) {
        self.carry(Carries::All);
    }

    pub(crate) fn carry(&self, what: Carries) {
        self.state.store(what as u8, Ordering::SeqCst);
    }
}

/// Copies bytes until an end is closed, and closes the other.
fn copy(mut from: TcpStream, mut to: TcpStream, state: Arc<AtomicU8>) {
    thread::spawn(move || {
        let mut random = Pcg32::seed_from_u64(1);
        let mut buffer = [0; 4096];
        let is = |what: Carries| state.load(Ordering::SeqCst) == what as u8;
        while let Ok(length @ 1..) = from.read(&mut buffer) {
            while is(Carries::Later) {
                thread::sleep(Duration::from_millis(1));
            }
            let written = if is(Carries::Slowly) {
                buffer[..length].iter().try_for_each(|byte| {
                    let pause = if is(Carries::Slowly) { 1 } else { 0 };
                    thread::sleep(Duration::from_millis(pause));
                    to.write_all(&[*byte])
                })
            } else if is(Carries::Noise) {
                let noise: [u8; 40] = random.random();
                to.write_all(&[&noise, &buffer[..length]].concat())
            } else {
                to.write_all(&buffer[..length])
            };
            if written.is_err() {
                break;
            }
        }
        let _ = to.shutdown(Shutdown::Both);
        let _ = from.shutdown(Shutdown::Both);
    });
}
