//! Packet memory: 1 KiB that the CPU and the USB share, with the table of buffers at its beginning (RM0440, USB chapter,
//! "Buffer descriptor table"). The CPU reads and writes it by half-words or bytes.

use crate::chip::{
    bank::Bank,
    map::Register,
    misuse::Misuse,
    peripheral::{Moment, Peripheral, has_bank},
};
use std::ops::Range;

/// Bytes of it.
pub(super) const BYTES: usize = 1024;

/// The memory.
#[derive(Clone, Debug)]
pub struct PacketMemory {
    bank: Bank,
    /// What the USB may read or write at any time.
    pub(super) guarded: Vec<(usize, Range<usize>)>,
}

impl Default for PacketMemory {
    fn default() -> Self {
        Self { bank: Bank::new("USBRAM", &[]), guarded: Vec::new() }
    }
}

impl PacketMemory {
    pub(super) fn half(&self, at: usize) -> u16 {
        // The map has one register for each half-word; the bank keeps two of them in every second one.
        (self.bank.at_place(at / 4 * 2) >> (8 * (at % 4))) as u16
    }

    pub(super) fn put_half(&mut self, at: usize, half: u16) {
        let register = self.bank.map.element("MEM", at / 4 * 2);
        let shift = 8 * (at % 4 / 2 * 2);
        let word = self.bank.value(register) & !(0xFFFF << shift) | u32::from(half) << shift;
        self.bank.store(register, word);
    }

    pub(super) fn read(&self, at: usize, length: usize) -> Vec<u8> {
        (at..at + length).map(|at| (self.half(at / 2 * 2) >> (8 * (at % 2))) as u8).collect()
    }

    pub(super) fn put(&mut self, at: usize, bytes: &[u8]) {
        for (place, pair) in (at..).step_by(2).zip(bytes.chunks(2)) {
            let high = pair.get(1).map_or(self.half(place) >> 8, |&byte| byte.into());
            self.put_half(place, high << 8 | u16::from(pair[0]));
        }
    }
}

impl Peripheral for PacketMemory {
    has_bank!();

    fn models(&self, register: &Register) -> bool {
        register.name == "MEM"
    }

    /// Both halves of a word mean something, which the map does not know.
    fn clears_flags(&self, _: &Register) -> bool {
        true
    }

    fn halves_only(&self) -> bool {
        true
    }

    fn write(&mut self, register: &Register, value: u32, _: Moment) -> Result<(), Misuse> {
        let changed = self.bank.value(register) ^ value;
        let start = register.offset as usize;
        let mut places = (0..4).filter(|byte| changed >> (8 * byte) & 0xFF != 0).map(|byte| start + byte);
        let held = places.find_map(|place| self.guarded.iter().find(|(_, range)| range.contains(&place)));
        if let Some((endpoint, _)) = held {
            let rule = format!(
                "packet memory is written at {start:#x} while endpoint {endpoint} may use it: it is VALID"
            );
            return Err(Misuse::rule("USB", rule));
        }
        self.bank.store(register, value);
        Ok(())
    }
}
