//! A firmware's log: defmt frames, as they come over RTT, become lines of text. Only the ELF has the texts.

use super::firmware::Firmware;
use crate::words::escaped;
use defmt_decoder::{DecodeError, Frame, StreamDecoder, Table};

/// The log of one firmware: where the board keeps it, and its texts.
#[derive(Clone)]
pub struct Log {
    control_block: u64,
    table: Table,
}

/// The firmware has no log.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("this firmware has no log ({reason})")]
pub struct NoLog {
    reason: String,
}

/// The log is not this firmware's.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("the board's log is damaged: is it the log of another firmware?")]
pub struct DamagedLog;

impl Log {
    /// The log of `firmware`.
    pub fn new(firmware: &Firmware) -> Result<Self, NoLog> {
        let missing = |reason: &str| NoLog { reason: reason.to_owned() };
        let control_block = firmware.rtt_control_block().ok_or_else(|| missing("no symbol `_SEGGER_RTT`"))?;
        let table = Table::parse(firmware.elf()).map_err(|error| missing(&format!("{error:#}")))?;
        let table = table.ok_or_else(|| missing("no section `.defmt`"))?;
        Ok(Self { control_block, table })
    }

    /// Where in RAM the board announces it.
    #[must_use]
    pub fn control_block(&self) -> u64 {
        self.control_block
    }

    /// Decodes what a board logs from one start to the next. Colours also need a terminal at standard output.
    #[must_use]
    pub fn decoder(&self, in_colour: bool) -> Decoder<'_> {
        let recovers = self.table.encoding().can_recover();
        Decoder { stream: self.table.new_stream_decoder(), recovers, in_colour }
    }
}

/// Makes lines of bytes.
pub struct Decoder<'a> {
    stream: Box<dyn StreamDecoder + Send + Sync + 'a>,
    recovers: bool,
    in_colour: bool,
}

impl Decoder<'_> {
    /// Decodes what has come, and hands on the lines that are complete.
    pub fn push(&mut self, bytes: &[u8], mut line: impl FnMut(&str)) -> Result<(), DamagedLog> {
        self.stream.received(bytes);
        loop {
            match self.stream.decode() {
                Ok(frame) => line(&words(&frame, self.in_colour)),
                Err(DecodeError::UnexpectedEof) => return Ok(()),
                // The next frame starts behind a mark; only this one is lost.
                Err(DecodeError::Malformed) if self.recovers => line("(a damaged line)"),
                Err(DecodeError::Malformed) => return Err(DamagedLog),
            }
        }
    }
}

/// Time, level and message of a frame; only the level has a colour, whatever the others hold.
fn words(frame: &Frame<'_>, in_colour: bool) -> String {
    let time = frame.display_timestamp().map(|time| format!("{time} ")).unwrap_or_default();
    let message = frame.display_message().to_string();
    let all = frame.display(in_colour).to_string();
    let level = all.strip_prefix(&time).and_then(|rest| rest.strip_suffix(&message)).unwrap_or_default();
    format!("{}{level}{}", escaped(&time), escaped(&message))
}
