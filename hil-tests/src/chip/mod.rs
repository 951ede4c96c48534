//! Chip: an STM32G474RE, one file for each peripheral, joined here.
//!
//! The story of one access: the CPU (or a DMA channel) touches an address; the map says which
//! register that is; the checks every access has to pass are made here (clock on, register known,
//! no reserved bit set); the peripheral's model does what the reference manual says. Then the chip
//! *settles*: DMA channels with a request move their beats, and interrupt lines go to the NVIC.
//!
//! Time passes in [`Chip::advance`], from one event of a peripheral to the next.

mod access;
pub mod adc;
pub mod bank;
mod blocks;
pub mod clocks;
pub mod core;
pub mod crs;
pub mod dac;
pub mod dma;
pub mod exti;
pub mod fdcan;
pub mod flash;
pub mod gpio;
pub mod iwdg;
mod lines;
pub mod map;
pub mod misuse;
pub mod nvic;
pub mod opamp;
pub mod peripheral;
pub mod plain;
pub mod pwr;
mod ram;
pub mod rcc;
mod schedule;
mod shown;
pub mod system_memory;
#[cfg(test)]
mod tests;
pub mod time;
pub mod timer;
pub mod trace;
mod transfers;
pub mod usart;
pub mod usb;
mod wiring;
pub mod world;

use self::{
    access::Place,
    adc::{Adc, common::AdcCommon},
    blocks::{ADC_COMMONS, ADCS, Block, Blocks, DACS, OPAMPS, TIMERS},
    clocks::Clocks,
    core::{Core, CoreMoment},
    crs::Crs,
    dac::Dac,
    dma::{Dma, Dmamux},
    exti::Exti,
    fdcan::Fdcan,
    flash::Flash,
    gpio::Gpio,
    iwdg::Iwdg,
    lines::Lines,
    misuse::Misuse,
    nvic::NMI,
    opamp::Opamp,
    peripheral::{Moment, Peripheral},
    plain::Plain,
    pwr::Pwr,
    rcc::{Rcc, ResetCause},
    schedule::Schedule,
    time::Time,
    timer::Timer,
    trace::{Event, Trace},
    usart::Usart,
    usb::Usb,
    wiring::Wire,
    world::Outside,
};

pub use self::{
    ram::{Memory, RAM_BYTES, RAM_START, Ram},
    shown::FlashObserver,
};

/// The chip without its CPU. Nobody observes the flash of a clone, and it has a
/// copy of the world if there can be one.
#[derive(Clone, Debug)]
pub struct Chip {
    /// Virtual time.
    pub now: Time,
    /// Time in which the core had no clock; the machine adds to it.
    pub unclocked: Time,
    /// The core's private peripherals.
    pub core: Core,
    /// The flash.
    pub flash: Flash,
    /// The UART of the link.
    pub uart: Usart,
    /// The UART of a link over a shared line.
    pub usart1: Usart,
    /// The controller of a link over CAN.
    pub fdcan: Fdcan,
    /// The USB, with the host at its other end.
    pub usb: Usb,
    /// What happened.
    pub trace: Trace,
    /// Is shown the flash whenever it begins to erase or program.
    pub flash_observer: FlashObserver,
    rcc: Rcc,
    crs: Crs,
    pwr: Pwr,
    ports: Vec<Gpio>,
    timers: Vec<Timer>,
    dma: [Dma; 2],
    dmamux: Dmamux,
    adcs: Vec<Adc>,
    adc_commons: Vec<AdcCommon>,
    dacs: Vec<Dac>,
    opamps: Vec<Opamp>,
    outside: Outside,
    exti: Exti,
    iwdg: Iwdg,
    syscfg: Plain,
    dbgmcu: Plain,
    clocks: Clocks,
    cycle: Time,
    /// Cycles of the core until its clock changed last, and the clocked time until then.
    cycles: (u64, Time),
    /// Blocks of the map's peripherals, in its order.
    blocks: Vec<Option<Block>>,
    /// Registers that were accessed, with their addresses.
    places: [Option<(u32, Place)>; 64],
    lines: Lines,
    /// Pins that carry outputs of timers.
    wires: Vec<Wire>,
    shown_operations: u64,
    transfers: u64,
    /// What was touched since requests, lines, times and outputs were brought up to date.
    touched: Blocks,
    schedule: Schedule,
}

