//! Sensing: the front end's place in the board's table, and what only this chip's registers can do.

use dermatome_shared::{acquire::FrontEnd, demodulate::MIDDLE, scan::Timing};
use embassy_stm32::{
    Peri,
    adc::{Adc, AdcConfig, RegularTrigger, RxDma},
    dac::{self, ChannelTrigger, DacChannel},
    dma::Channel,
    gpio::OutputType,
    mode::Blocking,
    pac::{self, adc::vals as adc_values, opamp},
    peripherals,
    timer::{
        self, Ch1, Ch2,
        low_level::{MasterMode, OutputCompareMode, SlaveMode, Timer, TriggerSource},
        simple_pwm::PwmPin,
    },
    triggers,
};
use embassy_time::Duration;

use super::Interrupts;

/// Cycles of the 170 MHz clock from sample to sample.
const SAMPLE_CYCLES: u16 = 85;
/// Samples per second: 2 megasamples, in which every carrier has a whole number.
pub const SAMPLE_RATE: u32 = 170_000_000 / SAMPLE_CYCLES as u32;
/// Samples while the DAC holds a value: its buffer takes one megasample per second.
pub const SAMPLES_PER_WAVE_VALUE: usize = 2;
/// Steps of the DAC from the middle to the crest at 100 %: 1.4 V, inside its buffer's range.
pub const FULL_DRIVE_CODES: f32 = 1738.0;
/// Samples for which the multiplexers are off when they switch; parts that break before they make, as
/// the recommended ones do, need none.
const BLANK_SAMPLES: u16 = 0;

/// Gain of the instrumentation amplifier.
const AMPLIFIER_GAIN: f32 = 19.93;
/// What the front end of docs/hardware.md does to a voltage.
pub const FRONT_END: FrontEnd = FrontEnd {
    sample_rate: SAMPLE_RATE,
    // 3.3 V over 12 bits, and 12 bits more that the lock-in makes.
    volts_per_code: 3.3 / 4096.0 / 4096.0 / AMPLIFIER_GAIN,
    full_scale_current: 1e-3,
    gain_bandwidth: 13e6,
    largest_gain: 64,
    bandwidths: [466.5e3, 965e3],
    waveform_rate: SAMPLE_RATE / SAMPLES_PER_WAVE_VALUE as u32,
    // The first value is at the DAC with the third sample, and is held for two: its middle lies three
    // samples after the first. A sample is taken 6.5 clocks of the converter after its trigger.
    lead: -3.0 / SAMPLE_RATE as f32 + 6.5 / 42.5e6,
};

/// What the front end is made of.
pub struct SensingParts {
    /// DAC of the current source.
    pub dac: Peri<'static, peripherals::DAC1>,
    /// Pin of the current source.
    pub dac_pin: Peri<'static, peripherals::PA4>,
    /// DMA channel that feeds the DAC.
    pub dac_dma: Peri<'static, peripherals::DMA1_CH3>,
    /// Timer that is the base of time.
    pub sample_timer: Peri<'static, peripherals::TIM4>,
    /// Timer that triggers the DAC.
    pub wave_timer: Peri<'static, peripherals::TIM2>,
    /// Timer of the slots.
    pub slot_timer: Peri<'static, peripherals::TIM3>,
    /// DMA channel that switches the multiplexers.
    pub word_dma: Peri<'static, peripherals::DMA1_CH4>,
    /// Pin that enables the multiplexers.
    pub enable_pin: Peri<'static, peripherals::PC6>,
    /// DMA channel that sets the amplifier's gain.
    pub gain_dma: Peri<'static, peripherals::DMA1_CH5>,
    /// Pin of the programmable amplifier.
    pub amplifier_pin: Peri<'static, peripherals::PA7>,
    /// Pin that holds the amplifier's bias.
    pub bias_pin: Peri<'static, peripherals::PA5>,
    /// Converter.
    pub converter: Peri<'static, peripherals::ADC2>,
    /// DMA channel that takes the samples.
    pub converter_dma: Peri<'static, peripherals::DMA1_CH6>,
}

