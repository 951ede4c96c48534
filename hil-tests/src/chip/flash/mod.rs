//! FLASH: 512 KiB in two banks of 128 pages of 2 KiB (RM0440 chapter 3, category 3 devices; DBANK = 1).
//!
//! What is modelled: the key sequence, page erase ("Flash main memory erase
//! sequences") and double-word programming ("standard programming") with their error flags and their times, ECC ("Error code correction"): a double word left half programmed by
//! a power cut reads as a double error, which sets ECCD and raises NMI. While a bank is busy, code
//! that runs from it stands still; data reads from a busy bank are not held up.

use super::{
    bank::Bank,
    map::{Field, Register},
    misuse::Misuse,
    peripheral::{Moment, Peripheral, has_bank},
    time::Time,
};
use rand::{Rng, SeedableRng};
use rand_pcg::Pcg32;
use std::{collections::BTreeSet, ops::Range};

/// Where the flash lies.
pub const START: u32 = 0x0800_0000;
/// Bytes of flash.
pub const BYTES: u32 = 512 * 1024;
/// Bytes of one page.
pub const PAGE: u32 = 2048;
const BANK: u32 = BYTES / 2;
/// Typical time to erase a page (DS12288, "Flash memory characteristics").
pub const ERASE_TIME: Time = Time::from_micros(22_020);
/// Typical time to program a double word (the same table: 81.69 us).
pub const PROGRAM_TIME: Time = Time::from_micros(82);

/// An operation under way.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Operation {
    /// Erasing the page that starts at this address.
    Erase(u32),
    /// Programming the double word at this address.
    Program(u32, u64),
}

impl Operation {
    fn address(self) -> u32 {
        match self {
            Self::Erase(address) | Self::Program(address, _) => address,
        }
    }

    fn time(self) -> Time {
        match self {
            Self::Erase(_) => ERASE_TIME,
            Self::Program(..) => PROGRAM_TIME,
        }
    }
}

/// Model of the flash and its controller.
#[derive(Clone, Debug)]
pub struct Flash {
    bank: Bank,
    access: AccessFields,
    content: Vec<u8>,
    /// Double words whose ECC does not fit, by address.
    damaged: BTreeSet<u32>,
    changed: Option<Range<u32>>,
    keys: u8,
    first_word: Option<(u32, u32)>,
    operation: Option<(Operation, Time)>,
    operations: u64,
    stuck: bool,
    nmi: bool,
}

/// Fields of the access control register, which the core asks for at every step.
#[derive(Clone, Debug)]
struct AccessFields {
    latency: Field,
    /// Prefetch, cache of instructions, cache of data.
    on: [Field; 3],
}

impl Default for Flash {
    fn default() -> Self {
        let bank = Bank::new(
            "FLASH",
            &[("ACR", 0x0004_0600), ("CR", 0xC000_0000), ("OPTR", 0xFFEF_F8AA & 0x7FDF_77FF | 1 << 22)],
        );
        let of_access = |field| bank.find("ACR", field);
        Self {
            access: AccessFields {
                latency: of_access("LATENCY"),
                on: ["PRFTEN", "ICEN", "DCEN"].map(of_access),
            },
            bank,
            content: vec![0xFF; BYTES as usize],
            damaged: BTreeSet::new(),
            changed: None,
            keys: 0,
            first_word: None,
            operation: None,
            operations: 0,
            stuck: false,
            nmi: false,
        }
    }
}

impl Flash {
    /// All bytes.
    #[must_use]
    pub fn content(&self) -> &[u8] {
        &self.content
    }

    /// Puts bytes there as a debug probe does, ECC and all.
    pub fn load(&mut self, address: u32, bytes: &[u8]) {
        let start = (address - START) as usize;
        self.content[start..start + bytes.len()].copy_from_slice(bytes);
        self.touch(address..address + bytes.len() as u32);
    }

    /// Takes what another flash holds, which differs at these addresses at most; keeps how its own controller is
    /// set up.
    pub fn take_content(&mut self, other: Self, changed: Range<u32>) {
        (self.content, self.damaged) = (other.content, other.damaged);
        self.touch(changed);
    }

    /// Whether both hold the same outside of these addresses, errors included.
    #[must_use]
    pub fn is_same_outside(&self, range: &Range<u32>, other: &Self) -> bool {
        let (start, end) = ((range.start - START) as usize, (range.end - START) as usize);
        let outside = |flash: &Self| flash.damaged.iter().all(|address| range.contains(address));
        self.content[..start] == other.content[..start]
            && self.content[end..] == other.content[end..]
            && outside(self)
            && outside(other)
    }

    /// Addresses whose content changed since it was asked last.
    pub fn take_changed(&mut self) -> Option<Range<u32>> {
        self.changed.take()
    }

    /// Operations started since the chip was made.
    #[must_use]
    pub fn operations(&self) -> u64 {
        self.operations
    }

