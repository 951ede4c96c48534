//! Front end: current source, multiplexers, amplifier and converter, run by timers and DMA.
//!
//! One timer is the base of time. Its trigger output starts each conversion, and clocks two more timers:
//!
//! ```text
//! sample timer -+-> converter ------------- DMA -> ring of samples
//!               +-> waveform timer -> DAC <- DMA - one carrier period
//!               +-> slot timer -+--- DMA -> port of the multiplexers  <- word of the next slot
//!                               +--- DMA -> programmable amplifier    <- gain of the next slot
//! ```
//!
//! A board without a programmable amplifier leaves out the last line.
//!
//! Nothing can get out of step: a slot is a number of samples, and a carrier period is one too. The
//! CPU only looks at the ring now and then.

use core::{
    ptr, slice,
    sync::atomic::{AtomicU16, AtomicU32, Ordering, fence},
};

use dermatome_shared::{
    acquire::{Acquisition, demodulate::MIDDLE, scan::multiplexer_word, trigonometry::cosine},
    drive::GAINS,
    limits::{MAX_PERIOD, MAX_SLOTS},
};
use embassy_stm32::{
    dma::{Channel, Transfer, TransferOptions},
    gpio::{Level, Output},
};
use embassy_time::{Duration, Instant, Timer};

use crate::board::{self, SensingParts};

/// Samples in the ring: 2 ms at 2 megasamples.
const RING_SAMPLES: usize = 4096;
/// As many not coming at all is no accident of timing.
const STILL_SAMPLES: usize = 200;
/// Steps in which the current rises and falls.
pub const RAMP_STEPS: u32 = 8;
/// How long a step of the fall lasts: a period of the slowest carrier.
const FALL_TIME: Duration = Duration::from_micros(80);

/// How long the current source takes to be at rest after the DAC has started, which its input feels for 31 ms, or in
/// another range, whose switch needs half a millisecond.
const REST_TIME: Duration = Duration::from_millis(100);

/// What the DMA reads and writes. The CPU may change tables while they are in use.
pub struct Tables {
    wave: [AtomicU32; MAX_PERIOD / board::SAMPLES_PER_WAVE_VALUE],
    words: [AtomicU16; MAX_SLOTS],
    gains: [AtomicU32; MAX_SLOTS],
    ring: [AtomicU16; RING_SAMPLES],
}

impl Tables {
    /// Empty tables: all zero, so that they cost no flash.
    pub const fn new() -> Self {
        Self {
            wave: [const { AtomicU32::new(0) }; _],
            words: [const { AtomicU16::new(0) }; _],
            gains: [const { AtomicU32::new(0) }; _],
            ring: [const { AtomicU16::new(0) }; _],
        }
    }
}

impl Default for Tables {
    fn default() -> Self {
        Self::new()
    }
}

