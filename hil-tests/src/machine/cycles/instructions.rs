//! Instructions: the cycles of each, without the flash, by the Cortex-M4's Technical Reference Manual
//! (Arm 100166_0001): tables 3-1 and 7-1 and section 3.3.3, "Load/store timings".
//!
//! A block is what unicorn runs at once, without a branch inside. What a taken branch costs beside its
//! own cycle shows only afterwards, so it is not in here. Instructions that an IT block skips cost what
//! they would if they were executed, rather more than on the chip.

use super::{Effects, Timing};
use capstone::{
    AccessType, Capstone, Insn, InsnDetail,
    arch::{
        ArchOperand, BuildsCapstone, BuildsCapstoneExtraMode,
        arm::{ArchExtraMode, ArchMode, ArmInsn, ArmOperand, ArmOperandType, ArmReg},
    },
};

const SEV: u16 = 0xBF40;
/// A branch to itself: nothing changes until an event.
const CIRCLE: u16 = 0xE7FE;

/// Reads Thumb code.
pub(super) struct Decoder(Capstone);

/// A double word of a block's code.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Piece {
    /// Its address.
    pub(super) address: u32,
    /// Cycles of the instructions that end in it.
    pub(super) cycles: u32,
}

/// Loads and stores of a block whose address lies in one register, which moves on from one to the next, as
/// where code goes through samples or coefficients.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(super) struct Walk {
    /// Number of the register.
    pub(super) register: usize,
    /// How far it has moved so far.
    offset: i32,
    /// Each access: from where the register was at first, and its bytes.
    pub(super) accesses: Vec<(i32, u32)>,
}

/// The walks of the part of a block that was read.
#[derive(Default)]
struct Walks {
    all: Vec<Walk>,
    /// Registers that hold something else than they and their steps say: a bit each.
    lost: u32,
}

impl Walks {
    fn step(&mut self, register: usize, displacement: i32, bytes: u32, moved: i32) {
        if self.lost >> register & 1 == 1 {
            return;
        }
        let place = self.all.iter().position(|walk| walk.register == register).unwrap_or_else(|| {
            self.all.push(Walk { register, ..Walk::default() });
            self.all.len() - 1
        });
        let walk = &mut self.all[place];
        walk.accesses.push((walk.offset + displacement, bytes));
        walk.offset += moved;
    }

    fn into_moving(self) -> Vec<Walk> {
        self.all.into_iter().filter(|walk| walk.offset != 0).collect()
    }
}

/// What the cycles of an instruction depend on.
struct Operation {
    kind: ArmInsn,
    operands: Vec<ArmOperand>,
}

/// What follows depends on.
#[derive(Default)]
struct Before {
    /// A load that the next load or store may overlap with.
    pipelines: bool,
    /// Registers that a load has written, or data processing.
    loaded: Vec<u16>,
    computed: Vec<u16>,
    /// Registers of a floating-point result that is not there yet.
    float: Vec<u16>,
}

impl Decoder {
    pub(super) fn new() -> Self {
        let builder = Capstone::new().arm().mode(ArchMode::Thumb);
        let modes = [ArchExtraMode::MClass, ArchExtraMode::V8];
        let capstone = builder.extra_mode(modes.into_iter()).detail(true).build();
        Self(capstone.expect("capstone reads Thumb code"))
    }

    /// The double words of a block of code with their cycles, in order; and how it goes through memory.
    pub(super) fn read(&self, code: &[u8], address: u32, timing: &Timing) -> (Vec<Piece>, Vec<Walk>) {
        let mut pieces: Vec<Piece> = Vec::new();
        let mut walks = Walks::default();
        let mut before = Before::default();
        let mut rest = code;
        let mut at = address;
        while !rest.is_empty() {
            let read = self.0.disasm_all(rest, at.into());
            let instructions = read.as_deref().unwrap_or_default();
            for instruction in instructions {
                let operation = self.operation(instruction);
                let cycles = operation.as_ref().map_or(1, |operation| before.cycles(operation, timing));
                operation.iter().for_each(|operation| operation.step(&mut walks));
                add(&mut pieces, at, instruction.len() as u32, cycles);
                at += instruction.len() as u32;
            }
            // What capstone does not know takes a cycle.
            let known = (at - address) as usize;
            let Some(&pair) = code.get(known..).and_then(|rest| rest.first_chunk()) else { break };
            let bytes = if is_long(u16::from_le_bytes(pair)) { 4 } else { 2 };
            add(&mut pieces, at, bytes, 1);
            at += bytes;
            rest = code.get((at - address) as usize..).unwrap_or_default();
        }
        (pieces, walks.into_moving())
    }

