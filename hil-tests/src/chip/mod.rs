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
pub mod core;
pub mod dac;
pub mod dma;
pub mod exti;
pub mod flash;
pub mod gpio;
pub mod iwdg;
pub mod map;
pub mod misuse;
pub mod nvic;
pub mod opamp;
pub mod peripheral;
pub mod plain;
pub mod pwr;
pub mod rcc;
#[cfg(test)]
mod tests;
pub mod time;
pub mod timer;
pub mod trace;
mod transfers;
pub mod usart;
mod wiring;
pub mod world;

use self::{
    adc::{Adc, common::AdcCommon},
    core::{Core, CoreMoment},
    dac::Dac,
    dma::{Dma, Dmamux},
    exti::Exti,
    flash::{Flash, Operation},
    gpio::Gpio,
    iwdg::Iwdg,
    map::Map,
    misuse::Misuse,
    nvic::{NMI, Nvic},
    opamp::Opamp,
    peripheral::{Moment, Peripheral},
    plain::Plain,
    pwr::Pwr,
    rcc::{Clocks, Rcc, ResetCause},
    time::Time,
    timer::Timer,
    trace::{Event, Trace},
    usart::Usart,
    world::Outside,
};

use std::fmt;

/// Where the RAM lies: SRAM1, SRAM2 and the second address of CCM SRAM, side by side (2.4).
pub const RAM_START: u32 = 0x2000_0000;
/// Bytes of RAM.
pub const RAM_BYTES: u32 = 128 * 1024;

/// RAM, for whoever copies without the CPU.
pub trait Memory {
    /// Reads bytes of RAM.
    fn read(&self, address: u32, bytes: &mut [u8]);
    /// Writes bytes of RAM.
    fn write(&mut self, address: u32, bytes: &[u8]);
}

/// Who looks at the flash.
pub struct Watcher(pub Box<dyn FnMut(&Flash) + Send>);

impl fmt::Debug for Watcher {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str("Watcher")
    }
}

