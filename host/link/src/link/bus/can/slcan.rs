//! slcan: a CAN FD bus behind an adapter that takes and gives lines of text, as the firmware of CANable 2.0 does.
//!
//! A line ends with a carriage return. `b`, three digits of the identifier, one for the length and two for each byte, all
//! hexadecimal, is a frame whose bit rate switches; `d` one whose bit rate does not. An adapter answers commands with an
//! empty line or not at all, and with a bell what it cannot do.

use super::{
    super::super::transport::{Transport, open_halves, write_all},
    Ends, Receiver, Sender,
};
use crate::{error::LinkError, port::Adapter};
use dermatome_shared::protocol::can::LENGTHS;
use std::{
    fmt::Write as _,
    io::{self, ErrorKind},
};

/// Ends what somebody before has left, closes the bus, makes it 1 Mbit/s and, where the bit rate switches, 2 Mbit/s, and
/// opens it. An empty line would do as well for the first, but CANable's firmware takes it for the last one once more.
const OPEN: &[u8] = b"C\rC\rS8\rY2\rO\r";
const CLOSE: &[u8] = b"C\r";
/// A frame's letter and digits; what comes behind, the time, is not read.
const HEAD: usize = 5;
/// Longest line that is looked at.
const LONGEST: usize = 256;

/// Opens an adapter's bus.
pub(super) fn open(name: &str, adapter: &Adapter) -> Result<Ends, LinkError> {
    let [wire, mut other] = open_halves(name, adapter)?;
    write_all(other.as_mut(), OPEN).map_err(|error| LinkError::on_open(name, error))?;
    let receiver = Lines { wire, line: Vec::new(), buffer: [0; 4096], name: name.to_owned() };
    Ok((Box::new(Text { wire: other, line: String::new() }), Box::new(receiver)))
}

/// Sends frames as lines.
struct Text {
    wire: Box<dyn Transport>,
    line: String,
}

impl Sender for Text {
    fn send(&mut self, identifier: u16, data: &[u8]) -> io::Result<()> {
        let length =
            LENGTHS.iter().position(|&length| length == data.len()).ok_or(ErrorKind::InvalidInput)?;
        self.line.clear();
        // Writing to a string never fails.
        let _ = write!(self.line, "b{identifier:03X}{length:X}");
        for byte in data {
            let _ = write!(self.line, "{byte:02X}");
        }
        self.line.push('\r');
        write_all(self.wire.as_mut(), self.line.as_bytes())
    }
}

impl Drop for Text {
    fn drop(&mut self) {
        // Where it cannot be closed any more, it is.
        let _ = write_all(self.wire.as_mut(), CLOSE);
    }
}

/// Receives lines.
struct Lines {
    wire: Box<dyn Transport>,
    /// What has come of a line.
    line: Vec<u8>,
    buffer: [u8; 4096],
    /// A board's port, for the log.
    name: String,
}

impl Receiver for Lines {
    fn receive(&mut self, take: &mut dyn FnMut(u16, &[u8])) -> io::Result<()> {
        let length = match self.wire.read(&mut self.buffer) {
            Ok(0) => return Err(ErrorKind::UnexpectedEof.into()),
            other => other?,
        };
        for &byte in &self.buffer[..length] {
            match byte {
                b'\r' => {
                    if let Some((identifier, data)) = frame(&self.line) {
                        take(identifier, &data);
                    }
                    self.line.clear();
                }
                b'\n' => {}
                b'\x07' => {
                    self.line.clear();
                    log::info!("the adapter of `{}` has refused a command or a frame", self.name);
                }
                byte if self.line.len() < LONGEST => self.line.push(byte),
                _ => {}
            }
        }
        Ok(())
    }
}

/// Identifier and data of a line; none of one that is no frame of CAN FD with an 11-bit identifier.
fn frame(line: &[u8]) -> Option<(u16, Vec<u8>)> {
    if !matches!(line.first(), Some(b'b' | b'd')) {
        return None;
    }
    let identifier =
        line[1..].iter().take(3).try_fold(0, |sum, &it| Some(sum << 4 | u16::from(digit(it)?)))?;
    let length = LENGTHS[usize::from(digit(*line.get(HEAD - 1)?)?)];
    let digits = line.get(HEAD..HEAD + 2 * length)?;
    let data = digits.chunks(2).map(|pair| Some(digit(pair[0])? << 4 | digit(pair[1])?));
    Some((identifier, data.collect::<Option<_>>()?))
}

