//! Bus: a link over a line that many boards share, of which each speaks in its turn only
//! ([`dermatome_shared::protocol::bus`]).
//!
//! A task of its own drives the line, on the acquisition's executor: what is computed does not keep a turn waiting. It
//! hands the bytes of requests on through a pipe, and takes packets from two lanes, replies first. So what owns the
//! link never touches the line, and the line is never written to outside a turn, whatever happens.
//!
//! **When a turn came** is not known: the CPU may have stood still, for the flash, while it did. Known is when nothing
//! unread was there last, which is looked at all the time. A turn that may be older than it may lapses, and so does one
//! after which another block was heard. One that comes before this board knows that the last one has ended counts: the
//! acquisition, which shares its executor, may keep that from it.
//!
//! **Its own echo**, where the transceiver hears what it sends, is read and dropped like what other boards say.
//!
//! Everything that it says begins with a zero byte, which ends what noise or a board that was cut off have left on the
//! line.

use core::{convert::Infallible, marker::PhantomData};

use defmt::warn;
use dermatome_shared::protocol::bus::{Ear, Heard, Mark, TURN_BYTES, TURN_LAPSES_MS};
use embassy_futures::{
    select::{Either, select},
    yield_now,
};
use embassy_stm32::{
    mode::Async,
    usart::{self, RingBufferedUartRx, Uart, UartTx},
};
use embassy_time::{Duration, Instant, Timer};

use super::{
    OUTGOING_BYTES, Outgoing, REOPEN_PAUSE, Urgency,
    lanes::{Error, Lane, LinkRx, REQUESTS, hand_on},
    uart::{RING_BYTES, config},
};
use crate::board::{Interrupts, LinkParts, executor};

/// Bytes before a packet: the zero byte, the mark and its complement.
pub const HEAD_BYTES: usize = 3;
/// Short packets share a turn.
pub const BYTES_IN_ONE_GO: usize = TURN_BYTES;
/// Memory that it needs beside ring and packets.
pub const OWN_BYTES: usize = 1024;

/// How often the line is looked at, at the longest.
const LOOK_INTERVAL: Duration = Duration::from_millis(2);
/// Until the rest of a block is looked at: it comes byte by byte, and each would be taken by itself, without a pause for the
/// acquisition.
const REST_OF_BLOCK: Duration = Duration::from_micros(250);
/// Oldest that a turn may be: the first byte needs its time as well.
const OLDEST_TURN: Duration = Duration::from_micros(1000 * TURN_LAPSES_MS - 500);
/// Sixteenths of a bit for which the driver is on before the first byte and after the last one.
const DRIVER_TIME: u8 = 16;

/// By urgency.
static LANES: [Lane<Outgoing>; 2] = [Lane::new(), Lane::new()];

/// What the link's owner holds.
pub struct LinkPort {
    address: u8,
}

/// Gives packets to the bus.
pub struct LinkTx<'a>(PhantomData<&'a mut LinkPort>);

impl LinkPort {
    /// Starts the bus on these parts. Can be called once, after the acquisition's executor has been started.
    pub fn new(parts: LinkParts, ring: &'static mut [u8; RING_BYTES]) -> Self {
        let address = parts.address;
        executor::spawner().spawn(run(parts, ring).expect("spawned once"));
        Self { address }
    }

    /// What packets are sent from, in this memory.
    pub fn outgoing(&self, bytes: &'static mut [u8; OUTGOING_BYTES]) -> Outgoing {
        let [mark, check] = Mark::Said.head(self.address);
        Outgoing { bytes, head: [0, mark, check], length: 0, last: 0 }
    }

    /// Its two ends, which never fail.
    pub fn open(&mut self) -> (LinkTx<'_>, LinkRx<'_>) {
        (LinkTx(PhantomData), LinkRx::new())
    }
}

impl LinkTx<'_> {
    /// Nothing may be sent yet.
    pub async fn begin(&mut self) -> Result<(), Error> {
        Ok(())
    }

    /// Sends all packets, in turns to come. If this is given up before it ends, the memory of the packets is lost.
    pub async fn send(&self, packets: &mut Outgoing, urgency: Urgency) -> Result<(), Error> {
        // They wait for a turn.
        *packets = LANES[urgency as usize].send(packets.hand_over(), || ()).await;
        Ok(())
    }
}

/// Drives the line for ever.
#[embassy_executor::task]
async fn run(mut parts: LinkParts, ring: &'static mut [u8; RING_BYTES]) -> ! {
    loop {
        let Err(error) = serve(&mut parts, ring).await;
        warn!("bus: {}; opening it anew", error);
        Timer::after(REOPEN_PAUSE).await;
        // The rest of a request is lost, so that the next one starts clean.
        let _ = REQUESTS.try_write(&[0]);
    }
}

