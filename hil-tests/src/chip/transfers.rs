//! Transfers: the DMA serves requests, beat by beat, over the bus that the CPU uses as well
//! (RM0440, "Direct memory access controller (DMA)"). The lowest channel of DMA1 goes first, whatever its priority.

use super::{
    Chip, Memory, RAM_BYTES, RAM_START,
    blocks::{Block, Blocks},
    core,
    dma::{CHANNELS, Mark, Source},
    flash,
    misuse::Misuse,
    trace::Event,
};

/// Most beats in a row before the chip is taken to hang.
const MAX_BEATS: usize = 1 << 20;

impl Chip {
    /// Serves every request of the blocks that were touched.
    pub(super) fn serve_requests(&mut self, memory: &mut dyn Memory) -> Result<(), Misuse> {
        for _ in 0..MAX_BEATS {
            self.deliver_triggers();
            let Some((controller, channel)) = self.channel_to_serve() else { return Ok(()) };
            self.move_beat(controller, channel, memory)?;
        }
        Err(Misuse::rule("DMA", "a channel is asked without end"))
    }

    /// Transfers of the DMA since this was asked last.
    pub fn take_transfers(&mut self) -> u64 {
        std::mem::take(&mut self.transfers)
    }

    fn channel_to_serve(&self) -> Option<(usize, usize)> {
        // Channels that copy memory go on as soon as their controller is touched.
        if !self.dmamux.listens_to(self.touched) && !self.touched.meets(Blocks::DMA) {
            return None;
        }
        let all = (0..2 * CHANNELS).map(|place| (place / CHANNELS, place % CHANNELS));
        let mut wanting = all.filter(|&(controller, channel)| {
            let dma = &self.dma[controller];
            dma.is_on(channel) && (dma.copies_memory(channel) || self.is_requested(controller, channel))
        });
        wanting.next()
    }

    fn is_requested(&self, controller: usize, channel: usize) -> bool {
        let source = self.dmamux.source(controller * CHANNELS + channel);
        source.is_some_and(|Source { block, signal }| {
            self.touched.contains(block) && self.model(block).requests(signal)
        })
    }

    fn move_beat(
        &mut self,
        controller: usize,
        channel: usize,
        memory: &mut dyn Memory,
    ) -> Result<(), Misuse> {
        self.transfers += 1;
        let beat = self.dma[controller].beat(channel);
        let source = self.dmamux.source(controller * CHANNELS + channel);
        if let Some(Source { block, signal }) = source {
            self.model_mut(block).acknowledge(signal);
        }
        let moved = match self.bus_read(beat.from, beat.from_bytes, memory)? {
            Some(value) => self.bus_write(beat.to, beat.to_bytes, value, memory)?,
            None => false,
        };
        if !moved {
            self.dma[controller].fail(channel);
            self.touched.insert(Block::Dma(controller as u8));
            return Ok(());
        }
        let Some(mark) = self.dma[controller].count(channel) else { return Ok(()) };
        self.touched.insert(Block::Dma(controller as u8));
        if mark == Mark::End {
            if let Some(Source { block, signal }) = source {
                self.model_mut(block).transfers_ended(signal);
            }
            let event = Event::DmaComplete { controller: controller as u8 + 1, channel: channel as u8 + 1 };
            self.trace.add(self.now, event);
        }
        Ok(())
    }

    fn bus_read(&mut self, address: u32, size: u32, memory: &dyn Memory) -> Result<Option<u32>, Misuse> {
        let mut bytes = [0; 4];
        let place = &mut bytes[..size as usize];
        if lies_in(address, size, RAM_START, RAM_BYTES) {
            memory.read(address, place);
        } else if lies_in(address, size, flash::START, flash::BYTES) {
            let start = (address - flash::START) as usize;
            place.copy_from_slice(&self.flash.content()[start..start + size as usize]);
            self.flash.check_read(address, size);
        } else if (0x4000_0000..core::START).contains(&address) {
            return self.read(address, size).map(Some);
        } else {
            return Ok(None);
        }
        Ok(Some(u32::from_le_bytes(bytes)))
    }

    fn bus_write(
        &mut self,
        address: u32,
        size: u32,
        value: u32,
        memory: &mut dyn Memory,
    ) -> Result<bool, Misuse> {
        if lies_in(address, size, RAM_START, RAM_BYTES) {
            memory.write(address, &value.to_le_bytes()[..size as usize]);
        } else if (0x4000_0000..core::START).contains(&address) {
            self.write(address, size, value)?;
        } else {
            return Ok(false);
        }
        Ok(true)
    }
}

fn lies_in(address: u32, size: u32, start: u32, bytes: u32) -> bool {
    address >= start && address + size <= start + bytes
}
