//! NUCLEO-G474RE on USB: the link, a full-speed device.
//!
//! | what         | which                | why                                                        |
//! |--------------|----------------------|------------------------------------------------------------|
//! | link         | USB                  | the chip's own, no debug adapter needed                    |
//! | link, pins   | PA11 D-, PA12 D+     | the chip has it nowhere else; the pull-up of D+ is inside  |
//! | clock        | HSI48                | trimmed by the host's frames (CRS), so it needs no crystal |

use embassy_stm32::{
    Peri,
    pac::{self, usb::vals::Stat},
    peripherals, rcc,
};

/// What the board calls itself to a host.
pub const NAME: &str = "nucleo-g474re-usb";

/// USB device of the link.
pub type LinkUsb = peripherals::USB;
/// Pin of D+.
pub type LinkDpPin = peripherals::PA12;
/// Pin of D-.
pub type LinkDmPin = peripherals::PA11;

/// What the link is made of.
pub struct LinkParts {
    /// USB device.
    pub usb: Peri<'static, LinkUsb>,
    /// Pin of D+.
    pub dp_pin: Peri<'static, LinkDpPin>,
    /// Pin of D-.
    pub dm_pin: Peri<'static, LinkDmPin>,
}

/// Takes the link's parts of the chip.
macro_rules! link_parts {
    ($chip:ident) => {
        $crate::board::LinkParts { usb: $chip.USB, dp_pin: $chip.PA12, dm_pin: $chip.PA11 }
    };
}
pub(super) use link_parts;

/// Adds the clock of the link: 48 MHz, within 0.25 % of the host's.
pub(super) fn add_link_clock(clocks: &mut rcc::Config) {
    clocks.hsi48 = Some(rcc::Hsi48Config { sync_from_usb: true });
    clocks.mux.clk48sel = rcc::mux::Clk48sel::HSI48;
}

/// Lets an endpoint begin with DATA0 again, which embassy-stm32 leaves to resets of the bus. Nothing may be under way on
/// it. The address' highest bit is set where it goes to the host.
pub fn begin_with_data0(address: u8) {
    let register = pac::USB.epr(usize::from(address & 0xF));
    register.modify(|w| {
        // Ones toggle these: what is one becomes zero, and the other direction stays as it is.
        if address & 0x80 == 0 {
            w.set_dtog_tx(false);
        } else {
            w.set_dtog_rx(false);
        }
        w.set_stat_rx(Stat::DISABLED);
        w.set_stat_tx(Stat::DISABLED);
        // Zeros clear these.
        w.set_ctr_rx(true);
        w.set_ctr_tx(true);
    });
}