impl Chip {
    /// A chip without power, whose link runs at `wire_baud` at its other end.
    #[must_use]
    pub fn new(wire_baud: u64, keep_trace: bool) -> Self {
        Self {
            now: Time::ZERO,
            unclocked: Time::ZERO,
            core: Core::default(),
            flash: Flash::default(),
            uart: Usart::new("LPUART1", wire_baud),
            usart1: Usart::new("USART1", wire_baud),
            fdcan: Fdcan::new("FDCAN1", "FDCANRAM1"),
            usb: Usb::default(),
            trace: Trace::new(keep_trace),
            flash_observer: FlashObserver::default(),
            rcc: Rcc::default(),
            crs: Crs::default(),
            pwr: Pwr::default(),
            ports: ('A'..='G').map(Gpio::new).collect(),
            timers: TIMERS.map(|(name, channels, bits)| Timer::new(name, channels, bits)).into(),
            dma: [Dma::new("DMA1"), Dma::new("DMA2")],
            dmamux: Dmamux::default(),
            adcs: (1..=ADCS.len()).map(Adc::new).collect(),
            adc_commons: ADC_COMMONS.map(AdcCommon::new).into(),
            dacs: DACS.map(Dac::new).into(),
            opamps: OPAMPS.map(Opamp::new).into(),
            outside: Outside::default(),
            exti: Exti::default(),
            iwdg: Iwdg::default(),
            syscfg: Plain::syscfg(),
            dbgmcu: Plain::dbgmcu(),
            clocks: Clocks::RESET,
            cycle: Clocks::RESET.cycle(),
            cycles: (0, Time::ZERO),
            blocks: blocks::by_place(),
            places: [None; 64],
            lines: Lines::of_chip(),
            wires: Vec::new(),
            shown_operations: 0,
            transfers: 0,
            touched: Blocks::ALL,
            schedule: Schedule::default(),
        }
    }

    /// How fast everything runs.
    #[must_use]
    pub fn clocks(&self) -> Clocks {
        self.clocks
    }

    /// Starts again: everything but RAM, flash, time and the world's end of the link.
    pub fn reset(&mut self, cause: ResetCause) {
        let name = match cause {
            ResetCause::Power => "power",
            ResetCause::Software => "software",
            ResetCause::Watchdog => "watchdog",
            ResetCause::Pin => "reset pin",
        };
        self.trace.add(self.now, Event::Reset(name));
        self.core = Core::default();
        Block::all().for_each(|block| self.model_mut(block).reset());
        self.rcc.restart(cause);
        self.follow_clocks();
        self.follow_wires();
    }

    /// Whether a watchdog runs.
    #[must_use]
    pub fn is_watched(&self) -> bool {
        self.iwdg.is_running()
    }

    /// The watchdog or the firmware wants the chip to start again.
    pub fn take_reset(&mut self) -> Option<ResetCause> {
        if self.iwdg.take_bite() {
            return Some(ResetCause::Watchdog);
        }
        self.core.take_reset().then_some(ResetCause::Software)
    }

    /// After an access: the DMA serves its requests, and lines go to the NVIC.
    pub fn settle(&mut self, memory: &mut dyn Memory) -> Result<(), Misuse> {
        if !self.touched.is_empty() {
            self.serve_requests(memory)?;
            self.raise_lines();
            self.carry_outputs();
            self.show_outside()?;
            self.reschedule();
            self.touched = Blocks::default();
        }
        self.show_flash();
        let links = [self.uart.take_passed(), self.usart1.take_passed(), self.fdcan.take_passed()];
        for (time, event) in links.into_iter().flatten().chain(self.usb.take_passed()) {
            self.trace.add(time, event);
        }
        if self.flash.raises_nmi() && !self.core.nvic.is_pending(NMI) && self.core.nvic.active() != Some(NMI)
        {
            self.core.nvic.pend(NMI);
        }
        Ok(())
    }

    /// Levels of a port's output register.
    #[must_use]
    pub fn outputs(&self, port: char) -> Option<u16> {
        ('A'..).zip(&self.ports).find(|(name, _)| *name == port).map(|(_, port)| port.outputs())
    }

    fn moment(&self) -> Moment {
        Moment { now: self.now, clocks: self.clocks }
    }

    fn core_moment(&self) -> CoreMoment {
        CoreMoment { now: self.now, cycle: self.cycle, cycles: self.cycles() }
    }

    /// Cycles of the core's clock so far.
    fn cycles(&self) -> u64 {
        let (before, changed) = self.cycles;
        before + self.clocked().since(changed).periods(self.cycle)
    }

    fn clocked(&self) -> Time {
        self.now.since(self.unclocked)
    }

    /// Whether the core's clock runs on while the core sleeps (DBGMCU_CR.DBG_SLEEP).
    #[must_use]
    pub fn is_clocked_in_sleep(&self) -> bool {
        self.dbgmcu.bank().is_set("CR", "DBG_SLEEP")
    }

    /// Tells trace and world what changed outside.
    fn show_outside(&mut self) -> Result<(), Misuse> {
        for block in self.touched.iter() {
            self.check_pins(block)?;
            match block {
                Block::Port(place) => self.show_pins(place.into()),
                Block::Dac(place) => {
                    let (place, dac) = (usize::from(place), &self.dacs[usize::from(place)]);
                    for channel in 0..2 {
                        self.outside.show_dac(place, channel, dac.output(channel), self.now);
                    }
                }
                Block::Opamp(place) => {
                    let setting = self.opamps[usize::from(place)].setting();
                    self.outside.show_opamp(place.into(), setting, self.now);
                }
                _ => {}
            }
        }
        Ok(())
    }
}
