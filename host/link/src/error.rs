//! What can go wrong on the way to a board and back.

use dermatome_shared::protocol::{PROTOCOL_VERSION, PacketError, Refusal};
use std::{fmt, io, sync::Arc, time::Duration};

/// Why a board could not be reached or did not do what was asked.
#[derive(Debug)]
pub struct LinkError {
    /// The port as written; shared with its link, so that a fault costs no allocation.
    pub port: Arc<str>,
    /// What went wrong there.
    pub kind: LinkErrorKind,
}

/// What went wrong at a port.
#[derive(Debug)]
pub enum LinkErrorKind {
    /// No such port.
    Missing,
    /// This user may not open it.
    Permission,
    /// Another program holds it.
    InUse,
    /// A file or device that is no serial port.
    NoPort,
    /// Nothing listens at a TCP port.
    ConnectionRefused,
    /// The system could not open it, for another reason: what it says.
    Open(io::Error),
    /// Nothing came back.
    NoAnswer {
        /// How long the host waited.
        timeout: Duration,
    },
    /// Only damaged packets came back.
    Damaged {
        /// How many, while the host waited.
        packets: u64,
        /// What was wrong with the last one.
        last: Damage,
    },
    /// The other end closed the link, or the cable was pulled.
    Cut,
    /// A board that streams sent no whole frame.
    NoFrame {
        /// How long the host waited.
        timeout: Duration,
        /// Events that came meanwhile.
        events: u64,
    },
    /// Reading or writing failed, for another reason: what the system says.
    Failed(io::Error),
    /// Board and host speak different protocol versions.
    ProtocolVersion {
        /// Version the board speaks.
        board: u16,
    },
    /// Same protocol version, but the messages differ: builds of different sources.
    Schema {
        /// Version of the board's firmware.
        firmware: String,
        /// Schema hash of the board.
        board: [u8; 8],
        /// Schema hash of this host.
        host: [u8; 8],
    },
    /// The board did not do it, and says why.
    Refused(Refusal),
    /// The answer belongs to another kind of question.
    WrongReply {
        /// What was asked.
        request: &'static str,
    },
    /// The tare did not end.
    NoTare {
        /// Frames to average.
        frames: u16,
        /// How long the host waited.
        timeout: Duration,
    },
    /// The bus that it shares with other boards does not carry what it was to stream.
    Overload(Overload),
    /// The board takes no samples that a scope could show.
    NoFrontEnd,
    /// The carrier is not whole samples long.
    NoCarrier {
        /// Carrier frequency, Hz.
        frequency: f32,
        /// Samples per second.
        sample_rate: u32,
    },
}

/// Why a packet is not used.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum Damage {
    /// Its bytes.
    #[error(transparent)]
    Packet(PacketError),
    /// A number in it is none.
    #[error("a number in a packet is infinite or none (NaN)")]
    NotANumber,
}

/// Boards of a bus that together say more than it carries.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[error(
    "the bus does not carry what {boards} boards are to say: it takes {:.0} % of the bus' time, allowed are {:.0} % (lower \
     frame rates, fewer boards on it, or every second frame)", 100.0 * load, 100.0 * allowed
)]
pub struct Overload {
    /// Boards that share the bus.
    pub boards: usize,
    /// Share of the bus' time, above 0.
    pub load: f64,
    /// Share that may be given away.
    pub allowed: f64,
}

impl LinkError {
    /// Something that went wrong at `port`.
    pub fn new(port: impl Into<Arc<str>>, kind: LinkErrorKind) -> Self {
        Self { port: port.into(), kind }
    }

    /// Whether it may pass once the port is opened anew: the board was not reached, or not understood. Not so where
    /// both understood each other and do not agree.
    #[must_use]
    pub fn may_pass(&self) -> bool {
        match &self.kind {
            LinkErrorKind::Refused(refusal) => *refusal == Refusal::Busy,
            LinkErrorKind::ProtocolVersion { .. }
            | LinkErrorKind::Schema { .. }
            | LinkErrorKind::Overload(_)
            | LinkErrorKind::NoFrontEnd
            | LinkErrorKind::NoCarrier { .. } => false,
            _ => true,
        }
    }

    /// Sorts an error of the system, met on opening `port`.
    pub(crate) fn on_open(port: &str, reason: io::Error) -> Self {
        let kind = match reason.kind() {
            io::ErrorKind::NotFound => LinkErrorKind::Missing,
            io::ErrorKind::PermissionDenied => LinkErrorKind::Permission,
            io::ErrorKind::ResourceBusy => LinkErrorKind::InUse,
            io::ErrorKind::ConnectionRefused => LinkErrorKind::ConnectionRefused,
            _ => LinkErrorKind::Open(reason),
        };
        Self::new(port, kind)
    }

    /// Sorts an error of the system, met on reading from or writing to the open `port`, which may take `timeout`.
    pub(crate) fn on_transfer(port: Arc<str>, reason: io::Error, timeout: Duration) -> Self {
        let kind = match reason.kind() {
            io::ErrorKind::UnexpectedEof
            | io::ErrorKind::BrokenPipe
            | io::ErrorKind::ConnectionReset
            | io::ErrorKind::ConnectionAborted
            | io::ErrorKind::NotConnected => LinkErrorKind::Cut,
            io::ErrorKind::TimedOut => LinkErrorKind::NoAnswer { timeout },
            _ => LinkErrorKind::Failed(reason),
        };
        Self::new(port, kind)
    }
}

