//! Crash: what happens when the firmware cannot go on.
//!
//! A panic, a fault of the core or an interrupt that nobody handles leaves a [`CrashNote`] in memory
//! that start-up code does not clear, and resets the chip. The next start finds the note and tells it
//! to whoever asks for the board's info.
//!
//! The stack lies below all statics (`memory`), as flip-link puts it: what overflows it meets no memory, and faults.
//! The core then enters the handler of faults though it could not save its registers (Arm DDI 0337E, 5.12.1).

use core::{
    fmt,
    mem::MaybeUninit,
    panic::PanicInfo,
    ptr,
    sync::atomic::{AtomicBool, Ordering},
};

use cortex_m::peripheral::SCB;
use cortex_m_rt::exception;
use dermatome_shared::restart::{CrashNote, MAX_CRASH_BYTES};
use heapless::String;

use super::vitals::stack_bounds;

#[expect(unsafe_code, reason = "only a section of its own survives a reset")]
// SAFETY: the section `.uninit` is meant for what start-up code leaves alone (cortex-m-rt, link.x).
#[unsafe(link_section = ".uninit.crash")]
static mut NOTE: MaybeUninit<CrashNote> = MaybeUninit::uninit();

/// Takes the note of the crash that ended the last run, if that is how it ended.
pub fn take_message() -> Option<String<MAX_CRASH_BYTES>> {
    #[expect(unsafe_code, reason = "the note lies in uninitialised memory")]
    // SAFETY: a CrashNote is made of integers, and memory always holds some; volatile, so that the
    // compiler assumes nothing about it. Nobody else looks before the first crash.
    let note = unsafe { ptr::read_volatile(&raw const NOTE).assume_init() };
    leave(&CrashNote::none());
    note.message()
}

/// Leaves a note and resets the chip.
fn end(what: fmt::Arguments<'_>) -> ! {
    static ENDING: AtomicBool = AtomicBool::new(false);
    cortex_m::interrupt::disable();
    // The first crash is the one to tell, should telling it crash as well.
    if !ENDING.swap(true, Ordering::Relaxed) {
        leave(&CrashNote::new(what));
        defmt::error!("{}", defmt::Display2Format(&what));
    }
    SCB::sys_reset()
}

fn leave(note: &CrashNote) {
    #[expect(unsafe_code, reason = "the note lies in uninitialised memory")]
    // SAFETY: one core, and either no task runs yet or interrupts are off for good.
    unsafe {
        ptr::write_volatile(&raw mut NOTE, MaybeUninit::new(*note));
    }
}

#[panic_handler]
fn panic(info: &PanicInfo<'_>) -> ! {
    match info.location() {
        Some(place) => end(format_args!("{}:{}: {}", place.file(), place.line(), info.message())),
        None => end(format_args!("{}", info.message())),
    }
}

#[expect(
    unsafe_code,
    reason = "the vector table has this symbol, and nothing may touch the stack before it is mended"
)]
mod entry {
    use core::arch::naked_asm;

    /// The handler of faults, which may come because there is no stack left: it takes note of where the core was, as
    /// far as the core could save that, and begins the stack anew. Nobody returns to the old one.
    // SAFETY: the vector table has this symbol, for a function that does not return. The stack pointer is given a
    // valid value before anything uses it; what lay on the stack is lost, and nothing that runs from here on needs it.
    #[unsafe(no_mangle)]
    #[unsafe(naked)]
    extern "C" fn HardFault() -> ! {
        naked_asm!(
            // r0: the frame of eight words that the core saved, or tried to; r1 and r2: PC and LR in it.
            "mov r0, sp",
            "movw r3, #:lower16:_stack_end",
            "movt r3, #:upper16:_stack_end",
            "cmp r0, r3",
            "blo 1f",
            "ldr r1, [r0, #24]",
            "ldr r2, [r0, #20]",
            "1:",
            "movw r3, #:lower16:_stack_start",
            "movt r3, #:upper16:_stack_start",
            "mov sp, r3",
            // FPCCR.LSPACT: registers of the FPU that were to be saved in that frame later are not any more.
            "movw r3, #0xEF34",
            "movt r3, #0xE000",
            "ldr r4, [r3]",
            "bic r4, r4, #1",
            "str r4, [r3]",
            "b {tell}",
            tell = sym super::tell_fault,
        )
    }
}

/// A push that does not fit moves nothing, and the core saves its frame behind it: so close to the end is no stack.
const NO_STACK: usize = 256;

extern "C" fn tell_fault(frame: usize, pc: u32, lr: u32) -> ! {
    let last = stack_bounds().0.addr();
    if frame < last {
        end(format_args!("stack overflow: no memory was left to save where it was"))
    } else if frame < last + NO_STACK {
        end(format_args!("stack overflow at {pc:#010x}, called from {lr:#010x}"))
    } else {
        end(format_args!("hard fault at {pc:#010x}, called from {lr:#010x}"))
    }
}

#[exception]
#[allow(unsafe_code, reason = "an exception handler is declared unsafe")]
unsafe fn DefaultHandler(interrupt: i16) {
    end(format_args!("interrupt {interrupt} has no handler"))
}
