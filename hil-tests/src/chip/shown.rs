//! Shown: what changed on the chip, told to its trace and to who watches the flash.

use super::{
    Chip,
    flash::{Flash, Operation},
    trace::Event,
};
use std::fmt;

/// Who looks at the flash.
pub struct Watcher(pub Box<dyn FnMut(&Flash) + Send>);

impl fmt::Debug for Watcher {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str("Watcher")
    }
}

impl Chip {
    /// Tells trace and world what a port's pins put out.
    pub(super) fn show_pins(&mut self, place: usize) {
        let levels = self.ports[place].driven_levels();
        if self.outside.show_pins(place, levels, self.now) {
            let port = (b'A' + place as u8).into();
            self.trace.add(self.now, Event::Pins { port, levels });
        }
    }

    pub(super) fn show_flash(&mut self) {
        if std::mem::replace(&mut self.shown_operations, self.flash.operations()) != self.flash.operations() {
            match self.flash.operation() {
                Some(Operation::Erase(page)) => self.trace.add(self.now, Event::Erase(page)),
                Some(Operation::Program(address, _)) => self.trace.add(self.now, Event::Program(address)),
                None => {}
            }
            if let Some(Watcher(look)) = &mut self.watcher {
                look(&self.flash);
            }
        }
    }
}
