//! CAN: two threads have a CAN FD bus, one that sends what is for boards and one that hands over what they say
//! ([`dermatome_shared::protocol::can`]).

mod slcan;
#[cfg(target_os = "linux")]
mod socket;

use super::{super::transport::may_retry, seat::Seats};
use crate::{error::LinkError, port::Adapter};
use dermatome_shared::protocol::{
    MAX_PACKET_BYTES,
    can::{ADDRESSES, Carries, FRAME_BYTES, filled},
};
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

/// A bus behind an adapter that speaks slcan.
pub(super) fn start_slcan(name: &str, adapter: &Adapter, seats: Seats) -> Result<(), LinkError> {
    start(name, slcan::open(name, adapter)?, seats)
}

/// A bus at a network interface.
#[cfg(target_os = "linux")]
pub(super) fn start_socket(name: &str, interface: &str, seats: Seats) -> Result<(), LinkError> {
    start(name, socket::open(name, interface)?, seats)
}

/// A bus at a network interface, which is Linux's.
#[cfg(not(target_os = "linux"))]
pub(super) fn start_socket(name: &str, _interface: &str, _seats: Seats) -> Result<(), LinkError> {
    let words = "network interfaces for CAN are Linux's; elsewhere use an adapter that speaks slcan";
    Err(LinkError::on_open(name, io::Error::new(io::ErrorKind::Unsupported, words)))
}

/// Moves frames from now on; `name` is a board's port, for errors.
fn start(name: &str, (sender, receiver): Ends, seats: Seats) -> Result<(), LinkError> {
    let (seats, is_over) = (Arc::new(seats), Arc::new(AtomicBool::new(false)));
    let failed = |error| LinkError::on_open(name, error);
    let bus = name.rsplit_once('#').map_or(name, |(bus, _)| bus);
    let thread = |does: &str| thread::Builder::new().name(format!("{does} {bus}"));
    let listener = Listener { receiver, is_over: is_over.clone(), seats: seats.clone() };
    let listening = thread("hears").spawn(move || listener.listen()).map_err(failed)?;
    let speaker = Speaker {
        sender: Some(sender),
        listening: Some(listening),
        packets: Vec::with_capacity(MAX_PACKET_BYTES),
        is_over,
        seats,
    };
    thread("speaks").spawn(move || speaker.speak()).map_err(failed)?;
    Ok(())
}

/// Hands over what boards say.
struct Listener {
    receiver: Box<dyn Receiver>,
    is_over: Arc<AtomicBool>,
    seats: Arc<Seats>,
}

/// Whatever ends it: who speaks closes the adapter.
impl Drop for Listener {
    fn drop(&mut self) {
        self.is_over.store(true, Ordering::Relaxed);
        self.seats.wake();
    }
}

impl Listener {
    /// Listens until it is over, or until the bus fails: then gives why.
    fn listen(mut self) -> io::Result<()> {
        // Whether somebody does not read, so that what is said is lost until a packet ends: `[address]`.
        let mut is_lost = [false; ADDRESSES as usize];
        while !self.is_over.load(Ordering::Relaxed) {
            let seats = &self.seats;
            let received = self.receiver.receive(&mut |identifier, data| {
                let Some((Carries::Said, address)) = Carries::of(identifier) else { return };
                let is_full = seats.lock().board(address).is_some_and(|board| board.is_full());
                let is_lost = &mut is_lost[usize::from(address)];
                *is_lost |= is_full;
                if !*is_lost {
                    seats.hand_over(address, data);
                } else if let Some(end) = data.iter().position(|&byte| byte == 0).filter(|_| !is_full) {
                    // From the zero byte on, which ends what there is of another packet.
                    *is_lost = false;
                    seats.hand_over(address, &data[end..]);
                }
            });
            match received {
                Err(error) if !may_retry(&error) => return Err(error),
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
    /// What is being sent; its memory goes round.
    packets: Vec<u8>,
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
        while let Some(address) = self.wait() {
            match self.send(address) {
                // Where there was no room for so long nobody is there, which whoever has asked finds out.
                Err(error) if !may_retry(&error) => {
                    let _ = self.close();
                    return self.seats.fail_with(&error);
                }
                _ => {}
            }
        }
    }

    fn send(&mut self, address: u8) -> io::Result<()> {
        let sender = self.sender.as_mut().ok_or(io::ErrorKind::NotConnected)?;
        self.packets.chunks(FRAME_BYTES).try_for_each(|bytes| {
            sender.send(Carries::Request.identifier(address), filled(bytes, &mut [0; FRAME_BYTES]))
        })
    }

    /// Waits until something is for a board, and takes it; none once nobody has one open, or nothing is heard any more.
    fn wait(&mut self) -> Option<u8> {
        loop {
            let mut state = self.seats.lock();
            let waiting = state.boards().find(|(_, board)| !board.to_board.is_empty());
            if let Some((address, board)) = waiting {
                self.packets.clear();
                std::mem::swap(&mut board.to_board, &mut self.packets);
                return Some(address);
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
}
