//! Link: bytes to and from the host, over a UART, both ways by DMA, or over USB.
//!
//! Receiving: each byte makes the UART ask its DMA channel, which writes it into a ring that it
//! fills for ever. The reader wakes when the line falls idle, which is the end of a packet, and
//! when the ring is half full or full. The ring holds 25 ms of bytes, more than the CPU is ever busy
//! with the flash.
//! Sending: one DMA transfer for what an [`Outgoing`] holds.
//!
//! After any error on the line the UART driver stops the ring. Starting it again would resume a
//! paused DMA channel, which the G474 does not support (RM0440, "Suspend and resume a channel"):
//! the ring could then be out of step with the DMA for ever. So its owner drops both halves
//! and opens the UART anew, which sets up UART and DMA from reset.
//!
//! There are three kinds, of which a build has one: `line`, to one host; with the feature `rs485` `bus`, which
//! many boards share; and with the feature `usb` `usb`, whose endpoints take the place of UART and DMA.

#[cfg(feature = "rs485")]
mod bus;
#[cfg(not(any(feature = "rs485", feature = "usb")))]
mod line;
#[cfg(not(feature = "usb"))]
mod uart;
#[cfg(feature = "usb")]
mod usb;

#[cfg(feature = "rs485")]
pub use bus::*;
#[cfg(not(any(feature = "rs485", feature = "usb")))]
pub use line::*;
#[cfg(not(feature = "usb"))]
pub use uart::*;
#[cfg(feature = "usb")]
pub use usb::*;

use dermatome_shared::protocol::MAX_PACKET_BYTES;
use embassy_time::Duration;

/// Bytes that an [`Outgoing`] is made of.
pub const OUTGOING_BYTES: usize = HEAD_BYTES + MAX_PACKET_BYTES;

/// How long a failed link rests: the last bytes leave the UART, and a line with endless errors
/// cannot take the whole CPU.
pub const REOPEN_PAUSE: Duration = Duration::from_millis(2);

/// How urgent what is sent is.
#[derive(Clone, Copy)]
pub enum Urgency {
    /// The host waits for it.
    Reply,
    /// The host does not.
    Event,
}

/// Packets to be sent in one go, each with what the link puts before it.
pub struct Outgoing {
    bytes: &'static mut [u8],
    head: [u8; HEAD_BYTES],
    length: usize,
    /// Where the last packet begins.
    last: usize,
}

impl Outgoing {
    /// Nothing yet.
    pub fn clear(&mut self) {
        (self.length, self.last) = (0, 0);
    }

    /// Where the next packet goes. The first finds room for the longest there is.
    pub fn room(&mut self) -> &mut [u8] {
        self.bytes.get_mut(self.length + HEAD_BYTES..).unwrap_or_default()
    }

    /// Takes the packet of this length that was put into the room.
    pub fn add(&mut self, length: usize) {
        let content = self.length + HEAD_BYTES;
        self.bytes[self.length..content].copy_from_slice(&self.head);
        (self.last, self.length) = (self.length, content + length);
    }

    /// Whether the link wants to send more packets with these.
    #[allow(clippy::absurd_extreme_comparisons, reason = "a link that sends one packet at a time wants none")]
    pub fn wants_more(&self) -> bool {
        self.length < BYTES_IN_ONE_GO
    }

    fn packets(&self) -> &[u8] {
        &self.bytes[..self.length]
    }
}
