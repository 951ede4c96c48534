//! FDCAN (RM0440 chapter 44): a controller for CAN FD, with its part of the message memory.
//!
//! [`node`] is what it does on the bus, this file its registers. Not modelled, and refused: frames with long identifiers and
//! remote frames, bus monitoring, restricted operation, loop back, clock stop, single shots, time stamps, time-outs, the FIFO
//! of transmit events, priority filters, FIFOs that overwrite. PSR.ACT does not show that a frame comes in. The delay of a
//! transceiver, and so its compensation, is not in the model, and where in a bit it is sampled makes no difference.

mod counters;
pub mod frame;
mod memory;
pub mod node;

use self::{
    counters::Counters,
    memory::{FRAMES, MessageRam},
    node::{Fifo, News, Presence, Request},
};
use super::{
    bank::Bank,
    map::Register,
    misuse::Misuse,
    peripheral::{Moment, Peripheral, has_bank},
    rcc::CanClock,
    time::Time,
    trace::Event,
};
use std::collections::VecDeque;

/// Registers that say what is, and take no values.
const STATUS: [&str; 8] = ["CREL", "ENDN", "ECR", "PSR", "RXFS", "TXFQS", "TXBRP", "TXBTO"];
/// Registers that change only while CCCR.INIT and CCE are 1, and the bits that must then stay as after a reset, with what
/// they would do.
const PROTECTED: [(&str, u32, &str); 11] = [
    ("NBTP", 0, ""),
    ("DBTP", 0, ""),
    ("TDCR", 0, ""),
    ("TXBC", 0, ""),
    ("CKDIV", 0, ""),
    ("XIDAM", 0x1FFF_FFFF, "long identifiers"),
    ("RXGFC", 0x0F00_0300, "filters of long identifiers, and FIFOs that overwrite"),
    ("TEST", u32::MAX, "tests"),
    ("RWD", u32::MAX, "the watchdog of the memory"),
    ("TSCC", u32::MAX, "time stamps"),
    ("TOCC", u32::MAX, "time-outs"),
];
/// Modes of CCCR that are not modelled.
const MODES: [&str; 8] = ["ASM", "CSR", "MON", "DAR", "TEST", "EFBI", "TXP", "NISO"];
/// Flags of protocol errors: at the nominal rate, where acknowledgements are, and at the data rate.
const PROTOCOL_NAMES: [&str; 2] = ["PEA", "PED"];
/// Flags of the groups that ILS gives to an interrupt.
const GROUPS: [(&str, &[&str]); 7] = [
    ("RXFIFO[0]", &["RFN[0]", "RFF[0]", "RFL[0]"]),
    ("RXFIFO[1]", &["RFN[1]", "RFF[1]", "RFL[1]"]),
    ("SMSG", &["HPM", "TC", "TCF"]),
    ("TFERR", &["TFE", "TEFN", "TEFF", "TEFL"]),
    ("MISC", &["TSW", "MRAF", "TOO"]),
    ("BERR", &["ELO", "EP"]),
    ("PERR", &["EW", "BO", "WDI", "PEA", "PED", "ARA"]),
];

/// Model of one FDCAN.
#[derive(Clone, Debug)]
pub struct Fdcan {
    bank: Bank,
    /// Its part of the memory.
    pub ram: MessageRam,
    /// Its clock; the chip keeps it current.
    pub clock: CanClock,
    wired: [bool; 2],
    presence: Presence,
    /// Whether it went off the bus, and has not recovered.
    is_off: bool,
    counters: Counters,
    fifos: [Fifo; 2],
    /// In the order in which they were asked for.
    requests: VecDeque<Request>,
    /// The buffer that the next request of a FIFO takes.
    put: usize,
    sending: Option<usize>,
    not_before: Time,
    received: usize,
    lost: usize,
    news: VecDeque<(Time, News)>,
    passed: Vec<(Time, Event)>,
}

