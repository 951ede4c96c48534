//! A firmware's ELF, checked before any board is touched: that it is for this chip, can start, and leaves
//! the patch slots alone. `firmware/check-elf` checks the same, and more, when the firmware is built.

use object::{
    Architecture, Endianness, Object, ObjectKind, ObjectSymbol,
    elf::{PF_X, PT_LOAD},
    read::elf::{ElfFile32, ProgramHeader},
};
use std::{
    io,
    ops::Range,
    path::{Path, PathBuf},
};

/// The chip's flash: 512 KiB.
const FLASH: Range<u64> = 0x0800_0000..0x0808_0000;

/// Where the trim and behind it the patch slots begin; the firmware lies before (`firmware/memory/nucleo-g474re.x`).
const PATCH_SLOTS: u64 = 0x0802_3000;

/// Addresses that the initial stack pointer may have: just beyond a word of the 128 KiB of RAM.
const STACK_TOPS: Range<u64> = 0x2000_0008..0x2002_0001;

/// A firmware that a board can run.
#[derive(Clone, Debug)]
pub struct Firmware {
    elf: Vec<u8>,
    segments: Vec<Segment>,
    rtt_control_block: Option<u64>,
}

/// Bytes to program.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Segment {
    /// Where they go in the flash.
    pub address: u64,
    /// What goes there; never empty.
    pub bytes: Vec<u8>,
    executable: bool,
}

/// Why a file is no firmware for the board.
#[derive(Debug, thiserror::Error)]
pub enum FirmwareError {
    /// The file cannot be read.
    #[error("cannot read firmware `{}`: {reason}; `firmware/build` makes it", path.display())]
    Read {
        /// Which file.
        path: PathBuf,
        /// What the system says.
        reason: io::Error,
    },
    /// The file was read, but must not go to a board.
    #[error("firmware `{}` {fault}", path.display())]
    Unfit {
        /// Which file.
        path: PathBuf,
        /// What is wrong with it.
        fault: Fault,
    },
}

/// What is wrong with an ELF. The words go on after the file's name.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum Fault {
    /// Not an ELF at all, or damaged.
    #[error("is no sound ELF file ({reason}); give the one that `firmware/build` makes")]
    NotElf {
        /// What the reader stumbled over.
        reason: String,
    },
    /// For another processor.
    #[error(
        "is built for {found}, but the board's STM32G474 needs little-endian 32-bit Arm; build it with \
         `firmware/build`"
    )]
    Architecture {
        /// What it is for.
        found: String,
    },
    /// An object file, a library or a core dump.
    #[error("is no program: its ELF type is {found}, allowed is Executable; it may not have been linked")]
    NotExecutable {
        /// What it is.
        found: String,
    },
    /// No bytes for the flash.
    #[error("holds nothing to program")]
    Empty,
    /// Would go where the chip has no flash.
    #[error(
        "would be programmed to {:#010x}..{:#010x}, outside the chip's flash ({:#010x}..{:#010x}): is it for \
         another chip?", range.start, range.end, FLASH.start, FLASH.end
    )]
    OutsideFlash {
        /// First address, and the one behind the last.
        range: Range<u64>,
    },
    /// Would overwrite what the board keeps.
    #[error(
        "would be programmed to {:#010x}..{:#010x}, into the trim and the patch slots, which start at {PATCH_SLOTS:#010x}: \
         link it with `firmware/memory/nucleo-g474re.x`", range.start, range.end
    )]
    PatchSlots {
        /// First address, and the one behind the last.
        range: Range<u64>,
    },
    /// Two segments want the same bytes.
    #[error("would program {:#010x}..{:#010x} twice: its segments overlap", range.start, range.end)]
    Overlap {
        /// First address that both have, and the one behind the last.
        range: Range<u64>,
    },
    /// Nothing where the core looks for its first two words.
    #[error("has no vector table at {:#010x}, where the chip starts", FLASH.start)]
    NoVectorTable,
    /// The first word of the vector table.
    #[error(
        "starts with its stack at {stack:#010x}; allowed are multiples of 8 from {:#010x} to {:#010x}",
        STACK_TOPS.start, STACK_TOPS.end - 1
    )]
    Stack {
        /// Initial stack pointer.
        stack: u64,
    },
    /// The second word of the vector table.
    #[error("starts at {reset:#010x}, which is not Thumb code of its own")]
    Reset {
        /// Reset vector, with its Thumb bit if it has it.
        reset: u64,
    },
}

impl Firmware {
    /// Reads an ELF and checks it.
    pub fn load(path: &Path) -> Result<Self, FirmwareError> {
        let path = || path.to_owned();
        let elf = std::fs::read(path()).map_err(|reason| FirmwareError::Read { path: path(), reason })?;
        Self::new(elf).map_err(|fault| FirmwareError::Unfit { path: path(), fault })
    }

