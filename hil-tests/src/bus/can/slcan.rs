//! slcan: the text protocol of an adapter for CAN on a serial port, as CANable 2.0 has it.
//!
//! A line ends with a carriage return. What is understood is answered with one, what is not with a bell; frames to be sent are
//! not answered, unless they cannot be.
//!
//! | line | means |
//! |---|---|
//! | `C`, `O` | close the channel, open it |
//! | `S0` to `S8`, `Y1`, `Y2`, `Y4`, `Y5` | nominal rate: 10, 20, 50, 100, 125, 250, 500, 750, 1000 kbit/s; data rate in Mbit/s |
//! | `V` | which adapter it is |
//! | `bIIIL...` | a frame in the FD format that switches its rate: identifier, length code, data, all in hexadecimal digits |
//! | `dIIIL...`, `tIIIL...` | the same without a switch; a classic frame |

use super::{Adapter, Frame};
use crate::chip::{
    fdcan::frame::{Format, LENGTHS},
    time::Time,
};

/// What is understood.
const DONE: u8 = b'\r';
/// And what is not.
const REFUSED: u8 = 7;
/// No line is longer: a command, an identifier, a length and 64 bytes.
const LONGEST: usize = 1 + 3 + 1 + 128;
const NOMINAL_KILOBITS: [u64; 9] = [10, 20, 50, 100, 125, 250, 500, 750, 1000];
const DATA_MEGABITS: [u64; 4] = [1, 2, 4, 5];

/// A program's end of an adapter.
#[derive(Debug, Default)]
pub struct Slcan {
    line: Vec<u8>,
}

impl Slcan {
    /// Takes what a program has written; gives what it reads.
    pub fn take(&mut self, bytes: &[u8], adapter: &mut Adapter, now: Time) -> Vec<u8> {
        let mut answers = Vec::new();
        for &byte in bytes {
            if byte != b'\r' {
                // What is too long stays so.
                if self.line.len() <= LONGEST {
                    self.line.push(byte);
                }
                continue;
            }
            let line = std::mem::take(&mut self.line);
            answers.extend(obey(&line, adapter, now).unwrap_or_else(|| vec![REFUSED]));
        }
        answers
    }
}

/// A frame that was heard, as a program reads it.
#[must_use]
pub fn shown(frame: &Frame) -> Vec<u8> {
    let kind = match frame.format {
        Format::Classic => 't',
        Format::Fd => 'd',
        Format::Switching => 'b',
    };
    let data: String = frame.data.iter().map(|byte| format!("{byte:02X}")).collect();
    format!("{kind}{:03X}{:X}{data}\r", frame.identifier, frame.length_code()).into()
}

/// The answer to a line, if that can be obeyed.
fn obey(line: &[u8], adapter: &mut Adapter, now: Time) -> Option<Vec<u8>> {
    let done = Some(vec![DONE]);
    match line {
        [] => done,
        b"C" => {
            adapter.is_on = false;
            adapter.forget();
            done
        }
        b"O" if !adapter.is_on => {
            adapter.is_on = true;
            done
        }
        b"V" => Some(b"dermatome-hil slcan\r".to_vec()),
        [b'S', rate @ b'0'..=b'8'] if !adapter.is_on => {
            adapter.rates.nominal = 1000 * NOMINAL_KILOBITS[usize::from(rate - b'0')];
            done
        }
        [b'Y', rate @ b'0'..=b'9'] if !adapter.is_on => {
            let rate = u64::from(rate - b'0');
            adapter.rates.data = 1_000_000 * DATA_MEGABITS.into_iter().find(|&known| known == rate)?;
            done
        }
        [kind @ (b'b' | b'd' | b't'), rest @ ..] if adapter.is_on => {
            adapter.send(frame(*kind, rest)?, now);
            Some(Vec::new())
        }
        _ => None,
    }
}

/// The frame of a line without its first letter.
fn frame(kind: u8, rest: &[u8]) -> Option<Frame> {
    let digits: Vec<u8> =
        rest.iter().map(|&digit| Some(char::from(digit).to_digit(16)? as u8)).collect::<Option<_>>()?;
    let (&[first, second, third, code], data) = digits.split_first_chunk()?;
    let identifier = u16::from(first) << 8 | u16::from(second) << 4 | u16::from(third);
    let format = match kind {
        b'b' => Format::Switching,
        b'd' => Format::Fd,
        _ => Format::Classic,
    };
    let length = LENGTHS[usize::from(code)];
    let fits = identifier < 0x800 && data.len() == 2 * length && (format != Format::Classic || length <= 8);
    let bytes = || data.chunks_exact(2).map(|pair| pair[0] << 4 | pair[1]).collect();
    fits.then(|| Frame { identifier, format, data: bytes() })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn asked(adapter: &mut Adapter, lines: &str) -> Vec<u8> {
        Slcan::default().take(lines.as_bytes(), adapter, Time::ZERO)
    }

    fn closed() -> Adapter {
        let mut adapter = Adapter::default();
        adapter.is_on = false;
        adapter
    }

    #[test]
    fn a_channel_is_set_up_opened_and_closed() {
        let mut adapter = closed();
        assert_eq!(asked(&mut adapter, "C\rS6\rY5\rO\r"), b"\r\r\r\r");
        assert_eq!((adapter.is_on, adapter.rates.nominal, adapter.rates.data), (true, 500_000, 5_000_000));
        assert_eq!(asked(&mut adapter, "O\rS8\rY2\r"), [7, 7, 7], "it is open");
        assert_eq!(asked(&mut adapter, "V\r"), b"dermatome-hil slcan\r");
        assert_eq!(asked(&mut adapter, "C\rS8\rY3\rX\r"), [b'\r', b'\r', 7, 7]);
        assert!(!adapter.is_on);
    }

    #[test]
    fn frames_of_all_kinds_go_there_and_back() {
        let long = format!("b10FF{}\r", "A5".repeat(64));
        for line in ["b1030\r", "t7FF3010203\r", "d20C9000102030405060708090A0B\r", &long] {
            let mut adapter = Adapter::default();
            assert_eq!(asked(&mut adapter, line), b"", "{line}");
            let (_, frame) = adapter.request().unwrap();
            assert_eq!(shown(&frame), line.as_bytes());
        }
    }

    #[test]
    fn what_is_no_frame_or_comes_to_a_closed_channel_is_refused() {
        let mut adapter = Adapter::default();
        let long = format!("b103F{}\r", "A5".repeat(65));
        for line in [
            "b8000\r",
            "t1009000102030405060708090A0B\r",
            "b1031\r",
            "b103100ZZ\r",
            "b10\r",
            "T000001030\r",
            &long,
        ] {
            assert_eq!(asked(&mut adapter, line), [7], "{line}");
        }
        assert_eq!(asked(&mut closed(), "b1030\r"), [7]);
        assert_eq!(adapter.waiting(), 0);
    }

    #[test]
    fn lines_come_in_pieces() {
        let (mut slcan, mut adapter) = (Slcan::default(), Adapter::default());
        assert_eq!(slcan.take(b"b10", &mut adapter, Time::ZERO), b"");
        assert_eq!(slcan.take(b"32AB", &mut adapter, Time::ZERO), b"");
        assert_eq!(slcan.take(b"CD\rb1030\r", &mut adapter, Time::ZERO), b"");
        assert_eq!(adapter.waiting(), 2);
    }
}
