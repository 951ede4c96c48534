//! Wiring: what peripherals tell each other beside the bus: clocks, pins, edges and triggers.

use super::{
    Chip,
    adc::{Adc, internal::Internal},
    blocks::{Block, Blocks, TIMERS},
    clocks::HSI,
    dac::Trigger,
    flash::Flash,
    gpio::PinMode,
    map::Map,
    misuse::Misuse,
    peripheral::Peripheral,
    time::Time,
    usb::UsbClocks,
    world::{OpampSetting, World},
};

/// A pin that carries the output of a timer's channel.
#[derive(Clone, Copy, Debug)]
pub(super) struct Wire {
    port: usize,
    pin: usize,
    timer: u8,
    channel: usize,
}

/// Pins (port and number) at which the first input and the bias of OPAMP2 are, and the outputs of DAC1 (DS12288,
/// table 12).
const OPAMP2_PINS: [(char, usize); 2] = [('A', 7), ('A', 5)];
const DAC1_PINS: [(char, usize); 2] = [('A', 4), ('A', 5)];
/// Fastest clock of converters that convert at the same time, Hz (DS12288, table 66, single-ended, VDDA of 2.7 V and
/// more).
const CONVERTERS_TOGETHER: u64 = 52_000_000;
/// Pins of the USB, which take no alternate function: D- and D+.
const USB_PINS: [(char, usize); 2] = [('A', 11), ('A', 12)];
/// Pins that UCPD1 may pull down as long as its dead battery support is on.
const UCPD1_PINS: [usize; 2] = [4, 6];

impl Chip {
    /// The DMA comes too late for the next sample of the converter of that number.
    pub fn lose_sample(&mut self, adc: usize) {
        self.adcs[adc - 1].lose_sample();
    }

    /// The DMA comes too late for the next value of DAC1's first channel.
    pub fn underrun(&mut self) {
        self.dacs[0].underrun(0);
        self.touched.insert(Block::Dac(0));
    }

    /// The world puts a level on a pin, or lets it go.
    pub fn drive(&mut self, port: char, pin: usize, level: Option<bool>) {
        if let Some(port) = port_of(port).and_then(|port| self.ports.get_mut(port)) {
            port.driven[pin] = level;
        }
        self.follow_pins();
        self.touched = Blocks::ALL;
    }

    /// Converters measure this world from now on, and it is told what the chip puts out.
    pub fn connect(&mut self, world: Box<dyn World>) {
        self.outside.connect(world, self.now);
    }

    /// The world loses its power with the chip.
    pub fn lose_power(&mut self) {
        let now = self.now;
        if let Some(world) = self.outside.world() {
            world.lose_power(now);
        }
    }

    /// Converters whose sampling ends ask the world.
    pub(super) fn ask_world(&mut self, now: Time) -> Result<(), Misuse> {
        for place in 0..self.adcs.len() {
            if let Some(internal) = self.adcs[place].measures(now) {
                self.check_internal(place, internal)?;
                self.check_converters(place, internal)?;
            }
            if let Some(world) = self.outside.world() {
                self.adcs[place].sample(now, world);
            }
        }
        Ok(())
    }

    /// A converter (from 0 on) measures inside the chip only what is on.
    fn check_internal(&self, adc: usize, internal: Internal) -> Result<(), Misuse> {
        let common = usize::from(adc >= 2);
        match (internal, internal.switch()) {
            (_, Some(field)) if !self.adc_commons[common].switches_on(field) => {
                let rule = format!("ADC{} measures {internal:?} while CCR.{field} is 0", adc + 1);
                Err(Misuse::rule("ADC", rule))
            }
            (Internal::Opamp(number), _) if !self.opamps[number - 1].reaches_converter() => {
                let rule =
                    format!("ADC{} measures OPAMP{number} while its OPAMPEN or OPAINTOEN is 0", adc + 1);
                Err(Misuse::rule("ADC", rule))
            }
            (Internal::Opamp(number), _) if !self.opamps[number - 1].is_fast() => {
                let rule = format!(
                    "ADC{} measures OPAMP{number} while its OPAHSM is 0: it slews at 6.5 V/us, and the world has no slew \
                     rate (DS12288, table 80)",
                    adc + 1
                );
                Err(Misuse::rule("ADC", rule))
            }
            (Internal::Opamp(2), _) => self.check_opamp2_pins(),
            _ => Ok(()),
        }
    }