    /// The operation under way.
    #[must_use]
    pub fn operation(&self) -> Option<Operation> {
        self.operation.map(|(operation, _)| operation)
    }

    /// Wait states that the core clock needs at the voltage of range 1 boost: ACR.LATENCY, "read access
    /// latency".
    #[must_use]
    pub fn needed_latency(core: u64) -> u32 {
        (core.saturating_sub(1) / 34_000_000) as u32
    }

    /// Wait states that are set.
    #[must_use]
    pub fn latency(&self) -> u32 {
        self.bank.at(self.access.latency)
    }

    /// Whether the prefetch, the cache of instructions and the cache of data are on.
    #[must_use]
    pub fn accelerates(&self) -> [bool; 3] {
        self.access.on.map(|field| self.bank.at(field) != 0)
    }

    /// Code from the first to the last of these addresses stands still until then ("erase sequences").
    #[must_use]
    pub fn stalled_code(&self) -> Option<(u32, u32, Time)> {
        let (operation, end) = self.operation?;
        let first = START + (operation.address() - START) / BANK * BANK;
        Some((first, first + BANK - 1, end))
    }

    /// Whether a read of these bytes meets an ECC error, for which the chip raises NMI.
    pub fn check_read(&mut self, address: u32, bytes: u32) -> bool {
        let first = address & !7;
        let hit = self.damaged.range(first..address + bytes).next().copied();
        let Some(at) = hit else { return false };
        let offset = at - START;
        self.bank.set("ECCR", "ADDR_ECC", (offset % BANK) / 8);
        self.bank.set("ECCR", "BK_ECC", offset / BANK);
        self.bank.set("ECCR", "ECCD", 1);
        self.nmi = true;
        true
    }

    /// Whether it asks for NMI.
    #[must_use]
    pub fn raises_nmi(&self) -> bool {
        self.nmi && self.bank.is_set("ECCR", "ECCD")
    }

    /// Ranges whose reads meet ECC errors.
    #[must_use]
    pub fn damaged(&self) -> Vec<u32> {
        self.damaged.iter().copied().collect()
    }

    /// From now on no operation ends: the busy flag is stuck.
    pub fn stick(&mut self) {
        self.stuck = true;
        if let Some((_, end)) = &mut self.operation {
            *end = Time::NEVER;
        }
    }

    /// Power fails: an operation under way leaves its page or double word undefined.
    pub fn cut(&mut self, seed: u64) {
        let mut random = Pcg32::seed_from_u64(seed);
        match self.operation() {
            Some(Operation::Erase(page)) => {
                for address in (page..page + PAGE).step_by(8) {
                    self.scramble(address, u64::MAX, &mut random);
                }
            }
            Some(Operation::Program(address, value)) => self.scramble(address, value, &mut random),
            None => {}
        }
        self.stuck = false;
        self.reset();
    }

    /// Leaves a double word as it was, as it was to be, or with any of the differing bits done.
    fn scramble(&mut self, address: u32, target: u64, random: &mut Pcg32) {
        let old = self.double_word(address);
        let (new, is_damaged) = match random.random_range(0..4) {
            0 => (old, self.damaged.contains(&address)),
            1 => (target, false),
            _ => {
                let done: u64 = random.random();
                let mixed = (old & !done) | (target & done);
                (mixed, mixed != old && mixed != target)
            }
        };
        self.put(address, new);
        if is_damaged {
            self.damaged.insert(address)
        } else {
            self.damaged.remove(&address)
        };
    }

    /// The CPU or the DMA stores to the flash (SR.PGSERR and CR.PG): two words make a double word.
    pub fn write_word(&mut self, address: u32, size: u32, value: u32, at: Moment) -> Result<(), Misuse> {
        if self.operation.is_some() {
            return Err(Misuse::rule("FLASH", "the flash is written while BSY is 1 (SR.PGSERR and CR.PG)"));
        }
        if !self.bank.is_set("CR", "PG") || self.has_errors() {
            self.flag("PGSERR");
        } else if size != 4 {
            self.flag("SIZERR");
        } else if let Some((first, low)) = self.first_word.take() {
            if address == first + 4 {
                self.program(first, u64::from(low) | u64::from(value) << 32, at.now);
            } else {
                self.flag("PGAERR");
            }
        } else if address.is_multiple_of(8) {
            self.first_word = Some((address, value));
        } else {
            self.flag("PGAERR");
        }
        // What the core stored is not what the flash holds.
        self.touch(address & !7..(address & !7) + 8);
        Ok(())
    }

    fn program(&mut self, address: u32, value: u64, now: Time) {
        let erased = self.double_word(address) == u64::MAX && !self.damaged.contains(&address);
        // Zeros may be written over anything (SR.PGSERR and CR.PG).
        if !erased && value != 0 {
            self.flag("PROGERR");
            return;
        }
        self.start(Operation::Program(address, value), now);
    }

