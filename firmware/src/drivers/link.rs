//! Link: bytes to and from the host over a UART, both ways by DMA.
//!
//! Receiving: each byte makes the UART ask its DMA channel, which writes it into a ring that it
//! fills for ever. The reader wakes when the line falls idle, which is the end of a packet, and
//! when the ring is half full or full. The ring holds 25 ms of bytes, more than the CPU is ever busy
//! with the flash.
//! Sending: one DMA transfer per packet.
//!
//! After any error on the line the UART driver stops the ring. Starting it again would resume a
//! paused DMA channel, which the G474 does not support (RM0440, "Suspend and resume a channel"):
//! the ring could then be out of step with the DMA for ever. So the owner drops both halves
//! and opens the link anew from its [`LinkPort`], which sets up UART and DMA from reset.

use embassy_stm32::{
    gpio::Pull,
    mode::Async,
    usart::{Config, Error, RingBufferedUartRx, Uart, UartTx},
};

use crate::board::{Interrupts, LINK_BAUD, LinkParts};

/// Bytes in the receive ring.
pub const RING_BYTES: usize = 5120;

/// What links are opened from, one after the other.
pub struct LinkPort {
    parts: LinkParts,
    ring: &'static mut [u8; RING_BYTES],
}

/// The sending half of an open link.
pub struct LinkTx<'a>(UartTx<'a, Async>);

/// The receiving half of an open link.
pub struct LinkRx<'a>(RingBufferedUartRx<'a>);

impl LinkPort {
    /// A port on these parts.
    pub fn new(parts: LinkParts, ring: &'static mut [u8; RING_BYTES]) -> Self {
        Self { parts, ring }
    }

    /// Sets up the hardware from reset.
    pub fn open(&mut self) -> (LinkTx<'_>, LinkRx<'_>) {
        let parts = &mut self.parts;
        let uart = Uart::new(
            parts.uart.reborrow(),
            parts.rx_pin.reborrow(),
            parts.tx_pin.reborrow(),
            parts.tx_dma.reborrow(),
            parts.rx_dma.reborrow(),
            Interrupts,
            config(),
        );
        let (tx, rx) = uart.expect("the UART can do LINK_BAUD").split();
        let mut rx = rx.into_ring_buffered(self.ring);
        rx.start_uart();
        (LinkTx(tx), LinkRx(rx))
    }
}

impl LinkTx<'_> {
    /// Sends all bytes; the last few may still be on their way when it returns.
    pub async fn write(&mut self, bytes: &[u8]) -> Result<(), Error> {
        self.0.write(bytes).await
    }
}

impl LinkRx<'_> {
    /// Waits for bytes and says how many came. After an error this link receives no more.
    pub async fn read(&mut self, bytes: &mut [u8]) -> Result<usize, Error> {
        self.0.read(bytes).await
    }
}

fn config() -> Config {
    let mut config = Config::default();
    config.baudrate = LINK_BAUD;
    // A line that nobody drives must not look like an endless break.
    config.rx_pull = Pull::Up;
    config
}
