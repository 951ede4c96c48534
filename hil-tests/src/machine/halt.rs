//! Halt: why a machine cannot go on.

use crate::chip::{misuse::Misuse, time::Time};

/// Why a machine cannot go on.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum Halt {
    /// The firmware does what the chip does not do.
    #[error("at {time}, pc {pc:#010x}: {misuse}")]
    Misuse {
        /// When.
        time: Time,
        /// Where.
        pc: u32,
        /// What.
        misuse: Misuse,
    },
    /// A fault in the handler of a fault, and no watchdog to end it.
    #[error(
        "at {time}, pc {pc:#010x}: the core locks up (a fault in the handler of a fault), and no watchdog runs"
    )]
    LockUp {
        /// When.
        time: Time,
        /// Where.
        pc: u32,
    },
    /// Unicorn does not do this.
    #[error("at {time}, pc {pc:#010x}: unicorn gives up: {reason}")]
    Unicorn {
        /// When.
        time: Time,
        /// Where.
        pc: u32,
        /// What it says.
        reason: String,
    },
}
