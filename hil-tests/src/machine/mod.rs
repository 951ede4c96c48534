//! Machine: the chip with its CPU, run by unicorn in virtual time.
//!
//! Unicorn executes instructions; everything else is here and in [`crate::chip`]. It runs block by
//! block; a hook at the start of each block counts its cycles ([`cycles`]), which is what time is made of. The hook
//! stops unicorn when an event of the chip is due or an exception may be taken.
//!
//! What is not modelled: the process stack pointer, unaligned-access faults of LDM and LDRD.

mod calls;
mod cpu;
pub mod cycles;
mod halt;
mod snapshot;
mod state;

use crate::{
    chip::{
        Chip, Memory, RAM_BYTES, RAM_START,
        core::FaultCause,
        flash::{self, Flash},
        misuse::Misuse,
        rcc::ResetCause,
        time::Time,
        trace::Event,
    },
    world::{AnalogueWorld, Setup, WorldHandle},
};
use calls::Calls;
use cycles::Timing;
pub use halt::Halt;
use rand::{RngCore, SeedableRng};
use rand_pcg::Pcg64;
use snapshot::BeforeRead;
pub use snapshot::SnapshotError;
use state::{State, Why};
use std::{ops::Range, rc::Rc, sync::Arc};
use unicorn_engine::{HookType, RegisterARM, UcHookId, Unicorn, uc_error};

/// Equal reads of one register, and no other, after which the CPU is taken to wait in a loop.
const SPINS: u32 = 16;

/// How a machine runs.
#[derive(Clone, Debug)]
pub struct Options {
    /// What the manuals leave open of the core's cycles.
    pub timing: Timing,
    /// Bits per second at the world's end of the link.
    pub wire_baud: u64,
    /// What RAM holds after power comes up, and what is random in faults.
    pub seed: u64,
    /// Whether events are kept, and not only hashed.
    pub keep_trace: bool,
    /// Whether the link goes over USB, to a host at the other end of a cable.
    pub usb: bool,
    /// What the chip measures, if anything.
    pub world: Option<Arc<Setup>>,
}

impl Default for Options {
    fn default() -> Self {
        Self {
            timing: Timing::PESSIMISTIC,
            wire_baud: 2_000_000,
            seed: 1,
            keep_trace: false,
            usb: false,
            world: None,
        }
    }
}

/// A chip with a CPU.
pub struct Machine {
    unicorn: Unicorn<'static, ()>,
    state: Rc<State>,
    options: Options,
    sleeps: bool,
    /// A fault in the handler of a fault has stopped the core.
    is_locked_up: bool,
    slept: Time,
    powered_up: u64,
    world: Option<WorldHandle>,
    /// Looks for reads of flash that a power cut has damaged.
    damage_watch: Option<UcHookId>,
    /// Where its start had come to before it read what other flashes may hold otherwise.
    before_read: Option<BeforeRead>,
}

/// RAM as unicorn has it.
struct Ram<'a, 'b>(&'a mut Unicorn<'b, ()>);

impl Memory for Ram<'_, '_> {
    fn read(&self, address: u32, bytes: &mut [u8]) {
        self.0.mem_read(address.into(), bytes).expect("the chip asks for RAM only");
    }
    fn write(&mut self, address: u32, bytes: &[u8]) {
        self.0.mem_write(address.into(), bytes).expect("the chip writes RAM only");
    }
}

impl Machine {
    /// A machine with this in its flash, switched on.
    pub fn new(flash: Flash, options: Options) -> Result<Self, Halt> {
        let mut chip = Chip::new(options.wire_baud, options.keep_trace);
        chip.flash = flash;
        if options.usb {
            chip.usb.host_mut().plug(Time::ZERO);
        }
        let world = options.world.clone().map(WorldHandle::new);
        if let Some(world) = &world {
            chip.connect(Box::new(AnalogueWorld::new(world.clone())));
        }
        let state = Rc::new(State::new(chip, options.timing));
        let unicorn = cpu::build(&state).map_err(|error| Halt::Unicorn {
            time: Time::ZERO,
            pc: 0,
            reason: format!("{error:?}"),
        })?;
        let mut machine = Self {
            unicorn,
            state,
            options,
            sleeps: false,
            is_locked_up: false,
            slept: Time::ZERO,
            powered_up: 0,
            world,
            damage_watch: None,
            before_read: None,
        };
        machine.power_up()?;
        Ok(machine)
    }

