//! Port: where a board is, as people write it.

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
}

/// Text that names no port.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum PortError {
    /// None of the known forms.
    #[error("`{text}` names no port; allowed are a serial port (`/dev/ttyACM0`, `COM5`) and `tcp:HOST:PORT`")]
    Unknown {
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
        }
    }
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
    }
}
