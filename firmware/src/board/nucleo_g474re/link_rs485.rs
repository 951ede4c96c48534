//! NUCLEO-G474RE on a bus: the link, to a transceiver for RS-485.
//!
//! | what         | which                    | why                                                  |
//! |--------------|--------------------------|------------------------------------------------------|
//! | link         | USART1                   | has a driver-enable output, on a pin that is free    |
//! | link, pins   | PC4 sends, PC5 receives  | PA9 and PA10 stay open: they switch pull-downs of USB-C |
//! | driver       | PA12, high while it sends| by hardware, so that no firmware that hangs holds the line |
//! | link, DMA    | DMA1 channels 1 and 2    | any channel can serve any request on this chip       |
//! | address      | PC9 (lowest bit) to PC12 | straps: open is 0, bridged to ground is 1            |

use embassy_stm32::peripherals;

/// What the board calls itself to a host.
pub const NAME: &str = "nucleo-g474re-rs485";

/// Bits per second on the link: USART1 divides 170 MHz by 85, which is exactly this rate. The HSI adds up to 1 %, which
/// 8 bits without parity tolerate.
pub const LINK_BAUD: u32 = 2_000_000;

/// UART of the link.
pub type LinkUart = peripherals::USART1;
/// Pin the link sends on.
pub type LinkTxPin = peripherals::PC4;
/// Pin the link receives on.
pub type LinkRxPin = peripherals::PC5;
/// Pin that switches the line's driver on.
pub type LinkDePin = peripherals::PA12;
/// DMA channel that sends.
pub type LinkTxDma = peripherals::DMA1_CH1;
/// DMA channel that receives.
pub type LinkRxDma = peripherals::DMA1_CH2;

/// Takes the link's parts of the chip.
macro_rules! link_parts {
    ($chip:ident) => {
        $crate::board::LinkParts {
            uart: $chip.USART1,
            tx_pin: $chip.PC4,
            rx_pin: $chip.PC5,
            tx_dma: $chip.DMA1_CH1,
            rx_dma: $chip.DMA1_CH2,
            de_pin: $chip.PA12,
            address: straps::address!($chip),
        }
    };
}
pub(super) use link_parts;
