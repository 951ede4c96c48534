//! Faults: what is done to an emulated board, and when.
//!
//! Written `WHAT@WHEN`, for instance `power@1.5s`, `power@op:37`, `flip@2s:0x20000100.3`.

use crate::{
    chip::{Chip, time::Time},
    machine::{Halt, Machine},
    world,
};
use std::{fmt, str::FromStr};

/// One fault.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fault {
    /// When it happens.
    pub when: When,
    /// What happens.
    pub what: What,
}

/// When a fault happens.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum When {
    /// At this virtual time.
    Time(Time),
    /// As soon as the flash has begun so many operations.
    FlashOperation(u64),
}

/// What happens.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum What {
    /// Power fails and comes back.
    Power,
    /// A bit of RAM flips: address and bit.
    Flip(u32, u8),
    /// One bit in each of the next so many bytes on the way to the board flips.
    Noise(u32),
    /// The flash never becomes ready again.
    Stuck,
    /// The DMA comes too late for a sample of the converter of voltages.
    LostSample,
    /// The DMA comes too late for a value of the current.
    LostValue,
    /// The CPU runs in circles.
    Hang,
    /// The CPU meets a bus error.
    BusError,
    /// The code that runs calls itself without end.
    StackOverflow,
    /// Something breaks before the chip.
    World(world::Fault),
}

/// Why a text is no fault.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error(
    "`{text}` is no fault: {reason} (allowed are power@TIME, power@op:N, flip@TIME:0xADDRESS.BIT, \
     noise@TIME:BYTES, stuck@TIME, sample@TIME, value@TIME, hang@TIME, crash@TIME, overflow@TIME; and, from the start or with \
     @TIME behind them, open:ELECTRODE, short:ELECTRODE-ELECTRODE, contact:ELECTRODE+OHMS, mux:LINE=LEVEL, dac, saturate; TIME is \
     like 20ms or 1.5s, electrodes are 1 to 16, lines 0 to 15)"
)]
pub struct FaultError {
    text: String,
    reason: String,
}

impl FromStr for Fault {
    type Err = FaultError;

    fn from_str(text: &str) -> Result<Self, FaultError> {
        parse(text).map_err(|reason| FaultError { text: text.to_owned(), reason })
    }
}

fn parse(text: &str) -> Result<Fault, String> {
    if let Some(fault) = before_the_chip(text)? {
        return Ok(fault);
    }
    let (what, rest) = text.split_once('@').ok_or("it has no `@`")?;
    if let Some(number) = rest.strip_prefix("op:") {
        let number = number.parse().map_err(|_| format!("`{number}` is no number"))?;
        return match what {
            "power" => Ok(Fault { when: When::FlashOperation(number), what: What::Power }),
            "stuck" => Ok(Fault { when: When::FlashOperation(number), what: What::Stuck }),
            _ => Err(format!("`{what}` cannot wait for the flash")),
        };
    }
    let (time, argument) = rest.split_once(':').map_or((rest, None), |(time, rest)| (time, Some(rest)));
    let what = match (what, argument) {
        ("power", None) => What::Power,
        ("stuck", None) => What::Stuck,
        ("sample", None) => What::LostSample,
        ("value", None) => What::LostValue,
        ("hang", None) => What::Hang,
        ("crash", None) => What::BusError,
        ("overflow", None) => What::StackOverflow,
        ("noise", Some(bytes)) => {
            What::Noise(bytes.parse().map_err(|_| format!("`{bytes}` is no number of bytes"))?)
        }
        ("flip", Some(place)) => flip(place)?,
        _ => return Err(format!("`{what}` is unknown, or lacks or has too much behind its time")),
    };
    Ok(Fault { when: When::Time(parse_time(time)?), what })
}

/// A fault of skin or front end; `None` if the text begins like none.
fn before_the_chip(text: &str) -> Result<Option<Fault>, String> {
    let (what, time) = text.split_once('@').map_or((text, None), |(what, time)| (what, Some(time)));
    let (kind, place) = what.split_once(':').map_or((what, ""), |(kind, place)| (kind, place));
    let fault = match kind {
        "open" => world::Fault::ElectrodeOpen(electrode(place)?),
        "short" => {
            let (a, b) = place.split_once('-').ok_or_else(|| format!("`{place}` is no pair like 3-4"))?;
            let (a, b) = (electrode(a)?, electrode(b)?);
            if a == b {
                return Err("a pair is two different electrodes".to_owned());
            }
            world::Fault::PairShorted(a, b)
        }
        "contact" => {
            let (which, ohms) =
                place.split_once('+').ok_or_else(|| format!("`{place}` is not like 3+500"))?;
            let ohms = ohms.parse().map_err(|_| format!("`{ohms}` is no whole number of ohms"))?;
            world::Fault::BadContact { electrode: electrode(which)?, ohms }
        }
        "mux" => line(place)?,
        "dac" if place.is_empty() => world::Fault::DacDead,
        "saturate" if place.is_empty() => world::Fault::AdcSaturated,
        _ => return Ok(None),
    };
    let time = time.map_or(Ok(Time::ZERO), parse_time)?;
    Ok(Some(Fault { when: When::Time(time), what: What::World(fault) }))
}

