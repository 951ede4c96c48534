//! NUCLEO-G474RE: the link, to the debug adapter.

use embassy_stm32::peripherals;

/// What the board calls itself to a host.
pub const NAME: &str = "nucleo-g474re";

/// Bits per second on the link.
///
/// LPUART1 divides 170 MHz by 21760 / 256: exactly this rate. Its own limit is a third of its clock,
/// so the debug adapter is the slower of the two. The HSI adds up to 1 %, which 8 bits without
/// parity tolerate.
pub const LINK_BAUD: u32 = 2_000_000;

/// UART of the link.
pub type LinkUart = peripherals::LPUART1;
/// Pin the link sends on.
pub type LinkTxPin = peripherals::PA2;
/// Pin the link receives on.
pub type LinkRxPin = peripherals::PA3;
/// DMA channel that sends.
pub type LinkTxDma = peripherals::DMA1_CH1;
/// DMA channel that receives.
pub type LinkRxDma = peripherals::DMA1_CH2;

/// Takes the link's parts of the chip.
macro_rules! link_parts {
    ($chip:ident) => {
        $crate::board::LinkParts {
            uart: $chip.LPUART1,
            tx_pin: $chip.PA2,
            rx_pin: $chip.PA3,
            tx_dma: $chip.DMA1_CH1,
            rx_dma: $chip.DMA1_CH2,
        }
    };
}
pub(super) use link_parts;
