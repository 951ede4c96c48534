//! Wiring: what peripherals tell each other beside the bus: clocks, pins, edges and triggers.

use super::{
    Chip, flash::Flash, gpio::PinMode, map::Map, misuse::Misuse, peripheral::Peripheral, rcc, time::Time,
    world::World,
};

impl Chip {
    /// The world puts a level on a pin, or lets it go.
    pub fn drive(&mut self, port: char, pin: usize, level: Option<bool>) {
        if let Some((_, port)) = self.ports.iter_mut().find(|(name, _)| *name == port) {
            port.driven[pin] = level;
        }
        self.follow_pins();
        self.touch();
    }

    /// Code that a DAC's channel (0 or 1) puts out; none while it is off.
    #[must_use]
    pub fn dac_output(&self, name: &str, channel: usize) -> Option<u16> {
        self.dacs.iter().find(|(dac, _)| *dac == name).and_then(|(_, dac)| dac.output(channel))
    }

    /// Converters measure this world from now on, and it is told what the chip puts out.
    pub fn connect(&mut self, world: Box<dyn World>) {
        self.outside.connect(world, self.now);
    }

    pub(super) fn ask_world(&mut self, now: Time) {
        if let Some(world) = self.outside.world() {
            self.adcs.iter_mut().for_each(|(_, adc)| adc.sample(now, world));
        }
    }

    fn follow_adc_clocks(&mut self) {
        for (place, (_, common)) in self.adc_commons.iter().enumerate() {
            let kernel = self.rcc.adc_clock(["ADC12SEL", "ADC345SEL"][place]);
            let clock = common.clock(self.clocks.core, kernel);
            let converters = if place == 0 { 0..2 } else { 2..5 };
            self.adcs[converters].iter_mut().for_each(|(_, adc)| adc.clock = clock);
        }
    }

    /// Each line of the EXTI sees the pin of the port that SYSCFG.EXTICR selects for it.
    pub(super) fn follow_pins(&mut self) {
        let level = |line: usize| {
            let port = self.syscfg.bank().get_at("EXTICR", line / 4, &format!("EXTI[{}]", line % 4));
            self.ports.get(port as usize).is_some_and(|(_, port)| port.level(line))
        };
        let levels = (0..16).map(|line| u16::from(level(line)) << line).sum();
        self.exti.see(levels);
    }

    /// Timers' trigger outputs reach the converters.
    pub(super) fn deliver_triggers(&mut self) {
        for (name, timer) in &mut self.timers {
            if timer.take_trigger() {
                self.adcs.iter_mut().for_each(|(_, adc)| adc.trigger(name, self.now));
                self.dacs.iter_mut().for_each(|(_, dac)| dac.trigger(name));
            }
        }
    }

    pub(super) fn follow_clocks(&mut self) {
        self.clocks = self.rcc.clocks();
        let clocks = self.clocks;
        for (name, timer) in &mut self.timers {
            timer.clock = clocks.timer(if *name == "TIM15" { clocks.apb2 } else { clocks.apb1 });
        }
        self.follow_adc_clocks();
        self.uart.clock = self.rcc.uart_clock("LPUART1SEL");
        let wired = ["TX", "RX"].map(|signal| self.is_wired("LPUART1", signal));
        self.uart.wired = wired;
    }

    /// Whether some pin carries a signal: it is set to the alternate function that the chip has.
    fn is_wired(&self, peripheral: &str, signal: &str) -> bool {
        let mut pins = Map::of_chip().peripheral(peripheral).pins(signal);
        pins.any(|(pin, function)| {
            let port = self.ports.iter().find(|(port, _)| pin[1..].starts_with(*port));
            let number = pin[2..].parse::<usize>();
            matches!((port, number), (Some((_, port)), Ok(number)) if port.mode(number) == PinMode::Alternate(function))
        })
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
        if core > rcc::HSI && self.flash.latency() < needed {
            let found = self.flash.latency();
            let rule = format!(
                "the core runs at {core} Hz with {found} wait states, {needed} are needed (FLASH chapter, ACR.LATENCY)"
            );
            return Err(Misuse::rule("FLASH", rule));
        }
        Ok(())
    }
}
