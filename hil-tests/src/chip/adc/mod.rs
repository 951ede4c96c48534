//! ADC: regular conversions of one converter (RM0440, "Analog-to-digital converters (ADC)").
//!
//! The life of a converter: leave deep power-down, regulator on (20 us to start), calibrate, enable,
//! and then sequences of channels, started by software or by a timer's trigger output. A conversion
//! samples for SMPR's time and then takes 12.5, 10.5, 8.5 or 6.5 clocks; the world is asked for the
//! voltage at the instant at which sampling ends. After a trigger, sampling begins two clocks later. Oversampling adds 2 to 256 conversions up and
//! shifts. A conversion that begins long after the one before is wrong, by the chip's erratum. What this
//! model does not do is refused: injected and discontinuous conversions, watchdogs,
//! dual mode, differential inputs, offsets, delayed conversions.

pub mod common;
pub mod internal;
mod plan;

use self::{internal::Internal, plan::Plan};
use super::{
    bank::Bank,
    map::{Field, Register},
    misuse::Misuse,
    peripheral::{Moment, Peripheral, has_bank},
    time::Time,
    world::World,
};

/// Volts at which a conversion gives its highest code (VREF+).
pub const VREF_VOLTS: f64 = 3.3;
/// Time that the regulator takes to start (DS12288, tADCVREG_STUP).
const REGULATOR_START: Time = Time::from_micros(20);
/// Clocks of a calibration (DS12288, tCAL).
const CALIBRATION_CLOCKS: u64 = 112;
/// Clocks from ADSTP to the stop. RM0440 gives no figure and asks to wait for ADSTP to be cleared (ADC_CR.ADSTP): this
/// one is assumed.
const STOP_CLOCKS: u64 = 4;
/// A conversion that begins later after the last one, or after a calibration, is wrong (ES0430, "Wrong ADC result if
/// conversion done late after calibration or previous conversion").
const STALE: Time = Time::from_millis(1);
/// Half clocks for which a channel is sampled, by SMPR.
const SAMPLING: [u64; 8] = [5, 13, 25, 49, 95, 185, 495, 1281];
/// Timers, by number, whose trigger outputs EXTSEL selects; the same for all five converters.
const TRIGGERS: [(u32, u8); 6] = [(4, 3), (11, 2), (12, 4), (13, 6), (14, 15), (30, 7)];
/// Registers that may only keep their value after reset.
const UNUSED: [&str; 8] = ["TR1", "TR2", "TR3", "JSQR", "OFR", "AWD2CR", "AWD3CR", "GCOMP"];

/// Model of one converter.
#[derive(Clone, Debug)]
pub struct Adc {
    bank: Bank,
    flags: Flags,
    plan: Plan,
    number: usize,
    /// Its clock, Hz, common prescaler applied.
    clock: u64,
    regulator_on: Time,
    calibrated_at: Time,
    /// Rank under way, samples taken for it, and their sum.
    rank: usize,
    samples: u32,
    sum: u32,
    sampled_at: Time,
    converted_at: Time,
    stopped_at: Time,
    /// When a conversion or calibration ended last.
    fresh_at: Time,
    is_stale: bool,
    loses_sample: bool,
    data: u32,
    waits_for_trigger: bool,
    /// The DMA has come to its end and CFGR.DMACFG asks for no more.
    is_done: bool,
}

/// Flags of ISR, found once.
#[derive(Clone, Copy, Debug)]
struct Flags {
    sampled: Field,
    converted: Field,
    sequence: Field,
    overrun: Field,
    enables: usize,
}

impl Flags {
    fn of(bank: &Bank) -> Self {
        let [sampled, converted, sequence, overrun] =
            ["EOSMP", "EOC", "EOS", "OVR"].map(|flag| bank.find("ISR", flag));
        Self { sampled, converted, sequence, overrun, enables: bank.map.register("IER").place }
    }
}

