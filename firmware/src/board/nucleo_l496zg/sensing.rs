//! Sensing: the front end's place in the board's table, and what only this chip's registers can do.

use dermatome_shared::acquire::{CurrentRange, FrontEnd, trim::Trim};
use embassy_stm32::{
    Peri,
    adc::{Adc, AdcChannel, AnyAdcChannel, RxDma},
    dac,
    dma::Channel,
    gpio::{Level, Output, OutputType, Speed},
    pac::{self, adc::vals as adc_values},
    peripherals,
    timer::{self, low_level::TriggerSource, simple_pwm::PwmPin},
    triggers,
};

use super::Interrupts;
use crate::board::{Amplifier, Held, Sensing, SensingTimers, start_dac, start_multiplexers};

/// Cycles of the 80 MHz clock from sample to sample.
pub(in crate::board) const SAMPLE_CYCLES: u16 = 40;
/// Samples per second: 2 megasamples, in which every carrier has a whole number.
pub const SAMPLE_RATE: u32 = 80_000_000 / SAMPLE_CYCLES as u32;
/// Samples while the DAC holds a value: its buffer takes one megasample per second.
pub const SAMPLES_PER_WAVE_VALUE: usize = 2;
/// Steps of the DAC from the middle to the crest at 100 %: 1.4 V, inside its buffer's range.
pub const FULL_DRIVE_CODES: f32 = 1738.0;
/// Samples for which the multiplexers are off when they switch; parts that break before they make, as
/// the recommended ones do, need none.
pub(in crate::board) const BLANK_SAMPLES: u16 = 0;

/// Gain of the instrumentation amplifier.
const AMPLIFIER_GAIN: f32 = 19.93;
/// What the front end of docs/hardware.md does to a voltage, without the G474's own amplifier.
pub const FRONT_END: FrontEnd = FrontEnd {
    sample_rate: SAMPLE_RATE,
    // 3.3 V over 12 bits, and 12 bits more that the lock-in makes.
    volts_per_code: 3.3 / 4096.0 / 4096.0 / AMPLIFIER_GAIN,
    full_scale_current: 1e-3,
    small_range: Some(CurrentRange { full_current: 28.73e-6, bandwidth: 163.3e3 }),
    gain_bandwidth: f32::INFINITY,
    largest_gain: 1,
    bandwidths: [844e3, 157.4e3, 10e6, 965e3],
    // Fitted to the emulated board's voltages at 100 and 200 kHz.
    lead_corner: 575e3,
    waveform_rate: SAMPLE_RATE / SAMPLES_PER_WAVE_VALUE as u32,
    // The first value is at the DAC with the third sample, and is held for two: its middle lies three
    // samples after the first. A sample is taken 24.5 clocks of the converter after its trigger.
    lead: -3.0 / SAMPLE_RATE as f32 + 24.5 / 80e6,
    trim: Trim::NONE,
};

/// Timer that is the base of time.
pub type SampleTimer = peripherals::TIM4;
/// Timer that triggers the DAC.
pub type WaveTimer = peripherals::TIM2;
/// Timer of the slots.
pub type SlotTimer = peripherals::TIM3;
/// Where TIM2 and TIM3 find the trigger output of TIM4, as drivers of others have it for such chips (SimpleFOC); not
/// looked up in RM0351.
pub(in crate::board) const SAMPLE_TRIGGER: TriggerSource = TriggerSource::ITR3;
/// DAC of the current source.
pub type WaveDac = peripherals::DAC1;
/// Its pin.
pub type WaveDacPin = peripherals::PA4;
/// Its registers.
pub(in crate::board) const DAC: pac::dac::Dac = pac::DAC1;
/// What makes it take its next value.
pub(in crate::board) const WAVE_TRIGGER: triggers::TIM2_TRGO = triggers::TIM2_TRGO;
/// Port of the multiplexers, all of its pins.
pub(in crate::board) const MULTIPLEXERS: pac::gpio::Gpio = pac::GPIOF;
/// Converter of the voltages.
pub type Converter = peripherals::ADC2;
/// Its trigger: TIM4's output (EXTSEL of `LL_ADC_REG_TRIG_EXT_TIM4_TRGO` in ST's stm32l4xx_ll_adc.h). The chip's
/// description lacks these triggers, so nothing else checks it.
const CONVERTER_TRIGGER: u8 = 12;
/// EXTEN: at rising edges.
const RISING_EDGE: u8 = 1;
/// The chip's own amplifiers are of no use here.
pub const AMPLIFIER: Option<Amplifier> = None;