impl Fdcan {
    /// The controller of that name, with the memory of that name.
    #[must_use]
    pub fn new(name: &str, memory: &str) -> Self {
        let resets = [
            ("CREL", 0x3214_1218),
            ("ENDN", 0x8765_4321),
            ("DBTP", 0x0000_0A33),
            ("CCCR", 1),
            ("NBTP", 0x0600_0A03),
            ("TOCC", 0xFFFF_0000),
            ("PSR", 0x707),
            ("XIDAM", 0x1FFF_FFFF),
        ];
        Self {
            bank: Bank::new(name, &resets),
            ram: MessageRam::new(memory),
            clock: CanClock::default(),
            wired: [false; 2],
            presence: Presence::Off,
            is_off: false,
            counters: Counters::default(),
            fifos: [Fifo::default(); 2],
            requests: VecDeque::new(),
            put: 0,
            sending: None,
            not_before: Time::ZERO,
            received: 0,
            lost: 0,
            news: VecDeque::new(),
            passed: Vec::new(),
        }
    }

    /// Whether pins carry what it sends and what it receives.
    pub fn wire(&mut self, wired: [bool; 2]) {
        self.wired = wired;
    }

    fn is_queue(&self) -> bool {
        self.bank.is_set("TXBC", "TFQM")
    }

    fn raise(&mut self, flag: &str) {
        self.bank.set("IR", flag, 1);
    }

    fn rule(&self, rule: impl Into<String>) -> Misuse {
        Misuse::rule(self.bank.map.name, rule)
    }

    /// CCCR: INIT leaves the bus and joins it, CCE lets settings change and forgets all frames.
    fn control(&mut self, register: &Register, value: u32) -> Result<(), Misuse> {
        let old = self.bank.value(register);
        let [was_off, could_change] = ["INIT", "CCE"].map(|field| register.get(old, field) == 1);
        let [is_off, can_change] = ["INIT", "CCE"].map(|field| register.get(value, field) == 1);
        if let Some(mode) = MODES.iter().find(|mode| register.get(value, mode) != 0) {
            return Err(self.rule(format!("CCCR.{mode} is not modelled")));
        }
        if can_change && !was_off {
            return Err(self.rule("CCCR.CCE is set while INIT is 0 (44.4.6)"));
        }
        let changed =
            ["FDOE", "BRSE", "PXHD"].into_iter().find(|field| register.get(old ^ value, field) != 0);
        if let Some(field) = changed.filter(|_| !could_change) {
            return Err(self.rule(format!("CCCR.{field} changes while CCE is 0 (44.4.6)")));
        }
        self.bank.store(register, if is_off { value } else { register.with(value, "CCE", 0) });
        if can_change && is_off && !could_change {
            self.forget_frames();
        }
        match (was_off, is_off) {
            (false, true) => self.leave(),
            (true, false) => {
                self.check_join()?;
                self.join();
            }
            _ => {}
        }
        Ok(())
    }

    fn forget_frames(&mut self) {
        self.fifos = Default::default();
        self.requests.clear();
        self.ram.pending = [false; FRAMES];
        self.put = 0;
        self.bank.set_word("TXBTO", 0, 0);
        self.bank.set_word("TXBCF", 0, 0);
    }

    /// What must be so before it takes part in a bus.
    fn check_join(&self) -> Result<(), Misuse> {
        let get = |register, field| self.bank.get(register, field);
        if self.clock.hertz == 0 {
            return Err(self.rule("CCCR.INIT becomes 0 while its clock is off (RCC_CCIPR.FDCANSEL)"));
        }
        if !self.clock.is_crystal {
            return Err(
                self.rule("its clock comes from the HSI16, which is off by up to 1 %: too much for CAN FD")
            );
        }
        if self.clock.hertz > self.clock.bus {
            return Err(self.rule("its clock is faster than its bus (44.3.1)"));
        }
        if get("NBTP", "NSJW") > get("NBTP", "NTSEG2") || get("DBTP", "DSJW") > get("DBTP", "DTSEG2") {
            return Err(self.rule("NSJW or DSJW is longer than the segment after the sample point"));
        }
        if get("DBTP", "TDC") == 1 && get("DBTP", "DBRP") > 1 {
            return Err(self.rule("DBTP.TDC with a prescaler above 2 (44.3.3)"));
        }
        Ok(())
    }

    fn protect(&mut self, register: &Register, value: u32, (fixed, what): (u32, &str)) -> Result<(), Misuse> {
        let old = self.bank.value(register);
        if self.bank.get("CCCR", "CCE") == 0 {
            return Err(self.rule(format!("{} is written while CCCR.CCE is 0 (44.4.6)", register.name)));
        }
        if (old ^ value) & fixed != 0 {
            return Err(self.rule(format!("{} = {value:#x}: {what} are not modelled", register.name)));
        }
        if register.name == "RXGFC" && register.get(value, "LSS") > 28 {
            return Err(self.rule("RXGFC.LSS is above 28"));
        }
        self.bank.store(register, value);
        Ok(())
    }

