//! Usb: a link to one host over USB, which sees a serial port (CDC ACM).
//!
//! A task of its own serves the bus, on the acquisition's executor: what is computed does not keep the host waiting, which
//! asks for a packet of 64 bytes some twenty times a millisecond. It hands the bytes of requests on through a pipe, and
//! takes packets from two lanes, replies first. While the pipe is full or the lanes are empty, the chip answers the host
//! by itself: not now.
//!
//! **Whether a host listens** decides what happens with what is to be sent. It does once it has set DTR, or has sent
//! something, as not all set it; it does not before it has configured the board, after it has cleared DTR or reset the
//! bus, and while the bus is at rest: it sleeps, or the cable is out. What is offered then is gone, as on a line that
//! nobody hears. A host that listens and does not read lets it wait, and the queue of events drops what comes meanwhile.
//!
//! Everything that it says begins with a zero byte, which ends what the host before did not take.

mod descriptors;
mod device;

use core::{cell::Cell, future::poll_fn, marker::PhantomData, mem, pin::pin, task::Poll};

use embassy_futures::{join::join3, select::select};
use embassy_stm32::usb::Driver;
use embassy_sync::{blocking_mutex::raw::CriticalSectionRawMutex, signal::Signal};
use embassy_usb_driver::{Driver as _, EndpointError, EndpointIn, EndpointOut, EndpointType};

use self::descriptors::{FROM_HOST, NOTIFICATION_BYTES, NOTIFICATIONS, TO_HOST};
use super::{
    OUTGOING_BYTES, Outgoing, Urgency,
    lanes::{Error, Lane, LinkRx, REQUESTS},
};
use crate::board::{self, Interrupts, LinkParts, executor};

/// Bytes before a packet: the zero byte.
pub const HEAD_BYTES: usize = 1;
/// One packet at a time: a reply must not wait for more.
pub const BYTES_IN_ONE_GO: usize = 0;
/// Memory that it needs beside packets, less than the ring that others have.
pub const OWN_BYTES: usize = 0;
/// The chip has a memory of its own for what comes.
pub const RING_BYTES: usize = 0;
/// The next request waits in the host while the flash is written.
pub const SETTLES_FIRST: bool = false;

/// Bytes of a packet on the bus.
const BUS_PACKET_BYTES: usize = 64;

/// By urgency.
static LANES: [Lane<Outgoing>; 2] = [Lane::new(), Lane::new()];
/// There is something in a lane.
static OFFERED: Signal<CriticalSectionRawMutex, ()> = Signal::new();

/// What the link's owner holds.
pub struct LinkPort(());

/// Gives packets to the bus.
pub struct LinkTx<'a>(PhantomData<&'a mut LinkPort>);

impl LinkPort {
    /// Starts the device on these parts. Can be called once, after the acquisition's executor has been started.
    pub fn new(parts: LinkParts, _ring: &'static mut [u8; RING_BYTES]) -> Self {
        executor::spawner().spawn(run(parts).expect("spawned once"));
        Self(())
    }

    /// What packets are sent from, in this memory.
    pub fn outgoing(&self, bytes: &'static mut [u8; OUTGOING_BYTES]) -> Outgoing {
        Outgoing { bytes, head: [0], length: 0, last: 0 }
    }

    /// Its two ends, which never fail.
    pub fn open(&mut self) -> (LinkTx<'_>, LinkRx<'_>) {
        (LinkTx(PhantomData), LinkRx::new())
    }
}

impl LinkTx<'_> {
    /// Nothing is left unfinished.
    pub async fn begin(&mut self) -> Result<(), Error> {
        Ok(())
    }

    /// Sends all packets, or drops them if no host listens. If this is given up before it ends, the memory of the
    /// packets is lost.
    pub async fn send(&self, packets: &mut Outgoing, urgency: Urgency) -> Result<(), Error> {
        *packets = LANES[urgency as usize].send(packets.hand_over(), || OFFERED.signal(())).await;
        Ok(())
    }
}

