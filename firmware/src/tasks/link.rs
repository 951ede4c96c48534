//! Link task: reads requests, lets the device answer them, and sends replies and events.
//!
//! Nothing that comes over the line ends this task. A packet that is damaged or unknown is
//! dropped with a warning, and the host's time-out does the rest. After an error of the line
//! itself the link is opened anew.
//!
//! A reply goes out before any event that waits. Once it is on its way, the device settles: it
//! writes to the flash what the request brought, while the next request comes in by DMA.

use core::convert::Infallible;

use defmt::{Debug2Format, warn};
use dermatome_firmware::{
    board::LinkParts,
    drivers::link::{LinkPort, LinkRx, LinkTx, RING_BYTES},
};
use dermatome_shared::protocol::{self, MAX_PACKET_BYTES, PacketError, PacketReader, RequestPacket};
use embassy_futures::{
    select::{Either, select},
    yield_now,
};
use embassy_stm32::usart::Error;
use embassy_sync::{blocking_mutex::raw::NoopRawMutex, mutex::Mutex};
use embassy_time::{Duration, Instant, Timer};
use static_cell::{ConstStaticCell, StaticCell};

use super::State;

/// How long a failed link rests: the last bytes leave the UART, and a line with endless errors
/// cannot take the whole CPU.
const REOPEN_PAUSE: Duration = Duration::from_millis(2);

/// Both the replies and the events need the sender.
type Sender<'a> = Mutex<NoopRawMutex, LinkTx<'a>>;
type Packet = [u8; MAX_PACKET_BYTES];

/// Reads requests and sends replies.
struct Requests {
    state: &'static State,
    reader: &'static mut PacketReader,
    reply: &'static mut Packet,
}

/// Sends events.
struct Events {
    state: &'static State,
    packet: &'static mut Packet,
}

/// Serves the host for ever.
#[embassy_executor::task]
pub(crate) async fn run(parts: LinkParts, state: &'static State) -> ! {
    static RING: ConstStaticCell<[u8; RING_BYTES]> = ConstStaticCell::new([0; RING_BYTES]);
    static READER: StaticCell<PacketReader> = StaticCell::new();
    static REPLY: ConstStaticCell<Packet> = ConstStaticCell::new([0; MAX_PACKET_BYTES]);
    static EVENT: ConstStaticCell<Packet> = ConstStaticCell::new([0; MAX_PACKET_BYTES]);
    let reader = READER.init_with(PacketReader::default);
    let mut requests = Requests { state, reader, reply: REPLY.take() };
    let mut events = Events { state, packet: EVENT.take() };
    let mut port = LinkPort::new(parts, RING.take());
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
    // Ends what a link that failed before may have left unfinished.
    tx.write(&[0]).await?;
    let sender = Sender::new(tx);
    match select(requests.serve(rx, &sender), events.serve(&sender)).await {
        Either::First(result) | Either::Second(result) => result,
    }
}

impl Requests {
    async fn serve(&mut self, mut rx: LinkRx<'_>, sender: &Sender<'_>) -> Result<Infallible, Error> {
        let mut chunk = [0; 128];
        loop {
            let length = rx.read(&mut chunk).await?;
            for &byte in &chunk[..length] {
                if let Some(request) = self.reader.push(byte) {
                    self.answer(&request, sender).await?;
                }
            }
            // Bytes that come as fast as they are read must not keep the other tasks waiting.
            yield_now().await;
        }
    }

    async fn answer(
        &mut self,
        request: &Result<RequestPacket, PacketError>,
        sender: &Sender<'_>,
    ) -> Result<(), Error> {
        match request {
            Ok(request) => {
                let length = self.reply_to(request);
                self.state.answered.signal(());
                sender.lock().await.write(&self.reply[..length]).await?;
                self.state.device.borrow_mut().settle();
            }
            Err(error) => warn!("packet dropped: {}", Debug2Format(error)),
        }
        Ok(())
    }

    /// Lets the device answer; gives the length of the reply's packet.
    fn reply_to(&mut self, request: &RequestPacket) -> usize {
        let reply = self.state.device.borrow_mut().handle(request, Instant::now().as_millis());
        match protocol::encode(&reply, self.reply) {
            Ok(packet) => packet.len(),
            Err(error) => {
                warn!("reply not sent: {}", Debug2Format(&error));
                0
            }
        }
    }

    /// Forgets a packet whose rest is lost, so that the next one starts clean.
    fn forget_partial_packet(&mut self) {
        let _ = self.reader.push::<RequestPacket>(0);
    }
}

impl Events {
    async fn serve(&mut self, sender: &Sender<'_>) -> Result<Infallible, Error> {
        loop {
            let next = self.state.events.borrow_mut().pop(self.packet);
            match next {
                Some(length) => {
                    sender.lock().await.write(&self.packet[..length]).await?;
                    // Lets a reply that waits go first.
                    yield_now().await;
                }
                None => self.state.queued.wait().await,
            }
        }
    }
}
