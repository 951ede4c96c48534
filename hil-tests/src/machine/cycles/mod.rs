//! Cycles: how long the core takes for what it executes.
//!
//! Instructions take the cycles of Arm's manual (`instructions`), code and data in the flash the waits of
//! its port (`flash`). Where the manuals give a range or nothing, [`Timing`] says what is assumed: two
//! variants, between which the chip is expected.

mod flash;
mod instructions;

pub(crate) use flash::Access;

use crate::chip::flash::{BYTES, START};
use flash::FlashPort;
use instructions::{Decoder, Piece, Walk};
use serde::Deserialize;

/// What manuals leave open.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(from = "Variant")]
pub struct Timing {
    /// Cycles that a taken branch adds: 1 to 3 (100166_0001, table 3-1, P).
    refill: u32,
    /// Cycles of a store that nothing overlaps with: 2, or 1 (section 3.3.3).
    store: u32,
    /// Cycles of an IT: 1, or none where it is folded into what is before.
    condition: u32,
    /// Cycles of a division: 2 to 12.
    divide: u32,
    /// Cycles that a barrier adds.
    barrier: u32,
    /// Cycles that the core takes to enter a handler, and to leave it, without waits.
    exception: u32,
    /// Whether the floating-point registers are saved and restored, a cycle each, wherever they are in use,
    /// though the core saves them only once a handler uses its own.
    saves_floats: bool,
    /// Cycles that the core waits for a register behind the APB bridge.
    peripheral: u32,
    /// Cycles that the core waits for each transfer of the DMA.
    transfer: u32,
    /// Bytes that a cache forgets at once.
    line_bytes: u32,
    /// Whether a read has to wait for the end of a prefetch.
    finishes_prefetch: bool,
}

/// The variants of [`Timing`] by name.
#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(rename_all = "lowercase")]
enum Variant {
    Pessimistic,
    Optimistic,
}

impl From<Variant> for Timing {
    fn from(variant: Variant) -> Self {
        match variant {
            Variant::Pessimistic => Self::PESSIMISTIC,
            Variant::Optimistic => Self::OPTIMISTIC,
        }
    }
}

impl Timing {
    /// The slow end of what is open.
    pub const PESSIMISTIC: Self = Self {
        refill: 3,
        store: 2,
        condition: 1,
        divide: 12,
        barrier: 4,
        exception: 12,
        saves_floats: true,
        peripheral: 4,
        transfer: 1,
        line_bytes: 32,
        finishes_prefetch: true,
    };

    /// The fast end of what is open.
    pub const OPTIMISTIC: Self = Self {
        refill: 1,
        store: 1,
        condition: 0,
        divide: 2,
        barrier: 0,
        exception: 12,
        saves_floats: false,
        peripheral: 1,
        transfer: 0,
        line_bytes: 8,
        finishes_prefetch: false,
    };
}

/// Code that unicorn runs at once.
struct Block {
    address: u32,
    size: u32,
    pieces: Vec<Piece>,
    walks: Vec<Walk>,
    effects: Effects,
}

/// What a block does beside taking time.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Effects {
    /// It has an SEV.
    pub(super) sends_event: bool,
    /// It is a branch to itself.
    pub(super) is_circle: bool,
    /// It has an IT.
    pub(super) has_conditions: bool,
}

/// What is asked of the core whose cycles are counted.
pub(super) trait Core {
    /// So many bytes of code.
    fn code(&self, address: u32, size: u32) -> Vec<u8>;
    /// A register, R0 to R12.
    fn register(&self, number: usize) -> u32;
}

/// Counts the cycles of one core.
pub(super) struct Counter {
    timing: Timing,
    decoder: Decoder,
    port: FlashPort,
    /// Blocks that were run, each where its address says, unless another took its place.
    blocks: Vec<Option<Block>>,
    /// Where the code goes on if no branch is taken.
    follows: u32,
    cycles: u64,
}

/// A counter at one moment.
pub(super) struct CounterSnapshot {
    port: FlashPort,
    follows: u32,
    cycles: u64,
}

impl Counter {
    pub(super) fn new(timing: Timing) -> Self {
        Self {
            timing,
            decoder: Decoder::new(),
            port: FlashPort::new(&timing),
            blocks: no_blocks(),
            follows: 0,
            cycles: 0,
        }
    }

