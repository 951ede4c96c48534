//! Shown: what changed on the chip, told to its trace and to who observes the flash.

use super::{
    Chip,
    flash::{Flash, Operation},
    trace::Event,
};
use std::fmt;

type Observe = Box<dyn FnMut(&Flash) + Send>;

/// Sees the flash as each of its operations begins; by default there is none. A clone is none either.
#[derive(Default)]
pub struct FlashObserver(Option<Observe>);

impl FlashObserver {
    /// One that does this.
    pub fn new(observe: impl FnMut(&Flash) + Send + 'static) -> Self {
        Self(Some(Box::new(observe)))
    }
}

impl Clone for FlashObserver {
    fn clone(&self) -> Self {
        Self::default()
    }
}

impl fmt::Debug for FlashObserver {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str("FlashObserver")
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
            if let Some(observe) = &mut self.flash_observer.0 {
                observe(&self.flash);
            }
        }
    }
}