    fn operation(&self, instruction: &Insn<'_>) -> Option<Operation> {
        let detail: InsnDetail<'_> = self.0.insn_detail(instruction).ok()?;
        let operands = detail.arch_detail().operands().into_iter();
        let operands = operands.map(|ArchOperand::ArmOperand(operand)| operand);
        Some(Operation { kind: ArmInsn::from(instruction.id().0), operands: operands.collect() })
    }
}

/// What a block of code does beside taking time.
pub(super) fn effects(code: &[u8]) -> Effects {
    let mut halfwords = code.chunks_exact(2).map(|pair| u16::from_le_bytes([pair[0], pair[1]]));
    let mut effects = Effects { is_circle: code == CIRCLE.to_le_bytes(), ..Effects::default() };
    while let Some(halfword) = halfwords.next() {
        effects.sends_event |= halfword == SEV;
        effects.has_conditions |= halfword & 0xFF00 == 0xBF00 && halfword & 0xF != 0;
        if is_long(halfword) {
            halfwords.next();
        }
    }
    effects
}

/// The first five bits tell long instructions from short ones.
fn is_long(halfword: u16) -> bool {
    halfword >> 11 >= 0b11101
}

/// Adds an instruction to the double words that it lies in; its cycles belong to the last.
fn add(pieces: &mut Vec<Piece>, address: u32, bytes: u32, cycles: u32) {
    for address in [address & !7, (address + bytes - 1) & !7] {
        if pieces.last().is_none_or(|piece| piece.address != address) {
            pieces.push(Piece { address, cycles: 0 });
        }
    }
    if let Some(last) = pieces.last_mut() {
        last.cycles += cycles;
    }
}

impl Before {
    /// Cycles of an instruction behind this; then this is behind the instruction.
    fn cycles(&mut self, operation: &Operation, timing: &Timing) -> u32 {
        use ArmInsn as I;
        let before = std::mem::take(self);
        let reads = operation.registers(AccessType::ReadOnly);
        let writes = operation.registers(AccessType::WriteOnly);
        let waits = |late: &[u16], reads: &[u16]| u32::from(late.iter().any(|late| reads.contains(late)));
        let of_address = operation.address();
        match operation.kind {
            I::ARM_INS_LDR
            | I::ARM_INS_LDRB
            | I::ARM_INS_LDRH
            | I::ARM_INS_LDRSB
            | I::ARM_INS_LDRSH
            | I::ARM_INS_LDREX
            | I::ARM_INS_LDREXB
            | I::ARM_INS_LDREXH
            | I::ARM_INS_STREX
            | I::ARM_INS_STREXB
            | I::ARM_INS_STREXH => {
                let overlaps = before.pipelines && waits(&before.loaded, &of_address) == 0;
                (self.pipelines, self.loaded) = (true, writes);
                2 - u32::from(overlaps) + waits(&before.computed, &of_address)
            }
            I::ARM_INS_STR | I::ARM_INS_STRB | I::ARM_INS_STRH => {
                let overlaps = before.pipelines && waits(&before.loaded, &of_address) == 0;
                let is_indexed = of_address.len() > 1;
                let alone = if is_indexed { 2 } else { timing.store };
                (if overlaps { 1 } else { alone }) + waits(&before.computed, &of_address)
            }
            I::ARM_INS_LDM | I::ARM_INS_LDMDB | I::ARM_INS_STM | I::ARM_INS_STMDB => {
                operation.operands.len() as u32 + waits(&before.computed, &of_address)
            }
            I::ARM_INS_PUSH | I::ARM_INS_POP => 1 + operation.operands.len() as u32,
            I::ARM_INS_LDRD | I::ARM_INS_STRD => 3 + waits(&before.computed, &of_address),
            I::ARM_INS_IT => timing.condition,
            I::ARM_INS_TBB | I::ARM_INS_TBH => 3,
            I::ARM_INS_MLA | I::ARM_INS_MLS => {
                self.computed = writes;
                2
            }
            I::ARM_INS_SDIV | I::ARM_INS_UDIV => {
                self.computed = writes;
                timing.divide
            }
            I::ARM_INS_ISB | I::ARM_INS_DSB | I::ARM_INS_DMB => 1 + timing.barrier,
            I::ARM_INS_VMLA
            | I::ARM_INS_VMLS
            | I::ARM_INS_VNMLA
            | I::ARM_INS_VNMLS
            | I::ARM_INS_VFMA
            | I::ARM_INS_VFMS
            | I::ARM_INS_VFNMA
            | I::ARM_INS_VFNMS => {
                self.float = writes;
                // The sum so far is needed a cycle later than the factors.
                3 + waits(&before.float, reads.get(1..).unwrap_or_default())
            }
            I::ARM_INS_VDIV | I::ARM_INS_VSQRT => {
                self.float = writes;
                14 + waits(&before.float, &reads)
            }
            I::ARM_INS_VADD | I::ARM_INS_VSUB | I::ARM_INS_VMUL | I::ARM_INS_VNMUL | I::ARM_INS_VCVT => {
                self.float = writes;
                1 + waits(&before.float, &reads)
            }
            I::ARM_INS_VLDR | I::ARM_INS_VSTR => {
                let words = if operation.operands.first().is_some_and(is_double) { 2 } else { 1 };
                1 + words + waits(&before.float, &reads) + waits(&before.computed, &of_address)
            }
            I::ARM_INS_VLDMIA
            | I::ARM_INS_VLDMDB
            | I::ARM_INS_VSTMIA
            | I::ARM_INS_VSTMDB
            | I::ARM_INS_VPUSH
            | I::ARM_INS_VPOP => 1 + operation.words(),
            I::ARM_INS_VMOV => {
                operation.operands.len().saturating_sub(1).max(1) as u32 + waits(&before.float, &reads)
            }
            _ => {
                self.computed = writes;
                1 + waits(&before.float, &reads)
            }
        }
    }
}

