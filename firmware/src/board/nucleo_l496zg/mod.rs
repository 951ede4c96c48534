//! NUCLEO-L496ZG: the one table of clocks, pins, DMA channels and interrupts.
//!
//! It shows that another chip takes the same scan; nobody has run it, not even on an emulated chip.
//! What differs from the NUCLEO-G474RE: half the clock, no programmable amplifier, DMA channels that serve only
//! certain requests, and more flash and RAM.
//!
//! | what          | which                       | why                                            |
//! |---------------|-----------------------------|------------------------------------------------|
//! | system clock  | 80 MHz from HSI and PLL     | the fastest the chip does; needs no crystal    |
//! | time          | TIM5 (feature in Cargo.toml)| no acquisition chain needs it                  |
//! | link          | LPUART1                     | the debug adapter's virtual COM port           |
//! | link, pins    | PG7 sends, PG8 receives     | wired to the debug adapter on the NUCLEO board |
//! | link, DMA     | DMA2 channels 6 and 7       | the only ones that serve LPUART1               |
//! | base of time  | TIM4                        | its trigger output reaches ADC2 and the timers |
//! | waveform      | TIM2, DAC1 channel 1 on PA4 | TIM2 counts TIM4, and triggers DAC1            |
//! | slots         | TIM3                        | counts TIM4, and asks the DMA once in a slot   |
//! | multiplexers  | PF0 to PF15                 | one port: I+, I-, V+, V-, four bits each; port |
//! |               |                             | B has two of the board's LEDs                  |
//! | their enable  | PC6, TIM3 channel 1         | off around a switch, for parts that need it    |
//! | current range | PC8                         | high for 1 mA, low for 29 uA                   |
//! | amplifier     | none                        | OPAMP1 and 2 amplify from ground, not from the |
//! |               |                             | middle; the voltage goes straight to PA7       |
//! | converter     | ADC2 on PA7                 | 2 megasamples of 12 bits                       |
//! | temperature   | ADC1                        | has the chip's sensor                          |
//! | waveform, DMA | DMA2 channel 4              | DMA1 channel 3 serves it too, but is taken     |
//! | switch, DMA   | DMA1 channel 3              | the only one that serves updates of TIM3       |
//! | samples, DMA  | DMA1 channel 2              | DMA2 channel 4 serves it too, but is taken     |
//! | acquisition   | interrupt of the LCD        | nothing else uses it; see `board::executor`    |
//! | patch slots   | flash from 512 KiB on       | the second bank: the core never waits for it   |
//! | reflexes      | PC0 to PC3                  | low while a rule is tripped                    |
//! | watchdog      | IWDG                        | its clock is its own                           |

mod sensing;

pub use sensing::*;

use dermatome_shared::restart::ResetCauses;
use embassy_stm32::{
    Config,
    adc::Adc,
    bind_interrupts, dma,
    gpio::{Level, Output, Speed},
    interrupt, pac, peripherals, rcc, usart,
};

use super::{Board, LinkParts, ReflexPins, Thermometer, executor};

/// What the board calls itself to a host.
pub const NAME: &str = "nucleo-l496zg";
/// Electrodes its four 16:1 multiplexers switch.
pub const ELECTRODES: u8 = 16;

/// Bits per second on the link.
///
/// LPUART1 divides 80 MHz by 10240 / 256: exactly this rate. Whether this board's debug adapter keeps up was
/// not looked up.
pub const LINK_BAUD: u32 = 2_000_000;

/// Clock of the core, in cycles per microsecond.
pub const CYCLES_PER_MICROSECOND: f32 = 80.0;

/// Where the first patch slot starts, bytes from the start of the flash; the second one follows.
pub const SLOTS_OFFSET: usize = 512 * 1024;

/// UART of the link.
pub type LinkUart = peripherals::LPUART1;
/// Pin the link sends on.
pub type LinkTxPin = peripherals::PG7;
/// Pin the link receives on.
pub type LinkRxPin = peripherals::PG8;
/// DMA channel that sends.
pub type LinkTxDma = peripherals::DMA2_CH6;
/// DMA channel that receives.
pub type LinkRxDma = peripherals::DMA2_CH7;