    fn start(&mut self, operation: Operation, now: Time) {
        self.operations += 1;
        let end = if self.stuck { Time::NEVER } else { now + operation.time() };
        self.operation = Some((operation, end));
    }

    fn start_erase(&mut self, now: Time) -> Result<(), Misuse> {
        if !self.bank.is_set("CR", "PER") {
            return Err(Misuse::rule("FLASH", "CR.STRT without CR.PER: mass erase is not modelled"));
        }
        let page = self.bank.get("CR", "PNB") + self.bank.get("CR", "BKER") * (BANK / PAGE);
        self.start(Operation::Erase(START + page * PAGE), now);
        Ok(())
    }

    fn finish(&mut self, operation: Operation) {
        match operation {
            Operation::Erase(page) => {
                (page..page + PAGE).step_by(8).for_each(|address| self.put(address, u64::MAX));
                self.damaged.retain(|address| !(page..page + PAGE).contains(address));
                self.bank.set("CR", "STRT", 0);
            }
            Operation::Program(address, value) => {
                self.put(address, value);
                self.damaged.remove(&address);
            }
        }
        if self.bank.is_set("CR", "EOPIE") {
            self.flag("EOP");
        }
    }

    fn double_word(&self, address: u32) -> u64 {
        let start = (address - START) as usize;
        u64::from_le_bytes(self.content[start..start + 8].try_into().unwrap_or([0xFF; 8]))
    }

    fn put(&mut self, address: u32, value: u64) {
        let start = (address - START) as usize;
        self.content[start..start + 8].copy_from_slice(&value.to_le_bytes());
        self.touch(address..address + 8);
    }

    fn touch(&mut self, range: Range<u32>) {
        self.changed = Some(match self.changed.take() {
            Some(old) => old.start.min(range.start)..old.end.max(range.end),
            None => range,
        });
    }

    fn flag(&mut self, field: &str) {
        self.bank.set("SR", field, 1);
    }

    fn has_errors(&self) -> bool {
        self.bank.word("SR", 0) & 0x0000_C3FA != 0
    }

    fn key(&mut self, key: u32) -> Result<(), Misuse> {
        match (self.keys, key) {
            (0, 0x4567_0123) => self.keys = 1,
            (1, 0xCDEF_89AB) => {
                self.keys = 0;
                self.bank.set("CR", "LOCK", 0);
            }
            _ => return Err(Misuse::rule("FLASH", "a wrong key locks the flash until reset (KEYR)")),
        }
        Ok(())
    }
}

impl Peripheral for Flash {
    has_bank!();

    fn models(&self, register: &Register) -> bool {
        matches!(register.name.as_str(), "ACR" | "KEYR" | "SR" | "CR" | "ECCR" | "OPTR")
    }

    fn read(&mut self, register: &Register, _: Moment) -> u32 {
        let value = self.bank.value(register);
        match register.name.as_str() {
            "SR" => register.with(value, "BSY", u32::from(self.operation.is_some())),
            _ => value,
        }
    }

    fn write(&mut self, register: &Register, value: u32, at: Moment) -> Result<(), Misuse> {
        let old = self.bank.value(register);
        match register.name.as_str() {
            "KEYR" => return self.key(value),
            "SR" => self.bank.store(register, old & !value),
            // ECCC and ECCD are cleared by writing 1 (ECCR).
            "ECCR" => {
                self.bank
                    .store(register, (old & !(value & 0xF000_0000) & !0x0100_0000) | (value & 0x0100_0000));
                self.nmi = false;
            }
            "CR" if register.get(old, "LOCK") == 1 => {
                return Err(Misuse::rule("FLASH", "CR is written while locked (KEYR)"));
            }
            "CR" if self.operation.is_some() => {
                return Err(Misuse::rule("FLASH", "CR is written while BSY is 1 (SR.BSY)"));
            }
            "CR" => {
                self.bank.store(register, value);
                if register.get(value, "STRT") == 1 {
                    return self.start_erase(at.now);
                }
            }
            "OPTR" => return Err(Misuse::rule("FLASH", "option bytes are not modelled")),
            _ => self.bank.store(register, value),
        }
        Ok(())
    }

    fn next_event(&self) -> Time {
        self.operation.map_or(Time::NEVER, |(_, end)| end)
    }

    fn advance(&mut self, at: Moment) -> Result<(), Misuse> {
        if let Some((operation, _)) = self.operation.take_if(|(_, end)| at.now >= *end) {
            self.finish(operation);
        }
        Ok(())
    }

    fn interrupts(&self, signal: &str) -> bool {
        signal == "GLOBAL" && self.bank.is_set("CR", "EOPIE") && self.bank.is_set("SR", "EOP")
    }

    fn reset(&mut self) {
        let (content, damaged) = (std::mem::take(&mut self.content), std::mem::take(&mut self.damaged));
        let (changed, operations) = (Some(START..START + BYTES), self.operations);
        *self = Self { content, damaged, changed, operations, ..Self::default() };
    }
}

#[cfg(test)]
mod tests;