/// An electrode as people count them, from 1.
fn electrode(text: &str) -> Result<usize, String> {
    let number = text.parse().ok().filter(|number| (1..=16).contains(number));
    number.map(|number: usize| number - 1).ok_or_else(|| format!("`{text}` is no electrode from 1 to 16"))
}

fn line(text: &str) -> Result<world::Fault, String> {
    let (number, level) = text.split_once('=').unwrap_or((text, "0"));
    let line = number.parse().ok().filter(|&line| line < world::fault::LINES);
    let line = line.ok_or_else(|| format!("`{number}` is no address line from 0 to 15"))?;
    let high = match level {
        "0" => false,
        "1" => true,
        _ => return Err(format!("`{level}` is no level, 0 or 1")),
    };
    Ok(world::Fault::LineStuck { line, high })
}

fn flip(place: &str) -> Result<What, String> {
    let wrong = || format!("`{place}` is not like 0x20000100.3");
    let (address, bit) = place.split_once('.').ok_or_else(wrong)?;
    let address = address.strip_prefix("0x").and_then(|digits| u32::from_str_radix(digits, 16).ok());
    let bit = bit.parse().ok().filter(|&bit| bit < 8);
    match (address, bit) {
        (Some(address), Some(bit)) if (0x2000_0000..0x2002_0000).contains(&address) => {
            Ok(What::Flip(address, bit))
        }
        (Some(address), Some(_)) => Err(format!("{address:#x} is not in RAM (0x20000000 to 0x2001ffff)")),
        _ => Err(wrong()),
    }
}

/// A time such as `20ms`, `1.5s`, `300us`.
pub fn parse_time(text: &str) -> Result<Time, String> {
    let digits =
        text.find(|c: char| c.is_ascii_alphabetic()).ok_or_else(|| format!("`{text}` lacks its unit"))?;
    let (number, unit) = text.split_at(digits);
    let scale = match unit {
        "s" => 1e6,
        "ms" => 1e3,
        "us" => 1.0,
        _ => return Err(format!("`{unit}` is no unit of time (allowed are s, ms, us)")),
    };
    let number: f64 = number.parse().map_err(|_| format!("`{number}` is no number"))?;
    let micros = number * scale;
    if !(0.0..=1e10).contains(&micros) {
        return Err(format!("`{text}` is not between 0 and 10000 s"));
    }
    Ok(Time::from_micros(micros.round() as u64))
}

impl fmt::Display for What {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Power => formatter.write_str("power fails and comes back"),
            Self::Flip(address, bit) => write!(formatter, "bit {bit} at {address:#010x} flips"),
            Self::Noise(bytes) => write!(formatter, "the next {bytes} bytes to the board are damaged"),
            Self::Stuck => formatter.write_str("the flash stays busy for ever"),
            Self::LostSample => formatter.write_str("the DMA comes too late for a sample"),
            Self::LostValue => formatter.write_str("the DMA comes too late for a value of the current"),
            Self::Hang => formatter.write_str("the CPU runs in circles"),
            Self::BusError => formatter.write_str("the CPU meets a bus error"),
            Self::StackOverflow => formatter.write_str("the code that runs calls itself without end"),
            Self::World(fault) => fault.fmt(formatter),
        }
    }
}

/// Faults that are still to come.
#[derive(Clone, Debug, Default)]
pub struct Schedule {
    faults: Vec<Fault>,
}

impl Schedule {
    /// These faults.
    #[must_use]
    pub fn new(faults: &[Fault]) -> Self {
        Self { faults: faults.to_vec() }
    }