    /// Virtual time.
    #[must_use]
    pub fn now(&self) -> Time {
        self.state.now.get()
    }

    /// Time that the core has slept.
    #[must_use]
    pub fn slept(&self) -> Time {
        self.slept
    }

    /// Cycles that the core has run since the machine was made.
    #[must_use]
    pub fn cycles(&self) -> u64 {
        self.state.counter.borrow().cycles()
    }

    /// The skin and the front end before the chip, if there are any.
    #[must_use]
    pub fn world(&self) -> Option<&WorldHandle> {
        self.world.as_ref()
    }

    /// How it runs.
    #[must_use]
    pub fn options(&self) -> &Options {
        &self.options
    }

    /// Looks at the chip, or changes it. Its time is never past an event that is still to happen.
    pub fn chip<T>(&mut self, look: impl FnOnce(&mut Chip) -> T) -> T {
        let mut chip = self.state.chip.borrow_mut();
        let now = self.state.now.get().min(chip.next_event());
        chip.now = chip.now.max(now);
        look(&mut chip)
    }

    /// Reads RAM or flash.
    #[must_use]
    pub fn peek(&self, address: u32, length: usize) -> Vec<u8> {
        self.unicorn.mem_read_as_vec(address.into(), length).unwrap_or_default()
    }

    /// Writes RAM, as a debug probe or a cosmic ray does.
    pub fn poke(&mut self, address: u32, bytes: &[u8]) {
        let _ = self.unicorn.mem_write(address.into(), bytes);
    }

    /// Power fails and comes back: RAM is lost, and what the flash was doing is left undone.
    pub fn cut_power(&mut self) -> Result<(), Halt> {
        let seed = self.options.seed ^ self.powered_up << 32 ^ self.now().nanoseconds();
        self.chip(|chip| {
            chip.flash.cut(seed);
            chip.uart.unplug();
            chip.usart1.unplug();
            chip.fdcan.unplug();
            chip.lose_power();
        });
        self.power_up()
    }

    /// Somebody presses the reset button.
    pub fn press_reset(&mut self) -> Result<(), Halt> {
        self.restart(ResetCause::Pin)
    }

    /// The next instruction is taken to fault, as if the core had met a bus error.
    pub fn inject_fault(&mut self) {
        self.chip(|chip| chip.core.escalate(FaultCause::Bus(0xDEAD_BEEF)));
    }

    /// From now on the CPU runs in circles: a branch to itself, with interrupts off.
    pub fn hang(&mut self) {
        let circle = RAM_START + RAM_BYTES - 4;
        self.poke(circle, &[0xFE, 0xE7]);
        self.set(RegisterARM::PRIMASK, 1);
        self.set(RegisterARM::PC, u64::from(circle | 1));
        self.sleeps = false;
    }

    /// From now on the code that runs calls itself without end: it saves nine registers again and again.
    pub fn overflow_stack(&mut self) {
        let circle = RAM_START + RAM_BYTES - 4;
        // push {r0-r7, lr}; b to it.
        self.poke(circle, &[0xFF, 0xB5, 0xFD, 0xE7]);
        self.set(RegisterARM::PC, u64::from(circle | 1));
        self.sleeps = false;
    }

    /// The CPU stands still until then, as while the flash that it runs from is erased; the rest of the chip goes on.
    pub fn stand_until(&mut self, end: Time) -> Result<(), Halt> {
        self.pass_time()?;
        self.state.now.set(self.now().max(end));
        self.pass_time()
    }

    /// From now on, counts the cycles of each call of the function at this address.
    pub fn count_calls(&mut self, function: u32) {
        *self.state.calls.borrow_mut() = Some(Calls::of(function, self.cycles()));
    }

    /// Cycles of each call that has returned.
    #[must_use]
    pub fn calls(&self) -> Vec<u64> {
        self.state.calls.borrow().as_ref().map(Calls::done).unwrap_or_default()
    }

    /// Runs until `deadline`, in virtual time.
    pub fn run_until(&mut self, deadline: Time) -> Result<(), Halt> {
        self.run_while(deadline, |_| true)
    }

    /// Runs until `deadline`, or until `go_on` says no: it is asked between blocks, whenever
    /// something happens.
    pub fn run_while(
        &mut self,
        deadline: Time,
        mut go_on: impl FnMut(&mut Chip) -> bool,
    ) -> Result<(), Halt> {
        while self.now() < deadline {
            self.step(deadline)?;
            if !go_on(&mut self.state.chip.borrow_mut()) {
                break;
            }
        }
        Ok(())
    }

