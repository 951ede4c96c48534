//! Port: where a board is, as people write it.

use dermatome_shared::protocol::bus::ADDRESSES;
use std::{fmt, str::FromStr};

const RS485: &str = "rs485:";
const CAN: &str = "can:";

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
    /// One of several boards that share a bus: `rs485:/dev/ttyUSB0#3`, `can:can0#3`.
    Bus(Bus, u8),
}

/// What several boards share.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Bus {
    /// A line of RS-485: `rs485:/dev/ttyUSB0`.
    Rs485(Adapter),
    /// A CAN FD bus behind an adapter that speaks slcan: `can:/dev/ttyACM0`.
    Slcan(Adapter),
    /// A CAN FD bus at a network interface of Linux: `can:can0`.
    SocketCan(String),
}

/// Where the adapter to a bus is.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Adapter {
    /// A serial port: `/dev/ttyUSB0`.
    Serial(String),
    /// Host and port number of an adapter behind TCP: `tcp:127.0.0.1:7000`.
    Tcp(String),
}

/// Text that names no port.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum PortError {
    /// None of the known forms.
    #[error(
        "`{text}` names no port; allowed are a serial port (`/dev/ttyACM0`, `COM5`), `tcp:HOST:PORT`, \
         `rs485:LINE#ADDRESS` and `can:BUS#ADDRESS`"
    )]
    Unknown {
        /// What was written.
        text: String,
    },
    /// A board on a bus, without the bus or its address.
    #[error(
        "`{text}` is no board on a bus; allowed are `rs485:LINE#ADDRESS` with LINE a serial port or `tcp:HOST:PORT`, and \
         `can:BUS#ADDRESS` with BUS one of those or a network interface (`can0`); ADDRESS is from 0 to {}", ADDRESSES - 1
    )]
    OnBus {
        /// What was written.
        text: String,
    },
    /// What is no bus of several boards.
    #[error(
        "`{text}` is no bus; allowed are `rs485:LINE` with LINE a serial port (`/dev/ttyUSB0`, `COM5`) or `tcp:HOST:PORT`, \
         and `can:BUS` with BUS one of those or a network interface (`can0`)"
    )]
    Bus {
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
        if text.starts_with(RS485) || text.starts_with(CAN) {
            return on_bus(text).ok_or_else(|| PortError::OnBus { text: owned() });
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
            Self::Bus(bus, address) => write!(f, "{bus}#{address}"),
        }
    }
}

impl fmt::Display for Bus {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Rs485(adapter) => write!(f, "{RS485}{adapter}"),
            Self::Slcan(adapter) => write!(f, "{CAN}{adapter}"),
            Self::SocketCan(interface) => write!(f, "{CAN}{interface}"),
        }
    }
}

impl FromStr for Bus {
    type Err = PortError;

    fn from_str(text: &str) -> Result<Self, PortError> {
        let rs485 = text.strip_prefix(RS485).and_then(adapter).map(Self::Rs485);
        let can = || {
            let place = text.strip_prefix(CAN)?;
            let interface = || is_interface(place).then(|| Self::SocketCan(place.to_owned()));
            adapter(place).map(Self::Slcan).or_else(interface)
        };
        rs485.or_else(can).ok_or_else(|| PortError::Bus { text: text.to_owned() })
    }
}

impl fmt::Display for Adapter {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Serial(name) => f.write_str(name),
            Self::Tcp(address) => write!(f, "tcp:{address}"),
        }
    }
}

fn adapter(text: &str) -> Option<Adapter> {
    match text.parse() {
        Ok(Port::Serial(name)) => Some(Adapter::Serial(name)),
        Ok(Port::Tcp(host)) => Some(Adapter::Tcp(host)),
        _ => None,
    }
}

/// `BUS#ADDRESS`.
fn on_bus(text: &str) -> Option<Port> {
    let (bus, address) = text.rsplit_once('#')?;
    let address = address.parse().ok().filter(|&address| address < ADDRESSES)?;
    Some(Port::Bus(bus.parse().ok()?, address))
}

/// What Linux takes as the name of a network interface.
fn is_interface(name: &str) -> bool {
    let is_allowed = |c: char| c.is_ascii_graphic() && !"/:#".contains(c);
    (1..16).contains(&name.len()) && name.chars().all(is_allowed) && name != "." && name != ".."
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
            ("rs485:/dev/ttyUSB0#3", Port::Bus(Bus::Rs485(Adapter::Serial("/dev/ttyUSB0".to_owned())), 3)),
            ("rs485:COM7#0", Port::Bus(Bus::Rs485(Adapter::Serial("COM7".to_owned())), 0)),
            ("rs485:tcp:[::1]:7000#15", Port::Bus(Bus::Rs485(Adapter::Tcp("[::1]:7000".to_owned())), 15)),
            ("can:/dev/ttyACM0#3", Port::Bus(Bus::Slcan(Adapter::Serial("/dev/ttyACM0".to_owned())), 3)),
            ("can:tcp:robot:7000#0", Port::Bus(Bus::Slcan(Adapter::Tcp("robot:7000".to_owned())), 0)),
            ("can:can0#15", Port::Bus(Bus::SocketCan("can0".to_owned()), 15)),
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
        let on_buses = [
            "rs485:",
            "rs485:#1",
            "rs485:can0#1",
            "rs485:/dev/ttyUSB0",
            "rs485:/dev/ttyUSB0#",
            "rs485:/dev/ttyUSB0#16",
            "rs485:/dev/ttyUSB0#-1",
            "rs485:tcp:x#1",
            "rs485:rs485:/a#1#2",
            "can:",
            "can:#1",
            "can:can0",
            "can:can0#16",
            "can:an-interface-of-sixteen#1",
            "can:can 0#1",
            "can:..#1",
            "can:can:can0#1",
        ];
        for text in on_buses {
            let error = text.parse::<Port>().unwrap_err();
            assert_eq!(error, PortError::OnBus { text: text.to_owned() });
            assert!(error.to_string().contains("0 to 15"), "{error}");
        }
    }
}
