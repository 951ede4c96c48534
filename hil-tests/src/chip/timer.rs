//! Timers: basic and general (RM0440 chapters 28 to 31): counting up, update and compare events.
//!
//! The counter is not stepped: its value follows from the time since it was set. What the model
//! does not do (counting down, input capture, slave modes, dithering) is refused when asked for.

use super::{
    bank::Bank,
    map::Register,
    misuse::Misuse,
    peripheral::{Moment, Peripheral, has_bank},
    time::Time,
};

/// Model of one timer.
#[derive(Clone, Debug)]
pub struct Timer {
    bank: Bank,
    channels: usize,
    widest: u64,
    /// Clock of the counter before its prescaler, Hz; the chip keeps it current.
    pub clock: u64,
    /// Prescaler in use: PSC is taken over at an update.
    prescaler: u64,
    /// The counter had this value at that time.
    count: u64,
    since: Time,
    /// Requests to the DMA that are not served: update, then one for each channel.
    pending: [bool; 5],
    /// The trigger output has fired.
    fired: bool,
}

/// What fires the trigger output (CR2.MMS).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum TriggerMode {
    Reset,
    Enable,
    Update,
    Compare,
}

impl Timer {
    /// The timer of that name, with so many channels and bits.
    #[must_use]
    pub fn new(name: &str, channels: usize, bits: u32) -> Self {
        let widest = u64::MAX >> (64 - bits);
        Self {
            bank: Bank::new(name, &[("ARR", widest as u32)]),
            channels,
            widest,
            clock: 0,
            prescaler: 1,
            count: 0,
            since: Time::ZERO,
            pending: [false; 5],
            fired: false,
        }
    }

    /// Whether the trigger output (TRGO) has fired since it was asked last.
    pub fn take_trigger(&mut self) -> bool {
        std::mem::take(&mut self.fired)
    }

    /// Something happens that TRGO shows if CR2.MMS says so.
    fn fire(&mut self, mode: TriggerMode) {
        self.fired |= self.bank.get("CR2", "MMS") == mode as u32;
    }

    fn is_counting(&self) -> bool {
        self.bank.is_set("CR1", "CEN") && self.clock > 0
    }

    fn tick(&self) -> Time {
        Time::period(self.clock) * self.prescaler
    }

    fn top(&self) -> u64 {
        u64::from(self.bank.word("ARR", 0)) & self.widest
    }

    fn compare(&self, channel: usize) -> u64 {
        u64::from(self.bank.word("CCR", channel)) & self.widest
    }

    /// Brings count and flags up to `now`, one event after the other.
    fn catch_up(&mut self, now: Time) {
        while self.is_counting() {
            let ticks = now.since(self.since).periods(self.tick());
            let to_update = (self.top() + 1).saturating_sub(self.count).max(1);
            let steps = ticks.min(to_update);
            if steps == 0 {
                return;
            }
            self.match_channels(self.count + 1, self.count + steps);
            self.since += self.tick() * steps;
            self.count += steps;
            if steps < to_update {
                return;
            }
            self.count = 0;
            self.update();
            self.skip_rounds(now);
        }
        self.since = now;
    }

    /// Flags do not count: of many rounds that are due, all but the last two go by at once.
    fn skip_rounds(&mut self, now: Time) {
        let round = self.tick() * (self.top() + 1);
        let rounds = now.since(self.since).periods(round).saturating_sub(1);
        if self.is_counting() {
            self.since += round * rounds;
        }
    }

    fn match_channels(&mut self, from: u64, to: u64) {
        for channel in 0..self.channels {
            let value = self.compare(channel);
            // Zero is met when the counter starts again.
            let met = (from..=to).contains(&value) || (value == 0 && to > self.top());
            if met {
                self.raise(channel);
            }
        }
    }

    fn raise(&mut self, channel: usize) {
        if channel == 0 {
            self.fire(TriggerMode::Compare);
        }
        self.bank.set("SR", &self.field("CCIF", channel), 1);
        self.pending[channel + 1] |= self.bank.is_set("DIER", &self.field("CCDE", channel));
    }

    fn field(&self, name: &str, channel: usize) -> String {
        format!("{name}[{channel}]")
    }

