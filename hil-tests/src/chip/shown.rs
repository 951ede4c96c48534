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
    /// Tells the trace what changed outside.
    pub(super) fn show_pins(&mut self) {
        for (place, (port, model)) in self.ports.iter().enumerate() {
            let levels = model.outputs();
            if std::mem::replace(&mut self.shown_pins[place], levels) != levels {
                self.trace.add(self.now, Event::Pins { port: *port, levels });
            }
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
