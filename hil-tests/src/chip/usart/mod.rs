//! USART and LPUART (RM0440 chapters 37 and 38): 8 bits, no parity, one stop bit, FIFOs of eight.
//!
//! A byte takes ten bit times each way. The world's end of the line is a queue of symbols for the
//! board and a list of bytes from it; a symbol of another speed, or damaged, has a framing error. A byte that is being
//! sent when the UART is switched off or reset is not sent at all.

mod driver;

use super::{
    bank::Bank,
    map::Register,
    misuse::Misuse,
    peripheral::{Moment, Peripheral, has_bank},
    time::Time,
    trace::Event,
};
use driver::Driver;
use std::collections::VecDeque;

/// Bytes in each FIFO when FIFOs are on (37.5.4).
const FIFO_BYTES: usize = 8;
/// Bits of one byte on the line.
const BITS: u64 = 10;

/// What the world sends: a byte, or a damaged one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Symbol {
    /// The byte.
    pub byte: u8,
    /// Whether its stop bit is missing.
    pub damaged: bool,
}

impl Symbol {
    /// These bytes, as a line without noise carries them.
    #[must_use]
    pub fn undamaged(bytes: &[u8]) -> Vec<Self> {
        bytes.iter().map(|&byte| Self { byte, damaged: false }).collect()
    }
}

/// Model of one UART.
#[derive(Clone, Debug)]
pub struct Usart {
    bank: Bank,
    low_power: bool,
    /// Kernel clock, Hz; the chip keeps it current.
    pub clock: u64,
    /// Whether pins carry what it sends and what it receives.
    wired: [bool; 2],
    driver: Driver,
    wire_baud: u64,
    /// Symbols, and when their stop bits end.
    incoming: VecDeque<(Time, Symbol)>,
    arrives_at: Time,
    received: VecDeque<u8>,
    idle_at: Time,
    to_send: VecDeque<u8>,
    shifting: Option<u8>,
    sent_at: Time,
    sent: Vec<(Time, u8)>,
    /// What of that the driver of a shared line has sent.
    driven: Vec<(Time, u8)>,
    /// Bytes that came or went since somebody asked.
    passed: Vec<(Time, Event)>,
    /// Bytes to come of which a bit flips on the way.
    disturbed: u32,
}

impl Usart {
    /// The UART of that name, with a line of `wire_baud` bits per second at the world's end.
    #[must_use]
    pub fn new(name: &str, wire_baud: u64) -> Self {
        Self {
            bank: Bank::new(name, &[("ISR", 0x00C0)]),
            low_power: name.starts_with("LP"),
            clock: 0,
            wired: [false; 2],
            driver: Driver::default(),
            wire_baud,
            incoming: VecDeque::new(),
            arrives_at: Time::NEVER,
            received: VecDeque::new(),
            idle_at: Time::NEVER,
            to_send: VecDeque::new(),
            shifting: None,
            sent_at: Time::NEVER,
            sent: Vec::new(),
            driven: Vec::new(),
            passed: Vec::new(),
            disturbed: 0,
        }
    }

    /// The world sends symbols, one after the other from `now` on.
    pub fn receive(&mut self, symbols: impl IntoIterator<Item = Symbol>, now: Time) {
        for symbol in symbols {
            let before = self.incoming.back().map_or(now, |&(time, _)| time);
            self.hear(symbol, before + self.wire_byte());
        }
    }

    /// A symbol's stop bit ends at this time, which is still to come as a whole, after all that was heard before.
    pub fn hear(&mut self, symbol: Symbol, at: Time) {
        if self.incoming.is_empty() {
            self.arrives_at = at;
            if at - self.wire_byte() < self.idle_at {
                // A start bit ends the silence.
                self.idle_at = Time::NEVER;
            }
        }
        self.incoming.push_back((at, symbol));
    }

    /// Which pins carry its lines from now on: what it sends, what it receives, the driver's enable.
    pub fn wire(&mut self, [tx, rx, de]: [bool; 3], now: Time) {
        self.wired = [tx, rx];
        self.driver.wire(de, now);
    }

