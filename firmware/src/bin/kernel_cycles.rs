//! Measures the reconstruction on a real board: cycles of the core for one image, wait states of the
//! flash included. **It awaits its first board**; the emulated board counts them by the manuals.
//!
//! It uses the patch that the board holds, so send one first (`dermatome flash`). Then, in `firmware`:
//!
//!     cargo run --release --bin kernel_cycles
//!
//! It prints the fewest and the most cycles of 20 images, for the kernel and for the portable code, and
//! whether both gave the same bits. It changes nothing in the patch slots; afterwards program the
//! firmware again.
#![no_std]
#![no_main]

use cortex_m::{asm, peripheral::DWT};
use cortex_m_rt::entry;
use defmt::info;
use defmt_rtt as _;
use dermatome_firmware::{board, drivers::flash::SlotFlash};
use dermatome_shared::{
    device::{PatchStore, flash_slots::FlashSlotStore},
    image::Image,
    limits::MAX_MEASUREMENTS,
    patch::PatchView,
    pipeline::{reconstruct, reference::DifferenceData},
};

const IMAGES: u32 = 20;

#[entry]
fn main() -> ! {
    let board = board::start();
    let store = FlashSlotStore::open(SlotFlash::new(board.flash));
    let mut core = board.core;
    core.DCB.enable_trace();
    core.DWT.enable_cycle_counter();
    match store.active().map(PatchView::open) {
        Some(Ok(patch)) => measure(&patch),
        _ => info!("the board holds no patch: send one with `dermatome flash`, then run this again"),
    }
    loop {
        asm::wfi();
    }
}

fn measure(patch: &PatchView<'_>) {
    let products = u32::from(patch.header.pixels) * u32::from(patch.header.measurements);
    info!("{} pixels x {} measurements", patch.header.pixels, patch.header.measurements);
    let (mut image, mut portable_image) = (Image::new(), Image::new());
    let (mut kernel, mut portable) = (Span::new(), Span::new());
    let mut same = true;
    for sequence in 0..IMAGES {
        let data = difference(patch, sequence);
        kernel.time(|| reconstruct::reconstruct(patch, &data, &mut image));
        portable.time(|| reconstruct::portable(patch, &data, &mut portable_image));
        same &= image == portable_image;
    }
    kernel.print("kernel", products);
    portable.print("portable", products);
    info!("same bits: {}", same);
}

/// Data of any values, as many as the patch has measurements.
fn difference(patch: &PatchView<'_>, sequence: u32) -> DifferenceData {
    let any = |measurement: u16| f32::from(mix(sequence << 16 | u32::from(measurement)) as i16) / 65_536.0;
    let relative: heapless::Vec<f32, MAX_MEASUREMENTS> = (0..patch.header.measurements).map(any).collect();
    let mut data = DifferenceData::default();
    data.quantise(&relative, patch.matrix().column_exponents());
    data
}

/// Spreads each bit over all: the finaliser of MurmurHash3.
fn mix(mut word: u32) -> u32 {
    word = (word ^ (word >> 16)).wrapping_mul(0x85EB_CA6B);
    word = (word ^ (word >> 13)).wrapping_mul(0xC2B2_AE35);
    word ^ (word >> 16)
}

/// Fewest and most cycles of a piece of work.
struct Span {
    least: u32,
    most: u32,
}

impl Span {
    fn new() -> Self {
        Self { least: u32::MAX, most: 0 }
    }

    fn time(&mut self, work: impl FnOnce()) {
        let start = DWT::cycle_count();
        work();
        let cycles = DWT::cycle_count().wrapping_sub(start);
        self.least = self.least.min(cycles);
        self.most = self.most.max(cycles);
    }

    fn print(&self, what: &str, products: u32) {
        let each = self.least as f32 / products as f32;
        info!("{}: {} to {} cycles, {} for each product", what, self.least, self.most, each);
    }
}
