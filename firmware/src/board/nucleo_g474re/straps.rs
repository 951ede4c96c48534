//! NUCLEO-G474RE on a bus: the straps that make its address.

use embassy_stm32::{
    Peri,
    gpio::{AnyPin, Input, Pull},
};

use super::CYCLES_PER_MICROSECOND;

/// Time in which a pull-up lifts an open strap, us: 50 kohm and some 100 pF.
const STRAPS_RISE: f32 = 50.0;

/// The address that straps make, the first one its lowest bit.
pub(super) fn read(straps: [Peri<'static, AnyPin>; 4]) -> u8 {
    let straps = straps.map(|pin| Input::new(pin, Pull::Up));
    cortex_m::asm::delay((STRAPS_RISE * CYCLES_PER_MICROSECOND) as u32);
    straps.iter().rev().fold(0, |address, strap| address << 1 | u8::from(strap.is_low()))
}

/// Takes the straps of the chip, and gives their address.
macro_rules! address {
    ($chip:ident) => {
        straps::read([$chip.PC9.into(), $chip.PC10.into(), $chip.PC11.into(), $chip.PC12.into()])
    };
}
pub(super) use address;
