//! Device: what it answers to the host's packets, as its endpoint registers say (RM0440, USB chapter, "USB endpoint
//! registers"), and what it notices of the bus.

use super::{UsbClocks, memory::PacketMemory};
use crate::chip::{bank::Bank, misuse::Misuse, time::Time};

/// From one start of a frame to the next.
pub(super) const FRAME: Time = Time::from_millis(1);
/// A start of a frame is missing so long after it was due.
const LATE: Time = Time::from_micros(50);
/// Missing starts of frames until the bus is at rest.
const MISSING_UNTIL_SUSPENDED: u32 = 3;
/// Slowest bus with which the device keeps up, Hz.
const LEAST_BUS: u64 = 10_000_000;

/// Values of STAT_TX and STAT_RX.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Stat {
    Disabled,
    Stall,
    Nak,
    Valid,
}

impl Stat {
    pub(super) fn of(device: &Device, index: usize, field: &str) -> Self {
        match device.bank.get_at("EPR", index, field) {
            0 => Self::Disabled,
            1 => Self::Stall,
            2 => Self::Nak,
            _ => Self::Valid,
        }
    }
}

/// What the host gets for a packet of its own.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum Answer {
    /// Nobody of that address, or no such endpoint.
    Silence,
    Ack,
    Nak,
    Stall,
    /// DATA0 or DATA1, and its bytes.
    Data(bool, Vec<u8>),
}

/// State of the two wires.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Wires {
    /// Idle: the pull-up's, or nobody's.
    J,
    /// The host wakes the device.
    K,
    /// Both low: a reset.
    Low,
}

/// The device's side.
#[derive(Clone, Debug)]
pub(super) struct Device {
    pub(super) bank: Bank,
    pub(super) memory: PacketMemory,
    pub(super) clocks: UsbClocks,
    pub(super) powered_at: Time,
    /// When the next start of a frame is missing.
    pub(super) missing_at: Time,
    missing: u32,
    wires: Wires,
}

impl Default for Device {
    fn default() -> Self {
        Self {
            bank: Bank::new("USB", &[("CNTR", 3)]),
            memory: PacketMemory::default(),
            clocks: UsbClocks::default(),
            powered_at: Time::ZERO,
            missing_at: Time::NEVER,
            missing: 0,
            wires: Wires::J,
        }
    }
}

impl Device {
    /// The device after a reset of the chip: what is outside stays.
    pub(super) fn after_reset(&self) -> Self {
        Self { clocks: self.clocks, wires: self.wires, ..Self::default() }
    }

    pub(super) fn is_powered(&self) -> bool {
        !self.bank.is_set("CNTR", "PDWN")
    }

    pub(super) fn is_on(&self) -> bool {
        self.is_powered() && !self.bank.is_set("CNTR", "FRES")
    }

    /// Whether a host sees it.
    pub(super) fn pulls_up(&self) -> bool {
        self.is_powered() && self.bank.is_set("BCDR", "DPPU")
    }

    /// What a host relies on where it talks to it.
    pub(super) fn check_clocks(&self) -> Result<(), Misuse> {
        let UsbClocks { kernel, is_exact, bus } = self.clocks;
        if kernel != 48_000_000 {
            return Err(rule(format!("it runs at {kernel} Hz, not 48 MHz (CCIPR.CLK48SEL)")));
        }
        if !is_exact {
            return Err(rule(
                "the HSI48 is not trimmed by the host's frames (CRS): it may be off by more than 0.25 %",
            ));
        }
        if bus < LEAST_BUS {
            return Err(rule(format!("APB1 runs at {bus} Hz: at least {LEAST_BUS} are needed")));
        }
        Ok(())
    }

    pub(super) fn flag(&mut self, field: &str) {
        self.bank.set("ISTR", field, 1);
    }

    /// ISTR, with what follows from the endpoints: the first that has something to tell.
    pub(super) fn status(&self) -> u32 {
        let register = self.bank.map.register("ISTR");
        let value = self.bank.value(register);
        let has = |index: usize, field| self.bank.get_at("EPR", index, field) != 0;
        let Some(index) = (0..8).find(|&index| has(index, "CTR_RX") || has(index, "CTR_TX")) else {
            return value;
        };
        let value = register.with(value, "CTR", 1);
        let value = register.with(value, "DIR", u32::from(has(index, "CTR_RX")));
        register.with(value, "EP_ID", index as u32)
    }