/// The chip without its CPU.
#[derive(Debug)]
pub struct Chip {
    /// Virtual time.
    pub now: Time,
    /// Instructions executed so far; the machine keeps it current.
    pub instructions: u64,
    /// The core's private peripherals.
    pub core: Core,
    /// The flash.
    pub flash: Flash,
    /// The UART of the link.
    pub uart: Usart,
    /// What happened.
    pub trace: Trace,
    /// Looks at the flash whenever it begins to erase or program.
    pub watcher: Option<Watcher>,
    rcc: Rcc,
    pwr: Pwr,
    ports: Vec<(char, Gpio)>,
    timers: Vec<(&'static str, Timer)>,
    dma: [Dma; 2],
    dmamux: Dmamux,
    adcs: Vec<(&'static str, Adc)>,
    adc_commons: Vec<(&'static str, AdcCommon)>,
    outside: Outside,
    dacs: Vec<(&'static str, Dac)>,
    opamps: Vec<(&'static str, Opamp)>,
    exti: Exti,
    iwdg: Iwdg,
    syscfg: Plain,
    dbgmcu: Plain,
    clocks: Clocks,
    lines: Vec<Line>,
    shown_operations: u64,
    /// Something was touched since lines and requests were looked at.
    touched: bool,
    /// A port was written since its pins were shown.
    pins_touched: bool,
    /// The next event of all but link and flash, which the world may touch at any time.
    next: Option<Time>,
}

/// One way to the NVIC: a peripheral's signal and its exception.
#[derive(Clone, Copy, Debug)]
struct Line {
    peripheral: &'static str,
    signal: &'static str,
    exception: usize,
}

/// Converters, and the common registers of the first two and of the others.
const ADCS: [&str; 5] = ["ADC1", "ADC2", "ADC3", "ADC4", "ADC5"];
const ADC_COMMONS: [&str; 2] = ["ADC12_COMMON", "ADC345_COMMON"];
const DACS: [&str; 4] = ["DAC1", "DAC2", "DAC3", "DAC4"];
const OPAMPS: [&str; 6] = ["OPAMP1", "OPAMP2", "OPAMP3", "OPAMP4", "OPAMP5", "OPAMP6"];

/// Peripherals whose DMA requests and interrupts are modelled.
const WITH_SIGNALS: [&str; 17] = [
    "LPUART1", "TIM2", "TIM3", "TIM4", "TIM5", "TIM6", "TIM7", "TIM15", "DMA1", "DMA2", "FLASH", "DMAMUX1",
    "EXTI", "DAC1", "DAC2", "DAC3", "DAC4",
];

impl Chip {
    /// A chip without power, whose link runs at `wire_baud` at its other end.
    #[must_use]
    pub fn new(wire_baud: u64, keep_trace: bool) -> Self {
        let map = Map::of_chip();
        let signals = |name: &&'static str| {
            let of = map.peripheral(name).interrupts();
            of.map(|(signal, number)| Line {
                peripheral: name,
                signal,
                exception: Nvic::exception_of(number),
            })
        };
        let mut lines: Vec<Line> = WITH_SIGNALS.iter().chain(&ADCS).flat_map(signals).collect();
        // All signals of a timer are one (its model raises all of them).
        lines.retain(|line| !line.peripheral.starts_with("TIM") || line.signal == "UP");
        lines.sort_by_key(|line| line.exception);
        let timers = [
            ("TIM2", 4, 32),
            ("TIM3", 4, 16),
            ("TIM4", 4, 16),
            ("TIM5", 4, 32),
            ("TIM6", 0, 16),
            ("TIM7", 0, 16),
            ("TIM15", 2, 16),
        ];
        Self {
            now: Time::ZERO,
            instructions: 0,
            core: Core::default(),
            flash: Flash::default(),
            uart: Usart::new("LPUART1", wire_baud),
            trace: Trace::new(keep_trace),
            watcher: None,
            rcc: Rcc::default(),
            pwr: Pwr::default(),
            ports: ('A'..='G').map(|port| (port, Gpio::new(port))).collect(),
            timers: timers.map(|(name, channels, bits)| (name, Timer::new(name, channels, bits))).into(),
            dma: [Dma::new("DMA1"), Dma::new("DMA2")],
            dmamux: Dmamux::default(),
            adcs: (1..).zip(ADCS).map(|(number, name)| (name, Adc::new(number))).collect(),
            adc_commons: ADC_COMMONS.map(|name| (name, AdcCommon::new(name))).into(),
            outside: Outside::default(),
            dacs: DACS.map(|name| (name, Dac::new(name))).into(),
            opamps: OPAMPS.map(|name| (name, Opamp::new(name))).into(),
            exti: Exti::default(),
            iwdg: Iwdg::default(),
            syscfg: Plain::syscfg(),
            dbgmcu: Plain::dbgmcu(),
            clocks: Clocks::RESET,
            lines,
            shown_operations: 0,
            touched: true,
            pins_touched: true,
            next: None,
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
        self.each(|_, peripheral| peripheral.reset());
        self.rcc.restart(cause);
        self.pins_touched = true;
        self.touch();
        self.follow_clocks();
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
        if std::mem::take(&mut self.touched) {
            self.deliver_triggers();
            self.serve_requests(memory)?;
            self.raise_lines();
            self.show_analogue();
        }
        if std::mem::take(&mut self.pins_touched) {
            self.show_pins();
        }
        // Beats of the DMA touch as well; requests and lines have been looked at after the last one.
        self.touched = false;
        self.show_flash();
        for (time, event) in self.uart.take_passed() {
            self.trace.add(time, event);
        }
        if self.flash.raises_nmi() && !self.core.nvic.is_pending(NMI) && self.core.nvic.active() != Some(NMI)
        {
            self.core.nvic.pend(NMI);
        }
        Ok(())
    }

    /// Signals of one exception are or-ed.
    fn raise_lines(&mut self) {
        let lines = std::mem::take(&mut self.lines);
        for signals in lines.chunk_by(|one, other| one.exception == other.exception) {
            let is_up = |line: &Line| {
                self.model(line.peripheral)
                    .is_some_and(|model| model.bank().is_in_use && model.interrupts(line.signal))
            };
            let level = signals.iter().any(is_up);
            self.core.nvic.set_line(signals[0].exception, level);
        }
        self.lines = lines;
    }

    /// Lines, requests and events have to be looked at again.
    fn touch(&mut self) {
        self.touched = true;
        self.next = None;
    }

    /// When anything happens by itself next.
    pub fn next_event(&mut self) -> Time {
        let next = self.next.unwrap_or_else(|| self.find_next());
        self.next = Some(next);
        let world = self.uart.next_event().min(self.flash.next_event());
        next.min(world).min(self.core.next_event(self.clocks.cycle()))
    }

    fn find_next(&mut self) -> Time {
        let mut next = Time::NEVER;
        self.each(|name, peripheral| {
            if peripheral.bank().is_in_use && !matches!(name, "FLASH" | "LPUART1") {
                next = next.min(peripheral.next_event());
            }
        });
        next
    }

    /// Lets time pass, from one event to the next.
    pub fn advance(&mut self, to: Time, memory: &mut dyn Memory) -> Result<(), Misuse> {
        loop {
            let next = self.next_event();
            if next > to {
                break;
            }
            self.now = self.now.max(next);
            self.core.advance(self.now, self.clocks.cycle());
            let at = Moment { now: next, clocks: self.clocks };
            self.ask_world(next);
            let mut result = Ok(());
            self.each(|_, peripheral| {
                if peripheral.next_event() <= next && result.is_ok() {
                    result = peripheral.advance(at);
                }
            });
            result?;
            self.touch();
            self.settle(memory)?;
        }
        self.now = self.now.max(to);
        Ok(())
    }

    /// Levels of a port's output register.
    #[must_use]
    pub fn outputs(&self, port: char) -> Option<u16> {
        self.ports.iter().find(|(name, _)| *name == port).map(|(_, port)| port.outputs())
    }

    fn moment(&self) -> Moment {
        Moment { now: self.now, clocks: self.clocks }
    }

    fn core_moment(&self) -> CoreMoment {
        CoreMoment { now: self.now, cycle: self.clocks.cycle(), instructions: self.instructions }
    }

    fn model_mut(&mut self, name: &str) -> Option<&mut dyn Peripheral> {
        Some(match name {
            "RCC" => &mut self.rcc,
            "PWR" => &mut self.pwr,
            "FLASH" => &mut self.flash,
            "LPUART1" => &mut self.uart,
            "DMA1" => &mut self.dma[0],
            "DMA2" => &mut self.dma[1],
            "DMAMUX1" => &mut self.dmamux,
            "IWDG" => &mut self.iwdg,
            "EXTI" => &mut self.exti,
            "SYSCFG" => &mut self.syscfg,
            "DBGMCU" => &mut self.dbgmcu,
            _ => {
                let port = name.strip_prefix("GPIO").and_then(|rest| rest.chars().next());
                if let Some((_, port)) = self.ports.iter_mut().find(|(letter, _)| Some(*letter) == port) {
                    return Some(port);
                }
                return by_name(&mut self.timers, name)
                    .or_else(|| by_name(&mut self.dacs, name))
                    .or_else(|| by_name(&mut self.opamps, name))
                    .or_else(|| by_name(&mut self.adcs, name))
                    .or_else(|| by_name(&mut self.adc_commons, name));
            }
        })
    }

    fn model(&self, name: &str) -> Option<&dyn Peripheral> {
        Some(match name {
            "FLASH" => &self.flash,
            "LPUART1" => &self.uart,
            "DMA1" => &self.dma[0],
            "DMA2" => &self.dma[1],
            "EXTI" => &self.exti,
            _ if name.starts_with("ADC") => &self.adcs.iter().find(|(adc, _)| *adc == name)?.1,
            _ if name.starts_with("DAC") => &self.dacs.iter().find(|(dac, _)| *dac == name)?.1,
            _ => &self.timers.iter().find(|(timer, _)| *timer == name)?.1,
        })
    }

    fn each(&mut self, mut visit: impl FnMut(&str, &mut dyn Peripheral)) {
        visit("RCC", &mut self.rcc);
        visit("PWR", &mut self.pwr);
        visit("FLASH", &mut self.flash);
        visit("LPUART1", &mut self.uart);
        self.ports.iter_mut().for_each(|(_, port)| visit("GPIO", port));
        self.timers.iter_mut().for_each(|(name, timer)| visit(name, timer));
        self.dma.iter_mut().for_each(|dma| visit("DMA", dma));
        self.dacs.iter_mut().for_each(|(name, dac)| visit(name, dac));
        self.opamps.iter_mut().for_each(|(name, opamp)| visit(name, opamp));
        self.adcs.iter_mut().for_each(|(name, adc)| visit(name, adc));
        self.adc_commons.iter_mut().for_each(|(name, common)| visit(name, common));
        visit("EXTI", &mut self.exti);
        visit("DMAMUX1", &mut self.dmamux);
        visit("IWDG", &mut self.iwdg);
        visit("SYSCFG", &mut self.syscfg);
        visit("DBGMCU", &mut self.dbgmcu);
    }

    /// Tells trace and world what changed outside.
    fn show_pins(&mut self) {
        for (place, (port, model)) in self.ports.iter().enumerate() {
            let levels = model.driven_levels();
            if self.outside.show_pins(place, levels, self.now) {
                self.trace.add(self.now, Event::Pins { port: *port, levels });
            }
        }
    }

    /// Tells the world what converters and amplifiers do now.
    fn show_analogue(&mut self) {
        for (place, (_, dac)) in self.dacs.iter().enumerate() {
            for channel in 0..2 {
                self.outside.show_dac(place, channel, dac.output(channel), self.now);
            }
        }
        for (place, (_, opamp)) in self.opamps.iter().enumerate() {
            self.outside.show_opamp(place, opamp.setting(), self.now);
        }
    }

    fn show_flash(&mut self) {
        if std::mem::replace(&mut self.shown_operations, self.flash.operations()) != self.flash.operations() {
            match self.flash.operation() {
                Some(Operation::Erase(page)) => self.trace.add(self.now, Event::Erase(page)),
                Some(Operation::Program(address, _)) => self.trace.add(self.now, Event::Program(address)),
                None => {}
            }
            if let Some(Watcher(look)) = &mut self.watcher {
                look(&self.flash);
            }
        }
    }
}

fn by_name<'a, P: Peripheral>(
    all: &'a mut [(&'static str, P)],
    name: &str,
) -> Option<&'a mut dyn Peripheral> {
    all.iter_mut().find(|(known, _)| *known == name).map(|(_, model)| model as _)
}
