//! Chain: the timers of a scan and what they trigger, alike on all boards.
//!
//! The slave timers count the trigger output of the first, and the board's table says which timers, DAC,
//! converter and port these are.

use dermatome_shared::acquire::{demodulate::MIDDLE, scan::Timing};
use embassy_stm32::{
    Peri,
    adc::Adc,
    dac::{self, ChannelTrigger, DacChannel},
    dma::Channel,
    gpio::Output,
    mode::Blocking,
    pac,
    timer::{
        Ch1, Channel as Compare,
        low_level::{MasterMode, OutputCompareMode, SlaveMode, Timer},
        simple_pwm::PwmPin,
    },
};

use super::{
    AMPLIFIER, BLANK_SAMPLES, Converter, DAC, MULTIPLEXERS, SAMPLE_CYCLES, SAMPLE_TRIGGER,
    SAMPLES_PER_WAVE_VALUE, SampleTimer, SlotTimer, WAVE_TRIGGER, WaveDac, WaveDacPin, WaveTimer,
    arm_converter, converter_overran, disarm_converter,
};

/// The front end, set up: DMA channels come with the requests they serve.
pub struct Sensing {
    /// The three timers and what they trigger.
    pub timers: SensingTimers,
    /// What stays on.
    pub held: Held,
    /// The current source's range: low for the small one.
    pub range: Output<'static>,
    /// Feeds the DAC.
    pub wave: (Channel<'static>, u8),
    /// Switches the multiplexers.
    pub words: (Channel<'static>, u8),
    /// Sets the gain of the [`Amplifier`](super::Amplifier), if there is one.
    pub gains: Option<(Channel<'static>, u8)>,
    /// Takes the samples.
    pub ring: (Channel<'static>, u8),
}

/// What dropping would switch off.
pub struct Held {
    pub(super) _dac: DacChannel<'static, Blocking>,
    pub(super) _converter: Adc<'static, Converter>,
    pub(super) _enable_pin: PwmPin<'static, SlotTimer, Ch1>,
}

/// The three timers and what they trigger.
pub struct SensingTimers {
    sample: Timer<'static, SampleTimer>,
    wave: Timer<'static, WaveTimer>,
    slot: Timer<'static, SlotTimer>,
}

impl SensingTimers {
    /// Sets them up, standing still.
    pub(super) fn new(
        sample: Peri<'static, SampleTimer>,
        wave: Peri<'static, WaveTimer>,
        slot: Peri<'static, SlotTimer>,
    ) -> Self {
        Self { sample: sample_timer(sample), wave: wave_timer(wave), slot: slot_timer(slot) }
    }

    /// Starts the scan: its first slot begins with the first sample.
    pub fn start(&mut self, timing: Timing) {
        let slot = timing.slot_samples() as u16;
        self.slot.regs_gp16().arr().write(|w| w.set_arr(slot - 1));
        self.slot.regs_gp16().cnt().write(|w| w.set_cnt(slot - 1));
        self.slot.enable_update_dma(true);
        self.slot.set_cc_dma_enable_state(Compare::Ch2, AMPLIFIER.is_some());
        self.slot.set_output_compare_mode(Compare::Ch1, OutputCompareMode::PwmMode2);
        // The first sample triggers the DAC, then every other.
        self.wave.regs_gp32().cnt().write_value(SAMPLES_PER_WAVE_VALUE as u32 - 1);
        DAC.dhr12r(0).write(|w| w.set_dhr(MIDDLE));
        DAC.sr().write(|w| w.set_dmaudr(0, true));
        DAC.cr().modify(|w| w.set_dmaen(0, true));
        arm_converter();
        self.slot.start();
        self.wave.start();
        self.sample.regs_gp16().cnt().write(|w| w.set_cnt(0));
        self.sample.start();
    }

    /// Whether the DMA has come too late: a sample is lost, or the DAC has stopped at a value.
    pub fn has_lost_step(&self) -> bool {
        converter_overran() || DAC.sr().read().dmaudr(0)
    }

    /// Stops the scan; the DAC stays where it is, and all switches open.
    pub fn stop(&mut self) {
        self.slot.set_output_compare_mode(Compare::Ch1, OutputCompareMode::ForceInactive);
        self.sample.stop();
        self.slot.stop();
        self.wave.stop();
        self.slot.enable_update_dma(false);
        self.slot.set_cc_dma_enable_state(Compare::Ch2, false);
        DAC.cr().modify(|w| w.set_dmaen(0, false));
        disarm_converter();
    }
}

/// Where a table of the multiplexers' words goes.
pub fn multiplexer_register() -> *mut u16 {
    MULTIPLEXERS.odr().as_ptr().cast()
}

/// Where a table of the DAC's codes goes. It takes whole words only.
pub fn dac_register() -> *mut u32 {
    DAC.dhr12r(0).as_ptr().cast()
}

/// The base of time: its trigger output fires for each sample.
fn sample_timer(timer: Peri<'static, SampleTimer>) -> Timer<'static, SampleTimer> {
    let timer = Timer::new(timer);
    timer.regs_gp16().arr().write(|w| w.set_arr(SAMPLE_CYCLES - 1));
    timer.set_master_mode(MasterMode::UPDATE);
    timer
}

/// Counts samples, and triggers the DAC.
fn wave_timer(timer: Peri<'static, WaveTimer>) -> Timer<'static, WaveTimer> {
    let timer = Timer::new(timer);
    timer.regs_gp32().arr().write_value(SAMPLES_PER_WAVE_VALUE as u32 - 1);
    timer.set_master_mode(MasterMode::UPDATE);
    timer.set_trigger_source(SAMPLE_TRIGGER);
    timer.set_slave_mode(SlaveMode::EXT_CLOCK_MODE);
    timer
}

/// Counts samples, and switches multiplexers and amplifier at the start of each slot.
fn slot_timer(timer: Peri<'static, SlotTimer>) -> Timer<'static, SlotTimer> {
    let timer = Timer::new(timer);
    timer.set_compare_value(Compare::Ch2, 0);
    // Until a scan begins, all switches are open.
    timer.set_output_compare_mode(Compare::Ch1, OutputCompareMode::ForceInactive);
    timer.set_compare_value(Compare::Ch1, BLANK_SAMPLES);
    timer.enable_channel(Compare::Ch1, true);
    timer.set_trigger_source(SAMPLE_TRIGGER);
    timer.set_slave_mode(SlaveMode::EXT_CLOCK_MODE);
    timer
}

/// All pins of the multiplexers' port put out their addresses.
pub(super) fn start_multiplexers() {
    MULTIPLEXERS.odr().write_value(pac::gpio::regs::Odr(0));
    MULTIPLEXERS.moder().write_value(pac::gpio::regs::Moder(0x5555_5555));
    // No pulls: after reset, port B has the JTAG's.
    MULTIPLEXERS.pupdr().write_value(pac::gpio::regs::Pupdr(0));
}

/// The DAC at the middle: no current.
pub(super) fn start_dac(
    dac: Peri<'static, WaveDac>,
    pin: Peri<'static, WaveDacPin>,
) -> DacChannel<'static, Blocking> {
    let mut channel = DacChannel::new_blocking::<WaveDac, dac::Ch1>(dac, pin);
    channel.set(dac::Value::Bit12Right(MIDDLE));
    let trigger = ChannelTrigger::<WaveDac>::signal(&WAVE_TRIGGER);
    // Not the driver's own way to switch it off, which takes the clock away as well.
    DAC.cr().modify(|w| w.set_en(0, false));
    DAC.cr().modify(|w| {
        w.set_tsel(0, trigger);
        w.set_ten(0, true);
        w.set_en(0, true);
    });
    channel
}
