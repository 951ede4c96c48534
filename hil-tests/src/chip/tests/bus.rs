//! Bus: pokes one peripheral's registers by name, without a chip or a firmware around it.

use crate::chip::{
    clocks::Clocks,
    misuse::Misuse,
    peripheral::{Moment, Peripheral},
    time::Time,
};

/// One peripheral, and the time.
pub(crate) struct Bus<P> {
    pub(crate) model: P,
    pub(crate) now: Time,
}

impl<P: Peripheral> Bus<P> {
    pub(crate) fn new(model: P) -> Self {
        Self { model, now: Time::ZERO }
    }

    pub(crate) fn moment(&self) -> Moment {
        Moment { now: self.now, clocks: Clocks::RESET }
    }

    pub(crate) fn read_at(&mut self, register: &str, index: usize) -> u32 {
        let map = self.model.bank().map;
        let at = self.moment();
        self.model.read(map.element(register, index), at)
    }

    pub(crate) fn read(&mut self, register: &str) -> u32 {
        self.read_at(register, 0)
    }

    pub(crate) fn get(&mut self, register: &str, field: &str) -> u32 {
        let value = self.read(register);
        self.model.bank().map.register(register).get(value, field)
    }

    pub(crate) fn write_at(&mut self, register: &str, index: usize, value: u32) -> Result<(), Misuse> {
        let map = self.model.bank().map;
        let at = self.moment();
        self.model.write(map.element(register, index), value, at)
    }

    pub(crate) fn write(&mut self, register: &str, value: u32) {
        self.write_at(register, 0, value).unwrap();
    }

    /// The message of a refusal.
    pub(crate) fn refused(&mut self, register: &str, value: u32) -> String {
        self.write_at(register, 0, value).unwrap_err().to_string()
    }

    /// Writes fields of a register, the others being zero.
    pub(crate) fn fields(&mut self, register: &str, fields: &[(&str, u32)]) {
        let map = self.model.bank().map.register(register);
        let value = fields.iter().fold(0, |value, &(field, content)| map.with(value, field, content));
        self.write(register, value);
    }

    /// Lets time pass from one event to the next.
    pub(crate) fn pass(&mut self, span: Time) {
        let end = self.now + span;
        while self.model.next_event() <= end {
            self.now = self.now.max(self.model.next_event());
            let at = self.moment();
            self.model.advance(at).unwrap();
        }
        self.now = end;
    }
}

/// So many nanoseconds.
pub(crate) fn nanos(count: u64) -> Time {
    std::time::Duration::from_nanos(count).into()
}