    /// Runs to the next event, exception or sleep.
    fn step(&mut self, deadline: Time) -> Result<(), Halt> {
        self.pass_time()?;
        let reset = self.state.chip.borrow_mut().take_reset();
        if let Some(cause) = reset {
            return self.restart(cause);
        }
        if self.is_locked_up {
            self.chip(|chip| chip.core.nvic.forget_news());
            return self.sleep(deadline);
        }
        self.sync_flash();
        let masks = self.masks();
        let (next, wakes) = {
            let nvic = &mut self.state.chip.borrow_mut().core.nvic;
            nvic.forget_news();
            (nvic.next(masks), nvic.any_pending())
        };
        if let Some(exception) = next {
            self.enter(exception);
            return Ok(());
        }
        if self.sleeps {
            // An interrupt that is only masked wakes WFI, and here WFE as well (SEVONPEND or not:
            // code that waits is made to look again).
            if wakes && masks.primask {
                self.sleeps = false;
            } else {
                return self.sleep(deadline);
            }
        }
        let until = self.state.chip.borrow().next_event().min(deadline);
        self.state.stop_at.set(until);
        self.state.deadline.set(deadline);
        self.state.masks.set(wakes.then(|| cpu::raw_masks(&self.unicorn)));
        self.execute()
    }

    /// Time passes without the CPU until something may wake it, or the world may see something.
    fn sleep(&mut self, deadline: Time) -> Result<(), Halt> {
        let state = self.state.clone();
        let mut chip = state.chip.borrow_mut();
        let from = state.now.get();
        let result = chip.advance_quietly(deadline, &mut Ram(&mut self.unicorn));
        state.now.set(chip.now.max(from));
        let slept = state.now.get().since(from);
        self.slept += slept;
        // Nobody waits for them.
        chip.take_transfers();
        if !chip.is_clocked_in_sleep() {
            chip.unclocked += slept;
        }
        result.map(drop).map_err(|misuse| self.misused(misuse))
    }

    /// Events up to now happen.
    fn pass_time(&mut self) -> Result<(), Halt> {
        let state = self.state.clone();
        let mut chip = state.chip.borrow_mut();
        let result = chip.advance(state.now.get(), &mut Ram(&mut self.unicorn));
        result
            .and_then(|()| chip.settle(&mut Ram(&mut self.unicorn)))
            .map_err(|misuse| self.misused(misuse))?;
        state.follow(&mut chip);
        Ok(())
    }

    /// Executes code until a hook stops it, or it sleeps, or it faults.
    fn execute(&mut self) -> Result<(), Halt> {
        self.state.why.set(Why::Nothing);
        let pc = self.get(RegisterARM::PC);
        let result = self.unicorn.emu_start(pc | 1, 0xFFFF_FFFE, 0, 0);
        if let Some(misuse) = self.state.misuse.borrow_mut().take() {
            return Err(self.misused(misuse));
        }
        match (result, self.state.why.get()) {
            (Ok(()), Why::Due | Why::Misuse) => Ok(()),
            (_, Why::Interrupt(cpu::EXCEPTION_EXIT)) => self.leave(),
            (_, Why::Interrupt(cpu::SUPERVISOR_CALL)) => {
                self.chip(|chip| chip.core.nvic.pend(crate::chip::nvic::SV_CALL));
                Ok(())
            }
            (Err(uc_error::INSN_INVALID), _) if self.is_after(cpu::WFE) => {
                self.sleeps = !self.state.event.replace(false);
                self.note_sleep();
                Ok(())
            }
            (Ok(()), Why::Nothing) if self.is_after(cpu::WFI) => {
                self.sleeps = true;
                self.note_sleep();
                Ok(())
            }
            (Err(error), _) => self.fault(error),
            (Ok(()), why) => Err(self.gave_up(format!("it stopped by itself ({why:?})"))),
        }
    }

    fn note_sleep(&mut self) {
        if self.sleeps {
            self.chip(|chip| chip.trace.add(chip.now, Event::Sleep));
        }
    }

    fn is_after(&self, instruction: u16) -> bool {
        let pc = self.get(RegisterARM::PC);
        let mut bytes = [0; 2];
        self.unicorn.mem_read(pc.wrapping_sub(2), &mut bytes).is_ok()
            && u16::from_le_bytes(bytes) == instruction
    }