    /// Whether it drives a shared line.
    #[must_use]
    pub fn drives(&self) -> bool {
        self.driver.is_on()
    }

    /// When it began or ceased to drive a shared line, since this was asked last.
    pub fn take_edges(&mut self) -> Vec<(Time, bool)> {
        self.driver.take_edges()
    }

    /// What it has sent over a shared line since it was asked last, with the time each byte was complete.
    pub fn take_driven(&mut self) -> Vec<(Time, u8)> {
        std::mem::take(&mut self.driven)
    }

    /// One bit flips in each of the next so many bytes on the way to the board.
    pub fn disturb(&mut self, bytes: u32) {
        self.disturbed = bytes;
    }

    /// Whether bits of bytes to come still flip.
    #[must_use]
    pub fn is_disturbed(&self) -> bool {
        self.disturbed > 0
    }

    /// Bytes that came or went since this was asked last.
    pub fn take_passed(&mut self) -> Vec<(Time, Event)> {
        std::mem::take(&mut self.passed)
    }

    /// Symbols that are still to come.
    #[must_use]
    pub fn coming(&self) -> usize {
        self.incoming.len()
    }

    /// What the board has sent since it was asked last, with the time each byte was complete.
    pub fn take_sent(&mut self) -> Vec<(Time, u8)> {
        std::mem::take(&mut self.sent)
    }

    /// Whether the board has sent anything that was not taken.
    #[must_use]
    pub fn has_sent(&self) -> bool {
        !self.sent.is_empty()
    }

    /// Forgets what is on the line: its other end was pulled, or the board has no power.
    pub fn unplug(&mut self) {
        self.incoming.clear();
        self.arrives_at = Time::NEVER;
    }

    /// Bits per second that the registers ask for (37.5.8, 38.4.6).
    #[must_use]
    pub fn baud(&self) -> u64 {
        let divider = u64::from(self.bank.word("BRR", 0));
        let factor = if self.low_power { 256 } else { 1 };
        let prescaler = [1, 2, 4, 6, 8, 10, 12, 16, 32, 64, 128, 256];
        let prescaler = prescaler[self.bank.get("PRESC", "PRESCALER").min(11) as usize];
        factor * (self.clock / prescaler) / divider.max(1)
    }

    fn wire_byte(&self) -> Time {
        Time::period(self.wire_baud) * BITS
    }

    fn byte_time(&self) -> Time {
        Time::period(self.baud()) * BITS
    }

    fn depth(&self) -> usize {
        if self.bank.is_set("CR1", "FIFOEN") { FIFO_BYTES } else { 1 }
    }

    fn is_on(&self, direction: &str) -> bool {
        self.bank.is_set("CR1", "UE") && self.bank.is_set("CR1", direction)
    }

    fn flag(&mut self, field: &str) {
        self.bank.set("ISR", field, 1);
    }

    fn take_symbol(&mut self, now: Time) {
        let Some((_, mut symbol)) = self.incoming.pop_front() else { return };
        if self.disturbed > 0 {
            self.disturbed -= 1;
            symbol.byte ^= 1 << (self.disturbed % 8);
        }
        self.passed.push((now, Event::Received(symbol.byte)));
        self.arrives_at = self.incoming.front().map_or(Time::NEVER, |&(time, _)| time);
        if !self.is_on("RE") || !self.wired[1] {
            return;
        }
        let idle_at = now + self.byte_time();
        let is_ended = self.arrives_at != Time::NEVER && self.arrives_at - self.wire_byte() < idle_at;
        self.idle_at = if is_ended { Time::NEVER } else { idle_at };
        // Ten bits drift apart by half a bit at 5 %.
        let off = self.baud().abs_diff(self.wire_baud) * 20 > self.wire_baud;
        if symbol.damaged || off {
            self.flag("FE");
        }
        if self.received.len() >= self.depth() {
            self.flag("ORE");
            return;
        }
        self.received.push_back(if off { !symbol.byte } else { symbol.byte });
    }

