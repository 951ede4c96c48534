//! Trace: what happened when, and a hash of all of it.

use super::time::Time;
use crc::{CRC_64_XZ, Crc, Digest, Table};
use std::fmt;

static HASH: Crc<u64, Table<16>> = Crc::<u64, Table<16>>::new(&CRC_64_XZ);

/// Something that happened on the chip.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Event {
    /// An exception is taken: its number.
    Enter(usize),
    /// A handler returns.
    Leave(usize),
    /// A port's outputs changed.
    Pins {
        /// Letter of the port.
        port: char,
        /// Levels of its 16 pins.
        levels: u16,
    },
    /// A byte left the link.
    Sent(u8),
    /// A byte came over the link.
    Received(u8),
    /// A frame left for the bus, or came from it.
    Framed {
        /// Whether it left.
        is_sent: bool,
        /// Its identifier.
        identifier: u16,
        /// Bytes of its data.
        bytes: u8,
    },
    /// A DMA channel has come to the end of its buffer.
    DmaComplete {
        /// Controller, 1 or 2.
        controller: u8,
        /// Channel, from 1 on.
        channel: u8,
    },
    /// The flash begins to erase the page at this address.
    Erase(u32),
    /// The flash begins to program the double word at this address.
    Program(u32),
    /// The chip starts again.
    Reset(&'static str),
    /// The core sleeps, until an event.
    Sleep,
}

impl fmt::Display for Event {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Enter(exception) => write!(formatter, "exception   {exception} is taken"),
            Self::Leave(exception) => write!(formatter, "exception   {exception} returns"),
            Self::Pins { port, levels } => write!(formatter, "pins        GPIO{port} = {levels:#06x}"),
            Self::Sent(byte) => write!(formatter, "link        sends {byte:#04x}"),
            Self::Received(byte) => write!(formatter, "link        receives {byte:#04x}"),
            Self::Framed { is_sent, identifier, bytes } => {
                let what = if *is_sent { "sends" } else { "receives" };
                write!(formatter, "can         {what} a frame, {identifier:#05x} with {bytes} bytes")
            }
            Self::DmaComplete { controller, channel } => {
                write!(formatter, "dma         DMA{controller} channel {channel} is at its end")
            }
            Self::Erase(address) => write!(formatter, "flash       erases the page at {address:#010x}"),
            Self::Program(address) => write!(formatter, "flash       programs {address:#010x}"),
            Self::Reset(cause) => write!(formatter, "reset       by {cause}"),
            Self::Sleep => write!(formatter, "core        sleeps"),
        }
    }
}

/// Everything that happened, hashed, and kept if wanted.
#[derive(Clone)]
pub struct Trace {
    digest: Digest<'static, u64, Table<16>>,
    kept: Option<Vec<(Time, Event)>>,
}

impl fmt::Debug for Trace {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(formatter, "Trace({:016x})", self.hash())
    }
}

impl Trace {
    /// An empty trace, which keeps its events or only hashes them.
    #[must_use]
    pub fn new(keep: bool) -> Self {
        Self { digest: HASH.digest(), kept: keep.then(Vec::new) }
    }

    /// Adds an event.
    pub fn add(&mut self, time: Time, event: Event) {
        self.digest.update(&time.nanoseconds().to_le_bytes());
        let (kind, value) = event.code();
        self.digest.update(&[kind]);
        self.digest.update(&value.to_le_bytes());
        if let Some(kept) = &mut self.kept {
            kept.push((time, event));
        }
    }

    /// Hash of all events and their times so far.
    #[must_use]
    pub fn hash(&self) -> u64 {
        self.digest.clone().finalize()
    }

    /// Events kept since they were taken last.
    pub fn take(&mut self) -> Vec<(Time, Event)> {
        self.kept.as_mut().map(std::mem::take).unwrap_or_default()
    }
}

impl Event {
    fn code(self) -> (u8, u64) {
        match self {
            Self::Enter(exception) => (0, exception as u64),
            Self::Leave(exception) => (1, exception as u64),
            Self::Pins { port, levels } => (2, u64::from(u32::from(port)) << 16 | u64::from(levels)),
            Self::Sent(byte) => (3, byte.into()),
            Self::Received(byte) => (4, byte.into()),
            Self::DmaComplete { controller, channel } => (5, u64::from(controller) << 8 | u64::from(channel)),
            Self::Erase(address) => (6, address.into()),
            Self::Program(address) => (7, address.into()),
            Self::Reset(cause) => (8, cause.len() as u64),
            Self::Sleep => (9, 0),
            Self::Framed { is_sent, identifier, bytes } => {
                (10, u64::from(is_sent) << 24 | u64::from(identifier) << 8 | u64::from(bytes))
            }
        }
    }
}
