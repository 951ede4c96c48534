//! Faults of the analogue front end and of the skin.

use super::{error::WorldError, skin::LEADS};
use std::fmt;

/// Address lines of the four multiplexers.
pub const LINES: u8 = 16;

/// What is broken; electrodes count from 0.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Fault {
    /// An electrode has come off the skin.
    ElectrodeOpen(usize),
    /// An electrode touches worse, by so many ohms.
    BadContact {
        /// Which.
        electrode: usize,
        /// By how much.
        ohms: u32,
    },
    /// The leads of two electrodes touch.
    PairShorted(usize, usize),
    /// An address line of the multiplexers, 0 to 15, keeps its level.
    LineStuck {
        /// Bit of the multiplexer word.
        line: u8,
        /// Its level.
        high: bool,
    },
    /// The DAC's output stands at half its range.
    DacDead,
    /// The converter's input is at its highest voltage.
    AdcSaturated,
}

impl Fault {
    /// Refuses electrodes and lines that there are not.
    pub(super) fn check(self) -> Result<(), WorldError> {
        let electrode = |electrode: usize| {
            let (value, allowed) = (electrode.to_string(), format!("0 to {}", LEADS - 1));
            let wrong = WorldError::Value { field: "electrode", value, allowed };
            if electrode < LEADS { Ok(()) } else { Err(wrong) }
        };
        match self {
            Self::ElectrodeOpen(one) | Self::BadContact { electrode: one, .. } => electrode(one),
            Self::PairShorted(a, b) if a == b => Err(WorldError::Value {
                field: "pair",
                value: format!("{a} and {b}"),
                allowed: "two different electrodes".to_owned(),
            }),
            Self::PairShorted(a, b) => electrode(a).and_then(|()| electrode(b)),
            Self::LineStuck { line, .. } if line >= LINES => Err(WorldError::Value {
                field: "line",
                value: line.to_string(),
                allowed: format!("0 to {}", LINES - 1),
            }),
            _ => Ok(()),
        }
    }
}

impl fmt::Display for Fault {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::ElectrodeOpen(electrode) => write!(formatter, "electrode {} comes off", electrode + 1),
            Self::BadContact { electrode, ohms } => {
                write!(formatter, "electrode {} touches worse, by {ohms} ohm", electrode + 1)
            }
            Self::PairShorted(a, b) => write!(formatter, "electrodes {} and {} are shorted", a + 1, b + 1),
            Self::LineStuck { line, high } => {
                write!(formatter, "address line {line} is stuck at {}", u8::from(*high))
            }
            Self::DacDead => formatter.write_str("the DAC's output stands still"),
            Self::AdcSaturated => formatter.write_str("the converter's input is at its highest voltage"),
        }
    }
}

/// The word that reaches the multiplexers.
pub(super) fn stuck(word: u16, faults: &[Fault]) -> u16 {
    faults.iter().fold(word, |word, fault| match *fault {
        Fault::LineStuck { line, high: true } => word | 1 << line,
        Fault::LineStuck { line, high: false } => word & !(1 << line),
        _ => word,
    })
}