/// What the front end is made of.
pub struct SensingParts {
    /// DAC of the current source.
    pub dac: Peri<'static, WaveDac>,
    /// Pin of the current source.
    pub dac_pin: Peri<'static, WaveDacPin>,
    /// DMA channel that feeds the DAC.
    pub dac_dma: Peri<'static, peripherals::DMA2_CH4>,
    /// Timer that is the base of time.
    pub sample_timer: Peri<'static, SampleTimer>,
    /// Timer that triggers the DAC.
    pub wave_timer: Peri<'static, WaveTimer>,
    /// Timer of the slots.
    pub slot_timer: Peri<'static, SlotTimer>,
    /// DMA channel that switches the multiplexers.
    pub word_dma: Peri<'static, peripherals::DMA1_CH3>,
    /// Pin that enables the multiplexers.
    pub enable_pin: Peri<'static, peripherals::PC6>,
    /// Pin that chooses the current source's range.
    pub range_pin: Peri<'static, peripherals::PC8>,
    /// Converter.
    pub converter: Peri<'static, Converter>,
    /// Pin of the converter.
    pub converter_pin: Peri<'static, peripherals::PA7>,
    /// DMA channel that takes the samples.
    pub converter_dma: Peri<'static, peripherals::DMA1_CH2>,
}

/// Sets up everything that stays as it is.
pub fn start_sensing(parts: SensingParts) -> Sensing {
    start_multiplexers();
    let wave = dac::Dma::<WaveDac, dac::Ch1>::request(&*parts.dac_dma);
    let words = timer::UpDma::<SlotTimer>::request(&*parts.word_dma);
    let ring = RxDma::<Converter>::request(&*parts.converter_dma);
    let timers = SensingTimers::new(parts.sample_timer, parts.wave_timer, parts.slot_timer);
    let held = Held {
        _converter: start_converter(parts.converter, parts.converter_pin.degrade_adc()),
        _enable_pin: PwmPin::new(parts.enable_pin, OutputType::PushPull),
        _dac: start_dac(parts.dac, parts.dac_pin),
    };
    Sensing {
        timers,
        held,
        range: Output::new(parts.range_pin, Level::Low, Speed::Low),
        wave: (Channel::new(parts.dac_dma, Interrupts), wave),
        words: (Channel::new(parts.word_dma, Interrupts), words),
        gains: None,
        ring: (Channel::new(parts.converter_dma, Interrupts), ring),
    }
}

/// Where samples come from.
pub fn converter_register() -> *mut u16 {
    pac::ADC2.dr().as_ptr().cast()
}

/// A conversion takes 24.5 + 12.5 of the 40 clocks that there are.
fn start_converter(
    converter: Peri<'static, Converter>,
    pin: AnyAdcChannel<'static, Converter>,
) -> Adc<'static, Converter> {
    let adc = Adc::new(converter);
    let channel = pin.get_hw_channel();
    pac::ADC2.sqr1().write(|w| {
        w.set_l(0);
        w.set_sq(0, channel);
    });
    let place = usize::from(channel);
    pac::ADC2.smpr(place / 10).modify(|w| w.set_smp(place % 10, adc_values::SampleTime::CYCLES24_5));
    pac::ADC2.cfgr().modify(|w| {
        w.set_extsel(CONVERTER_TRIGGER);
        w.set_exten(RISING_EDGE);
        w.set_dmacfg(adc_values::Dmacfg::CIRCULAR);
        // A new sample replaces one that nobody took.
        w.set_ovrmod(true);
    });
    pac::ADC2.isr().write(|w| w.set_adrdy(true));
    pac::ADC2.cr().modify(|w| w.set_aden(true));
    while !pac::ADC2.isr().read().adrdy() {}
    adc
}

/// The converter converts at each trigger.
pub(in crate::board) fn arm_converter() {
    pac::ADC2.cfgr().modify(|w| w.set_dmaen(true));
    pac::ADC2.isr().write(|w| {
        w.set_ovr(true);
        w.set_eoc(true);
        w.set_eos(true);
        w.set_eosmp(true);
    });
    pac::ADC2.cr().modify(|w| w.set_adstart(true));
}

/// Whether a sample was lost since the converter was armed.
pub(in crate::board) fn converter_overran() -> bool {
    pac::ADC2.isr().read().ovr()
}

/// The converter stops, and asks the DMA no more.
pub(in crate::board) fn disarm_converter() {
    pac::ADC2.cr().modify(|w| w.set_adstp(true));
    while pac::ADC2.cr().read().adstart() {}
    pac::ADC2.cfgr().modify(|w| w.set_dmaen(false));
}
