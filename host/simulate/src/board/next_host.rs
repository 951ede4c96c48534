//! Next host: the one that waits while the board serves another.
//!
//! Hosts come one after the other, so the one that is served may just be leaving: the next waits a moment. Then it is
//! turned away, by closing its connection before anything was said, unless the first has been silent for so long that
//! it counts as gone.

use std::{
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
        let waiting = self.waiting.take().or_else(|| Some((knock(listener)?, Instant::now())));
        self.waiting = waiting.filter(|(_, since)| silence >= lease || since.elapsed() < GRACE);
        self.waiting.is_some() && silence >= lease
    }
}

/// Nobody there, or gone already, is all the same.
fn knock(listener: &TcpListener) -> Option<TcpStream> {
    listener.accept().ok().map(|(stream, _)| stream)
}