impl std::error::Error for LinkError {}

impl fmt::Display for LinkError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (port, version) = (&self.port, env!("CARGO_PKG_VERSION"));
        match &self.kind {
            LinkErrorKind::Missing => write!(f, "port `{port}` does not exist"),
            LinkErrorKind::Permission => write!(
                f,
                "no permission to open port `{port}` (on Linux, join the group that owns it, most often with \
                 `sudo usermod -aG dialout $USER`, and log in again)"
            ),
            LinkErrorKind::NoPort => {
                write!(f, "`{port}` is no serial port; allowed: a serial port, or tcp:HOST:PORT")
            }
            LinkErrorKind::InUse => write!(f, "port `{port}` is in use by another program"),
            LinkErrorKind::ConnectionRefused => {
                write!(f, "connection to `{port}` refused: no board listens there")
            }
            LinkErrorKind::Open(reason) => write!(f, "cannot open port `{port}`: {reason}"),
            LinkErrorKind::Cut => write!(f, "the link to `{port}` was cut: the board has gone or closed it"),
            LinkErrorKind::NoFrame { timeout, events: 0 } => write!(
                f,
                "nothing came from the board at `{port}` within {:.1} s, though it says that it streams",
                timeout.as_secs_f64()
            ),
            LinkErrorKind::NoFrame { timeout, events } => write!(
                f,
                "{events} events came from the board at `{port}` within {:.1} s, but no frame with what it was to \
                 stream",
                timeout.as_secs_f64()
            ),
            LinkErrorKind::Failed(reason) => write!(f, "port `{port}` failed: {reason}"),
            LinkErrorKind::Refused(refusal) => write!(f, "{refusal} (port `{port}`)"),
            LinkErrorKind::NoAnswer { timeout } => write!(
                f,
                "no answer from `{port}` within {} s: is it a Dermatome board, and is another program connected to it?",
                timeout.as_secs_f64()
            ),
            LinkErrorKind::Damaged { packets, last } => write!(
                f,
                "no answer from `{port}`, but {packets} damaged packets (last: {last}): check the cable, and that \
                 the board runs Dermatome firmware"
            ),
            LinkErrorKind::WrongReply { request } => {
                write!(f, "the board at `{port}` gave an answer of the wrong kind to {request}")
            }
            LinkErrorKind::NoTare { frames, timeout } => write!(
                f,
                "the board at `{port}` did not average {frames} frames within {:.1} s",
                timeout.as_secs_f64()
            ),
            LinkErrorKind::Overload(overload) => write!(f, "{overload} (port `{port}`)"),
            LinkErrorKind::NoFrontEnd => {
                write!(f, "the board at `{port}` has no analogue front end: it has no samples to show")
            }
            LinkErrorKind::NoCarrier { frequency, sample_rate } => write!(
                f,
                "the board at `{port}` drives at {frequency} Hz, which is not whole samples of {sample_rate} a second"
            ),
            LinkErrorKind::ProtocolVersion { board } => write!(
                f,
                "the board at `{port}` speaks protocol version {board}, this host speaks version \
                 {PROTOCOL_VERSION}: update {}",
                if *board < PROTOCOL_VERSION { "the board's firmware" } else { "this host program" }
            ),
            LinkErrorKind::Schema { firmware, board, host } => write!(
                f,
                "the board at `{port}` (firmware {firmware}) and this host ({version}) both speak protocol version \
                 {PROTOCOL_VERSION}, but their messages differ (schema {} on the board, {} here): {}",
                hexadecimal(board),
                hexadecimal(host),
                advice(firmware, version)
            ),
        }
    }
}

fn hexadecimal(bytes: &[u8; 8]) -> String {
    format!("{:016x}", u64::from_be_bytes(*bytes))
}

/// Which side to update, told by the versions of the programs.
fn advice(firmware: &str, host: &str) -> &'static str {
    match (numbers(firmware), numbers(host)) {
        (Some(firmware), Some(host)) if firmware < host => "update the board's firmware",
        (Some(firmware), Some(host)) if firmware > host => "update this host program",
        _ => "build both from the same source",
    }
}

fn numbers(version: &str) -> Option<Vec<u32>> {
    version.split('.').map(|number| number.parse().ok()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_older_side_is_the_one_to_update() {
        assert_eq!(advice("0.1.0", "0.2.0"), "update the board's firmware");
        assert_eq!(advice("0.10.0", "0.9.3"), "update this host program");
        assert_eq!(advice("0.1.0", "0.1.0"), "build both from the same source");
        assert_eq!(advice("dev", "0.1.0"), "build both from the same source");
        let text = |board| LinkError::new("COM5", LinkErrorKind::ProtocolVersion { board }).to_string();
        assert!(text(0).contains("update the board's firmware"), "{}", text(0));
        assert!(text(99).contains("update this host program"), "{}", text(99));
    }

    #[test]
    fn a_forbidden_port_hints_at_the_group() {
        let error = LinkError::on_open("/dev/ttyACM0", io::ErrorKind::PermissionDenied.into()).to_string();
        assert!(error.contains("`/dev/ttyACM0`") && error.contains("dialout"), "{error}");
    }
}