impl Adc {
    /// The converter of that number, 1 to 5.
    #[must_use]
    pub fn new(number: usize) -> Self {
        let bank = Bank::new(&format!("ADC{number}"), &[("CR", 0x2000_0000), ("CFGR", 0x8000_0000)]);
        Self {
            flags: Flags::of(&bank),
            plan: Plan::read(&bank, 0),
            bank,
            number,
            clock: 0,
            regulator_on: Time::NEVER,
            calibrated_at: Time::NEVER,
            rank: 0,
            samples: 0,
            sum: 0,
            sampled_at: Time::NEVER,
            converted_at: Time::NEVER,
            stopped_at: Time::NEVER,
            fresh_at: Time::ZERO,
            is_stale: false,
            loses_sample: false,
            data: 0,
            waits_for_trigger: false,
            is_done: false,
        }
    }

    /// Its clock, common prescaler applied, has so many hertz now.
    pub fn run_at(&mut self, clock: u64) {
        if clock != self.clock {
            self.clock = clock;
            self.plan = Plan::read(&self.bank, clock);
        }
    }

    /// The trigger output of the timer of that number fires. Says whether a conversion starts.
    pub fn trigger(&mut self, timer: u8, now: Time) -> bool {
        let starts = self.waits_for_trigger && self.plan.trigger == Some(timer);
        if starts {
            self.waits_for_trigger = false;
            let [latency, rest] = self.plan.latency;
            self.start_sampling(now + latency);
            // The next trigger must not come before the slowest conversion would have ended (DS12288, TTRIG).
            self.converted_at += rest;
        }
        starts
    }

    /// What is inside the chip at the channel whose sampling has ended; none if nothing has ended.
    #[must_use]
    pub fn measures(&self, now: Time) -> Option<Internal> {
        if now < self.sampled_at {
            None
        } else {
            Internal::at(self.number, self.plan.rank(self.rank).channel)
        }
    }

    /// Clock of the conversion under way, Hz, and how long it samples; none between conversions.
    #[must_use]
    pub fn converting(&self) -> Option<(u64, Time)> {
        (self.converted_at != Time::NEVER).then(|| (self.clock, self.plan.rank(self.rank).sampling))
    }

    /// The DMA comes too late for the next result.
    pub fn lose_sample(&mut self) {
        self.loses_sample = true;
    }

    /// Asks the world for the voltage when sampling ends.
    pub fn sample(&mut self, now: Time, world: &mut dyn World) {
        if now < self.sampled_at {
            return;
        }
        let channel = self.plan.rank(self.rank).channel;
        let volts = world.voltage(self.number, channel, self.sampled_at);
        self.sum += if self.is_stale { 0 } else { self.plan.code(volts) };
        self.sampled_at = Time::NEVER;
    }

    fn half_clock(&self, count: u64) -> Time {
        Time::period(2 * self.clock) * count
    }

    fn start_sampling(&mut self, now: Time) {
        let rank = self.plan.rank(self.rank);
        self.is_stale = now.since(self.fresh_at) > STALE;
        self.sampled_at = now + rank.sampling;
        self.converted_at = now + rank.whole;
    }

    fn finish_sample(&mut self) {
        let now = std::mem::replace(&mut self.converted_at, Time::NEVER);
        self.fresh_at = now;
        self.samples += 1;
        if self.samples < self.plan.ratio {
            return self.start_sampling(now);
        }
        let result = self.sum >> self.plan.shift & 0xFFFF;
        (self.samples, self.sum) = (0, 0);
        self.deliver(result);
        self.next_rank(now);
    }

    /// A result that nobody has read is kept, or replaced where OVRMOD says so; OVR is set.
    fn deliver(&mut self, result: u32) {
        if self.bank.at(self.flags.converted) == 1 || std::mem::take(&mut self.loses_sample) {
            self.bank.put(self.flags.overrun, 1);
            if !self.plan.overwrites {
                return;
            }
        }
        self.data = result;
        self.bank.put(self.flags.sampled, 1);
        self.bank.put(self.flags.converted, 1);
    }

    fn next_rank(&mut self, now: Time) {
        self.rank += 1;
        if self.rank <= self.plan.last {
            return self.start_sampling(now);
        }
        self.rank = 0;
        self.bank.put(self.flags.sequence, 1);
        if self.plan.is_continuous {
            self.start_sampling(now);
        } else if self.plan.is_triggered {
            self.waits_for_trigger = true;
        } else {
            self.bank.set("CR", "ADSTART", 0);
        }
    }

