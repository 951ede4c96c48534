//! Bank: the values of one peripheral's registers, by the names and fields of the map.

use super::map::{Field, Map, PeripheralMap, Register};

/// Values of a peripheral's registers.
#[derive(Clone, Debug)]
pub struct Bank {
    /// Where the registers are.
    pub map: &'static PeripheralMap,
    /// Whether the bus has written here since reset: until then the peripheral sleeps.
    pub is_in_use: bool,
    values: Vec<u32>,
    resets: Vec<(usize, u32)>,
}

impl Bank {
    /// The registers of a peripheral of the chip, all zero but for these values after reset.
    #[must_use]
    pub fn new(peripheral: &str, resets: &[(&str, u32)]) -> Self {
        let map = Map::of_chip().peripheral(peripheral);
        let resets = resets.iter().map(|&(name, value)| (map.register(name).place, value)).collect();
        let mut bank = Self { map, is_in_use: false, values: Vec::new(), resets };
        bank.reset();
        bank
    }

    /// Back to the values after reset.
    pub fn reset(&mut self) {
        self.is_in_use = false;
        self.values = vec![0; self.map.registers().count()];
        for &(place, value) in &self.resets {
            self.values[place] = value;
        }
    }

    /// Value of a register.
    #[must_use]
    pub fn value(&self, register: &Register) -> u32 {
        self.values[register.place]
    }

    /// Replaces the value of a register.
    pub fn store(&mut self, register: &Register, value: u32) {
        self.values[register.place] = value;
    }

    /// Where a field is, to look at it often.
    #[must_use]
    pub fn find(&self, register: &str, field: &str) -> Field {
        self.map.register(register).find(field)
    }

    /// Value of a field that was found before.
    #[must_use]
    pub fn at(&self, field: Field) -> u32 {
        (self.values[field.place] & field.mask) >> field.shift
    }

    /// Replaces a field that was found before.
    pub fn put(&mut self, field: Field, value: u32) {
        let old = self.values[field.place];
        self.values[field.place] = (old & !field.mask) | (value << field.shift & field.mask);
    }

    /// Value of the register at a place among the peripheral's.
    #[must_use]
    pub fn at_place(&self, place: usize) -> u32 {
        self.values[place]
    }

    /// Value of a field.
    #[must_use]
    pub fn get(&self, register: &str, field: &str) -> u32 {
        self.get_at(register, 0, field)
    }

    /// Whether a field is not zero.
    #[must_use]
    pub fn is_set(&self, register: &str, field: &str) -> bool {
        self.get(register, field) != 0
    }

    /// Value of a field in one of an array of registers.
    #[must_use]
    pub fn get_at(&self, register: &str, index: usize, field: &str) -> u32 {
        let register = self.map.element(register, index);
        register.get(self.value(register), field)
    }

    /// Replaces a field.
    pub fn set(&mut self, register: &str, field: &str, value: u32) {
        self.set_at(register, 0, field, value);
    }

    /// Replaces a field in one of an array of registers.
    pub fn set_at(&mut self, register: &str, index: usize, field: &str, value: u32) {
        let map = self.map;
        let register = map.element(register, index);
        self.store(register, register.with(self.value(register), field, value));
    }

    /// Value of a whole register.
    #[must_use]
    pub fn word(&self, register: &str, index: usize) -> u32 {
        self.value(self.map.element(register, index))
    }

    /// Replaces a whole register.
    pub fn set_word(&mut self, register: &str, index: usize, value: u32) {
        let map = self.map;
        self.store(map.element(register, index), value);
    }
}
