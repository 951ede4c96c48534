//! CPU: unicorn's Cortex-M4, its hooks, and the exceptions that it does not have (ARMv7-M, B1.5).

use super::{
    Halt, Machine, Ram, SPINS, State, Why,
    cycles::{Core, Effects},
};
use crate::chip::{
    RAM_BYTES, RAM_START,
    core::{self, FaultCause},
    flash,
    misuse::Misuse,
    nvic::{HARD_FAULT, Masks},
    peripheral::Moment,
    system_memory,
    time::Time,
    trace::Event,
};
use std::rc::Rc;
use unicorn_engine::{Arch, ArmCpuModel, HookType, Mode, Prot, RegisterARM, Unicorn, uc_error};

pub(super) const WFE: u16 = 0xBF20;
pub(super) const WFI: u16 = 0xBF30;
/// What unicorn's interrupt hook is told for SVC, and for a branch to an EXC_RETURN value.
pub(super) const SUPERVISOR_CALL: u32 = 2;
pub(super) const EXCEPTION_EXIT: u32 = 8;

/// Where peripherals lie, the core's own apart.
const PERIPHERALS: u32 = 0x4000_0000;
const PERIPHERAL_BYTES: u32 = 0x1010_0000;

/// Registers that an exception saves, in order (B1.5.6).
const SAVED: [RegisterARM; 7] = [
    RegisterARM::R0,
    RegisterARM::R1,
    RegisterARM::R2,
    RegisterARM::R3,
    RegisterARM::R12,
    RegisterARM::LR,
    RegisterARM::PC,
];
/// S0 to S15, two in each.
const FLOATS: [RegisterARM; 8] = [
    RegisterARM::D0,
    RegisterARM::D1,
    RegisterARM::D2,
    RegisterARM::D3,
    RegisterARM::D4,
    RegisterARM::D5,
    RegisterARM::D6,
    RegisterARM::D7,
];
/// The state of an IT block in the program status register (B1.4.2).
const IT_STATE: u64 = 0x0600_FC00;
const BASIC_FRAME: u32 = 0x20;
const EXTENDED_FRAME: u32 = 0x68;
const USES_FLOATING_POINT: u64 = 4;

/// A CPU whose memory and hooks belong to `state`.
pub(super) fn build(state: &Rc<State>) -> Result<Unicorn<'static, ()>, uc_error> {
    let mut unicorn = Unicorn::new(Arch::ARM, Mode::THUMB | Mode::MCLASS)?;
    unicorn.ctl_set_cpu_model(ArmCpuModel::CORTEX_M4 as i32)?;
    unicorn.mem_map(flash::START.into(), flash::BYTES.into(), Prot::ALL)?;
    unicorn.mem_map(RAM_START.into(), RAM_BYTES.into(), Prot::ALL)?;
    unicorn.mem_map(system_memory::START.into(), system_memory::BYTES.into(), Prot::READ)?;
    unicorn.mem_write(system_memory::START.into(), &system_memory::content())?;
    for (start, bytes) in [(PERIPHERALS, PERIPHERAL_BYTES), (core::START, core::BYTES)] {
        map_registers(&mut unicorn, start, bytes, state)?;
    }
    let shared = state.clone();
    unicorn.add_block_hook(1, 0, move |unicorn, address, size| shared.block(unicorn, address, size))?;
    let shared = state.clone();
    unicorn.add_intr_hook(move |unicorn, number| {
        shared.why.set(Why::Interrupt(number));
        let _ = unicorn.emu_stop();
    })?;
    let shared = state.clone();
    unicorn.add_mem_hook(HookType::MEM_INVALID, 1, 0, move |_, _, address, _, _| {
        shared.bad_address.set(address as u32);
        false
    })?;
    let (first, last) = (flash::START, flash::START + flash::BYTES - 1);
    let shared = state.clone();
    unicorn.add_mem_hook(
        HookType::MEM_READ,
        first.into(),
        last.into(),
        move |unicorn, _, address, size, _| {
            shared.spend(|counter| counter.load(address as u32, size as u32));
            shared.forget_condition(unicorn);
            true
        },
    )?;
    let shared = state.clone();
    unicorn.add_mem_hook(
        HookType::MEM_WRITE,
        first.into(),
        last.into(),
        move |unicorn, _, address, size, value| {
            shared.write_flash(unicorn, address as u32, size as u32, value as u32);
            shared.forget_condition(unicorn);
            true
        },
    )?;
    Ok(unicorn)
}