    /// TXBAR: each bit asks for a buffer.
    fn add_requests(&mut self, value: u32, now: Time) -> Result<(), Misuse> {
        for buffer in (0..FRAMES).filter(|buffer| value >> buffer & 1 == 1) {
            let frame =
                self.ram.to_send(buffer).map_err(|why| self.rule(format!("TX buffer {buffer}: {why}")))?;
            let wants = [frame.format != frame::Format::Classic, frame.format == frame::Format::Switching];
            let may = ["FDOE", "BRSE"].map(|field| self.bank.is_set("CCCR", field));
            let wrong = if self.bank.is_set("CCCR", "CCE") {
                "CCCR.CCE is 1"
            } else if self.ram.pending[buffer] {
                "the buffer is still to be sent"
            } else if !self.is_queue() && buffer != self.put {
                "it is not the FIFO's next one (TXFQS.TFQPI)"
            } else if !self.wired[0] {
                "no pin has TX as its alternate function"
            } else if wants.iter().zip(may).any(|(&wants, may)| wants && !may) {
                "its frame has FDF or BRS, and CCCR.FDOE or BRSE is 0"
            } else {
                ""
            };
            if !wrong.is_empty() {
                return Err(self.rule(format!("TXBAR asks for buffer {buffer}: {wrong}")));
            }
            self.ask(buffer, now);
            self.put = (buffer + 1) % FRAMES;
            self.bank.set("TXBTO", &format!("TO[{buffer}]"), 0);
            self.bank.set("TXBCF", &format!("CF[{buffer}]"), 0);
        }
        Ok(())
    }

    /// TXBCR: what is on the bus is finished first.
    fn cancel_requests(&mut self, value: u32) {
        for buffer in (0..FRAMES).filter(|buffer| value >> buffer & 1 == 1) {
            if self.sending != Some(buffer) {
                self.cancel(buffer);
            } else if let Some(request) = self.requests.iter_mut().find(|request| request.buffer == buffer) {
                request.is_cancelled = true;
            }
        }
    }

    fn cancel(&mut self, buffer: usize) {
        if !self.ram.pending[buffer] {
            return;
        }
        self.forget(buffer);
        self.bank.set("TXBCF", &format!("CF[{buffer}]"), 1);
        if self.bank.is_set("TXBCIE", &format!("CFIE[{buffer}]")) {
            self.raise("TCF");
        }
    }

    /// RXFA: the frame at this place, and those before it, were read.
    fn acknowledge_frame(&mut self, fifo: usize, place: usize) -> Result<(), Misuse> {
        let Fifo { first, fill } = self.fifos[fifo];
        let count = (place + FRAMES - first) % FRAMES + 1;
        if place >= FRAMES || count > fill {
            return Err(self.rule(format!("RXFA[{fifo}] = {place}: no frame lies there")));
        }
        self.fifos[fifo] = Fifo { first: (place + 1) % FRAMES, fill: fill - count };
        Ok(())
    }

    fn fifo_status(&self, register: &Register) -> u32 {
        let Fifo { first, fill } = self.fifos[register.index];
        let lost = self.bank.get("IR", &format!("RFL[{}]", register.index));
        let put = (first + fill) % FRAMES;
        let fields = [("FFL", fill), ("FGI", first), ("FPI", put), ("FF", usize::from(fill == FRAMES))];
        let value =
            fields.iter().fold(0, |value, &(field, content)| register.with(value, field, content as u32));
        register.with(value, "RFL", lost)
    }

    fn transmit_status(&self, register: &Register) -> u32 {
        let waiting = self.requests.len();
        let lowest_free = self.ram.pending.iter().position(|pending| !pending).unwrap_or(0);
        let next = self.requests.front().map_or(self.put, |request| request.buffer);
        let [free, get, put] =
            if self.is_queue() { [0, 0, lowest_free] } else { [FRAMES - waiting, next, self.put] };
        let fields =
            [("TFFL", free), ("TFGI", get), ("TFQPI", put), ("TFQF", usize::from(waiting == FRAMES))];
        fields.iter().fold(0, |value, &(field, content)| register.with(value, field, content as u32))
    }

