//! Transport: bytes to a board and back.

use crate::{
    error::{LinkError, LinkErrorKind},
    port::Adapter,
};
use serialport::{ClearBuffer, ErrorKind, SerialPort};
#[cfg(unix)]
use std::os::fd::{AsRawFd, RawFd};
use std::{
    io::{self, Read, Write},
    net::{TcpStream, ToSocketAddrs},
    path::Path,
    time::{Duration, Instant},
};

#[cfg(windows)]
type NativePort = serialport::COMPort;
#[cfg(unix)]
type NativePort = serialport::TTYPort;

/// How long a board has to answer, and to take what is sent.
pub const REPLY_TIMEOUT: Duration = Duration::from_secs(2);
/// Longest that one read waits for bytes.
pub(super) const READ_TIMEOUT: Duration = Duration::from_millis(20);
const CONNECT_TIMEOUT: Duration = Duration::from_secs(2);
pub(super) const BAUD: u32 = 2_000_000;

/// A stream of bytes both ways.
///
/// A read waits a short time only (20 ms), then fails with `TimedOut` or `WouldBlock`, so that
/// whoever reads can look at the clock. A read of zero bytes means that the other end has gone.
pub trait Transport: Read + Write + Send {
    /// Whether reads and writes wait from now on. Where they do not, they fail at once with `WouldBlock` or `TimedOut`.
    fn set_waiting(&mut self, _waits: bool) -> io::Result<()> {
        Err(io::ErrorKind::Unsupported.into())
    }

    /// What poll(2) says is readable when bytes have come, if the system has it.
    #[cfg(unix)]
    fn descriptor(&self) -> Option<RawFd> {
        None
    }

    /// How late it is by the line's own clock, as an emulated line has one: by it all on the line is waited for.
    fn time(&self) -> Option<Duration> {
        None
    }
}

impl Transport for TcpStream {
    fn set_waiting(&mut self, waits: bool) -> io::Result<()> {
        self.set_nonblocking(!waits)
    }

    #[cfg(unix)]
    fn descriptor(&self) -> Option<RawFd> {
        Some(self.as_raw_fd())
    }
}

/// A serial port.
pub(super) struct Serial {
    port: NativePort,
    waits: bool,
}

impl Read for Serial {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        // The port would allocate to say that nothing has come.
        if !self.waits && self.port.bytes_to_read()? == 0 {
            return Err(io::ErrorKind::WouldBlock.into());
        }
        self.port.read(buffer)
    }
}

impl Write for Serial {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.port.write(bytes)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.port.flush()
    }
}

impl Transport for Serial {
    fn set_waiting(&mut self, waits: bool) -> io::Result<()> {
        self.waits = waits;
        Ok(self.port.set_timeout(if waits { READ_TIMEOUT } else { Duration::ZERO })?)
    }

    #[cfg(unix)]
    fn descriptor(&self) -> Option<RawFd> {
        Some(self.port.as_raw_fd())
    }
}

/// Opens the serial port of this name at 2,000,000 baud, 8N1, for this program alone; `port` is the port as written, for
/// errors.
pub(super) fn open_serial(port: &str, name: &str) -> Result<Serial, LinkError> {
    let opened = serialport::new(name, BAUD).timeout(READ_TIMEOUT).open_native();
    let opened = opened.map_err(|error| failed_open(port, name, error))?;
    // What lies in the buffers was meant for whoever had the port before.
    opened.clear(ClearBuffer::All).map_err(|error| LinkError::on_open(port, error.into()))?;
    Ok(Serial { port: opened, waits: true })
}

/// Opens the adapter to a bus; `port` is the board's port as written, for errors.
pub(super) fn open_adapter(port: &str, adapter: &Adapter) -> Result<Box<dyn Transport>, LinkError> {
    Ok(match adapter {
        Adapter::Serial(name) => Box::new(open_serial(port, name)?),
        Adapter::Tcp(address) => Box::new(open_tcp(port, address.as_str())?),
    })
}

