//! NUCLEO-G474RE on a bus: the link, to a transceiver for CAN FD.
//!
//! | what         | which                     | why                                                 |
//! |--------------|---------------------------|-----------------------------------------------------|
//! | link         | FDCAN1                    | its other pins, PB8 and PB9, are addresses          |
//! | link, pins   | PA11 receives, PA12 sends | free, and PA12 is recessive in reset with a pull-up |
//! | its clock    | 24 MHz, the crystal alone | the HSI is off by up to 1 %, too much for CAN FD; without the PLL its bits have no jitter, |
//! |              |                           | and all else of the board stays as it is            |
//! | address      | PC9 (lowest bit) to PC12  | straps: open is 0, bridged to ground is 1           |

use core::cell::Cell;

use embassy_stm32::{
    interrupt::{
        InterruptExt, Priority,
        typelevel::{FDCAN1_IT0, Handler, Interrupt},
    },
    pac, peripherals, rcc,
    time::Hertz,
};
use embassy_sync::blocking_mutex::CriticalSectionMutex;

/// What the board calls itself to a host.
pub const NAME: &str = "nucleo-g474re-can";

/// CAN controller of the link.
pub type LinkCan = peripherals::FDCAN1;
/// Pin the link sends on.
pub type LinkTxPin = peripherals::PA12;
/// Pin the link receives on.
pub type LinkRxPin = peripherals::PA11;

/// Its registers.
pub const CAN: pac::can::Fdcan = pac::FDCAN1;
/// Its memory for filters and frames.
pub const CAN_MEMORY: pac::fdcanram::Fdcanram = pac::FDCANRAM1;
/// Its clock, Hz: the crystal.
pub const CAN_CLOCK: u32 = 24_000_000;

/// What an interrupt calls.
type Work = Option<fn()>;

static ON_INTERRUPT: CriticalSectionMutex<Cell<Work>> = CriticalSectionMutex::new(Cell::new(None));

/// Calls what the link's driver has set; bound to the interrupt of FDCAN1.
pub struct CanInterruptHandler;

impl Handler<FDCAN1_IT0> for CanInterruptHandler {
    #[expect(unsafe_code, reason = "the trait's function is unsafe; this one does nothing that is")]
    unsafe fn on_interrupt() {
        if let Some(work) = ON_INTERRUPT.lock(Cell::get) {
            work();
        }
    }
}

/// From now on the link's interrupt calls this.
pub fn on_can_interrupt(work: fn()) {
    ON_INTERRUPT.lock(|set| set.set(Some(work)));
    // Below the timer and the DMA, above the acquisition: three frames are all that the FDCAN holds.
    FDCAN1_IT0::IRQ.set_priority(Priority::P5);
    FDCAN1_IT0::unpend();
    #[expect(unsafe_code, reason = "an interrupt is let through")]
    // SAFETY: nothing relies on its being off; what it shares is behind critical sections.
    unsafe {
        FDCAN1_IT0::enable();
    }
}

/// The link's interrupt comes, whether the FDCAN has a reason or not.
pub fn call_can_interrupt() {
    FDCAN1_IT0::pend();
}

/// Switches the crystal on, and gives it to the FDCAN. embassy-stm32 waits for it: without one, the board does not start.
pub(super) fn add_link_clock(clocks: &mut rcc::Config) {
    clocks.hse = Some(rcc::Hse { freq: Hertz(CAN_CLOCK), mode: rcc::HseMode::Oscillator });
    clocks.mux.fdcansel = rcc::mux::Fdcansel::HSE;
}

/// Takes the link's parts of the chip.
macro_rules! link_parts {
    ($chip:ident) => {
        $crate::board::LinkParts {
            can: $chip.FDCAN1,
            tx_pin: $chip.PA12,
            rx_pin: $chip.PA11,
            address: straps::address!($chip),
        }
    };
}
pub(super) use link_parts;
