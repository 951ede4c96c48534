//! Vital signs: temperature of the chip, load of its CPU, and the stack that was never used.

use cortex_m::peripheral::{DCB, DWT};
use dermatome_shared::health::Vitals;
use embassy_time::Instant;

use crate::board::{self, Thermometer};

/// What start-up code fills the stack with (cortex-m-rt, feature `paint-stack`).
const PAINT: u32 = 0xCCCC_CCCC;

/// Watches the chip.
pub struct VitalSigns {
    thermometer: Thermometer,
    looked: Instant,
    cycles: u32,
}

impl VitalSigns {
    /// Starts the counter of cycles.
    pub fn new(thermometer: Thermometer, mut dcb: DCB, mut dwt: DWT) -> Self {
        dcb.enable_trace();
        dwt.enable_cycle_counter();
        Self { thermometer, looked: Instant::now(), cycles: DWT::cycle_count() }
    }

    /// How the board is, its load counted from the last time this was asked.
    pub fn take(&mut self) -> Vitals {
        Vitals { temperature: Some(self.thermometer.celsius()), load: self.load(), free_stack: free_stack() }
    }

    /// The counter stands still while the core sleeps.
    fn load(&mut self) -> f32 {
        let (now, cycles) = (Instant::now(), DWT::cycle_count());
        let (time, used) = (now - self.looked, cycles.wrapping_sub(self.cycles));
        (self.looked, self.cycles) = (now, cycles);
        let all = time.as_micros() as f32 * board::CYCLES_PER_MICROSECOND;
        if all > 0.0 { used as f32 / all } else { 0.0 }
    }
}

/// Bytes at the end of the stack that still hold what start-up code left there.
fn free_stack() -> u32 {
    #[expect(unsafe_code, reason = "the linker's symbols")]
    // SAFETY: cortex-m-rt's script defines both; only their addresses are used.
    unsafe extern "C" {
        static mut _stack_end: u32;
        static mut _stack_start: u32;
    }
    let (end, start) = (&raw const _stack_end, &raw const _stack_start);
    let mut place = end;
    #[expect(unsafe_code, reason = "the stack is looked at")]
    // SAFETY: the linker says where the stack lies; any memory there can be read as words.
    unsafe {
        while place < start && place.read_volatile() == PAINT {
            place = place.add(1);
        }
        place.byte_offset_from(end) as u32
    }
}
