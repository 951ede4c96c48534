//! DAC: two channels of twelve bits (RM0440 chapter 22): holding registers, triggers, DMA requests.
//!
//! Without a trigger the output follows its holding register at once; with one it takes the holding
//! register's value at the trigger, and asks the DMA for the next. Settling, wave generation, double
//! data, sample and hold, and offset trimming are not modelled.

use super::{
    bank::Bank,
    map::Register,
    misuse::Misuse,
    peripheral::{Moment, Peripheral, has_bank},
};

/// Channels of one converter.
const CHANNELS: usize = 2;
/// Triggers of TSEL ("DAC interconnection" tables): timers by number; 0 is software. Code 1 is TIM8 or, for
/// DAC3, TIM1.
const TRIGGERS: [(u32, Trigger); 7] = [
    (0, Trigger::Software),
    (2, Trigger::Timer(7)),
    (3, Trigger::Timer(15)),
    (4, Trigger::Timer(2)),
    (5, Trigger::Timer(4)),
    (7, Trigger::Timer(6)),
    (8, Trigger::Timer(3)),
];

/// What makes a channel take its holding register over.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Trigger {
    /// SWTRIGR.
    Software,
    /// The trigger output of the timer of that number.
    Timer(u8),
}

/// Model of one DAC.
#[derive(Clone, Debug)]
pub struct Dac {
    bank: Bank,
    channels: [Channel; CHANNELS],
}

/// One channel: what CR asks of it, and where it is.
#[derive(Clone, Copy, Debug, Default)]
struct Channel {
    is_on: bool,
    trigger: Option<Trigger>,
    uses_dma: bool,
    holding: u16,
    output: u16,
    asks: bool,
    /// SR.DMAUDR.
    underran: bool,
}

impl Dac {
    /// The converter of that name.
    #[must_use]
    pub fn new(name: &str) -> Self {
        Self { bank: Bank::new(name, &[]), channels: [Channel::default(); CHANNELS] }
    }

    /// Code that a channel (0 or 1) puts out; none while it is off.
    #[must_use]
    pub fn output(&self, channel: usize) -> Option<u16> {
        let channel = &self.channels[channel];
        channel.is_on.then_some(channel.output)
    }

    /// Whether a channel is on and its output on its pin: modes 3 and 7 keep it inside the chip (MCR.MODE).
    #[must_use]
    pub fn drives_pin(&self, channel: usize) -> bool {
        self.channels[channel].is_on && self.bank.get("MCR", &field("MODE", channel)) & 3 != 3
    }

    /// The DMA comes too late for a channel's next value.
    pub fn underrun(&mut self, channel: usize) {
        self.channels[channel].asks = false;
        self.channels[channel].underran = true;
    }

    /// A trigger fires. Says whether a channel listens to it.
    pub fn trigger(&mut self, source: Trigger) -> bool {
        let mut heard = false;
        for channel in &mut self.channels {
            if channel.is_on && channel.trigger == Some(source) {
                channel.convert();
                heard = true;
            }
        }
        heard
    }

    fn follow_control(&mut self) {
        for (place, channel) in self.channels.iter_mut().enumerate() {
            let get = |name| self.bank.get("CR", &field(name, place));
            let code = (get("TEN") == 1).then(|| get("TSEL"));
            let found = TRIGGERS.iter().find(|&&(known, _)| Some(known) == code);
            channel.trigger = found.map(|&(_, trigger)| trigger);
            (channel.is_on, channel.uses_dma) = (get("EN") == 1, get("DMAEN") == 1);
        }
    }

    /// The bus that feeds it may be so fast only with MCR.HFSEL (22.7.16), once a channel is on.
    fn check_speed(bus: u64, is_on: bool, hfsel: u32) -> Result<(), Misuse> {
        let needed = u32::from(bus > 80_000_000) + u32::from(bus > 160_000_000);
        if hfsel > 2 || is_on && hfsel < needed {
            let rule = format!("the bus runs at {bus} Hz with MCR.HFSEL = {hfsel}, {needed} is needed");
            return Err(Misuse::rule("DAC", rule));
        }
        Ok(())
    }

    fn check_control(&self, register: &Register, value: u32) -> Result<(), Misuse> {
        for channel in 0..CHANNELS {
            let get = |name| register.get(value, &field(name, channel));
            if get("WAVE") != 0 || get("CEN") != 0 {
                return Err(Misuse::rule("DAC", "waves and calibration (CR.WAVE, CR.CEN) are not modelled"));
            }
            let (code, is_on) = (get("TSEL"), get("TEN") == 1);
            if is_on && !TRIGGERS.iter().any(|&(known, _)| known == code) {
                return Err(Misuse::rule("DAC", format!("trigger {code} (CR.TSEL) is not modelled")));
            }
        }
        Ok(())
    }
}

