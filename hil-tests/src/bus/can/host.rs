//! Host: links to boards on a CAN bus, as slowly as virtual time passes.

use super::{CanBus, Frame};
use crate::{
    chip::{fdcan::frame::Format, time::Time},
    machine::Halt,
};
use dermatome::link::{Link, LinkError, Transport};
use dermatome_shared::protocol::can::{Carries, FRAME_BYTES, filled};
use std::{
    collections::{BTreeMap, VecDeque},
    io::{self, ErrorKind, Read, Write},
    sync::{Arc, Mutex, MutexGuard, PoisonError},
    time::Duration,
};

/// Longest that one read waits, in virtual time.
const READ_TIME: Time = Time::from_millis(20);

/// The host of a bus, with a link to each board that it is asked for.
#[derive(Clone, Debug)]
pub struct Host {
    bus: CanBus,
    /// What boards have said, by address.
    inboxes: Arc<Mutex<BTreeMap<u8, VecDeque<u8>>>>,
}

/// The host's end of one board's link.
#[derive(Debug)]
pub struct Port {
    host: Host,
    address: u8,
}

impl Host {
    /// Of this bus.
    #[must_use]
    pub fn new(bus: CanBus) -> Self {
        Self { bus, inboxes: Arc::default() }
    }

    /// A new link to an address.
    pub fn link(&self, address: u8) -> Result<Link, LinkError> {
        self.inboxes().insert(address, VecDeque::new());
        let port = Port { host: self.clone(), address };
        Ok(Link::connect(format!("can#{address}"), port)?.counting_from(0))
    }

    fn inboxes(&self) -> MutexGuard<'_, BTreeMap<u8, VecDeque<u8>>> {
        self.inboxes.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Lets time pass until somebody has said something, at most until then; takes what was said to its place. Says whether
    /// time is left.
    fn hear(&self, end: Time) -> Result<bool, Halt> {
        let (heard, now) = self.bus.with(move |wire| {
            let mut heard = wire.host.take_heard();
            while heard.is_empty() && wire.now() < end {
                wire.run_slice()?;
                heard = wire.host.take_heard();
            }
            Ok::<_, Halt>((heard, wire.now()))
        })?;
        let mut inboxes = self.inboxes();
        for (_, frame) in heard {
            if let Some((Carries::Said, address)) = Carries::of(frame.identifier)
                && let Some(inbox) = inboxes.get_mut(&address)
            {
                inbox.extend(frame.data);
            }
        }
        Ok(now < end)
    }
}

impl Read for Port {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let end = self.host.bus.with(|wire| wire.now()) + READ_TIME;
        loop {
            let read =
                self.host.inboxes().get_mut(&self.address).map_or(Ok(0), |inbox| inbox.read(buffer))?;
            if read > 0 {
                return Ok(read);
            }
            if !self.host.hear(end).map_err(io::Error::other)? {
                return Err(ErrorKind::TimedOut.into());
            }
        }
    }
}

impl Write for Port {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let identifier = Carries::Request.identifier(self.address);
        let frame = |bytes: &[u8]| {
            let data = filled(bytes, &mut [0; FRAME_BYTES]).to_vec();
            Frame { identifier, format: Format::Switching, data }
        };
        let frames: Vec<Frame> = bytes.chunks(FRAME_BYTES).map(frame).collect();
        self.host.bus.with(|wire| {
            let now = wire.now();
            frames.into_iter().for_each(|frame| wire.host.send(frame, now));
        });
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

impl Transport for Port {
    fn time(&self) -> Option<Duration> {
        Some(self.host.bus.with(|wire| wire.now()).into())
    }
}
