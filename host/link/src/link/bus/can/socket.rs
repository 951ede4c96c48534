//! Socket: a CAN FD bus at a network interface of Linux (SocketCAN), which somebody has set up.

use super::{Ends, Receiver, Sender};
use crate::{
    error::LinkError,
    link::transport::{READ_TIMEOUT, REPLY_TIMEOUT, may_retry},
};
use dermatome_shared::protocol::can::Carries;
use socketcan::{
    CanAnyFrame, CanFdFrame, CanFdSocket, CanFilter, EmbeddedFrame, Frame, Socket, SocketOptions, StandardId,
};
use std::{
    io::{self, ErrorKind},
    sync::Arc,
    thread,
    time::{Duration, Instant},
};

/// Until a frame is offered again that there was no room for: one takes 0.3 ms.
const FULL: Duration = Duration::from_millis(1);
/// Which bits of an identifier say what a frame carries; it is no longer than 11 bits.
const DIRECTION: u32 = 0x7F0 | libc::CAN_EFF_FLAG | libc::CAN_RTR_FLAG;

/// Opens a network interface.
pub(super) fn open(name: &str, interface: &str) -> Result<Ends, LinkError> {
    let socket = Arc::new(opened(interface).map_err(|error| LinkError::on_open(name, error))?);
    Ok((Box::new(Outgoing(socket.clone())), Box::new(Incoming(socket))))
}

fn opened(interface: &str) -> io::Result<CanFdSocket> {
    let socket = CanFdSocket::open(interface).map_err(in_words)?;
    socket.set_filters(&[CanFilter::new(Carries::Said as u32, DIRECTION)])?;
    socket.set_read_timeout(READ_TIMEOUT)?;
    socket.set_write_timeout(READ_TIMEOUT)?;
    Ok(socket)
}

/// What the system's word for an interface that cannot be used means.
fn in_words(error: io::Error) -> io::Error {
    let words = match error.raw_os_error() {
        Some(libc::ENODEV) => "there is no such network interface for CAN",
        Some(libc::ENETDOWN) => "the network interface is down (`ip link set ... up`)",
        Some(libc::EINVAL) => "the network interface takes no frames of CAN FD (`ip link set ... fd on`)",
        Some(libc::EAFNOSUPPORT) => "this Linux has no CAN (its modules can and can-raw)",
        _ => return error,
    };
    io::Error::new(error.kind(), words)
}

struct Outgoing(Arc<CanFdSocket>);

impl Sender for Outgoing {
    fn send(&mut self, identifier: u16, data: &[u8]) -> io::Result<()> {
        let frame = StandardId::new(identifier).and_then(|identifier| CanFdFrame::new(identifier, data));
        let mut frame = frame.ok_or(ErrorKind::InvalidInput)?;
        frame.set_brs(true);
        let deadline = Instant::now() + REPLY_TIMEOUT;
        loop {
            match self.0.write_frame(&frame) {
                Err(error) if !is_full(&error) => return Err(in_words(error)),
                Err(_) if Instant::now() >= deadline => return Err(ErrorKind::TimedOut.into()),
                Err(_) => thread::sleep(FULL),
                Ok(()) => return Ok(()),
            }
        }
    }
}

/// Whether there was no room for a frame.
fn is_full(error: &io::Error) -> bool {
    error.raw_os_error() == Some(libc::ENOBUFS) || may_retry(error)
}

struct Incoming(Arc<CanFdSocket>);

impl Receiver for Incoming {
    fn receive(&mut self, take: &mut dyn FnMut(u16, &[u8])) -> io::Result<()> {
        if let CanAnyFrame::Fd(frame) = self.0.read_frame().map_err(in_words)? {
            take(frame.raw_id() as u16, frame.data());
        }
        Ok(())
    }
}