    /// Runs the machine until `deadline` and does what is due on the way; says what was done.
    pub fn run(&mut self, machine: &mut Machine, deadline: Time) -> Result<Vec<(Time, What)>, Halt> {
        let mut done = Vec::new();
        while machine.now() < deadline {
            let due = |fault: &Fault| match fault.when {
                When::Time(time) => time,
                When::FlashOperation(_) => Time::NEVER,
            };
            let next = self.faults.iter().map(due).min().unwrap_or(Time::NEVER);
            let operation = self.faults.iter().filter_map(|fault| match fault.when {
                When::FlashOperation(number) => Some(number),
                When::Time(_) => None,
            });
            let operation = operation.min().unwrap_or(u64::MAX);
            machine.run_while(deadline.min(next), |chip| chip.flash.operations() < operation)?;
            let (now, operations) = (machine.now(), machine.chip(|chip| chip.flash.operations()));
            let is_due = |fault: &Fault| match fault.when {
                When::Time(time) => time <= now,
                When::FlashOperation(number) => number <= operations,
            };
            let (due, rest): (Vec<Fault>, Vec<Fault>) = self.faults.iter().partition(|fault| is_due(fault));
            self.faults = rest;
            for fault in due {
                fault.what.happen(machine)?;
                done.push((now, fault.what));
            }
        }
        Ok(done)
    }
}

impl What {
    /// Does it.
    pub fn happen(self, machine: &mut Machine) -> Result<(), Halt> {
        match self {
            Self::Power => return machine.cut_power(),
            Self::Flip(address, bit) => {
                let byte = machine.peek(address, 1).first().copied().unwrap_or(0);
                machine.poke(address, &[byte ^ 1 << bit]);
            }
            Self::Noise(bytes) => machine.chip(|chip| chip.uart.disturb(bytes)),
            Self::Stuck => machine.chip(|chip| chip.flash.stick()),
            Self::LostSample => machine.chip(|chip| chip.lose_sample(2)),
            Self::LostValue => machine.chip(Chip::underrun),
            Self::Hang => machine.hang(),
            Self::BusError => machine.inject_fault(),
            Self::StackOverflow => machine.overflow_stack(),
            Self::World(fault) => {
                if let Some(world) = machine.world() {
                    world.inject(fault).expect("only faults that can be are read");
                }
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn faults_are_read_as_people_write_them() {
        let at = |millis| When::Time(Time::from_millis(millis));
        let read = |text: &str| text.parse::<Fault>().unwrap();
        assert_eq!(read("power@1.5s"), Fault { when: at(1500), what: What::Power });
        assert_eq!(read("power@op:37"), Fault { when: When::FlashOperation(37), what: What::Power });
        assert_eq!(read("flip@20ms:0x20000100.3"), Fault { when: at(20), what: What::Flip(0x2000_0100, 3) });
        assert_eq!(read("overflow@2ms"), Fault { when: at(2), what: What::StackOverflow });
        assert_eq!(read("noise@2ms:40"), Fault { when: at(2), what: What::Noise(40) });
        for (text, millis, fault) in [
            ("open:3@2ms", 2, world::Fault::ElectrodeOpen(2)),
            ("open:16", 0, world::Fault::ElectrodeOpen(15)),
            ("short:3-4@1s", 1000, world::Fault::PairShorted(2, 3)),
            ("contact:1+500", 0, world::Fault::BadContact { electrode: 0, ohms: 500 }),
            ("mux:11=1@5ms", 5, world::Fault::LineStuck { line: 11, high: true }),
            ("mux:0", 0, world::Fault::LineStuck { line: 0, high: false }),
            ("dac@1ms", 1, world::Fault::DacDead),
            ("saturate", 0, world::Fault::AdcSaturated),
        ] {
            assert_eq!(read(text), Fault { when: at(millis), what: What::World(fault) }, "{text}");
        }
    }

    #[test]
    fn what_is_no_fault_is_refused_with_what_is_allowed() {
        for (text, part) in [
            ("power", "no `@`"),
            ("power@5", "lacks its unit"),
            ("power@op:x", "`x` is no number"),
            ("flip@1s:0x08000000.1", "not in RAM"),
            ("flip@1s:0x20000000.9", "not like"),
            ("boom@1s", "unknown"),
            ("open@1s:3", "no electrode"),
            ("open:0", "from 1 to 16"),
            ("open:17", "from 1 to 16"),
            ("open:3@5", "lacks its unit"),
            ("short:3", "no pair"),
            ("short:3-3", "different"),
            ("contact:3+x", "whole number"),
            ("mux:16", "from 0 to 15"),
            ("mux:3=2", "no level"),
            ("dac:1", "no `@`"),
            ("power@-1s", "not between"),
        ] {
            let error = text.parse::<Fault>().unwrap_err().to_string();
            assert!(error.contains(part) && error.contains(text) && error.contains("allowed"), "{error}");
        }
    }
}