/// Hears and speaks until the line fails.
async fn serve(parts: &mut LinkParts, ring: &mut [u8; RING_BYTES]) -> Result<Infallible, usart::Error> {
    let address = parts.address;
    let mut config = config();
    // embassy-stm32 takes it for both, before and after.
    config.de_assertion_time = DRIVER_TIME;
    config.de_deassertion_time = DRIVER_TIME;
    let uart = Uart::new_with_de(
        parts.uart.reborrow(),
        parts.rx_pin.reborrow(),
        parts.tx_pin.reborrow(),
        parts.de_pin.reborrow(),
        parts.tx_dma.reborrow(),
        parts.rx_dma.reborrow(),
        Interrupts,
        config,
    );
    let (mut tx, rx) = uart.expect("the UART can do LINK_BAUD").split();
    let mut rx = rx.into_ring_buffered(ring);
    rx.start_uart();
    let mut listener = Listener {
        rx,
        address,
        ear: Ear::default(),
        bytes: [0; 128],
        nothing_unread: Instant::now(),
        is_behind: false,
        turn: None,
        look: Timer::after(LOOK_INTERVAL),
    };
    loop {
        while !listener.may_speak() {
            listener.hear().await?;
        }
        match select(listener.overhear(), speak(&mut tx, address)).await {
            Either::First(Err(error)) => return Err(error),
            Either::Second(result) => result?,
        }
    }
}

/// Says what there is to say, and ends the turn.
async fn speak(tx: &mut UartTx<'_, Async>, address: u8) -> Result<(), usart::Error> {
    let mut said = 0;
    // What begins before the turn has had its bytes.
    let next = |said| LANES.iter().find_map(|lane| lane.take(|packets| said + packets.last < TURN_BYTES));
    while let Some(taken) = next(said) {
        let packets = taken.packets.as_ref().map_or(&[][..], Outgoing::packets);
        said += packets.len();
        tx.write(packets).await?;
    }
    let [mark, check, end] = Mark::End.block(address);
    tx.write(&[0, mark, check, end]).await
}

struct Listener<'a> {
    rx: RingBufferedUartRx<'a>,
    address: u8,
    ear: Ear,
    bytes: [u8; 128],
    /// When nothing unread was there last.
    nothing_unread: Instant,
    /// Whether more may be there than was taken.
    is_behind: bool,
    /// The board's turn, if no other block was heard since: it did not come before this time.
    turn: Option<Instant>,
    /// The line is looked at again.
    look: Timer,
}

impl Listener<'_> {
    /// Whether the board has a turn that has not lapsed, which it takes.
    fn may_speak(&mut self) -> bool {
        !self.is_behind && self.turn.take().is_some_and(|came_after| came_after.elapsed() < OLDEST_TURN)
    }

    /// Takes what has come, or looks again. Giving it up loses nothing.
    async fn hear(&mut self) -> Result<(), usart::Error> {
        let looked = Instant::now();
        let Either::First(read) = select(self.rx.read(&mut self.bytes), &mut self.look).await else {
            self.look = Timer::after(LOOK_INTERVAL);
            self.nothing_unread = looked;
            self.is_behind = false;
            return Ok(());
        };
        let length = read?;
        self.take(length);
        self.is_behind = length == self.bytes.len();
        if self.is_behind {
            // Bytes that come as fast as they are read must not keep the acquisition waiting.
            yield_now().await;
            return Ok(());
        }
        self.nothing_unread = Instant::now();
        if self.ear.is_in_block() {
            Timer::after(REST_OF_BLOCK).await;
        }
        Ok(())
    }

    /// Hands on what belongs to requests to this board, and notes its turn.
    fn take(&mut self, length: usize) {
        let mut kept = 0;
        let bytes = &mut self.bytes[..length];
        for place in 0..bytes.len() {
            match self.ear.hear(bytes[place]) {
                Some(Heard::Token { mark, address }) => {
                    let is_mine = mark == Mark::Turn && address == self.address;
                    self.turn = is_mine.then_some(self.nothing_unread);
                }
                Some(Heard::Byte { mark, address, byte }) => {
                    self.turn = None;
                    if mark == Mark::Request && address == self.address {
                        bytes[kept] = byte;
                        kept += 1;
                    }
                }
                None => {}
            }
        }
        if !hand_on(&bytes[..kept]) {
            warn!("bytes of a request dropped: those before it were not read yet");
        }
    }

    /// Drops what comes while the board speaks.
    async fn overhear(&mut self) -> Result<Infallible, usart::Error> {
        loop {
            self.hear().await?;
        }
    }
}
