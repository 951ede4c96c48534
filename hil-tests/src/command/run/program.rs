//! Program: the other end of a board's link, or of a line, over TCP.

use dermatome_hil::{chip::time::Time, machine::Halt};
use std::{
    error::Error,
    io::{self, ErrorKind, Read, Write},
    net::{TcpListener, TcpStream},
    process::ExitCode,
    thread,
    time::{Duration, Instant},
};

/// Several boards, and what goes on beside them.
pub(super) trait Served {
    /// Virtual time.
    fn now(&self) -> Time;

    /// Hands on what a program has sent and lets some time pass; gives the time and what the program is to read.
    fn pass(&mut self, sent: Vec<u8>) -> Result<(Time, Vec<u8>), Halt>;

    /// The program has gone.
    fn lose_host(&mut self);
}

/// Runs the boards for ever, at the pace of the clock on the wall.
pub(super) fn serve(listener: &TcpListener, mut served: impl Served) -> Result<ExitCode, Box<dyn Error>> {
    listener.set_nonblocking(true)?;
    let (start, wall) = (served.now(), Instant::now());
    let mut client: Option<TcpStream> = None;
    loop {
        if client.is_none() {
            client = accept(listener)?;
        }
        let sent = client.as_mut().map_or(Some(Vec::new()), read);
        let is_there = sent.is_some();
        let (now, heard) = served.pass(sent.unwrap_or_default())?;
        if let Some(stream) = &mut client
            && !(is_there && write_all(stream, &heard).is_ok())
        {
            client = None;
            served.lose_host();
        }
        let ahead = Duration::from_secs_f64(now.since(start).seconds()).saturating_sub(wall.elapsed());
        thread::sleep(ahead);
    }
}

/// The next program that connects, if one does. Others wait until it has gone.
pub(super) fn accept(listener: &TcpListener) -> io::Result<Option<TcpStream>> {
    match listener.accept() {
        Ok((stream, _)) => {
            stream.set_nonblocking(true)?;
            stream.set_nodelay(true)?;
            Ok(Some(stream))
        }
        Err(error) if error.kind() == ErrorKind::WouldBlock => Ok(None),
        Err(error) => Err(error),
    }
}

/// What a program has sent; none if it has gone.
pub(super) fn read(stream: &mut TcpStream) -> Option<Vec<u8>> {
    let mut buffer = [0; 4096];
    match stream.read(&mut buffer) {
        Ok(0) => None,
        Ok(length) => Some(buffer[..length].to_vec()),
        Err(error) if error.kind() == ErrorKind::WouldBlock => Some(Vec::new()),
        Err(_) => None,
    }
}

/// Waits for a program that reads slowly, as a line with flow control does.
pub(super) fn write_all(stream: &mut TcpStream, mut bytes: &[u8]) -> io::Result<()> {
    while !bytes.is_empty() {
        match stream.write(bytes) {
            Ok(0) => return Err(ErrorKind::BrokenPipe.into()),
            Ok(written) => bytes = &bytes[written..],
            Err(error) if error.kind() == ErrorKind::WouldBlock => {
                thread::sleep(Duration::from_millis(1));
            }
            Err(error) => return Err(error),
        }
    }
    Ok(())
}