fn digit(byte: u8) -> Option<u8> {
    char::from(byte).to_digit(16).map(|digit| digit as u8)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::link::transport::may_retry;
    use proptest::prelude::*;
    use std::collections::VecDeque;

    /// What was written, and what is to be read in pieces.
    #[derive(Default)]
    struct Wire {
        written: Vec<u8>,
        to_read: VecDeque<Vec<u8>>,
    }

    impl io::Read for Wire {
        fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
            let Some(piece) = self.to_read.pop_front() else { return Err(ErrorKind::TimedOut.into()) };
            buffer[..piece.len()].copy_from_slice(&piece);
            Ok(piece.len())
        }
    }

    impl io::Write for Wire {
        fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
            self.written.extend_from_slice(bytes);
            Ok(bytes.len())
        }

        fn flush(&mut self) -> io::Result<()> {
            Ok(())
        }
    }

    impl Transport for Wire {}

    fn received(pieces: impl IntoIterator<Item = Vec<u8>>) -> Vec<(u16, Vec<u8>)> {
        let to_read: VecDeque<_> = pieces.into_iter().collect();
        let reads = to_read.len();
        let wire = Box::new(Wire { to_read, ..Wire::default() });
        let mut lines = Lines { wire, line: Vec::new(), buffer: [0; 4096], name: "can:here#1".to_owned() };
        let mut frames = Vec::new();
        for _ in 0..reads {
            lines.receive(&mut |identifier, data| frames.push((identifier, data.to_vec()))).unwrap();
        }
        assert!(may_retry(&lines.receive(&mut |_, _| ()).unwrap_err()));
        frames
    }

    #[test]
    fn a_frame_is_a_line_with_its_length_code() {
        assert_eq!(frame(b"b2033ABCDEF"), Some((0x203, vec![0xAB, 0xCD, 0xEF])));
        assert_eq!(frame(b"d2F00"), Some((0x2F0, vec![])));
        let long: Vec<u8> = [b"b20FF".to_vec(), b"5a".repeat(64)].concat();
        assert_eq!(frame(&long), Some((0x20F, vec![0x5A; 64])));
        assert_eq!(frame(b"b20021122F00D"), Some((0x200, vec![0x11, 0x22])), "with the time");
        let none: [&[u8]; 9] =
            [b"", b"b", b"b20", b"b200", b"b2001", b"b2001A", b"bG001AA", b"b2001AX", b"t2001AA"];
        assert!(none.iter().all(|line| frame(line).is_none()));
    }

    #[test]
    fn what_is_no_frame_ends_with_its_line() {
        let text = b"V1.2 something\r\r\n\x07b2011AA\rB0000020011FF\rz\rtoo long ";
        let text = [&text[..], &b"x".repeat(1000), b"\rb2022AABB\rb2001A\x07b2001CC\r"].concat();
        assert_eq!(received([text]), [(0x201, vec![0xAA]), (0x202, vec![0xAA, 0xBB]), (0x200, vec![0xCC])]);
    }

    proptest! {
        #[test]
        fn what_is_sent_is_received_however_it_is_cut(
            frames in prop::collection::vec((0_u16..0x800, 0_usize..16, any::<u8>()), 1..20),
            piece in 1_usize..200,
        ) {
            let mut wire = Vec::new();
            let mut sent = Vec::new();
            for (identifier, code, byte) in frames {
                let mut text = Text { wire: Box::new(Wire::default()), line: String::new() };
                let data: Vec<u8> = (0..LENGTHS[code]).map(|at| byte.wrapping_add(at as u8)).collect();
                text.send(identifier, &data).unwrap();
                wire.extend_from_slice(text.line.as_bytes());
                sent.push((identifier, data));
            }
            prop_assert_eq!(received(wire.chunks(piece).map(<[u8]>::to_vec)), sent);
        }

        #[test]
        fn any_bytes_are_heard_without_harm(bytes in prop::collection::vec(any::<u8>(), 1..2000)) {
            received([bytes]);
        }
    }
}
