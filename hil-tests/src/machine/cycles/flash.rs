//! Flash port: what waiting for the flash costs the core (RM0440, "Adaptive real-time memory accelerator").
//!
//! The flash gives a double word at a time and makes whoever wants one wait for the states of its latency.
//! A cache of 1 KB keeps instructions, one of 256 bytes data, both in lines of four double words, the line
//! used least recently giving way. With the prefetch on, the double word behind the last one fetched is read while the core
//! executes that one.
//!
//! RM0440 does not say whether a line is one place or four, nor whether a prefetch that nobody wants any more
//! is broken off; [`Timing`] holds what is assumed.

use super::Timing;
use crate::chip::flash::{self, Flash};

/// Bytes that the flash gives at once.
const DOUBLE_WORD: u32 = 8;
const INSTRUCTION_CACHE: u32 = 1024;
const DATA_CACHE: u32 = 256;

/// How the firmware has set the flash up (FLASH_ACR).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Access {
    /// Wait states.
    pub(crate) latency: u32,
    /// Whether the next instructions are read ahead.
    pub(crate) prefetches: bool,
    /// Whether instructions are kept.
    pub(crate) caches_instructions: bool,
    /// Whether data are kept.
    pub(crate) caches_data: bool,
}

impl Access {
    /// As the firmware has it now.
    pub(crate) fn of(flash: &Flash) -> Self {
        let [prefetches, caches_instructions, caches_data] = flash.accelerates();
        Self { latency: flash.latency(), prefetches, caches_instructions, caches_data }
    }
}

/// The port with its caches.
#[derive(Clone)]
pub(super) struct FlashPort {
    access: Access,
    finishes_prefetch: bool,
    instructions: Cache,
    data: Cache,
    /// The double words that were read last: of code, and of data.
    current: [u32; 2],
    /// What is read ahead, and at which cycle it is there.
    ahead: Option<(u32, u64)>,
}

#[derive(Clone)]
struct Cache {
    /// Bits of an address within a line.
    line_bits: u32,
    /// Place of each line of the flash in the cache, one more; 0 where it is not there.
    place_of: Vec<u8>,
    lines: Vec<Line>,
}

#[derive(Clone, Copy, Default)]
struct Line {
    /// Line of the flash.
    number: u32,
    /// Which of its double words are there.
    valid: u8,
    used: u64,
}

impl FlashPort {
    pub(super) fn new(timing: &Timing) -> Self {
        Self {
            access: Access::default(),
            finishes_prefetch: timing.finishes_prefetch,
            instructions: Cache::new(INSTRUCTION_CACHE, timing.line_bytes),
            data: Cache::new(DATA_CACHE, timing.line_bytes),
            current: [u32::MAX; 2],
            ahead: None,
        }
    }

    pub(super) fn set_up(&mut self, access: Access) {
        self.access = access;
    }

    /// Cycles that the core waits at cycle `now` for a double word of code.
    pub(super) fn fetch(&mut self, address: u32, now: u64) -> u64 {
        if self.current[0] == address {
            return 0;
        }
        self.current[0] = address;
        if self.access.caches_instructions && self.instructions.holds(address, now) {
            return 0;
        }
        let wait = match self.ahead.take() {
            Some((ahead, ready)) if ahead == address => ready.saturating_sub(now),
            other => self.read(other, now),
        };
        if self.access.caches_instructions {
            self.instructions.keep(address, now);
        }
        if self.access.prefetches {
            let next = address + DOUBLE_WORD;
            self.ahead = Some((next, now + wait + u64::from(self.access.latency) + 1));
        }
        wait
    }

    /// Cycles that the core waits at cycle `now` for data.
    pub(super) fn load(&mut self, address: u32, bytes: u32, now: u64) -> u64 {
        let (first, last) = (address & !(DOUBLE_WORD - 1), (address + bytes - 1) & !(DOUBLE_WORD - 1));
        let mut wait = self.load_double_word(first, now);
        if last != first {
            wait += self.load_double_word(last, now + wait);
        }
        wait
    }

    fn load_double_word(&mut self, address: u32, now: u64) -> u64 {
        if self.current[1] == address {
            return 0;
        }
        self.current[1] = address;
        if self.access.caches_data && self.data.holds(address, now) {
            return 0;
        }
        let wait = self.read(self.ahead, now);
        if self.access.caches_data {
            self.data.keep(address, now);
        }
        wait
    }

    /// Cycles of a read, which may have to wait for the end of a prefetch.
    fn read(&self, ahead: Option<(u32, u64)>, now: u64) -> u64 {
        let rest = ahead.map_or(0, |(_, ready)| ready.saturating_sub(now));
        u64::from(self.access.latency) + if self.finishes_prefetch { rest } else { 0 }
    }
}

