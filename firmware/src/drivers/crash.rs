//! Crash: what happens when the firmware cannot go on.
//!
//! A panic, a fault of the core or an interrupt that nobody handles leaves a [`CrashNote`] in memory
//! that start-up code does not clear, and resets the chip. The next start finds the note and tells it
//! to whoever asks for the board's info.

use core::{
    fmt,
    mem::MaybeUninit,
    panic::PanicInfo,
    ptr,
    sync::atomic::{AtomicBool, Ordering},
};

use cortex_m::peripheral::SCB;
use cortex_m_rt::{ExceptionFrame, exception};
use dermatome_shared::restart::{CrashNote, MAX_CRASH_BYTES};
use heapless::String;

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

#[exception]
#[allow(unsafe_code, reason = "an exception handler is declared unsafe")]
unsafe fn HardFault(frame: &ExceptionFrame) -> ! {
    end(format_args!("hard fault at {:#010x}, called from {:#010x}", frame.pc(), frame.lr()))
}

#[exception]
#[allow(unsafe_code, reason = "an exception handler is declared unsafe")]
unsafe fn DefaultHandler(interrupt: i16) {
    end(format_args!("interrupt {interrupt} has no handler"))
}