    /// A converter that is not alone needs a slower clock, and what is inside the chip a longer look.
    fn check_converters(&self, adc: usize, internal: Internal) -> Result<(), Misuse> {
        let Some((clock, sampling)) = self.adcs[adc].converting() else { return Ok(()) };
        let others = self.adcs.iter().filter_map(Adc::converting).count() > 1;
        let (number, least) = (adc + 1, internal.least_sampling());
        if others && clock > CONVERTERS_TOGETHER {
            let rule = format!(
                "ADC{number} converts at {clock} Hz beside another one: up to {CONVERTERS_TOGETHER} Hz is allowed \
                 then (DS12288, fADC)"
            );
            return Err(Misuse::rule("ADC", rule));
        }
        if sampling < least {
            let [sampling, least] = [sampling, least].map(Time::nanoseconds);
            let rule =
                format!("ADC{number} samples {internal:?} for {sampling} ns, it takes {least} (DS12288)");
            return Err(Misuse::rule("ADC", rule));
        }
        Ok(())
    }

    /// The pin of the first input, if that is the one, and the pin of the bias, if the network ends there.
    fn check_opamp2_pins(&self) -> Result<(), Misuse> {
        let OpampSetting::Amplifier { input, gain } = self.opamps[1].setting() else { return Ok(()) };
        let [first_input, bias] = OPAMP2_PINS;
        let used = [(input == 0).then_some(first_input), (gain > 1.0).then_some(bias)];
        used.into_iter().flatten().try_for_each(|pin| self.check_analogue("OPAMP", pin))
    }

    /// Signals that are no levels need their pin to be analogue.
    fn check_analogue(&self, peripheral: &'static str, (letter, pin): (char, usize)) -> Result<(), Misuse> {
        let mode = port_of(letter).map(|port| self.ports[port].mode(pin));
        if mode == Some(PinMode::Analogue) {
            return Ok(());
        }
        Err(Misuse::rule(peripheral, format!("its pin P{letter}{pin} is not analogue (GPIO{letter}.MODER)")))
    }

    /// What belongs to the pins of a block that was touched.
    pub(super) fn check_pins(&self, block: Block) -> Result<(), Misuse> {
        match block {
            Block::Dac(0) => (0..2)
                .filter(|&channel| self.dacs[0].drives_pin(channel))
                .try_for_each(|channel| self.check_analogue("DAC", DAC1_PINS[channel])),
            Block::Usb | Block::Port(0) if self.usb.is_powered() => {
                USB_PINS.into_iter().try_for_each(|pin| self.check_analogue("USB", pin))
            }
            Block::Port(1) if !self.pwr.ends_dead_battery() => {
                // After reset they are analogue, or the debug port's.
                let is_used =
                    |pin| !matches!(self.ports[1].mode(pin), PinMode::Analogue | PinMode::Alternate(0));
                let pulled = UCPD1_PINS.into_iter().find(|&pin| is_used(pin));
                pulled.map_or(Ok(()), |pin| {
                    let rule = format!("UCPD1 may pull PB{pin} down while CR3.UCPD1_DBDIS is 0");
                    Err(Misuse::rule("PWR", rule))
                })
            }
            _ => Ok(()),
        }
    }

    fn follow_adc_clocks(&mut self) {
        for (place, common) in self.adc_commons.iter().enumerate() {
            let kernel = self.rcc.adc_clock(["ADC12SEL", "ADC345SEL"][place]);
            let clock = common.clock(self.clocks.core, kernel);
            let converters = if place == 0 { 0..2 } else { 2..5 };
            self.adcs[converters].iter_mut().for_each(|adc| adc.run_at(clock));
        }
    }

    /// Each line of the EXTI sees the pin of the port that SYSCFG.EXTICR selects for it.
    pub(super) fn follow_pins(&mut self) {
        let bank = self.syscfg.bank();
        let level = |line: usize| {
            let port = bank.word("EXTICR", line / 4) >> (4 * (line % 4)) & 0xF;
            self.ports.get(port as usize).is_some_and(|port| port.level(line))
        };
        let levels = (0..16).map(|line| u16::from(level(line)) << line).sum();
        self.exti.see(levels);
        self.touched.insert(Block::Exti);
    }

    /// Timers' trigger outputs reach their slaves and the converters.
    pub(super) fn deliver_triggers(&mut self) {
        while let Some(master) = self.firing_timer() {
            for (place, timer) in (0..).zip(&mut self.timers) {
                if timer.trigger(master, self.now) {
                    self.touched.insert(Block::Timer(place));
                }
            }
            for (place, adc) in (0..).zip(&mut self.adcs) {
                if adc.trigger(master, self.now) {
                    self.touched.insert(Block::Adc(place));
                }
            }
            for (place, dac) in (0..).zip(&mut self.dacs) {
                if dac.trigger(Trigger::Timer(master)) {
                    self.touched.insert(Block::Dac(place));
                }
            }
        }
    }