    pub(super) fn interrupts(&self) -> bool {
        self.status() & self.bank.word("CNTR", 0) & 0xFF80 != 0
    }

    pub(super) fn next_event(&self) -> Time {
        self.missing_at
    }

    pub(super) fn advance(&mut self, now: Time) {
        if now < self.missing_at {
            return;
        }
        self.flag("ESOF");
        self.missing += 1;
        let lost = self.missing.min(3);
        self.bank.set("FNR", "LSOF", lost);
        self.bank.set("FNR", "LCK", 0);
        self.missing_at += FRAME;
        if self.missing == MISSING_UNTIL_SUSPENDED {
            self.flag("SUSP");
            self.missing_at = Time::NEVER;
        }
    }

    /// Looks for starts of frames from now on.
    pub(super) fn expect_frames(&mut self, now: Time) {
        self.missing = 0;
        self.missing_at =
            if self.is_on() && self.wires == Wires::J { now + FRAME + LATE } else { Time::NEVER };
    }

    /// A frame starts.
    pub(super) fn start_of_frame(&mut self, number: u32, now: Time) {
        if !self.is_on() {
            return;
        }
        self.wake();
        self.flag("SOF");
        let is_locked = self.missing_at != Time::NEVER && self.missing == 0;
        self.bank.set("FNR", "FN_", number);
        self.bank.set("FNR", "LSOF", 0);
        self.bank.set("FNR", "LCK", u32::from(is_locked));
        self.expect_frames(now);
    }

    /// The wires are in this state from now on.
    pub(super) fn see(&mut self, wires: Wires, now: Time) {
        self.wires = wires;
        self.bank.set("FNR", "RXDP", u32::from(wires == Wires::J));
        self.bank.set("FNR", "RXDM", u32::from(wires == Wires::K));
        if !self.is_on() {
            return;
        }
        match wires {
            Wires::J => self.expect_frames(now),
            Wires::K => self.wake(),
            Wires::Low => {
                self.wake();
                self.start_anew();
                self.missing_at = Time::NEVER;
                self.flag("RESET");
            }
        }
    }

    fn wake(&mut self) {
        if self.bank.is_set("CNTR", "FSUSP") {
            self.flag("WKUP");
        }
    }

    /// A reset of the bus or by the firmware: nothing is answered any more. What was told of packets stays.
    pub(super) fn start_anew(&mut self) {
        for index in 0..8 {
            let register = self.bank.map.element("EPR", index);
            let kept = self.bank.value(register) & (register.mask("CTR_RX") | register.mask("CTR_TX"));
            self.bank.store(register, kept);
        }
        self.bank.set_word("DADDR", 0, 0);
        self.guard();
    }

    /// The host begins a request.
    pub(super) fn setup(&mut self, address: u8, bytes: [u8; 8]) -> Result<Answer, Misuse> {
        let Some(index) = self.endpoint(address, 0, "STAT_RX") else { return Ok(Answer::Silence) };
        if self.bank.get_at("EPR", index, "EP_TYPE") != 1 {
            return Err(rule("endpoint 0 is not a control endpoint"));
        }
        self.receive(index, &bytes)?;
        for (field, value) in [("SETUP", 1), ("STAT_RX", 2), ("STAT_TX", 2), ("DTOG_RX", 1), ("DTOG_TX", 1)] {
            self.bank.set_at("EPR", index, field, value);
        }
        self.guard();
        Ok(Answer::Ack)
    }

    /// The host sends a packet.
    pub(super) fn out(
        &mut self,
        address: u8,
        endpoint: u8,
        toggle: bool,
        bytes: &[u8],
    ) -> Result<Answer, Misuse> {
        let Some(index) = self.endpoint(address, endpoint, "STAT_RX") else { return Ok(Answer::Silence) };
        match Stat::of(self, index, "STAT_RX") {
            Stat::Disabled => return Ok(Answer::Silence),
            Stat::Stall => return Ok(Answer::Stall),
            Stat::Nak => return Ok(Answer::Nak),
            Stat::Valid => {}
        }
        let takes_status_only =
            self.bank.get_at("EPR", index, "EP_TYPE") == 1 && self.bank.get_at("EPR", index, "EP_KIND") == 1;
        if takes_status_only && !bytes.is_empty() {
            self.bank.set_at("EPR", index, "STAT_RX", 1);
            self.guard();
            return Ok(Answer::Stall);
        }
        let expected = self.bank.get_at("EPR", index, "DTOG_RX") == 1;
        if toggle != expected {
            // Taken for one that came before, of which the host did not hear that it had come.
            return Ok(Answer::Ack);
        }
        self.receive(index, bytes)?;
        for (field, value) in [("SETUP", 0), ("STAT_RX", 2), ("DTOG_RX", u32::from(!expected))] {
            self.bank.set_at("EPR", index, field, value);
        }
        self.guard();
        Ok(Answer::Ack)
    }