    fn shift_out(&mut self, now: Time) {
        if let Some(byte) = self.shifting.take() {
            self.sent.push((now, byte));
            self.passed.push((now, Event::Sent(byte)));
            if self.drives() {
                self.driven.push((now, byte));
            }
        }
        self.shifting = self.to_send.pop_front();
        self.sent_at = if self.shifting.is_some() { now + self.byte_time() } else { Time::NEVER };
        if self.shifting.is_none() {
            self.flag("TC");
            if self.has_driver() {
                self.driver.fall(now, self.driver_time("DEDT"));
            }
        }
    }

    fn has_driver(&self) -> bool {
        self.bank.is_set("CR3", "DEM")
    }

    /// A time of the driver's signal, counted in samples of a bit, of which there are sixteen (37.8.2).
    fn driver_time(&self, field: &str) -> Time {
        Time::period(16 * self.baud()) * u64::from(self.bank.get("CR1", field))
    }

    /// The first of some bytes goes on its way, at once or when the driver is on.
    fn begin(&mut self, now: Time) {
        if self.has_driver() {
            self.driver.raise(now, self.driver_time("DEAT"));
        } else {
            self.shift_out(now);
        }
    }

    fn load(&mut self, byte: u8, now: Time) -> Result<(), Misuse> {
        if !self.is_on("TE") {
            return Err(Misuse::rule(self.name(), "TDR is written while UE or TE is 0"));
        }
        if !self.wired[0] {
            return Err(Misuse::rule(
                self.name(),
                "TDR is written and no pin has TX as its alternate function",
            ));
        }
        if self.to_send.len() < self.depth() {
            self.to_send.push_back(byte);
        }
        self.bank.set("ISR", "TC", 0);
        if self.shifting.is_none() {
            self.begin(now);
        }
        Ok(())
    }

    fn name(&self) -> &'static str {
        self.bank.map.name
    }

    /// What only a UART that is off takes.
    fn check_off(&self, register: &Register, value: u32, fields: &[&str]) -> Result<(), Misuse> {
        let changes = self.bank.value(register) ^ value;
        let changed = fields.iter().find(|field| register.get(changes, field) != 0);
        match changed {
            Some(field) if self.bank.is_set("CR1", "UE") => {
                Err(Misuse::rule(self.name(), format!("{field} changes while UE is 1")))
            }
            _ => Ok(()),
        }
    }

    /// Bits of BRR that are allowed.
    fn check_divider(&self, value: u32) -> Result<(), Misuse> {
        let (allowed, section) =
            if self.low_power { (0x300..=0xF_FFFF, "38.7.5") } else { (0x10..=0xFFFF, "37.8.6") };
        if allowed.contains(&value) {
            return Ok(());
        }
        let (least, most) = allowed.into_inner();
        Err(Misuse::rule(self.name(), format!("BRR = {value:#x} is not {least:#x} to {most:#X} ({section})")))
    }

    fn status(&self) -> u32 {
        let register = self.bank.map.register("ISR");
        let flags = [
            ("RXNE", !self.received.is_empty()),
            ("RXFF", self.received.len() >= FIFO_BYTES),
            ("TXE", self.to_send.len() < self.depth()),
            ("TXFE", self.to_send.is_empty()),
            ("BUSY", !self.incoming.is_empty()),
            ("TEACK", self.is_on("TE")),
            ("REACK", self.is_on("RE")),
        ];
        let value = self.bank.value(register);
        flags.iter().fold(value, |value, &(field, on)| register.with(value, field, u32::from(on)))
    }

    fn has(&self, flag: &str) -> bool {
        self.bank.map.register("ISR").get(self.status(), flag) != 0
    }
}

impl Peripheral for Usart {
    has_bank!();

    fn models(&self, register: &Register) -> bool {
        !matches!(register.name.as_str(), "GTPR" | "RTOR")
    }

    fn read(&mut self, register: &Register, _: Moment) -> u32 {
        match register.name.as_str() {
            "ISR" => self.status(),
            "RDR" => u32::from(self.received.pop_front().unwrap_or(0)),
            _ => self.bank.value(register),
        }
    }

    fn read_changes(&self, register: &Register) -> bool {
        register.name == "RDR"
    }

