//! DMA and DMAMUX (RM0440, "Direct memory access controller (DMA)", "DMA request multiplexer (DMAMUX)"):
//! sixteen channels, any request to any of them.
//!
//! A transfer is one beat: read there, write here, count down. Beats take no time of their own.

use super::{
    bank::Bank,
    blocks::{Block, Blocks},
    map::{Map, Register},
    misuse::Misuse,
    peripheral::{Moment, Peripheral, has_bank},
};

/// Channels of one controller.
pub const CHANNELS: usize = 8;

/// Model of one controller.
#[derive(Clone, Debug)]
pub struct Dma {
    bank: Bank,
    channels: [Channel; CHANNELS],
}

/// One channel: what its registers ask for, and where it is: beats left of `total`.
#[derive(Clone, Copy, Debug, Default)]
struct Channel {
    there: Side,
    here: Side,
    /// CR.DIR: from memory to the peripheral.
    from_memory: bool,
    copies_memory: bool,
    is_circular: bool,
    total: u32,
    left: u32,
    is_on: bool,
}

/// One end of a transfer: PAR or MAR, with its width and whether it goes on after each beat.
#[derive(Clone, Copy, Debug, Default)]
struct Side {
    start: u32,
    /// Bytes, as a power of two.
    size: u32,
    increments: bool,
}

/// What a beat reaches.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Mark {
    /// Half of the buffer.
    Half,
    /// The end of the buffer.
    End,
}

/// One beat: what to read and what to write.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Beat {
    /// Address to read.
    pub from: u32,
    /// Bytes to read.
    pub from_bytes: u32,
    /// Address to write.
    pub to: u32,
    /// Bytes to write.
    pub to_bytes: u32,
}

impl Dma {
    /// The controller of that name.
    #[must_use]
    pub fn new(name: &str) -> Self {
        Self { bank: Bank::new(name, &[]), channels: [Channel::default(); CHANNELS] }
    }

    /// Whether a channel waits for a request.
    #[must_use]
    pub fn is_on(&self, channel: usize) -> bool {
        self.channels[channel].is_on && self.channels[channel].left > 0
    }

    /// Whether a channel copies memory without any request.
    #[must_use]
    pub fn copies_memory(&self, channel: usize) -> bool {
        self.channels[channel].copies_memory
    }

    /// The next beat of a channel.
    #[must_use]
    pub fn beat(&self, channel: usize) -> Beat {
        let channel = &self.channels[channel];
        let done = channel.total - channel.left;
        let ((there, there_bytes), (here, here_bytes)) = (channel.there.at(done), channel.here.at(done));
        if channel.from_memory {
            Beat { from: here, from_bytes: here_bytes, to: there, to_bytes: there_bytes }
        } else {
            Beat { from: there, from_bytes: there_bytes, to: here, to_bytes: here_bytes }
        }
    }

    /// Counts one beat ("DMA transfers"): flags at half and at the end, then stop or start again.
    pub fn count(&mut self, channel: usize) -> Option<Mark> {
        let progress = &mut self.channels[channel];
        progress.left -= 1;
        let (left, total) = (progress.left, progress.total);
        if left == 0 && progress.is_circular {
            progress.left = total;
        }
        if left == total / 2 {
            self.flag("HTIF", channel);
        }
        if left == 0 {
            self.flag("TCIF", channel);
            return Some(Mark::End);
        }
        (left == total / 2).then_some(Mark::Half)
    }

    fn follow(&mut self, channel: usize) {
        let get = |field| self.bank.get_at("CH.CR", channel, field);
        let side = |register, increments, size| Side {
            start: self.bank.word(register, channel),
            size: get(size),
            increments: get(increments) == 1,
        };
        let (there, here) = (side("CH.PAR", "PINC", "PSIZE"), side("CH.MAR", "MINC", "MSIZE"));
        let (from_memory, copies_memory) = (get("DIR") == 1, get("MEM2MEM") == 1);
        let is_circular = get("CIRC") == 1;
        let old = self.channels[channel];
        self.channels[channel] = Channel { there, here, from_memory, copies_memory, is_circular, ..old };
    }

    /// A beat met an address where nothing is (12.4.6): the channel stops.
    pub fn fail(&mut self, channel: usize) {
        self.bank.set_at("CH.CR", channel, "EN", 0);
        self.channels[channel].is_on = false;
        self.flag("TEIF", channel);
    }

    fn flag(&mut self, flag: &str, channel: usize) {
        self.bank.set("ISR", &format!("{flag}[{channel}]"), 1);
    }
}

impl Peripheral for Dma {
    has_bank!();

    fn models(&self, _: &Register) -> bool {
        true
    }

    fn read(&mut self, register: &Register, _: Moment) -> u32 {
        match register.name.as_str() {
            "CH.NDTR" => self.channels[register.index].left,
            "ISR" => (0..CHANNELS).fold(self.bank.value(register), |value, channel| {
                let any = value >> (4 * channel) & 0xE != 0;
                value | u32::from(any) << (4 * channel)
            }),
            _ => self.bank.value(register),
        }
    }

