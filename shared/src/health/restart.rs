//! Restart: why a board started last, and the note that a crash leaves for the next start.
//!
//! A [`CrashNote`] lies in memory that a reset leaves alone and that start-up code does not clear.
//! After power-on it holds anything, so a checksum says whether it is a note.

use crate::patch::checksum::crc32;
use core::fmt::{self, Write};
use heapless::String;
use postcard_schema::Schema;
use serde::{Deserialize, Serialize};

/// Longest message of a crash, bytes of UTF-8; what is longer is cut.
pub const MAX_CRASH_BYTES: usize = 96;

/// Why a board started.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub enum Restart {
    /// Its supply came up, or dipped.
    PowerOn,
    /// Its reset pin: a button, or a debug probe.
    ResetPin,
    /// Its firmware or a debug probe asked for it.
    Software,
    /// The firmware hung, and the watchdog noticed.
    Watchdog,
    /// The firmware met an error that it cannot go on from.
    Crash {
        /// What it was, and where.
        message: String<MAX_CRASH_BYTES>,
    },
    /// Something else, such as changed option bytes.
    Other,
}

impl fmt::Display for Restart {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::PowerOn => f.write_str("power on"),
            Self::ResetPin => f.write_str("its reset pin"),
            Self::Software => f.write_str("a reset by software"),
            Self::Watchdog => f.write_str("its watchdog: the firmware had hung"),
            Self::Crash { message } => write!(f, "a crash of the firmware: {message}"),
            Self::Other => f.write_str("another kind of reset"),
        }
    }
}

/// The causes that a chip keeps over a reset. Several can be set: most resets pull the reset pin too.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ResetCauses {
    /// The supply came up or dipped.
    pub power: bool,
    /// The watchdog.
    pub watchdog: bool,
    /// Asked for by software.
    pub software: bool,
    /// The reset pin.
    pub pin: bool,
}

impl Restart {
    /// What the causes and the note of a crash amount to.
    ///
    /// A note counts only after a reset by software, which is how a crash ends, or by the watchdog,
    /// should it come first: after power-on the memory holds anything.
    #[must_use]
    pub fn new(causes: ResetCauses, crash: Option<String<MAX_CRASH_BYTES>>) -> Self {
        match crash {
            Some(message) if causes.software || causes.watchdog => Self::Crash { message },
            _ if causes.power => Self::PowerOn,
            _ if causes.watchdog => Self::Watchdog,
            _ if causes.software => Self::Software,
            _ if causes.pin => Self::ResetPin,
            _ => Self::Other,
        }
    }
}

/// What a crash leaves behind. All bit patterns are allowed in it.
#[derive(Clone, Copy, Debug)]
#[repr(C)]
pub struct CrashNote {
    length: u32,
    text: [u8; MAX_CRASH_BYTES],
    check: u32,
}

impl CrashNote {
    /// No note.
    #[must_use]
    pub const fn none() -> Self {
        Self { length: 0, text: [0; MAX_CRASH_BYTES], check: 0 }
    }

    /// A note of what happened, cut at [`MAX_CRASH_BYTES`].
    #[must_use]
    pub fn new(what: fmt::Arguments<'_>) -> Self {
        let mut cut = Cut(String::new());
        let _ = cut.write_fmt(what);
        let mut note = Self::none();
        note.length = cut.0.len() as u32;
        note.text[..cut.0.len()].copy_from_slice(cut.0.as_bytes());
        note.check = note.checksum();
        note
    }

    /// The message, if this is a note.
    #[must_use]
    pub fn message(&self) -> Option<String<MAX_CRASH_BYTES>> {
        let text = self.text.get(..self.length as usize)?;
        if text.is_empty() || self.check != self.checksum() {
            return None;
        }
        core::str::from_utf8(text).ok()?.try_into().ok()
    }

    fn checksum(&self) -> u32 {
        crc32(&[&self.length.to_le_bytes(), &self.text])
    }
}

/// Takes as much text as fits, whole characters only.
struct Cut(String<MAX_CRASH_BYTES>);

impl Write for Cut {
    fn write_str(&mut self, text: &str) -> fmt::Result {
        text.chars().try_for_each(|character| self.0.push(character)).map_err(|_| fmt::Error)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use std::string::ToString;

    const POWER: ResetCauses = ResetCauses { power: true, watchdog: false, software: false, pin: true };
    const SOFTWARE: ResetCauses = ResetCauses { power: false, watchdog: false, software: true, pin: true };

    #[test]
    fn a_note_is_read_after_the_reset_that_ends_a_crash() {
        let note = CrashNote::new(format_args!("panicked at {}:{}: {}", "src/main.rs", 7, "no clock"));
        let restart = Restart::new(SOFTWARE, note.message());
        assert_eq!(restart.to_string(), "a crash of the firmware: panicked at src/main.rs:7: no clock");
    }

    #[test]
    fn what_memory_holds_after_power_on_is_no_crash() {
        let note = CrashNote::new(format_args!("left over"));
        assert_eq!(Restart::new(POWER, note.message()), Restart::PowerOn);
        assert_eq!(Restart::new(SOFTWARE, CrashNote::none().message()), Restart::Software);
    }

    #[test]
    fn each_cause_is_told_apart_though_all_pull_the_pin() {
        let pin = ResetCauses { pin: true, ..ResetCauses::default() };
        assert_eq!(Restart::new(pin, None), Restart::ResetPin);
        assert_eq!(Restart::new(ResetCauses { watchdog: true, ..pin }, None), Restart::Watchdog);
        assert_eq!(Restart::new(ResetCauses::default(), None), Restart::Other);
    }

    #[test]
    fn a_long_message_is_cut_between_characters() {
        let note = CrashNote::new(format_args!("{}", "µ".repeat(60)));
        assert_eq!(note.message().unwrap(), "µ".repeat(48).as_str());
        let note = CrashNote::new(format_args!("x{}", "µ".repeat(60)));
        assert_eq!(note.message().unwrap().len(), 95);
    }

    proptest! {
        #[test]
        fn no_flipped_bit_passes_for_a_note(bit in 0_usize..(8 + MAX_CRASH_BYTES) * 8, text in "[a-z]{1,96}") {
            let mut note = CrashNote::new(format_args!("{text}"));
            match bit / 8 {
                byte @ 0..4 => note.length ^= 1 << (8 * byte + bit % 8),
                byte @ 4..8 => note.check ^= 1 << (8 * (byte - 4) + bit % 8),
                byte => note.text[byte - 8] ^= 1 << (bit % 8),
            }
            prop_assert_eq!(note.message(), None);
        }
    }
}