    fn error_counters(&self, register: &Register) -> u32 {
        let Counters { transmit, receive } = self.counters;
        let fields =
            [("TEC", transmit.min(255)), ("REC", receive.min(127)), ("RP", u32::from(receive > 127))];
        fields
            .iter()
            .fold(self.bank.value(register), |value, &(field, content)| register.with(value, field, content))
    }

    fn protocol_status(&self, register: &Register) -> u32 {
        let activity = match self.presence {
            Presence::Off | Presence::Joining(_) => 0,
            Presence::On if self.is_sending() => 3,
            Presence::On => 1,
        };
        let flags = [("EP", self.is_passive()), ("EW", self.counters.is_warned()), ("BO", self.is_off)];
        let value = register.with(self.bank.value(register), "ACT", activity);
        flags.iter().fold(value, |value, &(field, on)| register.with(value, field, u32::from(on)))
    }

    /// Whether a flag that ILS gives to an interrupt (0 or 1) is raised and enabled.
    fn asks_for(&self, interrupt: u32) -> bool {
        let raised = self.bank.word("IR", 0) & self.bank.word("IE", 0);
        let flags = self.bank.map.register("IR");
        raised != 0
            && GROUPS.iter().any(|(group, members)| {
                self.bank.get("ILS", group) == interrupt
                    && members.iter().any(|flag| flags.get(raised, flag) == 1)
            })
    }
}

impl Peripheral for Fdcan {
    has_bank!();

    fn models(&self, register: &Register) -> bool {
        !matches!(register.name.as_str(), "TSCV" | "TOCV" | "HPMS" | "TXEFS" | "TXEFA")
    }

    fn words_only(&self) -> bool {
        true
    }

    fn read(&mut self, register: &Register, _: Moment) -> u32 {
        let stored = self.bank.value(register);
        match register.name.as_str() {
            "RXFS" => self.fifo_status(register),
            "TXFQS" => self.transmit_status(register),
            "TXBRP" => (0..FRAMES).map(|buffer| u32::from(self.ram.pending[buffer]) << buffer).sum(),
            // Both forget what they have shown.
            "ECR" => {
                let value = self.error_counters(register);
                self.bank.set("ECR", "CEL", 0);
                value
            }
            "PSR" => {
                let value = self.protocol_status(register);
                self.bank.store(register, 0x707);
                value
            }
            _ => stored,
        }
    }

    fn write(&mut self, register: &Register, value: u32, at: Moment) -> Result<(), Misuse> {
        let name = register.name.as_str();
        if STATUS.contains(&name) || name == "TXBCF" {
            return Err(Misuse::ReadOnly {
                peripheral: self.bank.map.name.to_owned(),
                register: register.name.clone(),
            });
        }
        if let Some(&(_, fixed, what)) = PROTECTED.iter().find(|(protected, ..)| *protected == name) {
            return self.protect(register, value, (fixed, what));
        }
        match name {
            "CCCR" => return self.control(register, value),
            "TXBAR" => return self.add_requests(value, at.now),
            "TXBCR" => self.cancel_requests(value),
            "RXFA" => return self.acknowledge_frame(register.index, value as usize),
            "IR" => {
                let flags = self.bank.value(register);
                self.bank.store(register, flags & !value);
            }
            _ => self.bank.store(register, value),
        }
        Ok(())
    }

    fn next_event(&self) -> Time {
        self.news.front().map_or(Time::NEVER, |&(at, _)| at)
    }

    fn advance(&mut self, at: Moment) -> Result<(), Misuse> {
        self.take_news(at.now);
        Ok(())
    }

    fn interrupts(&self, signal: &str) -> bool {
        let interrupt = u32::from(signal == "IT1");
        self.bank.is_set("ILE", ["EINT0", "EINT1"][interrupt as usize]) && self.asks_for(interrupt)
    }

    /// Off the bus, with its pins and its memory as they were.
    fn reset(&mut self) {
        self.bank.reset();
        self.forget_frames();
        self.leave();
        (self.is_off, self.counters, self.not_before) = (false, Counters::default(), Time::ZERO);
        (self.received, self.lost) = (0, 0);
    }
}

#[cfg(test)]
mod tests;
