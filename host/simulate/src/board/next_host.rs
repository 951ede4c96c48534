//! Next host: the one that waits while the board serves another.
//!
//! Hosts come one after the other, so the one that is served may just be leaving: the next waits a moment. Then its
//! Hello is refused, unless the first has been silent for so long that it counts as gone.

use dermatome_shared::protocol::{BoardPacket, MAX_PACKET_BYTES, Refusal, Reply, encode};
use std::{
    io::{self, Read, Write},
    net::{TcpListener, TcpStream},
    time::{Duration, Instant},
};

/// How long the next host waits for the one before to leave.
const GRACE: Duration = Duration::from_millis(500);

/// Looks after those who knock while a host is served.
#[derive(Default)]
pub(super) struct NextHost {
    waiting: Option<(TcpStream, Instant)>,
}

impl NextHost {
    /// Who waits, or has just come.
    pub(super) fn take(&mut self, listener: &TcpListener) -> Option<TcpStream> {
        self.waiting.take().map(|(stream, _)| stream).or_else(|| knock(listener))
    }

    /// Whether the host that has been silent for `silence` leaves its place, after `lease` of silence, to one who
    /// waits. Turns that one away if it has waited long enough.
    pub(super) fn takes_over(&mut self, listener: &TcpListener, silence: Duration, lease: Duration) -> bool {
        let Some((stream, since)) = self.waiting.take().or_else(|| Some((knock(listener)?, Instant::now())))
        else {
            return false;
        };
        let is_free = silence >= lease;
        if is_free || since.elapsed() < GRACE {
            self.waiting = Some((stream, since));
        } else {
            // One that has gone meanwhile needs no answer.
            let _ = turn_away(stream);
        }
        is_free
    }
}

/// Refuses the Hello that has come, and closes the connection.
fn turn_away(mut stream: TcpStream) -> io::Result<()> {
    stream.set_nonblocking(true)?;
    // Bytes that nobody has read would make the system drop the answer, too.
    let _ = stream.read(&mut [0; MAX_PACKET_BYTES]);
    let busy = BoardPacket::Reply { sequence: 0, reply: Reply::Refused(Refusal::Busy) };
    let mut buffer = [0; MAX_PACKET_BYTES];
    stream.write_all(encode(&busy, &mut buffer).map_err(io::Error::other)?)
}

/// Nobody there, or gone already, is all the same.
fn knock(listener: &TcpListener) -> Option<TcpStream> {
    listener.accept().ok().map(|(stream, _)| stream)
}