/// The front end, not driving.
pub struct FrontEnd {
    tables: &'static Tables,
    timers: board::SensingTimers,
    _held: board::Held,
    range: Output<'static>,
    /// Which range that is; none before the first scan.
    in_small_range: Option<bool>,
    /// When the current source is at rest there.
    at_rest: Instant,
    wave: (Channel<'static>, u8),
    words: (Channel<'static>, u8),
    gains: Option<(Channel<'static>, u8)>,
    ring: (Channel<'static>, u8),
}

/// Samples were lost, or do not come.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Missed;

impl FrontEnd {
    /// Sets up what stays as it is.
    pub fn new(parts: SensingParts, tables: &'static Tables) -> Self {
        let board::Sensing { timers, held, range, wave, words, gains, ring } = board::start_sensing(parts);
        let at_rest = Instant::MIN;
        Self { tables, timers, _held: held, range, in_small_range: None, at_rest, wave, words, gains, ring }
    }

    /// Starts to scan, with a current of this share (0 to 1) of the range that rises slowly.
    pub fn start(&mut self, acquisition: &Acquisition, share: f32) -> Scan<'_> {
        let Self { tables, timers, wave, words, gains, ring, .. } = self;
        let (slots, timing) = (acquisition.slots(), acquisition.timing());
        for (word, step) in tables.words.iter().zip(slots) {
            word.store(multiplexer_word(*step), Ordering::Relaxed);
        }
        set_gains(tables, acquisition.gains());
        let period = usize::from(timing.period) / board::SAMPLES_PER_WAVE_VALUE;
        set_wave(tables, period, 0.0);
        // What is in the tables counts before the DMA reads it.
        fence(Ordering::SeqCst);
        let transfers = [
            play(wave, &tables.wave[..period], board::dac_register()),
            play(words, &tables.words[..slots.len()], board::multiplexer_register()),
        ];
        let amplifier = gains.as_mut().zip(board::AMPLIFIER);
        let gains =
            amplifier.map(|(dma, amplifier)| play(dma, &tables.gains[..slots.len()], (amplifier.register)()));
        let ring = record(ring, &tables.ring);
        timers.start(timing);
        Scan {
            timers,
            tables,
            ring,
            _transfers: transfers,
            _gains: gains,
            next: 0,
            last: Instant::now(),
            period,
            share,
            risen: 0,
        }
    }

    /// Takes the current source to one of its ranges; says when it is at rest there. All switches of the multiplexers are
    /// open: the skin feels nothing of it.
    pub fn choose_range(&mut self, is_small: bool) -> Instant {
        if self.in_small_range.replace(is_small) != Some(is_small) {
            self.range.set_level(if is_small { Level::Low } else { Level::High });
            self.at_rest = Instant::now() + REST_TIME;
        }
        self.at_rest
    }
}

/// A scan under way.
pub struct Scan<'a> {
    timers: &'a mut board::SensingTimers,
    tables: &'static Tables,
    ring: Transfer<'a>,
    _transfers: [Transfer<'a>; 2],
    _gains: Option<Transfer<'a>>,
    /// Place in the ring of the next sample to take.
    next: usize,
    /// When the ring was looked at last.
    last: Instant,
    period: usize,
    /// Share of the current source's range, 0 to 1.
    share: f32,
    /// Steps by which the current has risen.
    risen: u32,
}

impl Scan<'_> {
    /// Hands the samples that have come since to `take`, in one or two pieces.
    pub fn take(&mut self, mut take: impl FnMut(&[u16])) -> Result<(), Missed> {
        self.rise();
        let now = Instant::now();
        let end = (RING_SAMPLES - self.ring.get_remaining_transfers() as usize) % RING_SAMPLES;
        let since = now - self.last;
        let is_still = end == self.next && since >= board::duration_of_samples(STILL_SAMPLES);
        if is_still || since >= board::duration_of_samples(RING_SAMPLES) || self.timers.has_lost_step() {
            return Err(Missed);
        }
        self.last = now;
        // What the DMA has counted is in memory.
        fence(Ordering::SeqCst);
        if end < self.next {
            take(self.samples(self.next, RING_SAMPLES));
            self.next = 0;
        }
        take(self.samples(self.next, end));
        self.next = end;
        Ok(())
    }

    /// Whether the current has not reached its amplitude yet: it rises with each [`Self::take`].
    pub fn is_rising(&self) -> bool {
        self.risen < RAMP_STEPS
    }

    /// When [`Self::take`] was called last, or the scan began.
    pub fn looked_at(&self) -> Instant {
        self.last
    }

    /// Uses these gains from now on.
    pub fn set_gains(&self, gains: &[u8]) {
        set_gains(self.tables, gains);
    }

    /// Lets the current fall, and stops.
    pub async fn stop(mut self) {
        while self.risen > 0 {
            self.risen -= 1;
            self.set_current();
            Timer::after(FALL_TIME).await;
        }
    }

    fn rise(&mut self) {
        if self.is_rising() {
            self.risen += 1;
            self.set_current();
        }
    }

    fn set_current(&self) {
        set_wave(self.tables, self.period, self.share * self.risen as f32 / RAMP_STEPS as f32);
    }

    /// Samples that the DMA is done with.
    fn samples(&self, from: usize, to: usize) -> &[u16] {
        let ring = &self.tables.ring[from..to];
        #[expect(unsafe_code, reason = "samples are taken where the DMA puts them")]
        // SAFETY: an AtomicU16 is a u16 in memory. The DMA is past these samples, and comes back to them
        // only after a whole turn of the ring, which `take` checks for.
        unsafe {
            slice::from_raw_parts(ring.as_ptr().cast(), ring.len())
        }
    }
}

impl Drop for Scan<'_> {
    fn drop(&mut self) {
        self.timers.stop();
    }
}

fn set_gains(tables: &Tables, gains: &[u8]) {
    let Some(amplifier) = board::AMPLIFIER else { return };
    for (word, &place) in tables.gains.iter().zip(gains) {
        let gain = GAINS.get(usize::from(place)).copied().unwrap_or(1);
        word.store((amplifier.word)(gain), Ordering::Relaxed);
    }
}

/// One period of a cosine of `amplitude` (0 to 1) around the middle: its crest is the first value.
fn set_wave(tables: &Tables, period: usize, amplitude: f32) {
    let codes = amplitude * board::FULL_DRIVE_CODES;
    for (n, value) in tables.wave.iter().enumerate().take(period) {
        let code = f32::from(MIDDLE) + codes * cosine(n as f32 / period as f32);
        value.store((code + 0.5) as u32, Ordering::Relaxed);
    }
}

/// Lets the DMA write a table to a register for ever, a value at each request.
fn play<'a, T, W: embassy_stm32::dma::word::Word>(
    (channel, request): &'a mut (Channel<'static>, u8),
    table: &'static [T],
    register: *mut W,
) -> Transfer<'a> {
    let table = ptr::slice_from_raw_parts(table.as_ptr().cast::<W>(), table.len());
    #[expect(unsafe_code, reason = "a circular transfer")]
    // SAFETY: the table is static and made of atomics of W's size; the register is one that takes W.
    unsafe {
        channel.write_raw(*request, table, register, circular())
    }
}

/// Lets the DMA fill the ring for ever.
fn record<'a>(
    (channel, request): &'a mut (Channel<'static>, u8),
    ring: &'static [AtomicU16],
) -> Transfer<'a> {
    let ring = ptr::slice_from_raw_parts_mut(ring.as_ptr().cast::<u16>().cast_mut(), ring.len());
    #[expect(unsafe_code, reason = "a circular transfer")]
    // SAFETY: the ring is static and made of atomics, which others may write.
    unsafe {
        channel.read_raw(*request, board::converter_register(), ring, circular())
    }
}

fn circular() -> TransferOptions {
    let mut options = TransferOptions::default();
    options.circular = true;
    // Nobody waits for the DMA: the ring is looked at when time comes.
    options.half_transfer_ir = false;
    options.complete_transfer_ir = false;
    options
}
