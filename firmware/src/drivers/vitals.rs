//! Vital signs: load of the chip's CPU, and the stack that was never used.

use cortex_m::peripheral::{DCB, DWT};
use embassy_time::Instant;

use crate::board;

/// What start-up code fills the stack with (cortex-m-rt, feature `paint-stack`).
const PAINT: u32 = 0xCCCC_CCCC;

/// Watches the chip.
pub struct VitalSigns {
    stack: StackWatch,
    looked: Instant,
    cycles: u32,
}

impl VitalSigns {
    /// Starts the counter of cycles.
    pub fn new(mut dcb: DCB, mut dwt: DWT) -> Self {
        dcb.enable_trace();
        dwt.enable_cycle_counter();
        Self { stack: StackWatch::new(), looked: Instant::now(), cycles: DWT::cycle_count() }
    }

    /// Bytes of the stack that were never used.
    pub fn free_stack(&mut self) -> u32 {
        self.stack.free()
    }

    /// Load of the CPU since this was asked last, 0 to 1: the counter stands still while the core sleeps.
    pub fn load(&mut self) -> f32 {
        let (now, cycles) = (Instant::now(), DWT::cycle_count());
        let (time, used) = (now - self.looked, cycles.wrapping_sub(self.cycles));
        (self.looked, self.cycles) = (now, cycles);
        let all = time.as_micros() as f32 * board::CYCLES_PER_MICROSECOND;
        if all > 0.0 { used as f32 / all } else { 0.0 }
    }
}

/// Looks at the free end of the stack, a part at a time: the whole takes half a millisecond, for which contacts
/// would have to wait.
struct StackWatch {
    /// The lowest word known to be used.
    used: *const u32,
    /// Where the next look begins.
    next: *const u32,
}

/// Words of a look: all of the stack is seen once in two or three seconds.
const LOOK_WORDS: usize = 1024;

impl StackWatch {
    fn new() -> Self {
        let (end, start) = stack_bounds();
        let mut watch = Self { used: start, next: end };
        while watch.next < watch.used {
            watch.look();
        }
        watch
    }

    /// Bytes at the end of the stack that still held what start-up code left there when they were looked at last.
    fn free(&mut self) -> u32 {
        let (end, _) = stack_bounds();
        if self.next >= self.used {
            self.next = end;
        }
        self.look();
        self.used.addr().saturating_sub(end.addr()) as u32
    }

    fn look(&mut self) {
        let last = self.next.wrapping_add(LOOK_WORDS).min(self.used);
        while self.next < last {
            #[expect(unsafe_code, reason = "the stack is looked at")]
            // SAFETY: it lies between the bounds of the stack, and any memory there can be read as words.
            if unsafe { self.next.read_volatile() } != PAINT {
                self.used = self.next;
                return;
            }
            self.next = self.next.wrapping_add(1);
        }
    }
}

/// First word of the stack's memory, and the one behind its last; the stack grows towards the first.
pub(super) fn stack_bounds() -> (*const u32, *const u32) {
    #[expect(unsafe_code, reason = "the linker's symbols")]
    // SAFETY: `memory` defines both; only their addresses are used.
    unsafe extern "C" {
        static mut _stack_end: u32;
        static mut _stack_start: u32;
    }
    (&raw const _stack_end, &raw const _stack_start)
}
