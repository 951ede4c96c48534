//! Port: where a board is, as people write it.

use dermatome_shared::protocol::bus::ADDRESSES;
use std::{fmt, str::FromStr};

/// Where a board is.
///
/// ```
/// use dermatome_link::Port;
/// assert_eq!("tcp:127.0.0.1:7000".parse(), Ok(Port::Tcp("127.0.0.1:7000".to_owned())));
/// ```
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Port {
    /// A serial port: `/dev/ttyACM0`, `COM5`.
    Serial(String),
    /// Host and port number of a board behind TCP: `tcp:127.0.0.1:7000`.
    Tcp(String),
    /// One of several boards on a line: `rs485:/dev/ttyUSB0#3`.
    Bus(Line, u8),
}

/// Where a line of several boards is.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Line {
    /// A serial port, which an adapter joins to the line.
    Serial(String),
    /// Host and port number of an adapter behind TCP.
    Tcp(String),
}

/// Text that names no port.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum PortError {
    /// None of the known forms.
    #[error(
        "`{text}` names no port; allowed are a serial port (`/dev/ttyACM0`, `COM5`), `tcp:HOST:PORT` and \
         `rs485:LINE#ADDRESS`"
    )]
    Unknown {
        /// What was written.
        text: String,
    },
    /// A board on a line, without the line or its address.
    #[error(
        "`{text}` is no board on a bus; allowed is `rs485:LINE#ADDRESS` with LINE a serial port or `tcp:HOST:PORT`, and \
         ADDRESS from 0 to {}", ADDRESSES - 1
    )]
    Bus {
        /// What was written.
        text: String,
    },
    /// What is no line of several boards.
    #[error("`{text}` is no line; allowed are a serial port (`/dev/ttyUSB0`, `COM5`) and `tcp:HOST:PORT`")]
    Line {
        /// What was written.
        text: String,
    },
    /// A TCP port without host or number.
    #[error("`{text}` is no TCP port; allowed is `tcp:HOST:PORT` with PORT from 1 to 65535")]
    Tcp {
        /// What was written.
        text: String,
    },
}

impl FromStr for Port {
    type Err = PortError;

    fn from_str(text: &str) -> Result<Self, PortError> {
        let owned = || text.to_owned();
        if let Some(place) = text.strip_prefix("rs485:") {
            return bus(place).ok_or_else(|| PortError::Bus { text: owned() });
        }
        if let Some(address) = text.strip_prefix("tcp:") {
            return if is_tcp_address(address) {
                Ok(Self::Tcp(address.to_owned()))
            } else {
                Err(PortError::Tcp { text: owned() })
            };
        }
        if is_serial_port(text) {
            Ok(Self::Serial(owned()))
        } else {
            Err(PortError::Unknown { text: owned() })
        }
    }
}

impl fmt::Display for Port {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Serial(name) => f.write_str(name),
            Self::Tcp(address) => write!(f, "tcp:{address}"),
            Self::Bus(line, address) => write!(f, "rs485:{line}#{address}"),
        }
    }
}

impl fmt::Display for Line {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Serial(name) => f.write_str(name),
            Self::Tcp(address) => write!(f, "tcp:{address}"),
        }
    }
}

impl FromStr for Line {
    type Err = PortError;

    fn from_str(text: &str) -> Result<Self, PortError> {
        match text.parse() {
            Ok(Port::Serial(name)) => Ok(Self::Serial(name)),
            Ok(Port::Tcp(host)) => Ok(Self::Tcp(host)),
            _ => Err(PortError::Line { text: text.to_owned() }),
        }
    }
}

/// `LINE#ADDRESS`.
fn bus(place: &str) -> Option<Port> {
    let (line, address) = place.rsplit_once('#')?;
    let address = address.parse().ok().filter(|&address| address < ADDRESSES)?;
    Some(Port::Bus(line.parse().ok()?, address))
}

/// `HOST:PORT`, the host not empty, an IPv6 address in brackets.
fn is_tcp_address(address: &str) -> bool {
    let Some((host, port)) = address.rsplit_once(':') else { return false };
    let bracketed = host.starts_with('[') && host.ends_with(']');
    !host.is_empty() && (bracketed || !host.contains(':')) && port.parse::<u16>().is_ok_and(|port| port > 0)
}

/// An absolute path, or `COM` and a number.
fn is_serial_port(text: &str) -> bool {
    let com = text.get(..3).filter(|start| start.eq_ignore_ascii_case("COM"));
    let numbered = com.is_some() && text[3..].parse::<u8>().is_ok_and(|number| number > 0);
    numbered || (text.starts_with('/') && text.len() > 1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_form_is_read_and_written_back() {
        let cases = [
            ("/dev/ttyACM0", Port::Serial("/dev/ttyACM0".to_owned())),
            ("COM5", Port::Serial("COM5".to_owned())),
            ("com12", Port::Serial("com12".to_owned())),
            ("tcp:127.0.0.1:7000", Port::Tcp("127.0.0.1:7000".to_owned())),
            ("tcp:[::1]:7000", Port::Tcp("[::1]:7000".to_owned())),
            ("tcp:robot.local:1", Port::Tcp("robot.local:1".to_owned())),
            ("rs485:/dev/ttyUSB0#3", Port::Bus(Line::Serial("/dev/ttyUSB0".to_owned()), 3)),
            ("rs485:COM7#0", Port::Bus(Line::Serial("COM7".to_owned()), 0)),
            ("rs485:tcp:[::1]:7000#15", Port::Bus(Line::Tcp("[::1]:7000".to_owned()), 15)),
        ];
        for (text, port) in cases {
            assert_eq!(text.parse(), Ok(port.clone()), "{text}");
            assert_eq!(port.to_string(), text);
        }
    }

    #[test]
    fn what_is_no_port_is_refused_with_what_is_allowed() {
        for text in ["", "ttyACM0", "COM", "COM0", "COMET", "/", "usb:1", "127.0.0.1:7000", "ÄÖ"] {
            let error = text.parse::<Port>().unwrap_err();
            assert_eq!(error, PortError::Unknown { text: text.to_owned() });
            assert!(error.to_string().contains("/dev/ttyACM0"), "{error}");
        }
        for text in
            ["tcp:", "tcp:7000", "tcp::7000", "tcp:host:", "tcp:host:0", "tcp:host:70000", "tcp:::1:5"]
        {
            let error = text.parse::<Port>().unwrap_err();
            assert_eq!(error, PortError::Tcp { text: text.to_owned() });
            assert!(error.to_string().contains("tcp:HOST:PORT"), "{error}");
        }
        let on_lines = [
            "",
            "#1",
            "/dev/ttyUSB0",
            "/dev/ttyUSB0#",
            "/dev/ttyUSB0#16",
            "/dev/ttyUSB0#-1",
            "tcp:x#1",
            "rs485:/a#1#2",
        ];
        for text in on_lines.map(|text| format!("rs485:{text}")) {
            let error = text.parse::<Port>().unwrap_err();
            assert_eq!(error, PortError::Bus { text: text.clone() });
            assert!(error.to_string().contains("0 to 15"), "{error}");
        }
    }
}