fn map_registers(
    unicorn: &mut Unicorn<'static, ()>,
    start: u32,
    bytes: u32,
    state: &Rc<State>,
) -> Result<(), uc_error> {
    let (reader, writer) = (state.clone(), state.clone());
    unicorn.mmio_map(
        start.into(),
        bytes.into(),
        Some(move |unicorn: &mut Unicorn<'_, ()>, offset: u64, size: usize| {
            reader.read_register(unicorn, start + offset as u32, size as u32).into()
        }),
        Some(move |unicorn: &mut Unicorn<'_, ()>, offset: u64, size: usize, value: u64| {
            writer.write_register(unicorn, start + offset as u32, size as u32, value as u32);
        }),
    )
}

impl Core for Unicorn<'_, ()> {
    fn code(&self, address: u32, size: u32) -> Vec<u8> {
        self.mem_read_as_vec(address.into(), size as usize).unwrap_or_default()
    }

    fn register(&self, number: usize) -> u32 {
        let number = RegisterARM::R0 as i32 + number as i32;
        self.reg_read(number).unwrap_or(0) as u32
    }
}

/// PRIMASK and BASEPRI as they are.
pub(super) fn raw_masks(unicorn: &Unicorn<'_, ()>) -> (u64, u64) {
    let get = |register: RegisterARM| unicorn.reg_read(register).unwrap_or(0);
    (get(RegisterARM::PRIMASK), get(RegisterARM::BASEPRI))
}

impl State {
    /// A block of code begins: its instructions take their time, unless the core is to stop first.
    fn block(&self, unicorn: &mut Unicorn<'_, ()>, address: u64, size: u32) {
        if let Some((first, last, until)) = self.stall.get()
            && (first..=last).contains(&(address as u32))
            && until > self.now.get()
        {
            self.now.set(until.min(self.stop_at.get().max(self.now.get())));
            if until > self.now.get() {
                return self.stop(unicorn, Why::Due);
            }
        }
        let unmasked = self.masks.get().is_some_and(|masks| masks != raw_masks(unicorn));
        let is_due = self.now.get() >= self.stop_at.get();
        if unmasked || (is_due && !self.pass_quietly(unicorn)) {
            return self.stop(unicorn, Why::Due);
        }
        if let Some(calls) = self.calls.borrow_mut().as_mut() {
            calls.pass(address as u32, self.counter.borrow().cycles(), unicorn);
        }
        let mut effects = Effects::default();
        self.spend(|counter| {
            let cycles;
            (cycles, effects) = counter.run(address as u32, size, unicorn);
            cycles
        });
        self.is_conditional.set(effects.has_conditions);
        if effects.sends_event {
            self.event.set(true);
        }
        if effects.is_circle {
            self.now.set(self.now.get().max(self.stop_at.get()));
        }
    }

    /// What is due happens while the core runs on, if it does not concern the core.
    fn pass_quietly(&self, unicorn: &mut Unicorn<'_, ()>) -> bool {
        if self.stop_at.get() == Time::ZERO || self.now.get() >= self.deadline.get() {
            return false;
        }
        let mut chip = self.chip.borrow_mut();
        match chip.advance_quietly(self.now.get(), &mut Ram(unicorn)) {
            Ok(true) => {
                self.spend(|counter| counter.give_way(chip.take_transfers()));
                self.stop_at.set(chip.next_event().min(self.deadline.get()));
                true
            }
            Ok(false) => false,
            Err(misuse) => {
                self.misuse.borrow_mut().get_or_insert(misuse);
                false
            }
        }
    }

    fn stop(&self, unicorn: &mut Unicorn<'_, ()>, why: Why) {
        self.why.set(why);
        let _ = unicorn.emu_stop();
    }

    /// For a hook of memory, unicorn puts the state of an IT block where the code that it made of the block
    /// has taken it away already; whatever is looked up next would depend on a condition that is no more.
    pub(super) fn forget_condition(&self, unicorn: &mut Unicorn<'_, ()>) {
        if self.is_conditional.get() {
            let status = unicorn.reg_read(RegisterARM::XPSR).unwrap_or(0);
            let _ = unicorn.reg_write(RegisterARM::XPSR, status & !IT_STATE);
        }
    }

    fn read_register(&self, unicorn: &mut Unicorn<'_, ()>, address: u32, size: u32) -> u32 {
        self.spend(|counter| counter.reach(address));
        let value = self.access(unicorn, |chip| chip.read(address, size)).unwrap_or(0);
        self.skip_polling(address, value);
        value
    }

