//! NUCLEO-G474RE: the one table of clocks, pins, DMA channels and interrupts.
//!
//! | what          | which                       | why                                            |
//! |---------------|-----------------------------|------------------------------------------------|
//! | system clock  | 170 MHz from HSI and PLL    | the fastest the chip does; needs no crystal    |
//! | time          | TIM5 (feature in Cargo.toml)| no acquisition chain needs it                  |
//! | link          | LPUART1                     | the debug adapter's virtual COM port           |
//! | link, pins    | PA2 sends, PA3 receives     | wired to the debug adapter on the NUCLEO board |
//! | link, DMA     | DMA1 channels 1 and 2       | any channel can serve any request on this chip |
//! | base of time  | TIM4                        | its trigger output reaches ADC2 and the timers |
//! | waveform      | TIM2, DAC1 channel 1 on PA4 | TIM2 counts TIM4, and triggers DAC1            |
//! | slots         | TIM3                        | counts TIM4, and asks the DMA twice in a slot  |
//! | multiplexers  | PB0 to PB15                 | one port: I+, I-, V+, V-, four bits each       |
//! | their enable  | PC6, TIM3 channel 1         | off around a switch, for parts that need it    |
//! | current range | PC8                         | high for 1 mA, low for 29 uA                   |
//! | amplifier     | OPAMP2, PA7 in, PA5 bias    | its output goes to ADC2 inside the chip        |
//! | converter     | ADC2, channel 16            | 2 megasamples of 12 bits                       |
//! | its clock     | 56.7 MHz from the PLL       | each sample lasts the 200 ns an OPAMP needs    |
//! | temperature   | ADC1                        | has the chip's sensor                          |
//! | sensing, DMA  | DMA1 channels 3 to 6        | waveform, multiplexers, amplifier, converter   |
//! | acquisition   | interrupt of the FMAC       | nothing else uses it; see `board::executor`    |
//! | patch slots   | flash from 144 KiB on       | the firmware has the part before, see `memory` |
//! | reflexes      | PC0 to PC3                  | low while a rule is tripped                    |
//! | watchdog      | IWDG                        | its clock is its own                           |
//!
//! With the feature `rs485`, `can` or `usb` the link is another one, and everything else the same: see `link`.

#[cfg_attr(feature = "rs485", path = "link_rs485.rs")]
#[cfg_attr(feature = "can", path = "link_can.rs")]
#[cfg_attr(feature = "usb", path = "link_usb.rs")]
mod link;
mod sensing;
#[cfg(any(feature = "rs485", feature = "can"))]
mod straps;

pub use link::*;
pub use sensing::*;

use dermatome_shared::restart::ResetCauses;
use embassy_stm32::{
    Config,
    adc::{Adc, AdcConfig},
    bind_interrupts, dma,
    gpio::{Level, Output, Speed},
    interrupt, pac, peripherals, rcc,
};

use super::{Board, ReflexPins, Thermometer, executor};

/// Electrodes its four 16:1 multiplexers switch.
pub const ELECTRODES: u8 = 16;

/// Clock of the core, in cycles per microsecond.
pub const CYCLES_PER_MICROSECOND: f32 = 170.0;

/// Where the first patch slot starts, bytes from the start of the flash; the second one follows.
pub const SLOTS_OFFSET: usize = 144 * 1024;

/// Interrupt that the acquisition runs in.
pub type AcquisitionInterrupt = interrupt::typelevel::FMAC;

/// Converter that has the chip's temperature sensor.
pub type ThermometerConverter = peripherals::ADC1;
/// Where the factory left the sensor's codes, and the degrees Celsius they were measured at with VDDA = 3.0 V
/// (DS12288, "Temperature sensor calibration values").
pub const TEMPERATURE_POINTS: [(usize, f32); 2] = [(0x1FFF_75A8, 30.0), (0x1FFF_75CA, 130.0)];

