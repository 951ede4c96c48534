//! Timers: basic and general (RM0440, "Basic timers", "General-purpose timers"): counting up, update and
//! compare events, PWM outputs, and slaves that another timer starts or clocks.
//!
//! The counter is not stepped by its clock: its value follows from the time since it was set. A slave in
//! external clock mode 1 counts its master's trigger outputs instead, at the instants at which they fire:
//! the clocks that synchronisation takes on silicon are not modelled. What the model does not do
//! (counting down, input capture, other slave modes, dithering) is refused when asked for.

mod settings;

use self::settings::{CHANNELS, Output, Settings, Slave, TriggerMode, check};
use super::{
    bank::Bank,
    map::{Field, Register},
    misuse::Misuse,
    peripheral::{Moment, Peripheral, has_bank},
    time::Time,
};

/// SR and DIER: update, channels 1 to 4 and trigger lie at the same bits in both.
const INTERRUPTS: u32 = 0x5F;

/// Model of one timer.
#[derive(Clone, Debug)]
pub struct Timer {
    bank: Bank,
    channels: usize,
    widest: u64,
    number: u8,
    flags: Flags,
    settings: Settings,
    /// Clock of the counter before its prescaler, Hz.
    clock: u64,
    /// Time of one count.
    tick: Time,
    /// What PSC, ARR and CCR hold, and what of it is in use: where it is preloaded, that of the last update.
    written: Values,
    used: Values,
    /// The counter had this value at that time.
    count: u64,
    since: Time,
    /// Triggers of its master that have not made a whole count yet.
    edges: u64,
    /// Requests to the DMA that are not served: update, then one for each channel.
    pending: [bool; CHANNELS + 1],
    /// The trigger output has fired.
    fired: bool,
}

/// Prescaler, top and compare values.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Values {
    prescaler: u64,
    top: u64,
    compare: [u64; CHANNELS],
}

impl Values {
    fn read(bank: &Bank, channels: usize, widest: u64) -> Self {
        let word = |register, index| u64::from(bank.word(register, index)) & widest;
        let compare = |channel| if channel < channels { word("CCR", channel) } else { 0 };
        Self { prescaler: word("PSC", 0) + 1, top: word("ARR", 0), compare: std::array::from_fn(compare) }
    }
}

/// Flags of SR and the counter's switch, found once.
#[derive(Clone, Copy, Debug)]
struct Flags {
    on: Field,
    update: Field,
    trigger: Option<Field>,
    compare: [Option<Field>; CHANNELS],
    all: usize,
}

impl Flags {
    fn of(bank: &Bank, channels: usize) -> Self {
        let mut compare = [None; CHANNELS];
        for (channel, flag) in compare.iter_mut().enumerate().take(channels) {
            *flag = Some(bank.find("SR", &format!("CCIF[{channel}]")));
        }
        let status = bank.map.register("SR");
        Self {
            on: bank.find("CR1", "CEN"),
            update: bank.find("SR", "UIF"),
            trigger: status.has_field("TIF").then(|| status.find("TIF")),
            compare,
            all: status.place,
        }
    }
}

impl Timer {
    /// The timer of that name, with so many channels and bits.
    #[must_use]
    pub fn new(name: &str, channels: usize, bits: u32) -> Self {
        let widest = u64::MAX >> (64 - bits);
        let bank = Bank::new(name, &[("ARR", widest as u32)]);
        Self {
            channels,
            widest,
            number: name.trim_start_matches("TIM").parse().expect("timers are named by their number"),
            flags: Flags::of(&bank, channels),
            settings: Settings::read(&bank, channels),
            clock: 0,
            tick: Time::NEVER,
            written: Values::read(&bank, channels, widest),
            used: Values::read(&bank, channels, widest),
            count: 0,
            since: Time::ZERO,
            edges: 0,
            pending: [false; CHANNELS + 1],
            fired: false,
            bank,
        }
    }

    /// Its number: 2 for TIM2.
    #[must_use]
    pub fn number(&self) -> u8 {
        self.number
    }

    /// The clock of the counter, before its prescaler, has so many hertz now.
    pub fn run_at(&mut self, clock: u64) {
        if clock != self.clock {
            self.clock = clock;
            self.tick = Time::period(clock) * self.used.prescaler;
        }
    }

    /// Whether the trigger output (TRGO) has fired since it was asked last.
    pub fn take_trigger(&mut self) -> bool {
        std::mem::take(&mut self.fired)
    }