    /// Code that reads one register again and again, no other, and finds the same value, waits in a
    /// loop: time goes on to the next event. The instructions of that time are not counted.
    fn skip_polling(&self, address: u32, value: u32) {
        let poll = (address, value);
        if self.last_poll.replace(poll) == poll {
            self.spins.set(self.spins.get() + 1);
        } else {
            self.spins.set(0);
        }
        let stop_at = self.stop_at.get();
        if self.spins.get() >= SPINS && stop_at > self.now.get() {
            self.spins.set(0);
            self.now.set(stop_at);
        }
    }

    fn write_register(&self, unicorn: &mut Unicorn<'_, ()>, address: u32, size: u32, value: u32) {
        self.spins.set(0);
        self.spend(|counter| counter.reach(address));
        self.access(unicorn, |chip| chip.write(address, size, value));
        // What was written may have brought an event closer, or an exception.
        self.stop_at.set(Time::ZERO);
    }

    fn write_flash(&self, unicorn: &mut Unicorn<'_, ()>, address: u32, size: u32, value: u32) {
        self.access(unicorn, |chip| {
            let at = Moment { now: chip.now, clocks: chip.clocks() };
            chip.flash.write_word(address, size, value, at)
        });
        self.stop_at.set(Time::ZERO);
    }

    /// Brings the chip up to now, touches it, and lets it settle.
    fn access<T>(
        &self,
        unicorn: &mut Unicorn<'_, ()>,
        touch: impl FnOnce(&mut crate::chip::Chip) -> Result<T, Misuse>,
    ) -> Option<T> {
        let mut chip = self.chip.borrow_mut();
        let result = chip
            .advance(self.now.get(), &mut Ram(unicorn))
            .and_then(|()| touch(&mut chip))
            .and_then(|value| chip.settle(&mut Ram(unicorn)).map(|()| value));
        result
            .map_err(|misuse| {
                self.misuse.borrow_mut().get_or_insert(misuse);
                self.stop(unicorn, Why::Misuse);
            })
            .ok()
    }
}

impl Machine {
    pub(super) fn get(&self, register: RegisterARM) -> u64 {
        self.unicorn.reg_read(register).unwrap_or(0)
    }

    pub(super) fn set(&mut self, register: RegisterARM, value: u64) {
        self.unicorn.reg_write(register, value).expect("the core has this register");
    }

    pub(super) fn masks(&self) -> Masks {
        let (primask, basepri) = raw_masks(&self.unicorn);
        let faultmask = self.get(RegisterARM::FAULTMASK) & 1 == 1;
        Masks { primask: primask & 1 == 1, faultmask, basepri: basepri as u8 }
    }

    /// Stack and program counter come from the vector table (B1.5.5).
    pub(super) fn reset_registers(&mut self) {
        for register in
            [RegisterARM::PRIMASK, RegisterARM::FAULTMASK, RegisterARM::BASEPRI, RegisterARM::CONTROL]
        {
            self.set(register, 0);
        }
        let vectors = self.chip(|chip| chip.core.vectors());
        let (stack, start) = (self.word(vectors), self.word(vectors + 4));
        self.set(RegisterARM::SP, stack.into());
        self.set(RegisterARM::LR, 0xFFFF_FFFF);
        self.set(RegisterARM::PC, start.into());
    }

    /// Takes an exception (B1.5.6): saves the caller's registers, jumps through the vector table.
    ///
    /// Where they cannot be saved, a bus fault follows, which nobody handles but the handler of hard faults. That one
    /// is taken instead, with what was saved; or goes on if it was to be taken anyway: "the fault handler still
    /// executes even though the stack pushes for the handler failed" (Arm DDI 0337E, 5.12.1, of the Cortex-M3, which
    /// has the same architecture).
    pub(super) fn enter(&mut self, mut exception: usize) {
        self.sleeps = false;
        self.state.event.set(true);
        let uses_floats = self.get(RegisterARM::CONTROL) & USES_FLOATING_POINT != 0;
        self.state.spend(|counter| counter.change_context(uses_floats));
        let stack = self.get(RegisterARM::SP) as u32;
        let size = if uses_floats { EXTENDED_FRAME } else { BASIC_FRAME };
        let frame = (stack - size) & !7;
        let padded = (stack >> 2 & 1) << 9;
        let mut words: Vec<u32> = SAVED.iter().map(|&register| self.get(register) as u32).collect();
        words.push(self.get(RegisterARM::XPSR) as u32 & !0x3FF | self.active_number() | padded | 1 << 24);
        if uses_floats {
            for register in FLOATS {
                let pair = self.get(register);
                words.extend([pair as u32, (pair >> 32) as u32]);
            }
            words.push(self.get(RegisterARM::FPSCR) as u32);
        }
        if !self.save(frame, &words) {
            self.chip(|chip| chip.core.escalate(FaultCause::Stacking));
            exception = exception.min(HARD_FAULT);
        }
        let nested = self.active_number() != 0;
        if !nested {
            self.tell_calls(true);
        }
        let link = 0xFFFF_FFE1 | u32::from(!uses_floats) << 4 | u32::from(!nested) << 3;
        let vectors = self.chip(|chip| {
            chip.core.nvic.enter(exception);
            chip.trace.add(chip.now, Event::Enter(exception));
            chip.core.vectors()
        });
        let handler = self.word(vectors + 4 * exception as u32);
        self.set(RegisterARM::CONTROL, self.get(RegisterARM::CONTROL) & !USES_FLOATING_POINT);
        self.set(RegisterARM::SP, frame.into());
        self.set(RegisterARM::LR, link.into());
        self.set(RegisterARM::XPSR, 1 << 24);
        self.set(RegisterARM::PC, u64::from(handler | 1));
    }