    /// Checks the bytes of an ELF.
    pub fn new(elf: Vec<u8>) -> Result<Self, Fault> {
        let program = program(&elf)?;
        let segments = segments(&program)?;
        segments.iter().try_for_each(check_place)?;
        check_apart(&segments)?;
        check_start(&segments)?;
        let control_block = program.symbols().find(|symbol| symbol.name() == Ok("_SEGGER_RTT"));
        let rtt_control_block = control_block.map(|symbol| symbol.address());
        Ok(Self { elf, segments, rtt_control_block })
    }

    /// What is to be programmed, in the file's order.
    #[must_use]
    pub fn segments(&self) -> &[Segment] {
        &self.segments
    }

    /// Bytes to program, without the gaps between segments.
    #[must_use]
    pub fn size(&self) -> usize {
        self.segments.iter().map(|segment| segment.bytes.len()).sum()
    }

    /// The whole file, which also holds the texts of the log.
    #[must_use]
    pub fn elf(&self) -> &[u8] {
        &self.elf
    }

    /// Address of the first symbol whose name holds `part`; compilers lengthen names.
    #[must_use]
    pub fn symbol(&self, part: &str) -> Option<u64> {
        let program = program(&self.elf).ok()?;
        let mut symbols = program.symbols();
        symbols
            .find(|symbol| symbol.name().is_ok_and(|name| name.contains(part)))
            .map(|found| found.address())
    }

    /// Where in RAM the firmware announces its log, if it does.
    #[must_use]
    pub fn rtt_control_block(&self) -> Option<u64> {
        self.rtt_control_block
    }
}

impl Segment {
    fn range(&self) -> Range<u64> {
        self.address..self.address + self.bytes.len() as u64
    }
}

/// The file as a program for the chip's processor.
fn program(elf: &[u8]) -> Result<ElfFile32<'_>, Fault> {
    let file = object::File::parse(elf).map_err(|error| Fault::NotElf { reason: error.to_string() })?;
    let endian = if file.is_little_endian() { "" } else { "big-endian " };
    let found = format!("{endian}{:?}", file.architecture());
    match file {
        object::File::Elf32(elf) if elf.architecture() == Architecture::Arm && elf.is_little_endian() => {
            match elf.kind() {
                ObjectKind::Executable => Ok(elf),
                kind => Err(Fault::NotExecutable { found: format!("{kind:?}") }),
            }
        }
        _ => Err(Fault::Architecture { found }),
    }
}

/// What the file wants to have in the chip's memory when it starts, by load address.
fn segments(program: &ElfFile32<'_>) -> Result<Vec<Segment>, Fault> {
    let endian: Endianness = program.endian();
    let mut segments = Vec::new();
    for header in program.elf_program_headers() {
        if header.p_type(endian) != PT_LOAD || header.p_filesz(endian) == 0 {
            continue;
        }
        let address = u64::from(header.p_paddr(endian));
        let cut = |()| Fault::NotElf { reason: format!("the bytes for {address:#010x} are cut off") };
        let bytes = header.data(endian, program.data()).map_err(cut)?.to_vec();
        segments.push(Segment { address, bytes, executable: header.p_flags(endian) & PF_X != 0 });
    }
    if segments.is_empty() { Err(Fault::Empty) } else { Ok(segments) }
}

fn check_place(segment: &Segment) -> Result<(), Fault> {
    let range = segment.range();
    if range.start < FLASH.start || range.end > FLASH.end {
        return Err(Fault::OutsideFlash { range });
    }
    if range.end > PATCH_SLOTS {
        return Err(Fault::PatchSlots { range });
    }
    Ok(())
}

fn check_apart(segments: &[Segment]) -> Result<(), Fault> {
    let mut ranges: Vec<_> = segments.iter().map(Segment::range).collect();
    ranges.sort_by_key(|range| range.start);
    for pair in ranges.windows(2) {
        let range = pair[1].start..pair[0].end.min(pair[1].end);
        if !range.is_empty() {
            return Err(Fault::Overlap { range });
        }
    }
    Ok(())
}

/// The core loads its stack pointer and its first address from the first two words of the flash.
fn check_start(segments: &[Segment]) -> Result<(), Fault> {
    let first = segments.iter().find(|segment| segment.address == FLASH.start);
    let table = first.and_then(|segment| segment.bytes.first_chunk::<8>()).ok_or(Fault::NoVectorTable)?;
    let [s0, s1, s2, s3, r0, r1, r2, r3] = *table;
    let stack = u64::from(u32::from_le_bytes([s0, s1, s2, s3]));
    let reset = u64::from(u32::from_le_bytes([r0, r1, r2, r3]));
    if !STACK_TOPS.contains(&stack) || stack % 8 != 0 {
        return Err(Fault::Stack { stack });
    }
    let is_code = |segment: &Segment| segment.executable && segment.range().contains(&(reset & !1));
    if reset & 1 == 0 || !segments.iter().any(is_code) {
        return Err(Fault::Reset { reset });
    }
    Ok(())
}