// Which interrupt calls which handler; a pair that does not belong together does not compile.
bind_interrupts!(
    /// The board's interrupts, bound to their handlers.
    pub struct Interrupts {
    #[cfg(not(any(feature = "rs485", feature = "can", feature = "usb")))]
    LPUART1 => embassy_stm32::usart::InterruptHandler<LinkUart>;
    #[cfg(feature = "rs485")]
    USART1 => embassy_stm32::usart::InterruptHandler<LinkUart>;
    #[cfg(feature = "can")]
    FDCAN1_IT0 => CanInterruptHandler;
    #[cfg(feature = "usb")]
    USB_LP => embassy_stm32::usb::InterruptHandler<LinkUsb>;
    #[cfg(not(any(feature = "can", feature = "usb")))]
    DMA1_CHANNEL1 => dma::InterruptHandler<LinkTxDma>;
    #[cfg(not(any(feature = "can", feature = "usb")))]
    DMA1_CHANNEL2 => dma::InterruptHandler<LinkRxDma>;
    DMA1_CHANNEL3 => dma::InterruptHandler<peripherals::DMA1_CH3>;
    DMA1_CHANNEL4 => dma::InterruptHandler<peripherals::DMA1_CH4>;
    DMA1_CHANNEL5 => dma::InterruptHandler<peripherals::DMA1_CH5>;
    DMA1_CHANNEL6 => dma::InterruptHandler<peripherals::DMA1_CH6>;
    FMAC => executor::InterruptHandler;
});

/// Starts the clocks and hands out the hardware. Can be called once.
pub fn start() -> Board {
    let mut config = Config::default();
    config.rcc = clocks();
    config.enable_debug_during_sleep = super::is_debugged();
    let chip = embassy_stm32::init(config);
    // The caches are on after a reset, the prefetch is not: it hides most waits of code that runs straight on.
    pac::FLASH.acr().modify(|w| w.set_prften(true));
    // While a debug probe holds the core, nobody can feed the watchdog.
    pac::DBGMCU.apb1lfzr().modify(|w| w.set_iwdg(true));
    Board {
        link: link_parts!(chip),
        sensing: SensingParts {
            dac: chip.DAC1,
            dac_pin: chip.PA4,
            dac_dma: chip.DMA1_CH3,
            sample_timer: chip.TIM4,
            wave_timer: chip.TIM2,
            slot_timer: chip.TIM3,
            word_dma: chip.DMA1_CH4,
            enable_pin: chip.PC6,
            range_pin: chip.PC8,
            gain_dma: chip.DMA1_CH5,
            amplifier_pin: chip.PA7,
            bias_pin: chip.PA5,
            converter: chip.ADC2,
            converter_dma: chip.DMA1_CH6,
        },
        thermometer: Thermometer::new(Adc::new(chip.ADC1, AdcConfig::default())),
        reflex_pins: ReflexPins([
            Output::new(chip.PC0, Level::Low, Speed::Low),
            Output::new(chip.PC1, Level::Low, Speed::Low),
            Output::new(chip.PC2, Level::Low, Speed::Low),
            Output::new(chip.PC3, Level::Low, Speed::Low),
        ]),
        flash: chip.FLASH,
        watchdog: chip.IWDG,
        core: cortex_m::Peripherals::take().expect("the board starts once"),
        reset_causes: take_reset_causes(),
    }
}

/// Reads why the chip started, and clears it for the next time.
fn take_reset_causes() -> ResetCauses {
    let flags = pac::RCC.csr().read();
    pac::RCC.csr().modify(|w| w.set_rmvf(true));
    ResetCauses {
        power: flags.borrstf(),
        watchdog: flags.iwdgrstf(),
        software: flags.sftrstf(),
        pin: flags.pinrstf(),
    }
}

/// Clears the error that flash raised when it was read; says whether there was one.
pub fn clear_flash_error() -> bool {
    let errors = pac::FLASH.eccr();
    let found = errors.read();
    // Writing a flag that is set clears it.
    errors.write_value(found);
    found.eccd() || found.eccd2()
}

/// HSI 16 MHz / 4 * 85 / 2 = 170 MHz for core and buses, and a third of that for the converters: more than the
/// 52 MHz that they may have side by side, so the thermometer waits until no scan runs.
fn clocks() -> rcc::Config {
    let mut clocks = rcc::Config::default();
    clocks.hsi = true;
    clocks.pll = Some(rcc::Pll {
        source: rcc::PllSource::HSI,
        prediv: rcc::PllPreDiv::DIV4,
        mul: rcc::PllMul::MUL85,
        divp: Some(rcc::PllPDiv::DIV6),
        divq: None,
        divr: Some(rcc::PllRDiv::DIV2),
    });
    clocks.sys = rcc::Sysclk::PLL1_R;
    clocks.mux.adc12sel = rcc::mux::Adcsel::PLL1_P;
    // The chip allows more than 150 MHz only with its core voltage boosted.
    clocks.boost = true;
    #[cfg(any(feature = "can", feature = "usb"))]
    add_link_clock(&mut clocks);
    clocks
}