    fn write(&mut self, register: &Register, value: u32, _: Moment) -> Result<(), Misuse> {
        let old = self.bank.value(register);
        match register.name.as_str() {
            // GIF clears all four flags of its channel (12.6.2).
            "IFCR" => {
                let all = (0..CHANNELS).filter(|channel| value >> (4 * channel) & 1 == 1);
                let clear = all.fold(value, |bits, channel| bits | 0xF << (4 * channel));
                let flags = self.bank.word("ISR", 0);
                self.bank.set_word("ISR", 0, flags & !clear);
            }
            "CH.NDTR" | "CH.PAR" | "CH.MAR" if self.bank.get_at("CH.CR", register.index, "EN") == 1 => {
                return Err(Misuse::rule(
                    "DMA",
                    format!("{} changes while its channel is on (12.6.4)", register.name),
                ));
            }
            "CH.NDTR" => {
                self.bank.store(register, value);
                let channel = &mut self.channels[register.index];
                (channel.total, channel.left, channel.is_on) = (value, value, false);
            }
            "CH.CR" => {
                self.bank.store(register, value);
                let channel = &mut self.channels[register.index];
                channel.is_on = register.get(value, "EN") == 1;
                if register.get(old, "EN") == 0 && channel.is_on {
                    // After the end, NDTR has to be written again (12.4.3).
                    channel.total = channel.left;
                }
                self.follow(register.index);
            }
            "CH.PAR" | "CH.MAR" => {
                self.bank.store(register, value);
                self.follow(register.index);
            }
            _ => self.bank.store(register, value),
        }
        Ok(())
    }

    fn interrupts(&self, signal: &str) -> bool {
        let number = signal.strip_prefix("CH").and_then(|number| number.parse::<usize>().ok());
        let Some(channel) = number.map(|number| number - 1) else { return false };
        // The enable bits lie where the flags lie (12.6.1, 12.6.3).
        let flags = self.bank.word("ISR", 0) >> (4 * channel) & 0xE;
        flags != 0 && flags & self.bank.word("CH.CR", channel) != 0
    }

    fn reset(&mut self) {
        *self = Self::new(self.bank.map.name);
    }
}

impl Side {
    fn at(self, done: u32) -> (u32, u32) {
        let offset = if self.increments { done << self.size } else { 0 };
        (self.start + offset, 1 << self.size)
    }
}

/// Model of the request multiplexer.
#[derive(Clone, Debug)]
pub struct Dmamux {
    bank: Bank,
    sources: [Option<Source>; 2 * CHANNELS],
    /// All blocks that some channel gets requests of.
    listened: Blocks,
}

/// Block and signal that ask for transfers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Source {
    pub(super) block: Block,
    pub(super) signal: &'static str,
}

impl Default for Dmamux {
    fn default() -> Self {
        Self { bank: Bank::new("DMAMUX1", &[]), sources: [None; 2 * CHANNELS], listened: Blocks::default() }
    }
}

impl Dmamux {
    /// Whether one of these blocks may ask for transfers.
    pub(super) fn listens_to(&self, blocks: Blocks) -> bool {
        self.listened.meets(blocks)
    }

    /// Block and signal whose requests a channel (0 to 15) gets.
    pub(super) fn source(&self, channel: usize) -> Option<Source> {
        self.sources[channel]
    }
}

/// Who has this request number (13.3.2, "DMAMUX mapping"); none has 0.
fn source_of(request: u32) -> Option<Source> {
    Map::of_chip().peripherals().find_map(|peripheral| {
        let (signal, _) = peripheral.dma_requests().find(|&(_, number)| number == request && request != 0)?;
        Some(Source { block: Block::named(peripheral.name)?, signal })
    })
}

impl Peripheral for Dmamux {
    has_bank!();

    fn models(&self, register: &Register) -> bool {
        matches!(register.name.as_str(), "CCR" | "CSR" | "CFR")
    }

    fn write(&mut self, register: &Register, value: u32, _: Moment) -> Result<(), Misuse> {
        // Events that nothing listens to may be generated (EGE).
        if register.name == "CCR" && ["SE", "SOIE"].iter().any(|field| register.get(value, field) != 0) {
            return Err(Misuse::rule("DMAMUX1", "synchronisation of requests is not modelled"));
        }
        if register.name == "CCR" {
            self.bank.store(register, value);
            self.sources[register.index] = source_of(register.get(value, "DMAREQ_ID"));
            self.listened = Blocks::default();
            self.sources.iter().flatten().for_each(|source| self.listened.insert(source.block));
        }
        Ok(())
    }

    fn reset(&mut self) {
        *self = Self::default();
    }
}

#[cfg(test)]
mod tests;