    /// The trigger output of the timer of that number fires. Says whether that did more than count.
    pub fn trigger(&mut self, master: u8, now: Time) -> bool {
        match self.settings.slave {
            Slave::Counts(of) if of == master => self.count_edge(),
            Slave::Starts(of) if of == master => {
                self.flag_trigger();
                if !self.settings.is_on {
                    self.bank.put(self.flags.on, 1);
                    self.settings.is_on = true;
                    self.since = now;
                    self.fire(TriggerMode::Enable);
                }
                true
            }
            _ => false,
        }
    }

    /// Level of a channel's output, if it is on.
    #[must_use]
    pub fn output(&self, channel: usize) -> Option<bool> {
        let output = self.settings.outputs[channel]?;
        Some(output.level(self.count, self.used.compare[channel]))
    }

    fn flag_trigger(&mut self) {
        if let Some(flag) = self.flags.trigger {
            self.bank.put(flag, 1);
        }
    }

    /// Something happens that TRGO shows if CR2.MMS says so.
    fn fire(&mut self, mode: TriggerMode) {
        self.fired |= self.settings.trigger == mode;
    }

    /// Whether time makes it count. While ARR is 0 the counter is blocked ("Auto-reload register").
    fn is_counting(&self) -> bool {
        let by_time = !matches!(self.settings.slave, Slave::Counts(_));
        self.settings.is_on && self.clock > 0 && self.used.top > 0 && by_time
    }

    fn count_edge(&mut self) -> bool {
        self.flag_trigger();
        if !self.settings.is_on || self.used.top == 0 {
            return false;
        }
        self.edges += 1;
        if self.edges < self.used.prescaler {
            return false;
        }
        self.edges = 0;
        self.count_up(1)
    }

    /// Brings count and flags up to `now`, one event after the other.
    fn catch_up(&mut self, now: Time) {
        while self.is_counting() {
            let steps = now.since(self.since).periods(self.tick).min(self.to_update());
            if steps == 0 {
                return;
            }
            let updates = steps == self.to_update();
            self.since += self.tick * steps;
            self.count_up(steps);
            if !updates {
                return;
            }
            self.skip_rounds(now);
        }
        self.since = now;
    }

    /// Ticks until the counter starts again.
    fn to_update(&self) -> u64 {
        (self.used.top + 1).saturating_sub(self.count).max(1)
    }

    /// Counts no further than to the next update. Says whether anything but the count changed.
    fn count_up(&mut self, steps: u64) -> bool {
        let updates = steps == self.to_update();
        let met = self.match_channels(self.count + 1, self.count + steps);
        self.count += steps;
        if updates {
            self.count = 0;
            self.update();
        }
        met || updates
    }

    /// Flags do not count: of many rounds that are due, all but the last two go by at once.
    fn skip_rounds(&mut self, now: Time) {
        let round = self.tick * (self.used.top + 1);
        let late = now.since(self.since);
        if self.is_counting() && late > round {
            self.since += round * late.periods(round).saturating_sub(1);
        }
    }

    fn match_channels(&mut self, from: u64, to: u64) -> bool {
        let mut any = false;
        for channel in 0..self.channels {
            let value = self.used.compare[channel];
            // Zero is met when the counter starts again.
            if (from..=to).contains(&value) || (value == 0 && to > self.used.top) {
                self.raise(channel);
                any = true;
            }
        }
        any
    }

    fn raise(&mut self, channel: usize) {
        if channel == 0 {
            self.fire(TriggerMode::Compare);
        }
        if let Some(flag) = self.flags.compare[channel] {
            self.bank.put(flag, 1);
        }
        self.pending[channel + 1] |= self.settings.requests[channel + 1];
    }

    fn update(&mut self) {
        if !self.settings.updates {
            return;
        }
        self.take_over(true);
        self.fire(TriggerMode::Update);
        self.bank.put(self.flags.update, 1);
        self.pending[0] |= self.settings.requests[0];
        if self.settings.one_pulse {
            self.bank.put(self.flags.on, 0);
            self.settings.is_on = false;
        }
    }

    /// Registers come into use: those that are preloaded, and PSC, only at an update.
    fn take_over(&mut self, updates: bool) {
        if updates || !self.settings.preloads_top {
            self.used.top = self.written.top;
        }
        for channel in 0..self.channels {
            if updates || !self.settings.preloads[channel] {
                self.used.compare[channel] = self.written.compare[channel];
            }
        }
        if updates && self.used.prescaler != self.written.prescaler {
            self.used.prescaler = self.written.prescaler;
            self.tick = Time::period(self.clock) * self.used.prescaler;
        }
    }

    /// EGR.UG: the counter starts again, and CR1.URS may keep UIF as it is.
    fn start_again(&mut self, now: Time) {
        (self.count, self.since, self.edges) = (0, now, 0);
        self.fire(TriggerMode::Reset);
        let before = self.bank.at(self.flags.update);
        self.update();
        if self.settings.only_overflow {
            self.bank.put(self.flags.update, before);
        }
    }

