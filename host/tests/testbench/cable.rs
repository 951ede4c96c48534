//! A cable that can be pulled and plugged in.

use std::{
    io::{Read, Write},
    net::{Shutdown, SocketAddr, TcpListener, TcpStream},
    sync::{
        Arc, Mutex,
        atomic::{AtomicBool, Ordering},
    },
    thread,
};

/// Leads from an address of its own to a board's.
pub(crate) struct Cable {
    address: SocketAddr,
    plugged_in: Arc<AtomicBool>,
    ends: Arc<Mutex<Vec<TcpStream>>>,
}

impl Cable {
    pub(crate) fn to(board: SocketAddr) -> Self {
        let listener = TcpListener::bind("127.0.0.1:0").unwrap();
        let address = listener.local_addr().unwrap();
        let plugged_in = Arc::new(AtomicBool::new(true));
        let ends = Arc::<Mutex<Vec<TcpStream>>>::default();
        let (is_plugged_in, kept) = (plugged_in.clone(), ends.clone());
        // Ends with the test.
        thread::spawn(move || {
            for host in listener.incoming().map(Result::unwrap) {
                if !is_plugged_in.load(Ordering::SeqCst) {
                    continue;
                }
                let board = TcpStream::connect(board).unwrap();
                copy(host.try_clone().unwrap(), board.try_clone().unwrap());
                copy(board.try_clone().unwrap(), host.try_clone().unwrap());
                kept.lock().unwrap().extend([host, board]);
            }
        });
        Self { address, plugged_in, ends }
    }

    pub(crate) fn address(&self) -> SocketAddr {
        self.address
    }

    pub(crate) fn pull(&self) {
        self.plugged_in.store(false, Ordering::SeqCst);
        for end in self.ends.lock().unwrap().drain(..) {
            // Fails only if it is closed already.
            let _ = end.shutdown(Shutdown::Both);
        }
    }

    pub(crate) fn plug_in(&self) {
        self.plugged_in.store(true, Ordering::SeqCst);
    }
}

/// Copies bytes until an end is closed, and closes the other.
fn copy(mut from: TcpStream, mut to: TcpStream) {
    thread::spawn(move || {
        let mut buffer = [0; 4096];
        while let Ok(length @ 1..) = from.read(&mut buffer) {
            if to.write_all(&buffer[..length]).is_err() {
                break;
            }
        }
        let _ = to.shutdown(Shutdown::Both);
        let _ = from.shutdown(Shutdown::Both);
    });
}