    /// Leaves the sequence under way.
    fn abort(&mut self) {
        (self.rank, self.samples, self.sum, self.waits_for_trigger) = (0, 0, 0, false);
        (self.sampled_at, self.converted_at) = (Time::NEVER, Time::NEVER);
    }

    fn begin_stop(&mut self, now: Time) {
        if self.bank.is_set("CR", "ADSTART") {
            self.abort();
            self.bank.set("CR", "ADSTP", 1);
            self.stopped_at = now + self.half_clock(2 * STOP_CLOCKS);
        }
    }

    fn stop(&mut self) {
        self.abort();
        self.stopped_at = Time::NEVER;
        for field in ["ADSTART", "ADSTP"] {
            self.bank.set("CR", field, 0);
        }
    }

    /// CR: each bit is a command, and bits at 0 change nothing but the regulator's.
    fn command(&mut self, register: &Register, value: u32, now: Time) -> Result<(), Misuse> {
        let asks = |field: &str| register.get(value, field) == 1;
        if asks("JADSTART") {
            return Err(Misuse::rule("ADC", "injected conversions are not modelled"));
        }
        if asks("ADVREGEN") && asks("DEEPPWD") {
            return Err(Misuse::rule("ADC", "ADVREGEN is set while DEEPPWD is 1"));
        }
        let was_on = self.bank.is_set("CR", "ADVREGEN");
        for field in ["ADVREGEN", "DEEPPWD", "ADCALDIF"] {
            self.bank.set("CR", field, register.get(value, field));
        }
        if asks("ADVREGEN") && !was_on {
            self.regulator_on = now + REGULATOR_START;
        }
        if asks("ADDIS") {
            self.stop();
            self.bank.set("CR", "ADEN", 0);
        }
        let begins = |field: &str| asks(field) && !self.bank.is_set("CR", field);
        if begins("ADCAL") {
            return self.calibrate(now);
        }
        if begins("ADSTP") {
            self.begin_stop(now);
        } else if begins("ADSTART") {
            return self.start(now);
        } else if begins("ADEN") && !asks("ADDIS") {
            return self.enable(now);
        }
        Ok(())
    }

    fn check_ready(&self, now: Time) -> Result<(), Misuse> {
        if now < self.regulator_on || !self.bank.is_set("CR", "ADVREGEN") {
            return Err(Misuse::rule(
                "ADC",
                "it is used before its regulator has started (20 us after ADVREGEN)",
            ));
        }
        if self.clock == 0 || self.clock > 60_000_000 {
            let rule = format!("its clock is {} Hz, up to 60 MHz is allowed (DS12288, fADC)", self.clock);
            return Err(Misuse::rule("ADC", rule));
        }
        Ok(())
    }

    fn calibrate(&mut self, now: Time) -> Result<(), Misuse> {
        self.check_ready(now)?;
        if self.bank.is_set("CR", "ADEN") {
            return Err(Misuse::rule("ADC", "ADCAL is set while ADEN is 1"));
        }
        self.bank.set("CR", "ADCAL", 1);
        self.calibrated_at = now + self.half_clock(2 * CALIBRATION_CLOCKS);
        Ok(())
    }

    fn enable(&mut self, now: Time) -> Result<(), Misuse> {
        self.check_ready(now)?;
        if self.bank.is_set("CR", "ADCAL") {
            return Err(Misuse::rule("ADC", "ADEN is set while ADCAL is 1"));
        }
        self.bank.set("CR", "ADEN", 1);
        self.bank.set("ISR", "ADRDY", 1);
        Ok(())
    }

    fn start(&mut self, now: Time) -> Result<(), Misuse> {
        if !self.bank.is_set("CR", "ADEN") {
            return Err(Misuse::rule("ADC", "ADSTART is set while ADEN is 0"));
        }
        self.bank.set("CR", "ADSTART", 1);
        if self.plan.is_triggered {
            self.waits_for_trigger = true;
        } else {
            self.start_sampling(now);
        }
        Ok(())
    }

