//! What can go wrong on the way to a board and back.

use super::REPLY_TIMEOUT;
use dermatome_shared::protocol::{PROTOCOL_VERSION, PacketError, Refusal};
use std::{io, time::Duration};

/// Why a board could not be reached or did not do what was asked. `port` is the port as written.
#[derive(Debug, thiserror::Error)]
pub enum LinkError {
    /// No such port.
    #[error("port `{port}` does not exist (`dermatome devices` lists the ports there are)")]
    Missing {
        /// Which port.
        port: String,
    },
    /// This user may not open it.
    #[error(
        "no permission to open port `{port}` (on Linux, join the group that owns it, most often with \
         `sudo usermod -aG dialout $USER`, and log in again)"
    )]
    Permission {
        /// Which port.
        port: String,
    },
    /// Another program holds it.
    #[error("port `{port}` is in use by another program")]
    InUse {
        /// Which port.
        port: String,
    },
    /// Nothing listens at a TCP port.
    #[error("connection to `{port}` refused: no board listens there")]
    ConnectionRefused {
        /// Which port.
        port: String,
    },
    /// The system could not open it, for another reason.
    #[error("cannot open port `{port}`: {reason}")]
    Open {
        /// Which port.
        port: String,
        /// What the system says.
        reason: io::Error,
    },
    /// Nothing came back.
    #[error(
        "no answer from `{port}` within {} s: is it a Dermatome board, and is another program connected to it?",
        timeout.as_secs_f64()
    )]
    NoAnswer {
        /// Which port.
        port: String,
        /// How long the host waited.
        timeout: Duration,
    },
    /// Only damaged packets came back.
    #[error(
        "no answer from `{port}`, but {packets} damaged packets (last: {last}): check the cable, and that \
         the board runs Dermatome firmware"
    )]
    Damaged {
        /// Which port.
        port: String,
        /// How many, while the host waited.
        packets: u64,
        /// What was wrong with the last one.
        last: PacketError,
    },
    /// The other end closed the link, or the cable was pulled.
    #[error("the link to `{port}` was cut: the board has gone or closed it")]
    Cut {
        /// Which port.
        port: String,
    },
    /// Reading or writing failed, for another reason.
    #[error("port `{port}` failed: {reason}")]
    Failed {
        /// Which port.
        port: String,
        /// What the system says.
        reason: io::Error,
    },
    /// Board and host speak different protocol versions.
    #[error(
        "the board at `{port}` speaks protocol version {board}, this host speaks version \
         {PROTOCOL_VERSION}: update {}", if *board < PROTOCOL_VERSION { "the board's firmware" } else { "this host program" }
    )]
    ProtocolVersion {
        /// Which port.
        port: String,
        /// Version the board speaks.
        board: u16,
    },
    /// Same protocol version, but the messages differ: builds of different sources.
    #[error(
        "the board at `{port}` (firmware {firmware}) and this host ({}) both speak protocol version \
         {PROTOCOL_VERSION}, but their messages differ (schema {} on the board, {} here): {}",
        env!("CARGO_PKG_VERSION"), hexadecimal(board), hexadecimal(host),
        advice(firmware, env!("CARGO_PKG_VERSION"))
    )]
    Schema {
        /// Which port.
        port: String,
        /// Version of the board's firmware.
        firmware: String,
        /// Schema hash of the board.
        board: [u8; 8],
        /// Schema hash of this host.
        host: [u8; 8],
    },
    /// The board did not do it, and says why.
    #[error("{refusal} (port `{port}`)")]
    Refused {
        /// Which port.
        port: String,
        /// What the board says.
        refusal: Refusal,
    },
    /// The answer belongs to another kind of question.
    #[error("the board at `{port}` gave an answer of the wrong kind to {request}")]
    WrongReply {
        /// Which port.
        port: String,
        /// What was asked.
        request: &'static str,
    },
    /// The tare did not end.
    #[error(
        "the board at `{port}` did not average {frames} frames within {:.1} s: `dermatome check` says what is wrong",
        timeout.as_secs_f64()
    )]
    NoTare {
        /// Which port.
        port: String,
        /// Frames to average.
        frames: u16,
        /// How long the host waited.
        timeout: Duration,
    },
}

impl LinkError {
    /// Sorts an error of the system, met on opening `port`.
    pub(super) fn on_open(port: &str, reason: io::Error) -> Self {
        let port = port.to_owned();
        match reason.kind() {
            io::ErrorKind::NotFound => Self::Missing { port },
            io::ErrorKind::PermissionDenied => Self::Permission { port },
            io::ErrorKind::ResourceBusy => Self::InUse { port },
            io::ErrorKind::ConnectionRefused => Self::ConnectionRefused { port },
            _ => Self::Open { port, reason },
        }
    }

    /// Sorts an error of the system, met on reading from or writing to the open `port`.
    pub(super) fn on_transfer(port: &str, reason: io::Error) -> Self {
        let port = port.to_owned();
        match reason.kind() {
            io::ErrorKind::UnexpectedEof
            | io::ErrorKind::BrokenPipe
            | io::ErrorKind::ConnectionReset
            | io::ErrorKind::ConnectionAborted
            | io::ErrorKind::NotConnected => Self::Cut { port },
            io::ErrorKind::TimedOut => Self::NoAnswer { port, timeout: REPLY_TIMEOUT },
            _ => Self::Failed { port, reason },
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
        let text = |board| LinkError::ProtocolVersion { port: "COM5".to_owned(), board }.to_string();
        assert!(text(0).contains("update the board's firmware"), "{}", text(0));
        assert!(text(99).contains("update this host program"), "{}", text(99));
    }

    #[test]
    fn a_forbidden_port_hints_at_the_group() {
        let error = LinkError::on_open("/dev/ttyACM0", io::ErrorKind::PermissionDenied.into()).to_string();
        assert!(error.contains("`/dev/ttyACM0`") && error.contains("dialout"), "{error}");
    }
}