    /// The host asks for a packet.
    pub(super) fn asked(&self, address: u8, endpoint: u8) -> Answer {
        let Some(index) = self.endpoint(address, endpoint, "STAT_TX") else { return Answer::Silence };
        match Stat::of(self, index, "STAT_TX") {
            Stat::Disabled => Answer::Silence,
            Stat::Stall => Answer::Stall,
            Stat::Nak => Answer::Nak,
            Stat::Valid => {
                let (start, length) = self.tx_buffer(index);
                Answer::Data(self.bank.get_at("EPR", index, "DTOG_TX") == 1, self.memory.read(start, length))
            }
        }
    }

    /// And has got it.
    pub(super) fn sent(&mut self, address: u8, endpoint: u8) {
        let Some(index) = self.endpoint(address, endpoint, "STAT_TX") else { return };
        if Stat::of(self, index, "STAT_TX") != Stat::Valid {
            return;
        }
        let toggle = self.bank.get_at("EPR", index, "DTOG_TX");
        for (field, value) in [("STAT_TX", 2), ("DTOG_TX", 1 - toggle), ("CTR_TX", 1)] {
            self.bank.set_at("EPR", index, field, value);
        }
        self.guard();
    }

    /// The register of an endpoint that takes part in this direction.
    fn endpoint(&self, address: u8, endpoint: u8, direction: &str) -> Option<usize> {
        let is_asked = self.is_on()
            && !self.bank.is_set("CNTR", "FSUSP")
            && self.bank.is_set("DADDR", "EF")
            && self.bank.get("DADDR", "ADD") == u32::from(address);
        let is_it = |&index: &usize| {
            self.bank.get_at("EPR", index, "EA") == u32::from(endpoint)
                && Stat::of(self, index, direction) != Stat::Disabled
        };
        (0..8).find(is_it).filter(|_| is_asked)
    }

    fn receive(&mut self, index: usize, bytes: &[u8]) -> Result<(), Misuse> {
        let (start, room) = self.rx_buffer(index);
        if bytes.len() > room {
            return Err(rule(format!(
                "a packet of {} bytes comes to endpoint {index}, whose buffer has {room}",
                bytes.len()
            )));
        }
        self.memory.put(start, bytes);
        let place = self.table() + 8 * index + 6;
        let count = self.memory.half(place) & 0xFC00 | bytes.len() as u16;
        self.memory.put_half(place, count);
        self.bank.set_at("EPR", index, "CTR_RX", 1);
        Ok(())
    }

    /// Where the table of buffers begins.
    pub(super) fn table(&self) -> usize {
        self.bank.word("BTABLE", 0) as usize & 0x3F8
    }

    /// Start and length of the packet that an endpoint sends.
    pub(super) fn tx_buffer(&self, index: usize) -> (usize, usize) {
        let place = self.table() + 8 * index;
        (self.memory.half(place).into(), usize::from(self.memory.half(place + 2) & 0x3FF))
    }

    /// Start and length of the buffer of an endpoint that receives (COUNTn_RX: blocks of 2 or of 32 bytes).
    pub(super) fn rx_buffer(&self, index: usize) -> (usize, usize) {
        let place = self.table() + 8 * index + 4;
        let count = usize::from(self.memory.half(place + 2));
        let blocks = count >> 10 & 0x1F;
        let length = if count & 0x8000 == 0 { 2 * blocks } else { 32 * (blocks + 1) };
        (self.memory.half(place).into(), length)
    }
}

pub(super) fn rule(rule: impl Into<String>) -> Misuse {
    Misuse::rule("USB", rule)
}