/// As [`open_adapter`], for two who use it at once.
pub(super) fn open_halves(port: &str, adapter: &Adapter) -> Result<[Box<dyn Transport>; 2], LinkError> {
    let failed = |reason| LinkError::on_open(port, reason);
    Ok(match adapter {
        Adapter::Serial(name) => {
            let one = open_serial(port, name)?;
            let other = one.port.try_clone_native().map_err(|error| failed(error.into()))?;
            [Box::new(Serial { port: other, waits: true }), Box::new(one)]
        }
        Adapter::Tcp(address) => {
            let one = open_tcp(port, address.as_str())?;
            [Box::new(one.try_clone().map_err(failed)?), Box::new(one)]
        }
    })
}

/// The `serialport` crate says `NoDevice` both for a port that is missing and for one in use, and of what is no terminal
/// only what Unix calls that.
fn failed_open(port: &str, name: &str, error: serialport::Error) -> LinkError {
    match error.kind {
        ErrorKind::NoDevice if Path::new(name).exists() => LinkError::new(port, LinkErrorKind::InUse),
        _ if error.description == "Not a typewriter" || Path::new(name).is_file() => {
            LinkError::new(port, LinkErrorKind::NoPort)
        }
        _ => LinkError::on_open(port, error.into()),
    }
}

/// Connects to `HOST:PORT`; `port` is the port as written, for errors.
pub(super) fn open_tcp(port: &str, address: impl ToSocketAddrs) -> Result<TcpStream, LinkError> {
    let failed = |reason| LinkError::on_open(port, reason);
    let stream = connect(address).map_err(failed)?;
    stream.set_read_timeout(Some(READ_TIMEOUT)).map_err(failed)?;
    stream.set_write_timeout(Some(READ_TIMEOUT)).map_err(failed)?;
    stream.set_nodelay(true).map_err(failed)?;
    Ok(stream)
}

/// Tries each address that the name stands for; the error is that of the last one.
fn connect(address: impl ToSocketAddrs) -> io::Result<TcpStream> {
    let unknown = |error| io::Error::other(format!("cannot look the host up: {error}"));
    let mut result = Err(io::Error::other("the host has no address"));
    for address in address.to_socket_addrs().map_err(unknown)? {
        result = TcpStream::connect_timeout(&address, CONNECT_TIMEOUT);
        if result.is_ok() {
            break;
        }
    }
    result
}

/// Sends all bytes, for [`REPLY_TIMEOUT`] at most.
pub(super) fn write_all(transport: &mut dyn Transport, mut bytes: &[u8]) -> io::Result<()> {
    let deadline = Instant::now() + REPLY_TIMEOUT;
    while !bytes.is_empty() {
        match transport.write(bytes) {
            Ok(0) => return Err(io::ErrorKind::BrokenPipe.into()),
            Ok(written) => bytes = &bytes[written..],
            Err(error) if !may_retry(&error) => return Err(error),
            Err(_) if Instant::now() >= deadline => return Err(io::ErrorKind::TimedOut.into()),
            Err(_) => {}
        }
    }
    Ok(())
}

/// Whether a read or a write only waits for longer than a transport does.
pub(super) fn may_retry(error: &io::Error) -> bool {
    use io::ErrorKind::{Interrupted, TimedOut, WouldBlock};
    matches!(error.kind(), TimedOut | WouldBlock | Interrupted)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::net::TcpListener;

    #[test]
    fn a_missing_serial_port_and_a_closed_tcp_port_are_told_apart() {
        let error = open_serial("here", "/dev/ttyNOTTHERE7").map(drop).unwrap_err();
        assert!(matches!(error.kind, LinkErrorKind::Missing), "{error}");
        let address = TcpListener::bind("127.0.0.1:0").unwrap().local_addr().unwrap();
        let error = open_tcp("tcp:here", address).unwrap_err();
        assert!(matches!(error.kind, LinkErrorKind::ConnectionRefused), "{error}");
        let error = open_tcp("tcp:x", "no.such.host.invalid:1").unwrap_err().to_string();
        assert!(error.contains("`tcp:x`") && error.contains("look the host up"), "{error}");
    }

    #[test]
    fn a_file_that_is_no_serial_port_is_an_error_of_its_own() {
        let file = tempfile::NamedTempFile::new().unwrap();
        let error = open_serial("here", file.path().to_str().unwrap()).map(drop).unwrap_err();
        assert!(matches!(error.kind, LinkErrorKind::NoPort), "{error}");
    }
}