/// Interrupt that the acquisition runs in.
pub type AcquisitionInterrupt = interrupt::typelevel::LCD;

/// Converter that has the chip's temperature sensor.
pub type ThermometerConverter = peripherals::ADC1;
/// Where the factory left the sensor's codes, and the degrees Celsius they were measured at with VDDA = 3.0 V.
/// From Zephyr's description of the chip; not looked up in DS11585.
pub const TEMPERATURE_POINTS: [(usize, f32); 2] = [(0x1FFF_75A8, 30.0), (0x1FFF_75CA, 130.0)];

// Which interrupt calls which handler; a pair that does not belong together does not compile.
bind_interrupts!(
    /// The board's interrupts, bound to their handlers.
    pub struct Interrupts {
    LPUART1 => usart::InterruptHandler<LinkUart>;
    DMA2_CHANNEL6 => dma::InterruptHandler<LinkTxDma>;
    DMA2_CHANNEL7 => dma::InterruptHandler<LinkRxDma>;
    DMA2_CHANNEL4 => dma::InterruptHandler<peripherals::DMA2_CH4>;
    DMA1_CHANNEL3 => dma::InterruptHandler<peripherals::DMA1_CH3>;
    DMA1_CHANNEL2 => dma::InterruptHandler<peripherals::DMA1_CH2>;
    LCD => executor::InterruptHandler;
});

/// Starts the clocks and hands out the hardware. Can be called once.
pub fn start() -> Board {
    let mut config = Config::default();
    config.rcc = clocks();
    // Pins PG2 to PG15 have a supply of their own, which the NUCLEO board connects.
    config.enable_independent_io_supply = true;
    config.enable_debug_during_sleep = super::is_debugged();
    let chip = embassy_stm32::init(config);
    // While a debug probe holds the core, nobody can feed the watchdog.
    pac::DBGMCU.apb1fzr1().modify(|w| w.set_iwdg(true));
    let thermometer = Adc::new(chip.ADC1);
    clock_converters();
    Board {
        link: LinkParts {
            uart: chip.LPUART1,
            tx_pin: chip.PG7,
            rx_pin: chip.PG8,
            tx_dma: chip.DMA2_CH6,
            rx_dma: chip.DMA2_CH7,
        },
        sensing: SensingParts {
            dac: chip.DAC1,
            dac_pin: chip.PA4,
            dac_dma: chip.DMA2_CH4,
            sample_timer: chip.TIM4,
            wave_timer: chip.TIM2,
            slot_timer: chip.TIM3,
            word_dma: chip.DMA1_CH3,
            enable_pin: chip.PC6,
            range_pin: chip.PC8,
            converter: chip.ADC2,
            converter_pin: chip.PA7,
            converter_dma: chip.DMA1_CH2,
        },
        thermometer: Thermometer::new(thermometer),
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
    found.eccd()
}

/// HSI 16 MHz * 10 / 2 = 80 MHz for core and buses.
fn clocks() -> rcc::Config {
    let mut clocks = rcc::Config::default();
    clocks.hsi = true;
    clocks.msi = None;
    clocks.pll = Some(rcc::Pll {
        source: rcc::PllSource::HSI,
        prediv: rcc::PllPreDiv::DIV1,
        mul: rcc::PllMul::MUL10,
        divp: None,
        divq: None,
        divr: Some(rcc::PllRDiv::DIV2),
    });
    clocks.sys = rcc::Sysclk::PLL1_R;
    // Only until `clock_converters`.
    clocks.mux.adcsel = rcc::mux::Adcsel::SYS;
    clocks
}

/// Gives all converters the 80 MHz of their bus, so that no sample has to wait for another clock. None of
/// them may be on.
fn clock_converters() {
    pac::ADC123_COMMON.ccr().modify(|w| w.set_ckmode(1));
}
