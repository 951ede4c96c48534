//! Schedule: when which block does something by itself next, and time that passes from one to the next.

use super::{
    Chip, Memory,
    blocks::Block,
    misuse::Misuse,
    peripheral::{Moment, Peripheral},
    time::Time,
};

/// Blocks that do something by themselves, in the order in which they act when they are due at once. The
/// links and the flash are asked each time: the world may touch them.
const EVENTFUL: [Block; 13] = [
    Block::Timer(0),
    Block::Timer(1),
    Block::Timer(2),
    Block::Timer(3),
    Block::Timer(4),
    Block::Timer(5),
    Block::Timer(6),
    Block::Adc(0),
    Block::Adc(1),
    Block::Adc(2),
    Block::Adc(3),
    Block::Adc(4),
    Block::Iwdg,
];

/// Place of a block in [`EVENTFUL`].
fn place_of(block: Block) -> Option<usize> {
    match block {
        Block::Timer(place) => Some(place.into()),
        Block::Adc(place) => Some(7 + usize::from(place)),
        Block::Iwdg => Some(12),
        _ => None,
    }
}

/// When each of [`EVENTFUL`] is due, and the first of them.
#[derive(Clone, Debug)]
pub(super) struct Schedule {
    due: [Time; EVENTFUL.len()],
    first: Time,
}

impl Default for Schedule {
    fn default() -> Self {
        Self { due: [Time::NEVER; EVENTFUL.len()], first: Time::NEVER }
    }
}

impl Chip {
    /// When anything happens by itself next, as it was when the chip settled last.
    #[must_use]
    pub fn next_event(&self) -> Time {
        self.schedule.first.min(self.next_loud_event())
    }

    /// When something happens next that more depends on than the chip's own blocks: links, flash, SysTick.
    fn next_loud_event(&self) -> Time {
        let uarts = self.uart.next_event().min(self.usart1.next_event());
        let links = uarts.min(self.fdcan.next_event()).min(self.usb.next_event());
        links.min(self.flash.next_event()).min(self.core.next_event(self.cycle))
    }

    /// Asks blocks that were touched when they are due.
    pub(super) fn reschedule(&mut self) {
        for block in self.touched.iter() {
            if let Some(place) = place_of(block) {
                let model = self.model(block);
                let due = if model.bank().is_in_use { model.next_event() } else { Time::NEVER };
                self.schedule.due[place] = due;
            }
        }
        self.schedule.first = self.schedule.due.iter().copied().min().unwrap_or(Time::NEVER);
    }

    /// Lets time pass, from one event to the next.
    pub fn advance(&mut self, to: Time, memory: &mut dyn Memory) -> Result<(), Misuse> {
        self.settle_touched(memory)?;
        loop {
            let next = self.next_event();
            if next > to {
                break;
            }
            self.pass_event(next, memory)?;
        }
        self.now = self.now.max(to);
        Ok(())
    }

    /// Lets time pass while nothing happens that the CPU or the world has to see at once: no exception
    /// becomes pending, and link, flash and SysTick do nothing. Says whether `to` was reached; otherwise it
    /// is now when that is due or has happened.
    pub fn advance_quietly(&mut self, to: Time, memory: &mut dyn Memory) -> Result<bool, Misuse> {
        self.settle_touched(memory)?;
        let loud = self.next_loud_event();
        while !self.is_news() && self.schedule.first <= to && self.schedule.first < loud {
            self.pass_event(self.schedule.first, memory)?;
        }
        if self.is_news() {
            return Ok(false);
        }
        self.now = self.now.max(to.min(loud));
        Ok(loud > to)
    }

    fn is_news(&self) -> bool {
        self.core.nvic.has_news() || self.iwdg.has_bitten()
    }

    fn settle_touched(&mut self, memory: &mut dyn Memory) -> Result<(), Misuse> {
        if self.touched.is_empty() { Ok(()) } else { self.settle(memory) }
    }

    /// What is due at this time happens.
    fn pass_event(&mut self, next: Time, memory: &mut dyn Memory) -> Result<(), Misuse> {
        self.now = self.now.max(next);
        self.core.advance(self.now, self.cycle);
        let at = Moment { now: next, clocks: self.clocks };
        self.ask_world(next)?;
        for block in [Block::Flash, Block::Link, Block::Bus, Block::Can, Block::Usb] {
            self.advance_block(block, at)?;
        }
        for (place, block) in EVENTFUL.into_iter().enumerate() {
            if self.schedule.due[place] <= next {
                self.advance_block(block, at)?;
                // A converter may only have asked the world.
                self.touched.insert(block);
            }
        }
        self.settle(memory)
    }

    fn advance_block(&mut self, block: Block, at: Moment) -> Result<(), Misuse> {
        let model = self.model_mut(block);
        if model.next_event() <= at.now {
            model.advance(at)?;
            self.touched.insert(block);
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_eventful_block_has_its_place() {
        for (place, block) in EVENTFUL.into_iter().enumerate() {
            assert_eq!(place_of(block), Some(place));
        }
        let known = Block::all().filter(|&block| place_of(block).is_some());
        assert_eq!(known.count(), EVENTFUL.len());
    }
}
