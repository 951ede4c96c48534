//! Lanes: how packets reach what drives a shared line, and how the bytes of requests leave it.
//!
//! What owns the link hands packets over in one of two lanes, replies and events, with their memory, and gets that back once
//! they are sent. So it never touches the line itself.

use core::cell::Cell;

use embassy_sync::{
    blocking_mutex::{CriticalSectionMutex, raw::CriticalSectionRawMutex},
    pipe::Pipe,
    signal::Signal,
};

use super::Outgoing;

/// Bytes of requests that wait: a host has one under way, of half a kilobyte at most.
const REQUEST_BYTES: usize = 640;

/// Bytes of requests, on their way to the link's owner.
pub(super) static REQUESTS: Pipe<CriticalSectionRawMutex, REQUEST_BYTES> = Pipe::new();
/// By urgency.
pub(super) static LANES: [Lane; 2] = [Lane::new(), Lane::new()];

/// Hands bytes of requests on; says whether there was room for all.
pub(super) fn hand_on(mut bytes: &[u8]) -> bool {
    // The pipe takes them in two pieces where they go round its end.
    while !bytes.is_empty()
        && let Ok(taken) = REQUESTS.try_write(bytes)
    {
        bytes = &bytes[taken..];
    }
    bytes.is_empty()
}

/// Packets on their way to the line, and their memory on its way back.
pub(super) struct Lane {
    offered: CriticalSectionMutex<Cell<Option<Outgoing>>>,
    sent: Signal<CriticalSectionRawMutex, Outgoing>,
}

impl Lane {
    const fn new() -> Self {
        Self { offered: CriticalSectionMutex::new(Cell::new(None)), sent: Signal::new() }
    }

    /// Offers all packets, says so, and waits until they are sent. If this is given up before it ends, their memory is
    /// lost.
    pub(super) async fn send(&self, packets: &mut Outgoing, says_so: fn()) {
        let empty = Outgoing { bytes: &mut [], ..*packets };
        let packets_offered = core::mem::replace(packets, empty);
        self.offered.lock(|offered| offered.set(Some(packets_offered)));
        says_so();
        *packets = self.sent.wait().await;
    }

    /// What is offered, if it fits.
    pub(super) fn take(&'static self, fits: impl FnOnce(&Outgoing) -> bool) -> Option<Taken> {
        let packets = self.offered.lock(|offered| {
            let packets = offered.take()?;
            if fits(&packets) {
                return Some(packets);
            }
            offered.set(Some(packets));
            None
        });
        packets.map(|packets| Taken { lane: self, packets: Some(packets) })
    }
}

/// Packets that are being sent; their memory goes back when that ends, in whatever way.
pub(super) struct Taken {
    lane: &'static Lane,
    packets: Option<Outgoing>,
}

impl Taken {
    /// Their bytes.
    pub(super) fn packets(&self) -> &[u8] {
        self.packets.as_ref().map_or(&[], Outgoing::packets)
    }
}

impl Drop for Taken {
    fn drop(&mut self) {
        if let Some(packets) = self.packets.take() {
            self.lane.sent.signal(packets);
        }
    }
}