    /// The core meets something that it cannot execute.
    fn fault(&mut self, error: uc_error) -> Result<(), Halt> {
        let pc = self.get(RegisterARM::PC) as u32;
        let cause = match error {
            uc_error::READ_UNMAPPED | uc_error::WRITE_UNMAPPED => {
                FaultCause::Bus(self.state.bad_address.get())
            }
            uc_error::FETCH_UNMAPPED | uc_error::FETCH_PROT => FaultCause::Fetch(pc),
            uc_error::INSN_INVALID | uc_error::EXCEPTION => FaultCause::Undefined,
            _ => return Err(self.gave_up(format!("{error:?}"))),
        };
        let handles_fault = self.chip(|chip| {
            let handles =
                chip.core.nvic.active().is_some_and(|active| active <= crate::chip::nvic::HARD_FAULT);
            chip.core.escalate(cause);
            handles
        });
        if handles_fault {
            self.lock_up(pc)?;
        }
        Ok(())
    }

    /// A fault in the handler of a fault: the core stands still until a reset (ARMv7-M, "Lockup"), for which it takes a watchdog.
    fn lock_up(&mut self, pc: u32) -> Result<(), Halt> {
        self.is_locked_up = true;
        let is_watched = self.chip(|chip| chip.is_watched());
        if is_watched { Ok(()) } else { Err(Halt::LockUp { time: self.now(), pc }) }
    }

    fn power_up(&mut self) -> Result<(), Halt> {
        self.powered_up += 1;
        let mut noise = vec![0; RAM_BYTES as usize];
        Pcg64::seed_from_u64(self.options.seed ^ self.powered_up << 16).fill_bytes(&mut noise);
        self.poke(RAM_START, &noise);
        self.watch_damage();
        self.restart(ResetCause::Power)
    }

    fn restart(&mut self, cause: ResetCause) -> Result<(), Halt> {
        self.chip(|chip| chip.reset(cause));
        (self.sleeps, self.is_locked_up) = (false, false);
        self.sync_flash();
        self.state.event.set(false);
        self.state.counter.borrow_mut().forget_code();
        // Another program may lie where one lay whose translation unicorn has kept.
        self.unicorn.ctl_flush_tb().map_err(|error| self.gave_up(format!("{error:?}")))?;
        self.pass_time()?;
        self.reset_registers();
        Ok(())
    }

    /// Shows the CPU what the flash really holds.
    fn sync_flash(&mut self) {
        let state = self.state.clone();
        let mut chip = state.chip.borrow_mut();
        let Some(range) = chip.flash.take_changed() else { return };
        let bytes = (range.start - flash::START) as usize..(range.end - flash::START) as usize;
        let content = &chip.flash.content()[bytes];
        self.unicorn.mem_write(range.start.into(), content).expect("the flash is mapped");
    }

    /// From now on, reads of what is damaged in the flash meet ECC errors.
    fn watch_damage(&mut self) {
        if let Some(hook) = self.damage_watch.take() {
            self.unicorn.remove_hook(hook).expect("it was added");
        }
        let damaged = self.chip(|chip| chip.flash.damaged());
        let (Some(&first), Some(&last)) = (damaged.first(), damaged.last()) else { return };
        let state = self.state.clone();
        self.damage_watch = Some(self.watch_reads(first..last + 8, move |unicorn, address, size| {
            state.forget_condition(unicorn);
            if state.chip.borrow_mut().flash.check_read(address, size) {
                state.stop_at.set(Time::ZERO);
            }
        }));
    }

    /// Tells `look` of each read of these addresses by the CPU.
    fn watch_reads(
        &mut self,
        range: Range<u32>,
        look: impl Fn(&mut Unicorn<'_, ()>, u32, u32) + 'static,
    ) -> UcHookId {
        let (first, last) = (u64::from(range.start), u64::from(range.end) - 1);
        let hook = self.unicorn.add_mem_hook(
            HookType::MEM_READ,
            first,
            last,
            move |unicorn, _, address, size, _| {
                look(unicorn, address as u32, size as u32);
                true
            },
        );
        hook.expect("memory can be watched")
    }

    fn misused(&self, misuse: Misuse) -> Halt {
        Halt::Misuse { time: self.now(), pc: self.get(RegisterARM::PC) as u32, misuse }
    }

    fn gave_up(&self, reason: String) -> Halt {
        Halt::Unicorn { time: self.now(), pc: self.get(RegisterARM::PC) as u32, reason }
    }
}

#[cfg(test)]
mod tests;
