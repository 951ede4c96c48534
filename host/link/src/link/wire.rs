//! Wire: packets over a transport.

use super::{
    sound::sound,
    transport::{REPLY_TIMEOUT, Transport, may_retry, write_all},
};
use crate::error::{Damage, LinkError, LinkErrorKind};
use dermatome_shared::protocol::{
    BoardPacket, MAX_PACKET_BYTES, PacketError, PacketReader, RequestPacket, encode,
};
use std::{
    io::{self, ErrorKind},
    sync::Arc,
    time::{Duration, Instant},
};

/// Most reads for one packet where nobody waits: garbage does not hold anybody up.
const MOST_READS: usize = 16;

/// Sends and receives packets, and counts the damaged ones.
pub(super) struct Wire {
    pub(super) port: Arc<str>,
    transport: Box<dyn Transport>,
    reader: PacketReader,
    /// Bytes received; those before `taken` went into the reader.
    input: Vec<u8>,
    taken: usize,
    /// Bytes that the transport has not taken yet, where nobody waits for it.
    unsent: Vec<u8>,
    /// When the last bytes came.
    heard: Duration,
    opened: Instant,
    damaged: u64,
    last_damage: Damage,
}

impl Wire {
    pub(super) fn new(port: Arc<str>, transport: Box<dyn Transport>) -> Self {
        Self {
            port,
            opened: Instant::now(),
            heard: transport.time().unwrap_or_default(),
            transport,
            reader: PacketReader::default(),
            input: Vec::with_capacity(MAX_PACKET_BYTES),
            taken: 0,
            unsent: Vec::new(),
            damaged: 0,
            last_damage: Damage::Packet(PacketError::Framing),
        }
    }

    pub(super) fn damaged(&self) -> u64 {
        self.damaged
    }

    /// How late it is on the line: by its own clock, or since it was opened.
    pub(super) fn time(&self) -> Duration {
        self.transport.time().unwrap_or_else(|| self.opened.elapsed())
    }

    /// How long no byte has come.
    pub(super) fn silence(&self) -> Duration {
        self.time().saturating_sub(self.heard)
    }

    pub(super) fn forget_damage(&mut self) {
        self.damaged = 0;
    }

    pub(super) fn send(&mut self, packet: &RequestPacket) -> Result<(), LinkError> {
        let mut buffer = [0; MAX_PACKET_BYTES];
        let bytes = self.encoded(packet, &mut buffer)?;
        self.send_bytes(bytes)
    }

    pub(super) fn send_bytes(&mut self, bytes: &[u8]) -> Result<(), LinkError> {
        write_all(&mut *self.transport, bytes).map_err(|reason| self.failed(reason))
    }

    /// The next packet, waiting for it until `deadline`, a [time](Self::time).
    pub(super) fn receive(&mut self, deadline: Duration) -> Result<Option<BoardPacket>, LinkError> {
        loop {
            if let Some(packet) = self.next_packet() {
                return Ok(Some(packet));
            }
            if self.time() >= deadline {
                return Ok(None);
            }
            self.fill().map_err(|reason| self.failed(reason))?;
        }
    }

    /// From now on neither reads nor writes wait, or they do again.
    pub(super) fn set_waiting(&mut self, waits: bool) -> Result<(), LinkError> {
        self.transport.set_waiting(waits).map_err(|reason| self.failed(reason))?;
        if waits {
            let rest = std::mem::take(&mut self.unsent);
            return self.send_bytes(&rest);
        }
        self.unsent.reserve(MAX_PACKET_BYTES);
        Ok(())
    }

    /// What becomes readable when bytes come.
    #[cfg(unix)]
    pub(super) fn descriptor(&self) -> Option<std::os::fd::RawFd> {
        self.transport.descriptor()
    }

    /// The next packet that has come; does not wait for one.
    pub(super) fn arrived(&mut self) -> Result<Option<BoardPacket>, LinkError> {
        for _ in 0..MOST_READS {
            if let Some(packet) = self.next_packet() {
                return Ok(Some(packet));
            }
            self.fill().map_err(|reason| self.failed(reason))?;
            if self.input.is_empty() {
                return Ok(None);
            }
        }
        Ok(self.next_packet())
    }

    /// Sends what the transport takes now; [`Self::flush`] sends the rest.
    pub(super) fn begin_to_send(&mut self, packet: &RequestPacket) -> Result<(), LinkError> {
        let mut buffer = [0; MAX_PACKET_BYTES];
        let bytes = self.encoded(packet, &mut buffer)?;
        self.unsent.extend_from_slice(bytes);
        self.flush().map(drop)
    }

    /// Sends more of what has begun; says whether all of it is sent.
    pub(super) fn flush(&mut self) -> Result<bool, LinkError> {
        while !self.unsent.is_empty() {
            match self.transport.write(&self.unsent) {
                Ok(0) => return Err(self.failed(ErrorKind::BrokenPipe.into())),
                Ok(written) => drop(self.unsent.drain(..written)),
                Err(error) if !may_retry(&error) => return Err(self.failed(error)),
                Err(_) => return Ok(false),
            }
        }
        Ok(true)
    }

    /// The error for an answer that has not come, with the count of damaged packets from before.
    pub(super) fn no_answer(&self, timeout: Duration, damaged_before: u64) -> LinkError {
        match self.damaged - damaged_before {
            0 => self.error(LinkErrorKind::NoAnswer { timeout }),
            packets => self.error(LinkErrorKind::Damaged { packets, last: self.last_damage }),
        }
    }

    /// Something that went wrong at this port.
    pub(super) fn error(&self, kind: LinkErrorKind) -> LinkError {
        LinkError::new(self.port.clone(), kind)
    }

    fn encoded<'a>(&self, packet: &RequestPacket, buffer: &'a mut [u8]) -> Result<&'a [u8], LinkError> {
        let failed = |error| self.error(LinkErrorKind::Failed(io::Error::other(error)));
        encode(packet, buffer).map_err(failed)
    }

    fn failed(&self, reason: io::Error) -> LinkError {
        LinkError::on_transfer(self.port.clone(), reason, REPLY_TIMEOUT)
    }

    fn next_packet(&mut self) -> Option<BoardPacket> {
        while let Some(&byte) = self.input.get(self.taken) {
            self.taken += 1;
            let Some(read) = self.reader.push(byte) else { continue };
            match read.map_err(Damage::Packet).and_then(sound) {
                Ok(packet) => return Some(packet),
                Err(damage) => {
                    self.damaged += 1;
                    self.last_damage = damage;
                }
            }
        }
        None
    }

    /// Replaces the input, all of it taken, by what arrives within the read timeout.
    fn fill(&mut self) -> io::Result<()> {
        self.input.resize(MAX_PACKET_BYTES, 0);
        let result = self.transport.read(&mut self.input);
        self.input.truncate(*result.as_ref().unwrap_or(&0));
        self.taken = 0;
        match result {
            Ok(0) => Err(ErrorKind::UnexpectedEof.into()),
            Err(error) if !may_retry(&error) => Err(error),
            Ok(_) => {
                self.heard = self.time();
                Ok(())
            }
            Err(_) => Ok(()),
        }
    }
}