    /// Cycles so far.
    pub(super) fn cycles(&self) -> u64 {
        self.cycles
    }

    /// The firmware may have set up the flash anew.
    pub(super) fn set_up(&mut self, access: Access) {
        self.port.set_up(access);
    }

    /// How it is now. Which code is where is not part of it.
    pub(super) fn snapshot(&self) -> CounterSnapshot {
        CounterSnapshot { port: self.port.clone(), follows: self.follows, cycles: self.cycles }
    }

    /// Goes on from there.
    pub(super) fn restore(&mut self, from: &CounterSnapshot) {
        (self.port, self.follows, self.cycles) = (from.port.clone(), from.follows, from.cycles);
    }

    /// Other code may lie where some lay.
    pub(super) fn forget_code(&mut self) {
        self.blocks = no_blocks();
        self.port = FlashPort::new(&self.timing);
    }

    /// Runs a block of this code: its cycles, and what else it does. `core` tells what is asked of the core.
    pub(super) fn run(&mut self, address: u32, size: u32, core: &impl Core) -> (u64, Effects) {
        let start = self.cycles;
        if address != self.follows {
            self.cycles += u64::from(self.timing.refill);
        }
        self.follows = address + size;
        let place = (address / 2) as usize % self.blocks.len();
        let known = self.blocks[place].take().filter(|block| (block.address, block.size) == (address, size));
        let block = known.unwrap_or_else(|| self.read(address, size, &core.code(address, size)));
        for piece in &block.pieces {
            if lies_in_flash(piece.address) {
                self.cycles += self.port.fetch(piece.address, self.cycles);
            }
            self.cycles += u64::from(piece.cycles);
        }
        for walk in &block.walks {
            let start = core.register(walk.register);
            let at = |offset: i32| start.wrapping_add_signed(offset);
            let unaligned = walk.accesses.iter().map(|&(offset, bytes)| unaligned(at(offset), bytes));
            self.cycles += unaligned.sum::<u64>();
        }
        let effects = block.effects;
        self.blocks[place] = Some(block);
        (self.cycles - start, effects)
    }

    fn read(&self, address: u32, size: u32, code: &[u8]) -> Block {
        let (pieces, walks) = self.decoder.read(code, address, &self.timing);
        Block { address, size, pieces, walks, effects: instructions::effects(code) }
    }

    /// Cycles that a load from the flash waits.
    pub(super) fn load(&mut self, address: u32, bytes: u32) -> u64 {
        let waits = self.port.load(address, bytes, self.cycles);
        self.spend(waits)
    }

    /// Cycles that an access to a register of a peripheral takes beside its own.
    pub(super) fn reach(&mut self, address: u32) -> u64 {
        let is_behind_bridge = (0x4000_0000..0x4002_0000).contains(&address);
        self.spend(if is_behind_bridge { self.timing.peripheral.into() } else { 0 })
    }

    /// Cycles of an exception that is taken, or of a handler that returns.
    pub(super) fn change_context(&mut self, uses_floats: bool) -> u64 {
        // S0 to S15 and FPSCR.
        let floats = if uses_floats && self.timing.saves_floats { 17 } else { 0 };
        self.follows = u32::MAX;
        self.spend(u64::from(self.timing.exception) + floats)
    }

    /// Cycles that the DMA takes from the core.
    pub(super) fn give_way(&mut self, transfers: u64) -> u64 {
        self.spend(transfers * u64::from(self.timing.transfer))
    }

    fn spend(&mut self, cycles: u64) -> u64 {
        self.cycles += cycles;
        cycles
    }
}

/// Cycles that a load or store takes more where it does not lie aligned ("Load/store timings").
fn unaligned(address: u32, bytes: u32) -> u64 {
    match bytes {
        4.. => [0, 2, 1, 2][(address & 3) as usize],
        2 => u64::from(address & 1),
        _ => 0,
    }
}

/// Room for a block at each halfword of the flash.
fn no_blocks() -> Vec<Option<Block>> {
    std::iter::repeat_with(|| None).take((BYTES / 2) as usize).collect()
}

fn lies_in_flash(address: u32) -> bool {
    (START..START + BYTES).contains(&address)
}

#[cfg(test)]
mod tests;