/// Serves the bus for ever.
#[embassy_executor::task]
async fn run(parts: LinkParts) -> ! {
    const BYTES: u16 = BUS_PACKET_BYTES as u16;
    let mut driver = Driver::new(parts.usb, Interrupts, parts.dp_pin, parts.dm_pin);
    let address = |endpoint: u8| Some(endpoint.into());
    // It has nothing to notify of, but hosts want this endpoint.
    let notifications =
        driver.alloc_endpoint_in(EndpointType::Interrupt, address(NOTIFICATIONS), NOTIFICATION_BYTES, 255);
    let from_host = driver.alloc_endpoint_out(EndpointType::Bulk, address(FROM_HOST), BYTES, 0);
    let to_host = driver.alloc_endpoint_in(EndpointType::Bulk, address(TO_HOST), BYTES, 0);
    let (Ok(_), Ok(from_host), Ok(to_host)) = (notifications, from_host, to_host) else {
        unreachable!("the chip has eight endpoints");
    };
    let (bus, pipe) = driver.start(BYTES);
    let presence = Presence::default();
    // In this order: what came before a host went is heard before that, and who speaks learns that it went.
    join3(hear(from_host, &presence), device::serve(bus, pipe, &presence), speak(to_host, &presence)).await.1
}

/// Hands on what the host sends.
async fn hear(mut endpoint: impl EndpointOut, presence: &Presence) -> ! {
    let mut bytes = [0; BUS_PACKET_BYTES];
    let mut session = presence.session.get();
    loop {
        match endpoint.read(&mut bytes).await {
            Ok(length) => {
                presence.listens.set(true);
                if mem::replace(&mut session, presence.session.get()) != presence.session.get() {
                    // The rest of a request is lost, so that the next one starts clean.
                    REQUESTS.write_all(&[0]).await;
                }
                REQUESTS.write_all(&bytes[..length]).await;
            }
            Err(_) => endpoint.wait_enabled().await,
        }
    }
}

/// Says what there is to say, replies first.
async fn speak(mut endpoint: impl EndpointIn, presence: &Presence) -> ! {
    loop {
        let Some(taken) = LANES.iter().find_map(|lane| lane.take(|_| true)) else {
            OFFERED.wait().await;
            continue;
        };
        if presence.is_here() {
            // What a host does not take that goes away meanwhile is gone.
            let packets = taken.packets.as_ref().map_or(&[][..], Outgoing::packets);
            let _ = select(say(&mut endpoint, packets), presence.end_of_session()).await;
        }
    }
}

/// Says all bytes. The last packet is a short one: it has the host's driver hand on what it has.
async fn say(endpoint: &mut impl EndpointIn, bytes: &[u8]) -> Result<(), EndpointError> {
    for packet in bytes.chunks(BUS_PACKET_BYTES) {
        say_packet(endpoint, packet).await?;
    }
    if bytes.len().is_multiple_of(BUS_PACKET_BYTES) { say_packet(endpoint, &[]).await } else { Ok(()) }
}

/// Says a packet as soon as the one before has gone.
async fn say_packet(endpoint: &mut impl EndpointIn, packet: &[u8]) -> Result<(), EndpointError> {
    poll_fn(|context| {
        // It has the driver wake this task when the endpoint changes.
        let is_enabled = pin!(endpoint.wait_enabled()).poll(context).is_ready();
        match (is_enabled, is_enabled && board::try_send(TO_HOST, packet)) {
            (false, _) => Poll::Ready(Err(EndpointError::Disabled)),
            (true, true) => Poll::Ready(Ok(())),
            (true, false) => Poll::Pending,
        }
    })
    .await
}

/// Whether a host listens.
#[derive(Default)]
struct Presence {
    listens: Cell<bool>,
    sleeps: Cell<bool>,
    /// Counts how often a host went.
    session: Cell<u8>,
}

impl Presence {
    fn is_here(&self) -> bool {
        self.listens.get() && !self.sleeps.get()
    }

    fn set_data_terminal_ready(&self, is_ready: bool) {
        if is_ready {
            self.listens.set(true);
        } else {
            self.end_session();
        }
    }

    /// The host goes.
    fn end_session(&self) {
        self.listens.set(false);
        self.session.set(self.session.get().wrapping_add(1));
    }

    /// Waits until the host goes or sleeps. The device, which knows, runs in the same task, and so wakes it.
    async fn end_of_session(&self) {
        let session = self.session.get();
        poll_fn(|_| {
            if self.session.get() != session || self.sleeps.get() { Poll::Ready(()) } else { Poll::Pending }
        })
        .await;
    }
}
