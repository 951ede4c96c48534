//! Line: a link to one host, which may be written to at any time.

pub use embassy_stm32::usart::Error;
use embassy_stm32::{
    mode::Async,
    usart::{RingBufferedUartRx, Uart, UartTx},
};
use embassy_sync::{blocking_mutex::raw::NoopRawMutex, mutex::Mutex};

use super::{
    OUTGOING_BYTES, Outgoing, Urgency,
    uart::{RING_BYTES, config},
};
use crate::board::{Interrupts, LinkParts};

/// Bytes before a packet.
pub const HEAD_BYTES: usize = 0;
/// One packet at a time: a reply must not wait for more.
pub const BYTES_IN_ONE_GO: usize = 0;
/// Memory that it needs beside ring and packets.
pub const OWN_BYTES: usize = 0;

/// What links are opened from, one after the other.
pub struct LinkPort {
    parts: LinkParts,
    ring: &'static mut [u8; RING_BYTES],
}

/// The sending half of an open link.
pub struct LinkTx<'a>(Mutex<NoopRawMutex, UartTx<'a, Async>>);

/// The receiving half of an open link.
pub struct LinkRx<'a>(RingBufferedUartRx<'a>);

impl LinkPort {
    /// A port on these parts.
    pub fn new(parts: LinkParts, ring: &'static mut [u8; RING_BYTES]) -> Self {
        Self { parts, ring }
    }

    /// What packets are sent from, in this memory.
    pub fn outgoing(&self, bytes: &'static mut [u8; OUTGOING_BYTES]) -> Outgoing {
        Outgoing { bytes, head: [], length: 0, last: 0 }
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
        (LinkTx(Mutex::new(tx)), LinkRx(rx))
    }
}

impl LinkTx<'_> {
    /// Ends what a link that failed before may have left unfinished.
    pub async fn begin(&mut self) -> Result<(), Error> {
        self.0.get_mut().write(&[0]).await
    }

    /// Sends all packets; the last few bytes may still be on their way when it returns. Whoever asks first goes first.
    pub async fn send(&self, packets: &mut Outgoing, _urgency: Urgency) -> Result<(), Error> {
        self.0.lock().await.write(packets.packets()).await
    }
}

impl LinkRx<'_> {
    /// Waits for bytes and says how many came. After an error this link receives no more.
    pub async fn read(&mut self, bytes: &mut [u8]) -> Result<usize, Error> {
        self.0.read(bytes).await
    }
}