    /// Saves words on the stack, as far as there is memory; says whether there was for all of them.
    fn save(&mut self, frame: u32, words: &[u32]) -> bool {
        let places = (u64::from(frame)..).step_by(4).zip(words);
        let saved = places.filter(|(at, word)| self.unicorn.mem_write(*at, &word.to_le_bytes()).is_ok());
        saved.count() == words.len()
    }

    fn tell_calls(&self, begins: bool) {
        if let Some(calls) = self.state.calls.borrow_mut().as_mut() {
            calls.interrupt(begins, self.state.counter.borrow().cycles());
        }
    }

    /// A handler returns (B1.5.8): gives the saved registers back.
    pub(super) fn leave(&mut self) -> Result<(), Halt> {
        self.state.event.set(true);
        // The branch has cleared the lowest bit; the rest of EXC_RETURN is in the PC.
        let link = self.get(RegisterARM::PC) as u32;
        let uses_floats = link & 0x10 == 0;
        self.state.spend(|counter| counter.change_context(uses_floats));
        let frame = self.get(RegisterARM::SP) as u32;
        let size = if uses_floats { EXTENDED_FRAME } else { BASIC_FRAME };
        let bytes = self.peek(frame, size as usize);
        let words: Vec<u32> = bytes
            .chunks_exact(4)
            .map(|word| u32::from_le_bytes([word[0], word[1], word[2], word[3]]))
            .collect();
        let left = self.chip(|chip| {
            let left = chip.core.nvic.leave();
            if let Some(exception) = left {
                chip.trace.add(chip.now, Event::Leave(exception));
            }
            left
        });
        if self.active_number() == 0 {
            self.tell_calls(false);
        }
        if words.len() * 4 != size as usize || left.is_none() {
            return Err(self.gave_up("a handler returns with a broken stack".to_owned()));
        }
        let status = words[7];
        for (place, &register) in SAVED.iter().enumerate().take(6) {
            self.set(register, words[place].into());
        }
        if uses_floats {
            for (place, register) in FLOATS.into_iter().enumerate() {
                let pair = u64::from(words[8 + 2 * place]) | u64::from(words[9 + 2 * place]) << 32;
                self.set(register, pair);
            }
            self.set(RegisterARM::FPSCR, words[24].into());
        }
        let control = self.get(RegisterARM::CONTROL) & !USES_FLOATING_POINT;
        self.set(RegisterARM::CONTROL, control | if uses_floats { USES_FLOATING_POINT } else { 0 });
        self.set(RegisterARM::SP, u64::from((frame + size) | (status >> 9 & 1) << 2));
        // Unicorn stays in thread mode: its own idea of handlers would get in the way.
        self.set(RegisterARM::XPSR, u64::from(status & !0x3FF));
        self.set(RegisterARM::PC, u64::from(words[6] | 1));
        if left == Some(crate::chip::nvic::NMI) {
            return Ok(());
        }
        // Returning from any handler but NMI clears FAULTMASK (B1.5.8).
        self.set(RegisterARM::FAULTMASK, 0);
        Ok(())
    }

    fn active_number(&mut self) -> u32 {
        self.chip(|chip| chip.core.nvic.active().unwrap_or(0) as u32)
    }

    fn word(&self, address: u32) -> u32 {
        let mut bytes = [0; 4];
        // Where nothing is, the CPU finds no code either, and says so.
        let _ = self.unicorn.mem_read(address.into(), &mut bytes);
        u32::from_le_bytes(bytes)
    }
}