    fn update(&mut self) {
        self.prescaler = u64::from(self.bank.word("PSC", 0)) + 1;
        if self.bank.is_set("CR1", "UDIS") {
            return;
        }
        self.fire(TriggerMode::Update);
        self.bank.set("SR", "UIF", 1);
        self.pending[0] |= self.bank.is_set("DIER", "UDE");
        if self.bank.is_set("CR1", "OPM") {
            self.bank.set("CR1", "CEN", 0);
        }
    }

    /// When the counter gets to `value` next.
    fn reaches(&self, value: u64) -> Time {
        let period = self.top() + 1;
        if value > self.top() && value != period {
            return Time::NEVER;
        }
        let steps = if value > self.count { value - self.count } else { period - self.count + value };
        self.since + self.tick() * steps
    }

    fn wants(&self, field: &str) -> bool {
        self.bank.is_set("DIER", field)
    }
}

impl Peripheral for Timer {
    has_bank!();

    fn models(&self, register: &Register) -> bool {
        matches!(
            register.name.as_str(),
            "CR1" | "CR2" | "DIER" | "SR" | "EGR" | "CNT" | "PSC" | "ARR" | "CCR" | "CCER"
        ) || register.name == "SMCR"
            || register.name.starts_with("CCMR")
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
        match register.name.as_str() {
            // Flags are cleared by writing 0 (29.5.5).
            "SR" => {
                let flags = self.bank.value(register);
                self.bank.store(register, flags & value);
            }
            "CNT" => (self.count, self.since) = (u64::from(value) & self.widest, at.now),
            "EGR" => {
                if register.get(value, "UG") == 1 {
                    (self.count, self.since) = (0, at.now);
                    self.fire(TriggerMode::Reset);
                    let quiet = self.bank.is_set("CR1", "URS");
                    let before = self.bank.get("SR", "UIF");
                    self.update();
                    if quiet {
                        self.bank.set("SR", "UIF", before);
                    }
                }
                for channel in 0..self.channels {
                    if value >> (channel + 1) & 1 == 1 {
                        self.raise(channel);
                    }
                }
            }
            "CR1" if ["DIR", "CMS", "DITHEN"].iter().any(|field| has(register, value, field)) => {
                return Err(Misuse::rule("TIM", "only counting up without dithering is modelled"));
            }
            "CR1" => {
                if !self.bank.is_set("CR1", "CEN") && register.get(value, "CEN") == 1 {
                    self.fire(TriggerMode::Enable);
                }
                self.bank.store(register, value);
            }
            "CR2" if register.get(value, "MMS") > 3 || register.get(value, "MMS.1") != 0 => {
                return Err(Misuse::rule("TIM", "of CR2.MMS reset, enable, update and compare are modelled"));
            }
            "SMCR" if value != 0 => return Err(Misuse::rule("TIM", "slave modes are not modelled")),
            "CCER" if value != 0 => {
                return Err(Misuse::rule("TIM", "outputs and captures of channels are not modelled"));
            }
            _ => self.bank.store(register, value),
        }
        Ok(())
    }

    fn next_event(&self) -> Time {
        if !self.is_counting() {
            return Time::NEVER;
        }
        let update = self.wants("UIE") || self.wants("UDE") || self.bank.is_set("CR1", "OPM");
        let fires = self.bank.get("CR2", "MMS");
        let update = update || fires == TriggerMode::Update as u32;
        let mut next = if update { self.reaches(self.top() + 1) } else { Time::NEVER };
        for channel in 0..self.channels {
            if (channel == 0 && fires == TriggerMode::Compare as u32)
                || self.wants(&self.field("CCIE", channel))
                || self.wants(&self.field("CCDE", channel))
            {
                next = next.min(self.reaches(self.compare(channel)));
            }
        }
        next
    }

    fn advance(&mut self, at: Moment) -> Result<(), Misuse> {
        self.catch_up(at.now);
        Ok(())
    }

    fn interrupts(&self, _: &str) -> bool {
        let status = self.bank.word("SR", 0);
        // The enable bits lie where the flags lie (29.5.4, 29.5.5).
        status & self.bank.word("DIER", 0) & 0x5F != 0
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
        *self = Self { clock, ..Self::new(self.bank.map.name, self.channels, bits) };
    }
}

fn has(register: &Register, value: u32, field: &str) -> bool {
    register.has_field(field) && register.get(value, field) != 0
}

fn channel(signal: &str) -> Option<usize> {
    signal.strip_prefix("CH")?.parse().ok().filter(|channel| (1..=4).contains(channel))
}

#[cfg(test)]
mod tests;
