//! Link task: reads requests, lets the device answer them, and sends replies and events.
//!
//! Nothing that comes over the line ends this task. A packet that is damaged or unknown is
//! dropped with a warning, and the host's time-out does the rest. After an error of the line
//! itself the link is opened anew.
//!
//! A reply goes out before any event that waits. Once it is on its way, the device settles: it
//! writes to the flash what the request brought, while the next request comes in by DMA. Over a link that takes in no
//! requests meanwhile, it settles before.

use core::convert::Infallible;

use defmt::{Debug2Format, warn};
use dermatome_firmware::{
    board::LinkParts,
    drivers::link::{
        Error, LinkPort, LinkRx, LinkTx, OUTGOING_BYTES, Outgoing, REOPEN_PAUSE, RING_BYTES, SETTLES_FIRST,
        Urgency,
    },
};
use dermatome_shared::protocol::{self, PacketError, PacketReader, RequestPacket};
use embassy_futures::{
    select::{Either, select},
    yield_now,
};
use embassy_time::{Instant, Timer};
use static_cell::{ConstStaticCell, StaticCell};

use super::State;

type Packets = [u8; OUTGOING_BYTES];

/// Reads requests and sends replies.
struct Requests {
    state: &'static State,
    reader: &'static mut PacketReader,
    reply: Outgoing,
}

/// Sends events.
struct Events {
    state: &'static State,
    packets: Outgoing,
}

/// Serves the host for ever.
#[embassy_executor::task]
pub(crate) async fn run(parts: LinkParts, state: &'static State) -> ! {
    static RING: ConstStaticCell<[u8; RING_BYTES]> = ConstStaticCell::new([0; RING_BYTES]);
    static READER: StaticCell<PacketReader> = StaticCell::new();
    static REPLY: ConstStaticCell<Packets> = ConstStaticCell::new([0; OUTGOING_BYTES]);
    static EVENT: ConstStaticCell<Packets> = ConstStaticCell::new([0; OUTGOING_BYTES]);
    let reader = READER.init_with(PacketReader::default);
    let mut port = LinkPort::new(parts, RING.take());
    let mut requests = Requests { state, reader, reply: port.outgoing(REPLY.take()) };
    let mut events = Events { state, packets: port.outgoing(EVENT.take()) };
    loop {
        let (tx, rx) = port.open();
        let Err(error) = serve(tx, rx, &mut requests, &mut events).await;
        warn!("link: {}; opening it anew", error);
        Timer::after(REOPEN_PAUSE).await;
        requests.forget_partial_packet();
    }
}

/// Serves the host until the line fails.
async fn serve(
    mut tx: LinkTx<'_>,
    rx: LinkRx<'_>,
    requests: &mut Requests,
    events: &mut Events,
) -> Result<Infallible, Error> {
    tx.begin().await?;
    match select(requests.serve(rx, &tx), events.serve(&tx)).await {
        Either::First(result) | Either::Second(result) => result,
    }
}

impl Requests {
    async fn serve(&mut self, mut rx: LinkRx<'_>, tx: &LinkTx<'_>) -> Result<Infallible, Error> {
        let mut chunk = [0; 128];
        loop {
            let length = rx.read(&mut chunk).await?;
            for &byte in &chunk[..length] {
                if let Some(request) = self.reader.push(byte) {
                    self.answer(&request, tx).await?;
                }
            }
            // Bytes that come as fast as they are read must not keep the other tasks waiting.
            yield_now().await;
        }
    }

    async fn answer(
        &mut self,
        request: &Result<RequestPacket, PacketError>,
        tx: &LinkTx<'_>,
    ) -> Result<(), Error> {
        match request {
            Ok(request) => {
                self.reply_to(request);
                self.state.answered.signal(());
                let settle = || self.state.device.borrow_mut().settle();
                if SETTLES_FIRST {
                    settle();
                }
                tx.send(&mut self.reply, Urgency::Reply).await?;
                if !SETTLES_FIRST {
                    settle();
                }
            }
            Err(error) => warn!("packet dropped: {}", Debug2Format(error)),
        }
        Ok(())
    }

    /// Lets the device answer.
    fn reply_to(&mut self, request: &RequestPacket) {
        let reply = self.state.device.borrow_mut().handle(request, Instant::now().as_millis());
        self.reply.clear();
        match protocol::encode(&reply, self.reply.room()).map(<[u8]>::len) {
            Ok(length) => self.reply.add(length),
            Err(error) => warn!("reply not sent: {}", Debug2Format(&error)),
        }
    }

    /// Forgets a packet whose rest is lost, so that the next one starts clean.
    fn forget_partial_packet(&mut self) {
        let _ = self.reader.push::<RequestPacket>(0);
    }
}

impl Events {
    async fn serve(&mut self, tx: &LinkTx<'_>) -> Result<Infallible, Error> {
        loop {
            if self.gather() {
                tx.send(&mut self.packets, Urgency::Event).await?;
                // Lets a reply that waits go first.
                yield_now().await;
            } else {
                self.state.queued.wait().await;
            }
        }
    }

    /// Takes what waits and is to be sent in one go; says whether there is anything.
    fn gather(&mut self) -> bool {
        let queue = &mut *self.state.events.borrow_mut();
        self.packets.clear();
        let Some(first) = queue.pop(self.packets.room()) else { return false };
        self.packets.add(first);
        while self.packets.wants_more()
            && let Some(next) = queue.pop_fitting(self.packets.room())
        {
            self.packets.add(next);
        }
        true
    }
}
