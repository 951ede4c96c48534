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
/// Triggers of TSEL ("DAC interconnection" tables); code 1 is TIM8 or, for DAC3, TIM1.
const TRIGGERS: [(u32, &str); 7] =
    [(2, "TIM7"), (3, "TIM15"), (4, "TIM2"), (5, "TIM4"), (7, "TIM6"), (8, "TIM3"), (0, "software")];

/// Model of one DAC.
#[derive(Clone, Debug)]
pub struct Dac {
    bank: Bank,
    holding: [u16; CHANNELS],
    output: [u16; CHANNELS],
    asks: [bool; CHANNELS],
}

impl Dac {
    /// The converter of that name.
    #[must_use]
    pub fn new(name: &str) -> Self {
        Self { bank: Bank::new(name, &[]), holding: [0; 2], output: [0; 2], asks: [false; 2] }
    }

    /// Code that a channel (0 or 1) puts out; none while it is off.
    #[must_use]
    pub fn output(&self, channel: usize) -> Option<u16> {
        self.is_set("EN", channel).then_some(self.output[channel])
    }

    /// A trigger output of that timer, or "software", fires.
    pub fn trigger(&mut self, source: &str) {
        for channel in 0..CHANNELS {
            if self.trigger_of(channel) == Some(source) {
                self.convert(channel);
            }
        }
    }

    fn trigger_of(&self, channel: usize) -> Option<&'static str> {
        let code = self.bank.get("CR", &field("TSEL", channel));
        let triggered = self.is_set("EN", channel) && self.is_set("TEN", channel);
        let found = TRIGGERS.iter().find(|&&(known, _)| known == code && triggered);
        found.map(|&(_, source)| source)
    }

    /// Takes the held value over; a request that nobody has served by then is an underrun (SR.DMAUDR).
    fn convert(&mut self, channel: usize) {
        self.output[channel] = self.holding[channel];
        if !self.is_set("DMAEN", channel) || self.bank.is_set("SR", &field("DMAUDR", channel)) {
            return;
        }
        if std::mem::replace(&mut self.asks[channel], true) {
            self.bank.set("SR", &field("DMAUDR", channel), 1);
            self.asks[channel] = false;
        }
    }

    fn hold(&mut self, channel: usize, code: u32) {
        self.holding[channel] = code as u16;
        if !self.is_set("TEN", channel) {
            self.output[channel] = code as u16;
        }
    }

    fn is_set(&self, name: &str, channel: usize) -> bool {
        self.bank.is_set("CR", &field(name, channel))
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
            "DOR" => self.output[register.index].into(),
            "SR" => (0..CHANNELS).fold(value, |value, channel| {
                register.with(value, &field("DACRDY", channel), u32::from(self.is_set("EN", channel)))
            }),
            _ => value,
        }
    }

    fn write(&mut self, register: &Register, value: u32, _: Moment) -> Result<(), Misuse> {
        match register.name.as_str() {
            "DHR12R" => self.hold(register.index, value & 0xFFF),
            "DHR12L" => self.hold(register.index, value >> 4 & 0xFFF),
            "DHR8R" => self.hold(register.index, (value & 0xFF) << 4),
            "SWTRIGR" => {
                let chosen = |channel: &usize| value >> channel & 1 == 1;
                for channel in (0..CHANNELS).filter(chosen) {
                    if self.trigger_of(channel) == Some("software") {
                        self.convert(channel);
                    }
                }
                return Ok(());
            }
            // DMAUDR is cleared by writing 1.
            "SR" => {
                let old = self.bank.value(register);
                self.bank.store(register, old & !value);
                return Ok(());
            }
            "MCR" if value & !0x0000_C000 & !0x0007_0007 != 0 => {
                return Err(Misuse::rule("DAC", "double and signed data (MCR) are not modelled"));
            }
            "CR" => self.check_control(register, value)?,
            _ => {}
        }
        self.bank.store(register, value);
        Ok(())
    }

    fn interrupts(&self, _: &str) -> bool {
        let underrun =
            |channel| self.is_set("DMAUDRIE", channel) && self.bank.is_set("SR", &field("DMAUDR", channel));
        (0..CHANNELS).any(underrun)
    }

    fn requests(&self, signal: &str) -> bool {
        channel(signal).is_some_and(|channel| self.asks[channel] && self.is_set("DMAEN", channel))
    }

    fn acknowledge(&mut self, signal: &str) {
        if let Some(channel) = channel(signal) {
            self.asks[channel] = false;
        }
    }

    fn reset(&mut self) {
        *self = Self::new(self.bank.map.name);
    }
}

fn channel(signal: &str) -> Option<usize> {
    ["CH1", "CH2"].iter().position(|&known| known == signal)
}

#[cfg(test)]
mod tests;
