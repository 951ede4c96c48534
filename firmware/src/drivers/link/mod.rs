//! Link: bytes to and from the host, over a UART, over CAN FD or over USB.
//!
//! There are four kinds, of which a build has one: `line`, to one host; with the feature `rs485` `bus`, and with the
//! feature `can` `can`, which many boards share; and with the feature `usb` `usb`. All send what an [`Outgoing`] holds in
//! one go.

#[cfg(feature = "rs485")]
mod bus;
#[cfg(feature = "can")]
mod can;
#[cfg(any(feature = "rs485", feature = "can", feature = "usb"))]
mod lanes;
#[cfg(not(any(feature = "rs485", feature = "can", feature = "usb")))]
mod line;
#[cfg(not(any(feature = "can", feature = "usb")))]
mod uart;
#[cfg(feature = "usb")]
mod usb;

#[cfg(feature = "rs485")]
pub use bus::*;
#[cfg(feature = "can")]
pub use can::*;
#[cfg(any(feature = "rs485", feature = "can", feature = "usb"))]
pub use lanes::{Error, LinkRx};
#[cfg(not(any(feature = "rs485", feature = "can", feature = "usb")))]
pub use line::*;
#[cfg(not(any(feature = "can", feature = "usb")))]
pub use uart::{RING_BYTES, SETTLES_FIRST};
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

    /// Hands all over, memory included.
    #[cfg(any(feature = "rs485", feature = "can", feature = "usb"))]
    fn hand_over(&mut self) -> Self {
        let empty = Self { bytes: &mut [], ..*self };
        core::mem::replace(self, empty)
    }

    fn packets(&self) -> &[u8] {
        &self.bytes[..self.length]
    }
}
