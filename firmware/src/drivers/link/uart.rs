//! Uart: what the links over a UART have in common.

use embassy_stm32::{gpio::Pull, usart::Config};

use crate::board::LINK_BAUD;

pub use embassy_stm32::usart::Error;

/// Bytes in the receive ring.
pub const RING_BYTES: usize = 5120;

/// Settings of the UART.
pub(super) fn config() -> Config {
    let mut config = Config::default();
    config.baudrate = LINK_BAUD;
    // A line that nobody drives must not look like an endless break.
    config.rx_pull = Pull::Up;
    config
}
