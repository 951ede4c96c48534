//! NUCLEO-G474RE on USB: the link, a full-speed device.
//!
//! | what         | which                | why                                                        |
//! |--------------|----------------------|------------------------------------------------------------|
//! | link         | USB                  | the chip's own, no debug adapter needed                    |
//! | link, pins   | PA11 D-, PA12 D+     | the chip has it nowhere else; the pull-up of D+ is inside  |
//! | clock        | HSI48                | trimmed by the host's frames (CRS), so it needs no crystal |

use embassy_stm32::{
    Peri,
    pac::{
        self,
        usb::vals::{EpType, Stat},
    },
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

/// Whether the host has let the bus rest.
pub fn host_sleeps() -> bool {
    pac::USB.cntr().read().fsusp()
}

/// Puts a packet where the chip sends it from, unless another one is still there; says whether it did. Bulk endpoints only.
/// embassy-stm32 does the same, but takes 25 us for it where it is built for size.
pub fn try_send(address: u8, packet: &[u8]) -> bool {
    let (index, memory) = (usize::from(address & 0xF), pac::USBRAM);
    let register = pac::USB.epr(index);
    if register.read().stat_tx() != Stat::NAK {
        return false;
    }
    let [start, count] = [4 * index, 4 * index + 1];
    let place = usize::from(memory.mem(start).read() / 2);
    let pairs = packet.chunks_exact(2);
    if let &[last] = pairs.remainder() {
        memory.mem(place + packet.len() / 2).write_value(last.into());
    }
    for (place, pair) in (place..).zip(pairs) {
        memory.mem(place).write_value(u16::from_le_bytes([pair[0], pair[1]]));
    }
    memory.mem(count).write_value(packet.len() as u16);
    register.write(|w| {
        w.set_ea(index as u8);
        w.set_ep_type(EpType::BULK);
        // Ones toggle this, zeros clear those.
        w.set_stat_tx(Stat::from_bits(Stat::NAK.to_bits() ^ Stat::VALID.to_bits()));
        w.set_ctr_rx(true);
        w.set_ctr_tx(true);
    });
    true
}
