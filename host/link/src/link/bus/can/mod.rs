//! CAN: two threads have a CAN FD bus, one that sends what is for boards and one that hands over what they say
//! ([`dermatome_shared::protocol::can`]).

mod slcan;
#[cfg(target_os = "linux")]
mod socket;

use super::{super::transport::may_retry, seat::Seats};
use crate::{error::LinkError, port::Bus};
use dermatome_shared::protocol::can::{ADDRESSES, Carries, FRAME_BYTES, filled};
use std::{
    io,
    sync::{
        Arc,
        atomic::{AtomicBool, Ordering},
    },
    thread::{self, JoinHandle},
};

/// Sends frames.
trait Sender: Send {
    /// Sends a frame with this identifier and these bytes, of which there are as many as a frame can have. Waits for room,
    /// but not for ever.
    fn send(&mut self, identifier: u16, data: &[u8]) -> io::Result<()>;
}

/// Receives frames.
trait Receiver: Send {
    /// Gives the frames that have come, identifier and data each; waits a short time for them, and fails then as a transport
    /// does.
    fn receive(&mut self, take: &mut dyn FnMut(u16, &[u8])) -> io::Result<()>;
}

/// The two ends of an adapter.
type Ends = (Box<dyn Sender>, Box<dyn Receiver>);

/// Opens a bus, and moves frames from now on.
pub(super) fn start(name: &str, bus: &Bus, seats: Seats) -> Result<(), LinkError> {
    let (sender, receiver) = open(name, bus)?;
    let (seats, is_over) = (Arc::new(seats), Arc::new(AtomicBool::new(false)));
    let failed = |error| LinkError::on_open(name, error);
    let thread = |does| thread::Builder::new().name(format!("{does} {bus}"));
    let listener = Listener { receiver, is_over: is_over.clone(), seats: seats.clone() };
    let listening = thread("hear").spawn(move || listener.listen()).map_err(failed)?;
    let speaker = Speaker { sender: Some(sender), listening: Some(listening), is_over, seats };
    thread("speak").spawn(move || speaker.speak()).map_err(failed)?;
    Ok(())
}

fn open(name: &str, bus: &Bus) -> Result<Ends, LinkError> {
    match bus {
        #[cfg(target_os = "linux")]
        Bus::SocketCan(interface) => socket::open(name, interface),
        Bus::Slcan(adapter) => slcan::open(name, adapter),
        _ => {
            let words = "network interfaces for CAN are Linux's; elsewhere use an adapter that speaks slcan";
            Err(LinkError::on_open(name, io::Error::new(io::ErrorKind::Unsupported, words)))
        }
    }
}

/// Hands over what boards say.
struct Listener {
    receiver: Box<dyn Receiver>,
    is_over: Arc<AtomicBool>,
    seats: Arc<Seats>,
}

impl Listener {
    /// Listens until it is over, or until the bus fails: then gives why.
    fn listen(mut self) -> io::Result<()> {
        // Where somebody does not read, what is said is lost: `[address]`.
        let mut is_lost = [false; ADDRESSES as usize];
        while !self.is_over.load(Ordering::Relaxed) {
            let seats = &self.seats;
            let received = self.receiver.receive(&mut |identifier, data| {
                let Some((Carries::Said, address)) = Carries::of(identifier) else { return };
                let is_full = seats.lock().board(address).is_some_and(|board| board.is_full());
                match (std::mem::replace(&mut is_lost[usize::from(address)], is_full), is_full) {
                    (_, true) => {}
                    // The next packet does not begin with what there is of another.
                    (true, false) => seats.hand_over(address, &[&[0], data].concat()),
                    (false, false) => seats.hand_over(address, data),
                }
            });
            match received {
                Err(error) if !may_retry(&error) => {
                    self.is_over.store(true, Ordering::Relaxed);
                    self.seats.wake();
                    return Err(error);
                }
                _ => {}
            }
        }
        Ok(())
    }
}

/// Sends what is for boards.
struct Speaker {
    sender: Option<Box<dyn Sender>>,
    listening: Option<JoinHandle<io::Result<()>>>,
    is_over: Arc<AtomicBool>,
    /// Dropped after both ends: who learns that the bus is dead finds its adapter closed.
    seats: Arc<Seats>,
}

impl Drop for Speaker {
    fn drop(&mut self) {
        let _ = self.close();
    }
}

impl Speaker {
    /// Sends until all have left, or until the bus fails.
    fn speak(mut self) {
        while let Some((address, packets)) = self.wait() {
            let sent = packets.chunks(FRAME_BYTES).try_for_each(|bytes| {
                let sender = self.sender.as_mut().ok_or(io::ErrorKind::NotConnected)?;
                sender.send(Carries::Request.identifier(address), filled(bytes, &mut [0; FRAME_BYTES]))
            });
            if let Err(error) = self.close_if(sent) {
                return self.seats.fail_with(&error);
            }
        }
    }

    /// Waits until something is for a board; none once nobody has one open, or nothing is heard any more.
    fn wait(&mut self) -> Option<(u8, Vec<u8>)> {
        loop {
            let mut state = self.seats.lock();
            let waiting = state.boards().find(|(_, board)| !board.to_board.is_empty());
            if let Some((address, board)) = waiting {
                return Some((address, std::mem::take(&mut board.to_board)));
            }
            if self.is_over.load(Ordering::Relaxed) {
                drop(state);
                if let Err(error) = self.close() {
                    self.seats.fail_with(&error);
                }
                return None;
            }
            if state.boards().next().is_some() {
                self.seats.wait(state, None);
                continue;
            }
            drop(state);
            let seats = self.seats.clone();
            if seats.close_if_left(|| drop(self.close())) {
                return None;
            }
        }
    }

    /// Closes both ends of the adapter; fails where that had failed before.
    fn close(&mut self) -> io::Result<()> {
        self.is_over.store(true, Ordering::Relaxed);
        self.sender = None;
        match self.listening.take().map(JoinHandle::join) {
            Some(Ok(listened)) => listened,
            Some(Err(_)) => Err(io::ErrorKind::BrokenPipe.into()),
            None => Ok(()),
        }
    }

    /// Closes the adapter where this failed.
    fn close_if(&mut self, sent: io::Result<()>) -> io::Result<()> {
        if sent.is_err() {
            let _ = self.close();
        }
        sent
    }
}