/// The front end, set up: DMA channels come with the requests they serve.
pub struct Sensing {
    /// The three timers and what they trigger.
    pub timers: SensingTimers,
    /// DAC of the current source.
    pub dac: DacChannel<'static, Blocking>,
    /// Feeds the DAC.
    pub wave: (Channel<'static>, u8),
    /// Switches the multiplexers.
    pub words: (Channel<'static>, u8),
    /// Sets the amplifier's gain.
    pub gains: (Channel<'static>, u8),
    /// Takes the samples.
    pub ring: (Channel<'static>, u8),
}

/// The three timers and what they trigger.
pub struct SensingTimers {
    sample: Timer<'static, peripherals::TIM4>,
    wave: Timer<'static, peripherals::TIM2>,
    slot: Timer<'static, peripherals::TIM3>,
    _converter: Adc<'static, peripherals::ADC2>,
    _enable_pin: PwmPin<'static, peripherals::TIM3, Ch1>,
}

/// Sets up everything that stays as it is.
pub fn start_sensing(parts: SensingParts) -> Sensing {
    start_multiplexers();
    start_amplifier(parts.amplifier_pin, parts.bias_pin);
    let wave = dac::Dma::<peripherals::DAC1, dac::Ch1>::request(&*parts.dac_dma);
    let words = timer::UpDma::<peripherals::TIM3>::request(&*parts.word_dma);
    let gains = timer::Dma::<peripherals::TIM3, Ch2>::request(&*parts.gain_dma);
    let ring = RxDma::<peripherals::ADC2>::request(&*parts.converter_dma);
    Sensing {
        timers: SensingTimers {
            sample: sample_timer(parts.sample_timer),
            wave: wave_timer(parts.wave_timer),
            slot: slot_timer(parts.slot_timer),
            _converter: start_converter(parts.converter),
            _enable_pin: PwmPin::new(parts.enable_pin, OutputType::PushPull),
        },
        dac: start_dac(parts.dac, parts.dac_pin),
        wave: (Channel::new(parts.dac_dma, Interrupts), wave),
        words: (Channel::new(parts.word_dma, Interrupts), words),
        gains: (Channel::new(parts.gain_dma, Interrupts), gains),
        ring: (Channel::new(parts.converter_dma, Interrupts), ring),
    }
}

/// Where a table of the multiplexers' words goes.
pub fn multiplexer_register() -> *mut u16 {
    pac::GPIOB.odr().as_ptr().cast()
}

/// Where a table of [`amplifier_word`]s goes.
pub fn amplifier_register() -> *mut u32 {
    pac::OPAMP2.csr().as_ptr().cast()
}

/// Where a table of the DAC's codes goes. It takes whole words only.
pub fn dac_register() -> *mut u32 {
    pac::DAC1.dhr12r(0).as_ptr().cast()
}

/// Where samples come from.
pub fn converter_register() -> *mut u16 {
    pac::ADC2.dr().as_ptr().cast()
}

/// How long so many samples take.
pub fn duration_of_samples(samples: usize) -> Duration {
    Duration::from_micros(samples as u64 * 1_000_000 / u64::from(SAMPLE_RATE))
}

/// What the amplifier's register has to hold for a gain of 1, 2, 4, 8, 16, 32 or 64.
pub fn amplifier_word(gain: u8) -> u32 {
    use opamp::vals::{PgaGain, VmSel, VpSel};
    let mut word = opamp::regs::Csr::default();
    word.set_opampen(true);
    word.set_opaintoen(true);
    word.set_opahsm(true);
    word.set_vp_sel(VpSel::VINP0);
    word.set_vm_sel(if gain == 1 { VmSel::OUTPUT } else { VmSel::PGA });
    // The network's foot is at the bias on VINM0; the six gains are numbered upwards.
    let number = gain.max(2).trailing_zeros() as u8 - 1;
    word.set_pga_gain(PgaGain::from_bits(PgaGain::GAIN2_INPUT_VINM0.to_bits() + number));
    word.0
}

impl SensingTimers {
    /// Starts the scan: its first slot begins with the first sample.
    pub fn start(&mut self, timing: Timing) {
        let slot = timing.slot_samples() as u16;
        self.slot.regs_gp16().arr().write(|w| w.set_arr(slot - 1));
        self.slot.regs_gp16().cnt().write(|w| w.set_cnt(slot - 1));
        self.slot.enable_update_dma(true);
        self.slot.set_cc_dma_enable_state(timer::Channel::Ch2, true);
        // The first sample triggers the DAC, then every other.
        self.wave.regs_gp32().cnt().write_value(SAMPLES_PER_WAVE_VALUE as u32 - 1);
        pac::DAC1.dhr12r(0).write(|w| w.set_dhr(MIDDLE));
        pac::DAC1.cr().modify(|w| w.set_dmaen(0, true));
        arm_converter();
        self.slot.start();
        self.wave.start();
        self.sample.regs_gp16().cnt().write(|w| w.set_cnt(0));
        self.sample.start();
    }

    /// Stops the scan; the DAC stays where it is.
    pub fn stop(&mut self) {
        self.sample.stop();
        self.slot.stop();
        self.wave.stop();
        self.slot.enable_update_dma(false);
        self.slot.set_cc_dma_enable_state(timer::Channel::Ch2, false);
        pac::DAC1.cr().modify(|w| w.set_dmaen(0, false));
        disarm_converter();
    }
}

/// The base of time: its trigger output fires for each sample.
fn sample_timer(timer: Peri<'static, peripherals::TIM4>) -> Timer<'static, peripherals::TIM4> {
    let timer = Timer::new(timer);
    timer.regs_gp16().arr().write(|w| w.set_arr(SAMPLE_CYCLES - 1));
    timer.set_master_mode(MasterMode::UPDATE);
    timer
}

/// Counts samples, and triggers the DAC.
fn wave_timer(timer: Peri<'static, peripherals::TIM2>) -> Timer<'static, peripherals::TIM2> {
    let timer = Timer::new(timer);
    timer.regs_gp32().arr().write_value(SAMPLES_PER_WAVE_VALUE as u32 - 1);
    timer.set_master_mode(MasterMode::UPDATE);
    timer.set_trigger_source(TriggerSource::ITR3);
    timer.set_slave_mode(SlaveMode::EXT_CLOCK_MODE);
    timer
}

/// Counts samples, and switches multiplexers and amplifier at the start of each slot.
fn slot_timer(timer: Peri<'static, peripherals::TIM3>) -> Timer<'static, peripherals::TIM3> {
    let timer = Timer::new(timer);
    timer.set_compare_value(timer::Channel::Ch2, 0);
    timer.set_output_compare_mode(timer::Channel::Ch1, OutputCompareMode::PwmMode2);
    timer.set_compare_value(timer::Channel::Ch1, BLANK_SAMPLES);
    timer.enable_channel(timer::Channel::Ch1, true);
    timer.set_trigger_source(TriggerSource::ITR3);
    timer.set_slave_mode(SlaveMode::EXT_CLOCK_MODE);
    timer
}

/// All pins of port B put out the multiplexers' addresses.
fn start_multiplexers() {
    pac::GPIOB.odr().write_value(pac::gpio::regs::Odr(0));
    pac::GPIOB.moder().write_value(pac::gpio::regs::Moder(0x5555_5555));
    // No pulls: port B has the JTAG's after reset.
    pac::GPIOB.pupdr().write_value(pac::gpio::regs::Pupdr(0));
}

fn start_amplifier(pin: Peri<'static, peripherals::PA7>, bias: Peri<'static, peripherals::PA5>) {
    embassy_stm32::gpio::Flex::new(pin).set_as_analog();
    embassy_stm32::gpio::Flex::new(bias).set_as_analog();
    pac::OPAMP2.csr().write_value(opamp::regs::Csr(amplifier_word(1)));
}

/// The DAC at the middle: no current.
fn start_dac(
    dac: Peri<'static, peripherals::DAC1>,
    pin: Peri<'static, peripherals::PA4>,
) -> DacChannel<'static, Blocking> {
    let mut channel = DacChannel::new_blocking(dac, pin);
    channel.set(dac::Value::Bit12Right(MIDDLE));
    let trigger = ChannelTrigger::<peripherals::DAC1>::signal(&triggers::TIM2_TRGO);
    // Not the driver's own way to switch it off, which takes the clock away as well.
    pac::DAC1.cr().modify(|w| w.set_en(0, false));
    pac::DAC1.cr().modify(|w| {
        w.set_tsel(0, trigger);
        w.set_ten(0, true);
        w.set_en(0, true);
    });
    channel
}

fn start_converter(converter: Peri<'static, peripherals::ADC2>) -> Adc<'static, peripherals::ADC2> {
    let adc = Adc::new(converter, AdcConfig::default());
    pac::ADC2.sqr1().write(|w| {
        w.set_l(0);
        w.set_sq(0, 16);
    });
    pac::ADC2.smpr2().modify(|w| w.set_smp(6, adc_values::SampleTime::CYCLES6_5));
    let trigger = RegularTrigger::<peripherals::ADC2>::signal(&triggers::TIM4_TRGO);
    pac::ADC2.cfgr().modify(|w| {
        w.set_extsel(trigger);
        w.set_exten(adc_values::Exten::RISING_EDGE);
        w.set_dmacfg(adc_values::Dmacfg::CIRCULAR);
        w.set_ovrmod(adc_values::Ovrmod::OVERWRITE);
    });
    adc
}

/// The converter converts at each trigger.
fn arm_converter() {
    pac::ADC2.cfgr().modify(|w| w.set_dmaen(adc_values::Dmaen::ENABLE));
    pac::ADC2.isr().write(|w| {
        w.set_ovr(true);
        w.set_eoc(true);
        w.set_eos(true);
        w.set_eosmp(true);
    });
    pac::ADC2.cr().modify(|w| w.set_adstart(true));
}

fn disarm_converter() {
    pac::ADC2.cr().modify(|w| w.set_adstp(adc_values::Adstp::STOP));
    while pac::ADC2.cr().read().adstart() {}
    pac::ADC2.cfgr().modify(|w| w.set_dmaen(adc_values::Dmaen::DISABLE));
}

/// Degrees Celsius for a code of the chip's sensor, by the two points that the factory has measured at
/// VDDA = 3.0 V (DS12288, "Temperature sensor calibration values").
pub fn temperature(code: u16) -> f32 {
    const FACTORY_VOLTS: f32 = 3.0;
    const VOLTS: f32 = 3.3;
    let [low, high] = [0x1FFF_75A8, 0x1FFF_75CA].map(factory_code);
    let code = f32::from(code) * VOLTS / FACTORY_VOLTS;
    30.0 + (code - low) * (130.0 - 30.0) / (high - low)
}

fn factory_code(address: usize) -> f32 {
    #[expect(unsafe_code, reason = "the factory left it at an address")]
    // SAFETY: the chip's system memory is always readable.
    let code = unsafe { core::ptr::read_volatile(address as *const u16) };
    f32::from(code)
}
