//! Boards on one line: a program at the other end of the TCP connection is its host, and gives the turns.

use super::{
    super::fingers::Fingers,
    program::{accept, read, write_all},
};
use dermatome_hil::{
    bus::{Bus, SLICE},
    chip::time::Time,
    machine::Halt,
};
use dermatome_shared::protocol::bus::{Ear, Heard, Mark};
use std::{
    error::Error,
    net::{TcpListener, TcpStream},
    process::ExitCode,
    thread,
    time::{Duration, Instant},
};

/// Slices of the line between two polls of the connection.
const SLICES: u64 = 5;

/// Boards on a line, and what goes on beside it.
pub(super) struct Served {
    bus: Bus,
    /// Of each board, where somebody presses.
    fingers: Vec<Fingers>,
    /// What the fingers go by.
    host: Ear,
    boards: Ear,
}

/// Runs the boards for ever, at the pace of the clock on the wall.
pub(super) fn serve(listener: &TcpListener, mut served: Served) -> Result<ExitCode, Box<dyn Error>> {
    listener.set_nonblocking(true)?;
    let (start, wall) = (served.bus.with(|line| line.now()), Instant::now());
    let mut client: Option<TcpStream> = None;
    loop {
        if client.is_none() {
            client = accept(listener)?;
        }
        let asked = client.as_mut().map_or(Some(Vec::new()), read);
        let is_there = asked.is_some();
        let (now, heard) = served.pass(asked.unwrap_or_default())?;
        if let Some(stream) = &mut client
            && !(is_there && write_all(stream, &heard).is_ok())
        {
            client = None;
            served.fingers.iter_mut().for_each(Fingers::lose_host);
        }
        let ahead = Duration::from_secs_f64(now.since(start).seconds()).saturating_sub(wall.elapsed());
        thread::sleep(ahead);
    }
}

impl Served {
    pub(super) fn new(bus: Bus, fingers: Vec<Fingers>) -> Self {
        Self { bus, fingers, host: Ear::default(), boards: Ear::default() }
    }

    /// Puts bytes on the line and lets some time pass; gives the time and what the host hears.
    fn pass(&mut self, asked: Vec<u8>) -> Result<(Time, Vec<u8>), Halt> {
        for &byte in &asked {
            self.follow(byte, Mark::Request);
        }
        let (now, heard) = self.bus.with(move |line| {
            if !asked.is_empty() {
                line.say(&asked);
            }
            line.run_until(line.now() + SLICE * SLICES)?;
            let heard: Vec<u8> = line.take_heard().into_iter().map(|(_, byte)| byte).collect();
            Ok::<_, Halt>((line.now(), heard))
        })?;
        for &byte in &heard {
            self.follow(byte, Mark::Said);
        }
        Ok((now, heard))
    }

    /// Fingers hear what their own boards are asked and say.
    fn follow(&mut self, byte: u8, of: Mark) {
        let ear = if of == Mark::Request { &mut self.host } else { &mut self.boards };
        let Some(Heard::Byte { mark, address, byte }) = ear.hear(byte) else { return };
        let Some(fingers) = self.fingers.get_mut(usize::from(address)).filter(|_| mark == of) else { return };
        match of {
            Mark::Request => fingers.hear_host(&[byte]),
            _ => fingers.hear_board(&[byte]),
        }
    }
}
