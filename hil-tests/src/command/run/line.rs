//! Boards on one line: a program at the other end of the TCP connection is its host, and gives the turns.

use super::{super::fingers::Fingers, program::Served};
use dermatome_hil::{
    bus::{Bus, SLICE},
    chip::time::Time,
    machine::Halt,
};
use dermatome_shared::protocol::bus::{Ear, Heard, Mark};
/// Slices of the line between two polls of the connection.
const SLICES: u64 = 5;

/// Boards on a line, and what goes on beside it.
pub(super) struct Boards {
    bus: Bus,
    /// Of each board, where somebody presses.
    fingers: Vec<Fingers>,
    /// What the fingers go by.
    host: Ear,
    boards: Ear,
}

impl Boards {
    pub(super) fn new(bus: Bus, fingers: Vec<Fingers>) -> Self {
        Self { bus, fingers, host: Ear::default(), boards: Ear::default() }
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

impl Served for Boards {
    fn now(&self) -> Time {
        self.bus.with(|line| line.now())
    }

    fn lose_host(&mut self) {
        self.fingers.iter_mut().for_each(Fingers::lose_host);
    }

    /// The program is the host of the line itself.
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
}
