//! Probe: pokes the registers of a whole chip, as a debug probe does.

use crate::chip::{Chip, Ram, map::Map, misuse::Misuse, rcc::ResetCause, time::Time};

/// A chip switched on.
pub(crate) fn chip() -> Chip {
    let mut chip = Chip::new(2_000_000, true);
    chip.reset(ResetCause::Power);
    chip
}

/// Address of a register.
pub(crate) fn address(peripheral: &str, register: &str, index: usize) -> u32 {
    let map = Map::of_chip().peripheral(peripheral);
    map.base + map.element(register, index).offset
}

impl Chip {
    /// Changes fields of a register, as a driver's read-modify-write does.
    pub(crate) fn try_modify(
        &mut self,
        peripheral: &str,
        register: &str,
        fields: &[(&str, u32)],
    ) -> Result<(), Misuse> {
        let address = address(peripheral, register, 0);
        let map = Map::of_chip().peripheral(peripheral).register(register);
        let old = if map.readable { self.read(address, 4)? } else { 0 };
        let value = fields.iter().fold(old, |value, &(field, content)| map.with(value, field, content));
        self.write(address, 4, value)
    }

    pub(crate) fn modify(&mut self, peripheral: &str, register: &str, fields: &[(&str, u32)]) {
        self.try_modify(peripheral, register, fields).unwrap();
    }

    pub(crate) fn refused(&mut self, peripheral: &str, register: &str, fields: &[(&str, u32)]) -> String {
        self.try_modify(peripheral, register, fields).unwrap_err().to_string()
    }

    pub(crate) fn put(&mut self, peripheral: &str, register: &str, index: usize, value: u32) {
        self.write(address(peripheral, register, index), 4, value).unwrap();
    }

    pub(crate) fn pass(&mut self, span: Time, ram: &mut Ram) {
        self.settle(ram).unwrap();
        self.advance(self.now + span, ram).unwrap();
    }
}

/// RM0440 6.1.5 and the PLL settings of the G4's drivers: boost, wait states, PLL, then the switch.
pub(crate) fn run_at_170_mhz(chip: &mut Chip, boost: bool, wait_states: u32) -> Result<(), Misuse> {
    chip.modify("RCC", "APB1ENR1", &[("PWREN", 1)]);
    if boost {
        chip.modify("PWR", "CR5", &[("R1MODE", 0)]);
    }
    chip.modify("FLASH", "ACR", &[("LATENCY", wait_states)]);
    chip.modify("RCC", "PLLCFGR", &[("PLLSRC", 2), ("PLLM", 3), ("PLLN", 85), ("PLLREN", 1)]);
    chip.modify("RCC", "CR", &[("PLLON", 1)]);
    chip.try_modify("RCC", "CFGR", &[("SW", 3)])
}