    fn firing_timer(&mut self) -> Option<u8> {
        if !self.touched.meets(Blocks::TIMERS) {
            return None;
        }
        self.timers.iter_mut().find_map(|timer| timer.take_trigger().then(|| timer.number()))
    }

    pub(super) fn follow_clocks(&mut self) {
        self.cycles = (self.cycles(), self.clocked());
        self.clocks = self.rcc.clocks();
        self.cycle = self.clocks.cycle();
        let clocks = self.clocks;
        for timer in &mut self.timers {
            timer.run_at(clocks.timer(if timer.number() == 15 { clocks.apb2 } else { clocks.apb1 }));
        }
        self.follow_adc_clocks();
        self.uart.clock = self.rcc.uart_clock("LPUART1SEL", clocks.apb1);
        self.usart1.clock = self.rcc.uart_clock("USART1SEL", clocks.apb2);
        self.fdcan.clock = self.rcc.can_clock();
        let (kernel, is_hsi48) = self.rcc.usb_clock();
        let is_exact = if is_hsi48 { self.crs.follows_frames() } else { self.rcc.pll_is_exact() };
        self.usb.run_at(UsbClocks { kernel, is_exact, bus: clocks.apb1 });
        self.touched = Blocks::ALL;
    }

    /// Finds again what pins carry.
    pub(super) fn follow_wires(&mut self) {
        let wired = |name| ["TX", "RX", "DE"].map(|signal| self.pins_with(name, signal).next().is_some());
        let [link, bus] = ["LPUART1", "USART1"].map(wired);
        self.uart.wire(link, self.now);
        self.usart1.wire(bus, self.now);
        self.fdcan.wire(["TX", "RX"].map(|signal| self.pins_with("FDCAN1", signal).next().is_some()));
        let mut wires = Vec::new();
        for (timer, (name, channels, _)) in (0..).zip(TIMERS) {
            for channel in 0..channels {
                let signal = format!("CH{}", channel + 1);
                let pins = self.pins_with(name, &signal);
                wires.extend(pins.map(|(port, pin)| Wire { port, pin, timer, channel }));
            }
        }
        self.wires = wires;
        self.follow_pins();
        self.touched = Blocks::ALL;
    }

    /// Pins (port and number) that carry a signal: they are set to the alternate function that the chip has.
    fn pins_with(&self, peripheral: &str, signal: &str) -> impl Iterator<Item = (usize, usize)> {
        let pins = Map::of_chip().peripheral(peripheral).pins(signal);
        pins.filter_map(|(name, function)| {
            let (port, pin) = (port_of(name.chars().nth(1)?)?, name[2..].parse().ok()?);
            (self.ports.get(port)?.mode(pin) == PinMode::Alternate(function)).then_some((port, pin))
        })
    }

    /// Outputs of timers that were touched reach their pins.
    pub(super) fn carry_outputs(&mut self) {
        if !self.touched.meets(Blocks::TIMERS) {
            return;
        }
        for &Wire { port, pin, timer, channel } in &self.wires {
            let level = self.timers[usize::from(timer)].output(channel);
            if self.ports[port].carry(pin, level) {
                self.touched.insert(Block::Port(port as u8));
            }
        }
    }

    /// Rules that join clocks, voltage and flash (RM0440 FLASH chapter, ACR.LATENCY, 6.1.5).
    pub(super) fn check_clocks(&self) -> Result<(), Misuse> {
        let core = self.clocks.core;
        if core > self.pwr.fastest_core() {
            return Err(Misuse::rule(
                "PWR",
                format!("the core runs at {core} Hz, too fast for its voltage (6.1.5)"),
            ));
        }
        let needed = Flash::needed_latency(core);
        if core > HSI && self.flash.latency() < needed {
            let found = self.flash.latency();
            let rule = format!(
                "the core runs at {core} Hz with {found} wait states, {needed} are needed (FLASH chapter, ACR.LATENCY)"
            );
            return Err(Misuse::rule("FLASH", rule));
        }
        Ok(())
    }
}

/// Place of a port among the ports.
fn port_of(letter: char) -> Option<usize> {
    ('A'..='G').position(|known| known == letter)
}