    fn check_configuration(&self, register: &Register, value: u32) -> Result<(), Misuse> {
        if self.bank.is_set("CR", "ADSTART") {
            return Err(Misuse::rule("ADC", format!("{} changes while ADSTART is 1", register.name)));
        }
        if register.name == "DIFSEL" && value != 0 {
            return Err(Misuse::rule("ADC", "differential inputs are not modelled"));
        }
        let refused: &[&str] = match register.name.as_str() {
            "CFGR" => &["AUTDLY", "ALIGN", "DISCEN", "JDISCEN", "AWD1EN", "JAWD1EN", "JAUTO"],
            "CFGR2" => &["JOVSE", "TROVS", "GCOMP", "SWTRIG", "BULB", "SMPTRIG"],
            _ => return Ok(()),
        };
        if let Some(field) = refused.iter().find(|field| register.get(value, field) != 0) {
            return Err(Misuse::rule("ADC", format!("{}.{field} is not modelled", register.name)));
        }
        let triggered = register.name == "CFGR" && register.get(value, "EXTEN") != 0;
        let code = if triggered { register.get(value, "EXTSEL") } else { 4 };
        if register.name == "CFGR" && !TRIGGERS.iter().any(|&(known, _)| known == code) {
            return Err(Misuse::rule("ADC", format!("trigger {code} (CFGR.EXTSEL) is not modelled")));
        }
        Ok(())
    }
}

impl Peripheral for Adc {
    has_bank!();

    fn models(&self, register: &Register) -> bool {
        !UNUSED.contains(&register.name.as_str()) && register.name != "JDR"
    }

    fn clears_flags(&self, register: &Register) -> bool {
        register.name == "ISR"
    }

    fn words_only(&self) -> bool {
        true
    }

    fn read(&mut self, register: &Register, _: Moment) -> u32 {
        if register.name != "DR" {
            return self.bank.value(register);
        }
        // Reading the result clears EOC.
        self.bank.put(self.flags.converted, 0);
        self.data
    }

    fn read_changes(&self, register: &Register) -> bool {
        register.name == "DR"
    }

    fn write(&mut self, register: &Register, value: u32, at: Moment) -> Result<(), Misuse> {
        match register.name.as_str() {
            "ISR" => {
                let flags = self.bank.value(register);
                self.bank.store(register, flags & !value);
            }
            "CR" => self.command(register, value, at.now)?,
            "IER" => self.bank.store(register, value),
            _ => {
                self.check_configuration(register, value)?;
                self.bank.store(register, value);
                self.plan = Plan::read(&self.bank, self.clock);
                self.is_done &= register.name != "CFGR";
            }
        }
        Ok(())
    }

    fn next_event(&self) -> Time {
        self.sampled_at.min(self.converted_at).min(self.calibrated_at).min(self.stopped_at)
    }

    fn advance(&mut self, at: Moment) -> Result<(), Misuse> {
        if at.now >= self.calibrated_at {
            self.fresh_at = std::mem::replace(&mut self.calibrated_at, Time::NEVER);
            self.bank.set("CR", "ADCAL", 0);
        }
        if at.now >= self.stopped_at {
            self.stop();
        }
        if at.now >= self.sampled_at {
            return Err(Misuse::rule("ADC", "a conversion samples and no world is connected"));
        }
        if at.now >= self.converted_at {
            self.finish_sample();
        }
        Ok(())
    }

    fn interrupts(&self, _: &str) -> bool {
        // The enable bits lie where the flags lie (ADC_ISR, ADC_IER).
        self.bank.at_place(self.flags.overrun.place) & self.bank.at_place(self.flags.enables) & 0x1F != 0
    }

    fn requests(&self, signal: &str) -> bool {
        self.plan.uses_dma
            && !self.is_done
            && self.bank.at(self.flags.converted) == 1
            && self.bank.at(self.flags.overrun) == 0
            && signal == self.bank.map.name
    }

    /// In one-shot mode (DMACFG = 0) the end of the DMA's buffer ends the conversions as well ("DMA
    /// one shot mode").
    fn transfers_ended(&mut self, _: &str) {
        if !self.plan.is_circular {
            self.is_done = true;
            self.abort();
        }
    }

    fn reset(&mut self) {
        let clock = self.clock;
        *self = Self::new(self.number);
        self.run_at(clock);
    }
}

#[cfg(test)]
mod tests;