impl Cache {
    fn new(bytes: u32, line_bytes: u32) -> Self {
        let lines = (bytes / line_bytes) as usize;
        Self {
            line_bits: line_bytes.trailing_zeros(),
            place_of: vec![0; (flash::BYTES / line_bytes) as usize],
            lines: vec![Line { number: u32::MAX, ..Line::default() }; lines],
        }
    }

    /// Line of the flash that an address belongs to, and the bit of its double word in there.
    fn find(&self, address: u32) -> (u32, u8) {
        let offset = (address - flash::START) % flash::BYTES;
        let within = offset & ((1 << self.line_bits) - 1);
        (offset >> self.line_bits, 1 << (within / DOUBLE_WORD))
    }

    fn holds(&mut self, address: u32, now: u64) -> bool {
        let (number, bit) = self.find(address);
        let place = usize::from(self.place_of[number as usize]);
        let Some(line) = place.checked_sub(1).map(|place| &mut self.lines[place]) else { return false };
        line.used = now + 1;
        line.valid & bit != 0
    }

    fn keep(&mut self, address: u32, now: u64) {
        let (number, bit) = self.find(address);
        let place = match self.place_of[number as usize] {
            0 => self.replace(number),
            place => usize::from(place) - 1,
        };
        let line = &mut self.lines[place];
        line.valid |= bit;
        line.used = now + 1;
    }

    /// Gives the line that was used least recently to another; says which place that is.
    fn replace(&mut self, number: u32) -> usize {
        let oldest = (0..self.lines.len()).min_by_key(|&place| self.lines[place].used).unwrap_or(0);
        let old = std::mem::replace(&mut self.lines[oldest], Line { number, ..Line::default() });
        if let Some(place) = self.place_of.get_mut(old.number as usize) {
            *place = 0;
        }
        self.place_of[number as usize] = oldest as u8 + 1;
        oldest
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const CODE: u32 = flash::START;

    fn port(timing: Timing, prefetches: bool) -> FlashPort {
        let mut port = FlashPort::new(&timing);
        port.set_up(Access { latency: 4, prefetches, caches_instructions: true, caches_data: true });
        port
    }

    #[test]
    fn a_double_word_is_waited_for_once_and_then_kept() {
        let mut port = port(Timing::PESSIMISTIC, false);
        let mut fetch = |offset: u32, now| port.fetch(CODE + offset, now);
        assert_eq!([fetch(0, 0), fetch(8, 10), fetch(0, 20), fetch(8, 30)], [4, 4, 0, 0]);
    }

    #[test]
    fn the_cache_holds_a_kilobyte_and_forgets_what_was_used_least_recently() {
        for timing in [Timing::PESSIMISTIC, Timing::OPTIMISTIC] {
            let mut port = port(timing, false);
            let mut run = |bytes: u32, from: u64| -> u64 {
                (0..bytes / 8).map(|word| port.fetch(CODE + 8 * word, from + u64::from(word))).sum()
            };
            assert_eq!([run(1024, 0), run(1024, 1000)], [4 * 128, 0]);
            // One line more, in a circle, is never there when it is wanted.
            assert_eq!([run(1056, 2000), run(1056, 3000)], [4 * 4, 4 * 132]);
        }
    }

    #[test]
    fn what_is_read_ahead_is_waited_for_less() {
        let mut port = port(Timing::PESSIMISTIC, true);
        assert_eq!(port.fetch(CODE, 0), 4);
        // There since cycle 9: fetched at 4, the next 5 cycles later.
        assert_eq!(port.fetch(CODE + 8, 6), 3);
        assert_eq!(port.fetch(CODE + 16, 30), 0);
        // Data behind a prefetch: it ends first, or is broken off.
        assert_eq!(port.load(CODE + 4096, 4, 32), 4 + 3);
        let mut fast = self::port(Timing::OPTIMISTIC, true);
        fast.fetch(CODE, 0);
        assert_eq!(fast.load(CODE + 4096, 4, 6), 4);
    }

    #[test]
    fn data_that_follow_one_another_wait_for_each_double_word() {
        let mut port = port(Timing::PESSIMISTIC, true);
        let waits: u64 = (0..52).map(|word| port.load(CODE + 4096 + 4 * word, 4, u64::from(word))).sum();
        assert_eq!(waits, 26 * 4);
        // A word that lies in two of them.
        assert_eq!(port.load(CODE + 8192 + 6, 4, 100), 8);
    }
}
