//! UART: what links over one have in common.
//!
//! Receiving: each byte makes the UART ask its DMA channel, which writes it into a ring that it
//! fills for ever. The reader wakes when the line falls idle, which is the end of a packet, and
//! when the ring is half full or full. The ring holds 25 ms of bytes, more than the CPU is ever busy
//! with the flash.
//! Sending: one DMA transfer for what an `Outgoing` holds.
//!
//! After any error on the line the UART driver stops the ring. Starting it again would resume a
//! paused DMA channel, which the G474 does not support (RM0440, "Suspend and resume a channel"):
//! the ring could then be out of step with the DMA for ever. So its owner drops both halves
//! and opens the UART anew, which sets up UART and DMA from reset.

use embassy_stm32::{gpio::Pull, usart::Config};

use crate::board::LINK_BAUD;

/// Bytes in the receive ring.
pub const RING_BYTES: usize = 5120;
/// The next request comes into the ring while the flash is written.
pub const SETTLES_FIRST: bool = false;

/// Settings of the UART.
pub(super) fn config() -> Config {
    let mut config = Config::default();
    config.baudrate = LINK_BAUD;
    // A line that nobody drives must not look like an endless break.
    config.rx_pull = Pull::Up;
    config
}