    /// When the counter gets to `value` next.
    fn reaches(&self, value: u64) -> Time {
        let period = self.used.top + 1;
        if value > self.used.top && value != period {
            return Time::NEVER;
        }
        let steps = if value > self.count { value - self.count } else { period - self.count + value };
        self.since + self.tick * steps
    }

    /// Whether something follows at once from the counter starting again.
    fn update_matters(&self) -> bool {
        let settings = &self.settings;
        settings.wanted & self.flags.update.mask != 0
            || settings.requests[0]
            || settings.one_pulse
            || settings.trigger == TriggerMode::Update
            || settings.outputs.iter().any(|output| matches!(output, Some(Output::Below(_))))
    }

    /// Whether something follows at once from the counter meeting a channel's compare value.
    fn compare_matters(&self, channel: usize) -> bool {
        let settings = &self.settings;
        settings.wanted & self.flags.compare[channel].map_or(0, |flag| flag.mask) != 0
            || settings.requests[channel + 1]
            || (channel == 0 && settings.trigger == TriggerMode::Compare)
            || matches!(settings.outputs[channel], Some(Output::Below(_)))
    }
}

impl Peripheral for Timer {
    has_bank!();

    fn models(&self, register: &Register) -> bool {
        matches!(
            register.name.as_str(),
            "CR1" | "CR2" | "DIER" | "SR" | "EGR" | "CNT" | "PSC" | "ARR" | "CCR" | "CCER" | "SMCR"
        ) || register.name.starts_with("CCMR")
    }

    fn clears_flags(&self, register: &Register) -> bool {
        matches!(register.name.as_str(), "SR" | "EGR")
    }

    fn read(&mut self, register: &Register, at: Moment) -> u32 {
        self.catch_up(at.now);
        match register.name.as_str() {
            "CNT" => self.count as u32,
            _ => self.bank.value(register),
        }
    }

    fn write(&mut self, register: &Register, value: u32, at: Moment) -> Result<(), Misuse> {
        self.catch_up(at.now);
        check(&self.bank, register, value, self.number)?;
        match register.name.as_str() {
            // Flags are cleared by writing 0 (TIMx_SR).
            "SR" => {
                let flags = self.bank.value(register);
                self.bank.store(register, flags & value);
            }
            "CNT" => (self.count, self.since) = (u64::from(value) & self.widest, at.now),
            "EGR" => {
                if register.get(value, "UG") == 1 {
                    self.start_again(at.now);
                }
                for channel in (0..self.channels).filter(|channel| value >> (channel + 1) & 1 == 1) {
                    self.raise(channel);
                }
            }
            _ => {
                let was_on = self.settings.is_on;
                self.bank.store(register, value);
                self.settings = Settings::read(&self.bank, self.channels);
                self.written = Values::read(&self.bank, self.channels, self.widest);
                self.take_over(false);
                if self.settings.is_on && !was_on {
                    self.since = at.now;
                    self.fire(TriggerMode::Enable);
                }
            }
        }
        Ok(())
    }

    fn next_event(&self) -> Time {
        if !self.is_counting() {
            return Time::NEVER;
        }
        let mut next = if self.update_matters() { self.reaches(self.used.top + 1) } else { Time::NEVER };
        for channel in 0..self.channels {
            if self.compare_matters(channel) {
                next = next.min(self.reaches(self.used.compare[channel]));
            }
        }
        next
    }

    fn advance(&mut self, at: Moment) -> Result<(), Misuse> {
        self.catch_up(at.now);
        Ok(())
    }

    fn interrupts(&self, _: &str) -> bool {
        self.bank.at_place(self.flags.all) & self.settings.wanted & INTERRUPTS != 0
    }

    fn requests(&self, signal: &str) -> bool {
        match signal {
            "UP" => self.pending[0],
            _ => channel(signal).is_some_and(|channel| self.pending[channel]),
        }
    }

    fn acknowledge(&mut self, signal: &str) {
        let place = if signal == "UP" { Some(0) } else { channel(signal) };
        if let Some(place) = place {
            self.pending[place] = false;
        }
    }

    fn reset(&mut self) {
        let clock = self.clock;
        let bits = 64 - self.widest.leading_zeros();
        *self = Self::new(self.bank.map.name, self.channels, bits);
        self.run_at(clock);
    }
}

fn channel(signal: &str) -> Option<usize> {
    signal.strip_prefix("CH")?.parse().ok().filter(|channel| (1..=CHANNELS).contains(channel))
}

#[cfg(test)]
mod tests;
