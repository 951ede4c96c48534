//! Port: where a board is, as people write it, be it a real one or one to simulate.

use crate::board::{ReplayError, SimulationError, board_for_recording, board_for_skin};
use dermatome_link::{self as link, Link, LinkError};
use std::{fmt, net::Ipv4Addr, path::PathBuf, str::FromStr};

/// Where a board is.
///
/// ```
/// use dermatome_simulate::port::Port;
/// assert_eq!("sim:skin.toml".parse(), Ok(Port::Simulated("skin.toml".into())));
/// ```
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Port {
    /// A board behind a serial or TCP port.
    Board(link::Port),
    /// The skin file of a board to simulate: `sim:models/disc-210mm/skin.toml`.
    Simulated(PathBuf),
    /// A recording to play: `replay:run.mcap`.
    Recorded(PathBuf),
}

/// Text that names no port.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum PortError {
    /// None of the known forms.
    #[error(
        "`{text}` names no port; allowed are a serial port (`/dev/ttyACM0`, `COM5`), `tcp:HOST:PORT`, \
         `rs485:LINE#ADDRESS`, `can:BUS#ADDRESS`, `sim:SKIN.toml` and `replay:FILE.mcap`"
    )]
    Unknown {
        /// What was written.
        text: String,
    },
    /// A board's port, written wrongly.
    #[error(transparent)]
    Board(link::PortError),
    /// A replay of nothing.
    #[error("`{text}` names no recording to play; allowed is `replay:FILE.mcap`")]
    Recorded {
        /// What was written.
        text: String,
    },
    /// A simulated board without a skin file.
    #[error("`{text}` names no skin to simulate; allowed is `sim:SKIN.toml`")]
    Simulated {
        /// What was written.
        text: String,
    },
}

/// Why a port was not opened.
#[derive(Debug, thiserror::Error)]
pub enum OpenError {
    /// The board was not reached.
    #[error(transparent)]
    Link(#[from] LinkError),
    /// There is no board to simulate.
    #[error(transparent)]
    Simulation(Box<SimulationError>),
    /// There is no recording to play.
    #[error(transparent)]
    Replay(Box<ReplayError>),
}

impl FromStr for Port {
    type Err = PortError;

    fn from_str(text: &str) -> Result<Self, PortError> {
        match text.strip_prefix("replay:") {
            Some("") => return Err(PortError::Recorded { text: text.to_owned() }),
            Some(path) => return Ok(Self::Recorded(path.into())),
            None => {}
        }
        match text.strip_prefix("sim:") {
            Some("") => Err(PortError::Simulated { text: text.to_owned() }),
            Some(path) => Ok(Self::Simulated(path.into())),
            None => text.parse().map(Self::Board).map_err(|error| match error {
                link::PortError::Unknown { text } => PortError::Unknown { text },
                error => PortError::Board(error),
            }),
        }
    }
}

impl fmt::Display for Port {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Board(port) => port.fmt(f),
            Self::Simulated(path) => write!(f, "sim:{}", path.display()),
            Self::Recorded(path) => write!(f, "replay:{}", path.display()),
        }
    }
}

/// Opens `port`; a simulated board starts first, and lives as long as the link.
pub fn open(port: &Port) -> Result<Link, OpenError> {
    match port {
        Port::Board(port) => Ok(link::open(port)?),
        Port::Simulated(path) => {
            let board = board_for_skin(path).map_err(|error| OpenError::Simulation(Box::new(error)))?;
            Ok(board.connect(port.to_string())?)
        }
        Port::Recorded(path) => {
            let board = board_for_recording(path, None, (Ipv4Addr::LOCALHOST, 0).into());
            let board = board.map_err(|error| OpenError::Replay(Box::new(error)))?;
            Ok(board.connect(port.to_string())?)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_form_is_read_and_written_back() {
        let cases = [
            ("COM5", Port::Board(link::Port::Serial("COM5".to_owned()))),
            ("tcp:127.0.0.1:7000", Port::Board(link::Port::Tcp("127.0.0.1:7000".to_owned()))),
            ("sim:models/disc/skin.toml", Port::Simulated("models/disc/skin.toml".into())),
            ("replay:run.mcap", Port::Recorded("run.mcap".into())),
        ];
        for (text, port) in cases {
            assert_eq!(text.parse(), Ok(port.clone()), "{text}");
            assert_eq!(port.to_string(), text);
        }
    }

    #[test]
    fn what_is_no_port_is_refused_with_all_that_is_allowed() {
        assert_eq!("sim:".parse::<Port>(), Err(PortError::Simulated { text: "sim:".to_owned() }));
        let unknown = "usb:1".parse::<Port>().unwrap_err();
        assert_eq!(unknown, PortError::Unknown { text: "usb:1".to_owned() });
        assert!(unknown.to_string().contains("sim:SKIN.toml"), "{unknown}");
        assert!("tcp:".parse::<Port>().unwrap_err().to_string().contains("tcp:HOST:PORT"));
    }
}
