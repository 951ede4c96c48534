//! Lanes: how packets reach what drives a shared line or the USB, and how the bytes of requests leave it.
//!
//! What owns the link hands packets over in one of two lanes, replies and events, with their memory, and gets that back once
//! they are sent. So it never touches the line itself.

use core::{cell::Cell, convert::Infallible, marker::PhantomData};

use embassy_sync::{
    blocking_mutex::{CriticalSectionMutex, raw::CriticalSectionRawMutex},
    pipe::Pipe,
    signal::Signal,
};

/// Bytes of requests that wait: a host has one under way, of half a kilobyte at most.
const REQUEST_BYTES: usize = 640;

/// Bytes of requests, on their way to the link's owner.
pub(super) static REQUESTS: Pipe<CriticalSectionRawMutex, REQUEST_BYTES> = Pipe::new();

/// Hands bytes of requests on, without waiting; says whether there was room for all.
#[cfg(not(feature = "usb"))]
pub(super) fn hand_on(mut bytes: &[u8]) -> bool {
    // The pipe takes them in two pieces where they go round its end.
    while !bytes.is_empty()
        && let Ok(taken) = REQUESTS.try_write(bytes)
    {
        bytes = &bytes[taken..];
    }
    bytes.is_empty()
}

/// What drives the line goes on by itself: a link over lanes does not fail in a way that its owner could mend.
pub type Error = Infallible;

/// Takes requests from what drives the line.
pub struct LinkRx<'a>(PhantomData<&'a mut ()>);

impl LinkRx<'_> {
    pub(super) fn new() -> Self {
        Self(PhantomData)
    }

    /// Waits for bytes and says how many came.
    pub async fn read(&mut self, bytes: &mut [u8]) -> Result<usize, Error> {
        Ok(REQUESTS.read(bytes).await)
    }
}

/// Packets on their way to the line, and their memory on its way back.
pub(super) struct Lane<T> {
    offered: CriticalSectionMutex<Cell<Option<T>>>,
    sent: Signal<CriticalSectionRawMutex, T>,
}

impl<T: Send> Lane<T> {
    /// With nothing to send.
    pub(super) const fn new() -> Self {
        Self { offered: CriticalSectionMutex::new(Cell::new(None)), sent: Signal::new() }
    }

    /// Offers packets, says so, and gives them back when they are sent. If this is given up before it ends, their memory is
    /// lost.
    pub(super) async fn send(&self, packets: T, says_so: fn()) -> T {
        self.offered.lock(|offered| offered.set(Some(packets)));
        says_so();
        self.sent.wait().await
    }

    /// What is offered, if it fits.
    pub(super) fn take(&'static self, fits: impl FnOnce(&T) -> bool) -> Option<Taken<T>> {
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
pub(super) struct Taken<T: Send + 'static> {
    lane: &'static Lane<T>,
    /// There until then.
    pub(super) packets: Option<T>,
}

impl<T: Send> Drop for Taken<T> {
    fn drop(&mut self) {
        if let Some(packets) = self.packets.take() {
            self.lane.sent.signal(packets);
        }
    }
}
