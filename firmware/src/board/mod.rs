//! Board: what the firmware asks of the hardware it runs on.
//!
//! Each board is a module of its own: one table of clocks, pins, DMA channels and interrupts, and in
//! `sensing` what only its chip's registers can do. A cargo feature of the same name chooses it, and nothing
//! outside this module knows which one it is. A pin or DMA channel that cannot do what the table asks of it
//! does not compile.
//!
//! | board           | chip        | feature         | tested                       |
//! |-----------------|-------------|-----------------|------------------------------|
//! | NUCLEO-G474RE   | STM32G474RE | `nucleo-g474re` | on an emulated chip          |
//! | the same on a bus | STM32G474RE | `nucleo-g474re`, `rs485` or `can` | on emulated chips |
//! | the same on USB | STM32G474RE | `nucleo-g474re`, `usb` | on an emulated chip |
//! | NUCLEO-L496ZG   | STM32L496ZG | `nucleo-l496zg` | not at all: it only builds   |
//!
//! What a scan does with its timers is the same on all of them: see `chain`.

#[cfg(feature = "nucleo-g474re")]
mod nucleo_g474re;
#[cfg(feature = "nucleo-l496zg")]
mod nucleo_l496zg;

#[cfg(all(feature = "nucleo-g474re", feature = "nucleo-l496zg"))]
compile_error!("two boards: add --no-default-features to --features nucleo-l496zg");
#[cfg(not(any(feature = "nucleo-g474re", feature = "nucleo-l496zg")))]
compile_error!("no board: add --features nucleo-g474re or --features nucleo-l496zg");

#[cfg(all(feature = "rs485", not(feature = "nucleo-g474re")))]
compile_error!("only the nucleo-g474re has a link over RS-485");
#[cfg(all(feature = "can", not(feature = "nucleo-g474re")))]
compile_error!("only the nucleo-g474re has a link over CAN");
#[cfg(all(feature = "usb", not(feature = "nucleo-g474re")))]
compile_error!("only the nucleo-g474re has a link over USB");
#[cfg(any(
    all(feature = "can", feature = "rs485"),
    all(feature = "can", feature = "usb"),
    all(feature = "rs485", feature = "usb")
))]
compile_error!("two links: choose `rs485`, `can` or `usb`");

mod chain;
pub mod executor;
mod thermometer;

pub use chain::*;
pub use thermometer::Thermometer;

#[cfg(feature = "nucleo-g474re")]
pub use nucleo_g474re::*;
#[cfg(feature = "nucleo-l496zg")]
pub use nucleo_l496zg::*;

use dermatome_shared::{REFLEX_PINS, restart::ResetCauses};
use embassy_stm32::{Peri, gpio::Output, peripherals};
use embassy_time::Duration;

/// The board's hardware, for the tasks to take.
pub struct Board {
    /// What the link is made of.
    pub link: LinkParts,
    /// What the front end is made of.
    pub sensing: SensingParts,
    /// The chip's temperature sensor.
    pub thermometer: Thermometer,
    /// Where reflexes act.
    pub reflex_pins: ReflexPins,
    /// The chip's flash.
    pub flash: Peri<'static, peripherals::FLASH>,
    /// The watchdog.
    pub watchdog: Peri<'static, peripherals::IWDG>,
    /// The core's own peripherals.
    pub core: cortex_m::Peripherals,
    /// Why the chip started.
    pub reset_causes: ResetCauses,
}

/// What the link is made of.
#[cfg(not(feature = "usb"))]
pub struct LinkParts {
    /// UART.
    #[cfg(not(feature = "can"))]
    pub uart: Peri<'static, LinkUart>,
    /// CAN controller.
    #[cfg(feature = "can")]
    pub can: Peri<'static, LinkCan>,
    /// Pin that sends.
    pub tx_pin: Peri<'static, LinkTxPin>,
    /// Pin that receives.
    pub rx_pin: Peri<'static, LinkRxPin>,
    /// DMA channel that sends.
    #[cfg(not(feature = "can"))]
    pub tx_dma: Peri<'static, LinkTxDma>,
    /// DMA channel that receives.
    #[cfg(not(feature = "can"))]
    pub rx_dma: Peri<'static, LinkRxDma>,
    /// Pin that switches the line's driver on.
    #[cfg(feature = "rs485")]
    pub de_pin: Peri<'static, LinkDePin>,
    /// The board's address on the line.
    #[cfg(any(feature = "rs485", feature = "can"))]
    pub address: u8,
}

/// The pins of reflexes, from 1 on: low after a reset, and while a rule is tripped.
pub struct ReflexPins(pub(in crate::board) [Output<'static>; REFLEX_PINS as usize]);

impl ReflexPins {
    /// Sets all of them: those whose bit is set are high, the first one's is the lowest.
    pub fn set(&mut self, high: u8) {
        for (number, pin) in self.0.iter_mut().enumerate() {
            pin.set_level((high >> number & 1 == 1).into());
        }
    }
}

/// A programmable amplifier, whose gain the DMA sets.
pub struct Amplifier {
    /// Where a table of its words goes.
    pub register: fn() -> *mut u32,
    /// The word for a gain of 1, 2, 4, 8, 16, 32 or 64.
    pub word: fn(u8) -> u32,
}

/// Whether a debug probe holds on to the core as it starts. Only then do clocks run on while it sleeps: the counter of
/// cycles, by which load is known, must stand still in sleep.
fn is_debugged() -> bool {
    cortex_m::peripheral::DCB::is_debugger_attached()
}

/// How long so many samples take.
pub fn duration_of_samples(samples: usize) -> Duration {
    Duration::from_micros(samples as u64 * 1_000_000 / u64::from(SAMPLE_RATE))
}