    fn write(&mut self, register: &Register, value: u32, at: Moment) -> Result<(), Misuse> {
        match register.name.as_str() {
            "TDR" => self.load(value as u8, at.now)?,
            "ICR" => {
                let isr = self.bank.word("ISR", 0);
                self.bank.set_word("ISR", 0, isr & !value);
            }
            "RQR" => {
                if register.get(value, "RXFRQ") != 0 {
                    self.received.clear();
                }
                if register.get(value, "TXFRQ") != 0 {
                    self.to_send.clear();
                }
            }
            "BRR" | "PRESC" if self.bank.is_set("CR1", "UE") => {
                return Err(Misuse::rule(self.name(), format!("{} changes while UE is 1", register.name)));
            }
            "BRR" => {
                self.check_divider(value)?;
                self.bank.store(register, value);
            }
            "CR3" => {
                self.check_off(register, value, &["DEM", "DEP"])?;
                if register.get(value, "DEP") != 0 {
                    return Err(Misuse::rule(self.name(), "only a driver that is on at high is modelled"));
                }
                self.bank.store(register, value);
            }
            "CR1" => {
                let fields = ["M0", "M1", "PCE", "OVER8"];
                if fields.iter().any(|field| register.get(value, field) != 0) {
                    return Err(Misuse::rule(self.name(), "only 8 bits without parity are modelled"));
                }
                self.check_off(register, value, &["DEAT", "DEDT"])?;
                self.bank.store(register, value);
                if register.get(value, "UE") == 0 {
                    self.received.clear();
                    self.to_send.clear();
                    (self.shifting, self.sent_at, self.idle_at) = (None, Time::NEVER, Time::NEVER);
                    self.driver.stop(at.now);
                    self.bank.set_word("ISR", 0, 0xC0);
                }
            }
            _ => self.bank.store(register, value),
        }
        Ok(())
    }

    fn next_event(&self) -> Time {
        self.arrives_at.min(self.idle_at).min(self.sent_at).min(self.driver.next_event())
    }

    fn advance(&mut self, at: Moment) -> Result<(), Misuse> {
        if at.now >= self.sent_at {
            self.shift_out(self.sent_at);
        }
        if self.driver.ends(at.now) && !self.to_send.is_empty() {
            self.begin(at.now);
        }
        if self.driver.begins(at.now) {
            self.shift_out(at.now);
        }
        if at.now >= self.idle_at {
            self.idle_at = Time::NEVER;
            self.flag("IDLE");
        }
        if at.now >= self.arrives_at {
            self.take_symbol(self.arrives_at);
        }
        Ok(())
    }

    fn interrupts(&self, signal: &str) -> bool {
        let enabled = |register, field| self.bank.is_set(register, field);
        let error = self.has("FE") || self.has("NE") || self.has("ORE");
        signal == "GLOBAL"
            && (enabled("CR1", "RXNEIE") && (self.has("RXNE") || self.has("ORE"))
                || enabled("CR1", "IDLEIE") && self.has("IDLE")
                || enabled("CR1", "TXEIE") && self.has("TXE")
                || enabled("CR1", "TCIE") && self.has("TC")
                || enabled("CR3", "EIE") && error)
    }

    fn requests(&self, signal: &str) -> bool {
        match signal {
            "RX" => self.bank.is_set("CR3", "DMAR") && self.is_on("RE") && !self.received.is_empty(),
            "TX" => self.bank.is_set("CR3", "DMAT") && self.is_on("TE") && self.has("TXE"),
            _ => false,
        }
    }

    fn reset(&mut self) {
        let (incoming, arrives_at) = (std::mem::take(&mut self.incoming), self.arrives_at);
        let [sent, driven] = [&mut self.sent, &mut self.driven].map(std::mem::take);
        let (clock, wired, driver) = (self.clock, self.wired, self.driver.after_reset());
        *self = Self {
            incoming,
            arrives_at,
            sent,
            driven,
            driver,
            clock,
            wired,
            ..Self::new(self.bank.map.name, self.wire_baud)
        };
    }
}

#[cfg(test)]
mod tests;
