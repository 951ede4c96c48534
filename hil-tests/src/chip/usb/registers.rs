//! Registers: what writing them does (RM0440, USB chapter, "USB and USB SRAM registers").

use super::{
    device::{Device, Stat, rule},
    memory,
};
use crate::chip::{map::Register, misuse::Misuse, time::Time};

/// Between the transceiver's power and the end of the reset (DS12288, USB startup time).
const STARTUP: Time = Time::from_micros(1);
/// Most bytes of a packet of a control, bulk or interrupt endpoint.
const MOST_BYTES: usize = 64;
/// Flags of ISTR that a zero clears.
const CLEARED_BY_ZERO: u32 = 0x7F80;
/// Values of EP_TYPE.
const BULK: u32 = 0;
const ISOCHRONOUS: u32 = 2;

impl Device {
    pub(super) fn write(&mut self, register: &Register, value: u32, now: Time) -> Result<(), Misuse> {
        match register.name.as_str() {
            "CNTR" => self.control(register, value, now),
            "ISTR" => {
                let old = self.bank.value(register);
                self.bank.store(register, old & (value | !CLEARED_BY_ZERO));
                Ok(())
            }
            "EPR" => self.write_endpoint(register, value),
            "BCDR" => {
                if value & !register.mask("DPPU") != 0 {
                    return Err(rule("detection of chargers (BCDR) is not modelled"));
                }
                self.bank.store(register, value);
                Ok(())
            }
            _ => {
                self.bank.store(register, value);
                Ok(())
            }
        }
    }

    fn control(&mut self, register: &Register, value: u32, now: Time) -> Result<(), Misuse> {
        let old = self.bank.value(register);
        let get = |value, field| register.get(value, field) != 0;
        if ["RESUME", "L1RESUME", "L1REQM"].iter().any(|field| get(value, field)) {
            return Err(rule("waking the host and link power management (CNTR) are not modelled"));
        }
        if get(value, "LPMODE") && !get(value, "FSUSP") {
            return Err(rule("CNTR.LPMODE is set outside a suspension"));
        }
        self.bank.store(register, value);
        if get(old, "PDWN") && !get(value, "PDWN") {
            self.powered_at = now;
        }
        if get(value, "FRES") || get(value, "PDWN") {
            self.start_anew();
            self.missing_at = Time::NEVER;
        } else if get(old, "FRES") {
            if now < self.powered_at + STARTUP {
                return Err(rule("CNTR.FRES ends before the transceiver has started: 1 us after CNTR.PDWN"));
            }
            self.expect_frames(now);
        } else if get(old, "FSUSP") && !get(value, "FSUSP") {
            self.expect_frames(now);
        }
        Ok(())
    }

    /// States and toggles change where a one is written, flags go where a zero is.
    fn write_endpoint(&mut self, register: &Register, value: u32) -> Result<(), Misuse> {
        if !self.is_on() {
            return Err(rule("an endpoint register is written while CNTR.FRES or PDWN is 1"));
        }
        let mask = |fields: &[&str]| fields.iter().fold(0, |mask, field| mask | register.mask(field));
        let plain = mask(&["EA", "EP_TYPE", "EP_KIND"]);
        let toggled = mask(&["STAT_TX", "STAT_RX", "DTOG_TX", "DTOG_RX"]);
        let flags = mask(&["CTR_TX", "CTR_RX"]);
        let old = self.bank.value(register);
        let new =
            value & plain | (old ^ value) & toggled | old & value & flags | old & register.mask("SETUP");
        self.bank.store(register, new);
        let kind = register.get(new, "EP_TYPE");
        let is_used = register.get(new, "STAT_TX") | register.get(new, "STAT_RX") != 0;
        if is_used && (kind == ISOCHRONOUS || kind == BULK && register.get(new, "EP_KIND") != 0) {
            return Err(rule("isochronous and double-buffered endpoints are not modelled"));
        }
        self.check_buffers(register.index)?;
        self.guard();
        Ok(())
    }

    /// Buffers of an endpoint lie in the memory, at even addresses, and hold a packet.
    fn check_buffers(&self, index: usize) -> Result<(), Misuse> {
        let checked = [
            (Stat::of(self, index, "STAT_TX"), self.tx_buffer(index)),
            (Stat::of(self, index, "STAT_RX"), self.rx_buffer(index)),
        ];
        for (stat, (start, length)) in checked {
            if stat == Stat::Valid && (start % 2 != 0 || start + length > memory::BYTES) {
                return Err(rule(format!(
                    "endpoint {index} is VALID with a buffer at {start:#x} of {length} bytes"
                )));
            }
        }
        let (_, length) = self.tx_buffer(index);
        if checked[0].0 == Stat::Valid && length > MOST_BYTES {
            return Err(rule(format!("endpoint {index} is to send a packet of {length} bytes")));
        }
        Ok(())
    }

    /// What the CPU may not change now: buffers of packets to be sent and their table.
    pub(super) fn guard(&mut self) {
        let mut guarded = Vec::new();
        for index in 0..8 {
            let table = self.table() + 8 * index;
            if Stat::of(self, index, "STAT_TX") == Stat::Valid {
                let (start, length) = self.tx_buffer(index);
                guarded.extend([(index, start..start + length), (index, table..table + 4)]);
            }
            if Stat::of(self, index, "STAT_RX") == Stat::Valid {
                let (start, length) = self.rx_buffer(index);
                guarded.extend([(index, start..start + length), (index, table + 4..table + 8)]);
            }
        }
        self.memory.guarded = guarded;
    }
}