impl Operation {
    /// Registers that are accessed so, outside of addresses.
    fn registers(&self, wanted: AccessType) -> Vec<u16> {
        let counts = |operand: &ArmOperand| {
            let access = operand.access;
            access.is_none_or(|access| access == wanted || access == AccessType::ReadWrite)
        };
        self.operands.iter().filter(|operand| counts(operand)).filter_map(register).collect()
    }

    /// Registers that make up the address of a load or store; the first operand is the base of a list.
    fn address(&self) -> Vec<u16> {
        let of_memory = self.operands.iter().find_map(|operand| match &operand.op_type {
            ArmOperandType::Mem(memory) => Some([memory.base().0, memory.index().0]),
            _ => None,
        });
        match of_memory {
            Some(registers) => registers.into_iter().filter(|&register| register != 0).collect(),
            None => self.operands.first().and_then(register).into_iter().collect(),
        }
    }

    /// What it adds to the ways through memory.
    fn step(&self, walks: &mut Walks) {
        use ArmInsn as I;
        let bytes = match self.kind {
            I::ARM_INS_LDR | I::ARM_INS_STR => 4,
            I::ARM_INS_LDRH | I::ARM_INS_LDRSH | I::ARM_INS_STRH => 2,
            _ => 0,
        };
        let base = self.operands.iter().find_map(|operand| match &operand.op_type {
            ArmOperandType::Mem(memory) if memory.index().0 == 0 => {
                Some((core(memory.base().0)?, memory.disp()))
            }
            _ => None,
        });
        if let (Some((register, displacement)), 1..) = (base, bytes) {
            let moved = match self.operands.last().map(|operand| &operand.op_type) {
                Some(&ArmOperandType::Imm(moved)) => moved,
                _ => 0,
            };
            walks.step(register, displacement, bytes, moved);
        }
        for written in self.registers(AccessType::WriteOnly).into_iter().filter_map(core) {
            walks.lost |= 1 << written;
        }
    }

    /// Words of a list of floating-point registers.
    fn words(&self) -> u32 {
        self.operands
            .iter()
            .map(|operand| if is_double(operand) { 2 } else { u32::from(is_single(operand)) })
            .sum()
    }
}

fn register(operand: &ArmOperand) -> Option<u16> {
    match operand.op_type {
        ArmOperandType::Reg(register) => Some(register.0),
        _ => None,
    }
}

/// Number of a core register up to R12.
fn core(register: u16) -> Option<usize> {
    let (first, last) = (ArmReg::ARM_REG_R0 as u16, ArmReg::ARM_REG_R12 as u16);
    (first..=last).contains(&register).then(|| usize::from(register - first))
}

fn is_double(operand: &ArmOperand) -> bool {
    let (first, last) = (ArmReg::ARM_REG_D0 as u16, ArmReg::ARM_REG_D31 as u16);
    register(operand).is_some_and(|register| (first..=last).contains(&register))
}

fn is_single(operand: &ArmOperand) -> bool {
    let (first, last) = (ArmReg::ARM_REG_S0 as u16, ArmReg::ARM_REG_S31 as u16);
    register(operand).is_some_and(|register| (first..=last).contains(&register))
}
