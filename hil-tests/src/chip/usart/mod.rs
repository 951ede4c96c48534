//! USART and LPUART (RM0440 chapters 37 and 38): 8 bits, no parity, one stop bit, FIFOs of eight.
//!
//! A byte takes ten bit times each way. The world's end of the line is a queue of symbols for the
//! board and a list of bytes from it; a symbol of another speed, or damaged, has a framing error.

use super::{
    bank::Bank,
    map::Register,
    misuse::Misuse,
    peripheral::{Moment, Peripheral, has_bank},
    time::Time,
    trace::Event,
};
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
    /// Whether pins carry its lines; the chip keeps it current.
    pub wired: [bool; 2],
    wire_baud: u64,
    incoming: VecDeque<Symbol>,
    arrives_at: Time,
    received: VecDeque<u8>,
    idle_at: Time,
    to_send: VecDeque<u8>,
    shifting: Option<u8>,
    sent_at: Time,
    sent: Vec<(Time, u8)>,
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
            wire_baud,
            incoming: VecDeque::new(),
            arrives_at: Time::NEVER,
            received: VecDeque::new(),
            idle_at: Time::NEVER,
            to_send: VecDeque::new(),
            shifting: None,
            sent_at: Time::NEVER,
            sent: Vec::new(),
            passed: Vec::new(),
            disturbed: 0,
        }
    }

    /// The world sends symbols, one after the other from `now` on.
    pub fn receive(&mut self, symbols: impl IntoIterator<Item = Symbol>, now: Time) {
        let was_idle = self.incoming.is_empty();
        self.incoming.extend(symbols);
        if was_idle && !self.incoming.is_empty() {
            // A start bit ends the silence.
            self.idle_at = Time::NEVER;
            self.arrives_at = now + self.wire_byte();
        }
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
        let Some(mut symbol) = self.incoming.pop_front() else { return };
        if self.disturbed > 0 {
            self.disturbed -= 1;
            symbol.byte ^= 1 << (self.disturbed % 8);
        }
        self.passed.push((now, Event::Received(symbol.byte)));
        self.arrives_at = if self.incoming.is_empty() { Time::NEVER } else { now + self.wire_byte() };
        if !self.is_on("RE") || !self.wired[1] {
            return;
        }
        self.idle_at = if self.incoming.is_empty() { now + self.byte_time() } else { Time::NEVER };
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
        }
        self.shifting = self.to_send.pop_front();
        self.sent_at = if self.shifting.is_some() { now + self.byte_time() } else { Time::NEVER };
        if self.shifting.is_none() {
            self.flag("TC");
        }
    }

    fn load(&mut self, byte: u8, now: Time) -> Result<(), Misuse> {
        if !self.is_on("TE") {
            return Err(Misuse::rule("LPUART1", "TDR is written while UE or TE is 0"));
        }
        if !self.wired[0] {
            return Err(Misuse::rule(
                "LPUART1",
                "TDR is written and no pin has TX as its alternate function",
            ));
        }
        if self.to_send.len() < self.depth() {
            self.to_send.push_back(byte);
        }
        self.bank.set("ISR", "TC", 0);
        if self.shifting.is_none() {
            self.shift_out(now);
        }
        Ok(())
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
            "BRR" if self.low_power && !(0x300..=0xF_FFFF).contains(&value) => {
                return Err(Misuse::rule(
                    "LPUART1",
                    format!("BRR = {value:#x} is not 0x300 to 0xFFFFF (38.7.5)"),
                ));
            }
            "BRR" | "PRESC" if self.bank.is_set("CR1", "UE") => {
                return Err(Misuse::rule("LPUART1", format!("{} changes while UE is 1", register.name)));
            }
            "CR1" => {
                let fields = ["M0", "M1", "PCE", "OVER8"];
                if fields.iter().any(|field| register.get(value, field) != 0) {
                    return Err(Misuse::rule("LPUART1", "only 8 bits without parity are modelled"));
                }
                self.bank.store(register, value);
                if register.get(value, "UE") == 0 {
                    self.received.clear();
                    self.to_send.clear();
                    (self.shifting, self.sent_at, self.idle_at) = (None, Time::NEVER, Time::NEVER);
                    self.bank.set_word("ISR", 0, 0xC0);
                }
            }
            _ => self.bank.store(register, value),
        }
        Ok(())
    }

    fn next_event(&self) -> Time {
        self.arrives_at.min(self.idle_at).min(self.sent_at)
    }

    fn advance(&mut self, at: Moment) -> Result<(), Misuse> {
        if at.now >= self.sent_at {
            self.shift_out(self.sent_at);
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
        let sent = std::mem::take(&mut self.sent);
        let (clock, wired) = (self.clock, self.wired);
        *self = Self {
            incoming,
            arrives_at,
            sent,
            clock,
            wired,
            ..Self::new(self.bank.map.name, self.wire_baud)
        };
    }
}

#[cfg(test)]
mod tests;