fn field(name: &str, channel: usize) -> String {
    format!("{name}[{channel}]")
}

impl Peripheral for Dac {
    has_bank!();

    fn models(&self, register: &Register) -> bool {
        ["CR", "SWTRIGR", "DHR12R", "DHR12L", "DHR8R", "DOR", "SR", "MCR"].contains(&register.name.as_str())
    }

    fn clears_flags(&self, register: &Register) -> bool {
        matches!(register.name.as_str(), "SR" | "SWTRIGR")
    }

    /// 22.7: registers have to be accessed by words.
    fn words_only(&self) -> bool {
        true
    }

    fn read(&mut self, register: &Register, _: Moment) -> u32 {
        let value = self.bank.value(register);
        match register.name.as_str() {
            "DOR" => self.channels[register.index].output.into(),
            "SR" => (0..CHANNELS).fold(value, |value, place| {
                let channel = &self.channels[place];
                let value = register.with(value, &field("DACRDY", place), channel.is_on.into());
                register.with(value, &field("DMAUDR", place), channel.underran.into())
            }),
            _ => value,
        }
    }

    fn write(&mut self, register: &Register, value: u32, at: Moment) -> Result<(), Misuse> {
        match register.name.as_str() {
            "DHR12R" => self.channels[register.index].hold(value & 0xFFF),
            "DHR12L" => self.channels[register.index].hold(value >> 4 & 0xFFF),
            "DHR8R" => self.channels[register.index].hold((value & 0xFF) << 4),
            "SWTRIGR" => {
                for (place, channel) in self.channels.iter_mut().enumerate() {
                    let listens = channel.is_on && channel.trigger == Some(Trigger::Software);
                    if listens && value >> place & 1 == 1 {
                        channel.convert();
                    }
                }
                return Ok(());
            }
            // DMAUDR is cleared by writing 1.
            "SR" => {
                for (place, channel) in self.channels.iter_mut().enumerate() {
                    channel.underran &= register.get(value, &field("DMAUDR", place)) == 0;
                }
                return Ok(());
            }
            "MCR" if value & !0x0000_C000 & !0x0007_0007 != 0 => {
                return Err(Misuse::rule("DAC", "double and signed data (MCR) are not modelled"));
            }
            "MCR" => {
                let is_on = self.channels.iter().any(|channel| channel.is_on);
                Self::check_speed(at.clocks.core, is_on, register.get(value, "HFSEL"))?;
            }
            "CR" => {
                self.check_control(register, value)?;
                let is_on = (0..CHANNELS).any(|channel| register.get(value, &field("EN", channel)) == 1);
                Self::check_speed(at.clocks.core, is_on, self.bank.get("MCR", "HFSEL"))?;
                self.bank.store(register, value);
                self.follow_control();
            }
            _ => {}
        }
        self.bank.store(register, value);
        Ok(())
    }

    fn interrupts(&self, _: &str) -> bool {
        let enabled = |place| self.bank.is_set("CR", &field("DMAUDRIE", place));
        (0..CHANNELS).any(|place| self.channels[place].underran && enabled(place))
    }

    fn requests(&self, signal: &str) -> bool {
        channel(signal).is_some_and(|place| self.channels[place].asks && self.channels[place].uses_dma)
    }

    fn acknowledge(&mut self, signal: &str) {
        if let Some(place) = channel(signal) {
            self.channels[place].asks = false;
        }
    }

    fn reset(&mut self) {
        *self = Self::new(self.bank.map.name);
    }
}

impl Channel {
    /// Takes the held value over; a request that nobody has served by then is an underrun (SR.DMAUDR).
    fn convert(&mut self) {
        self.output = self.holding;
        if !self.uses_dma || self.underran {
            return;
        }
        if std::mem::replace(&mut self.asks, true) {
            (self.underran, self.asks) = (true, false);
        }
    }

    fn hold(&mut self, code: u32) {
        self.holding = code as u16;
        if self.trigger.is_none() {
            self.output = code as u16;
        }
    }
}

fn channel(signal: &str) -> Option<usize> {
    ["CH1", "CH2"].iter().position(|&known| known == signal)
}

#[cfg(test)]
mod tests;
