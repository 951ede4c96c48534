//! CAN: a link over a bus of CAN FD that many boards share ([`dermatome_shared::protocol::can`]).
//!
//! All of it happens in the interrupt of the FDCAN, above the acquisition: it empties the receive FIFO, in which three frames
//! have room, 0.9 ms of full ones, and fills the three transmit buffers from two lanes, replies first. So nothing that is
//! computed keeps the bus waiting, and what owns the link never touches it.
//!
//! **While the flash is written** the CPU stands still, for longer than the FIFO lasts. A host has one request under way at a
//! time, so the reply to one that brings something for the flash goes out only when that is written.
//!
//! **Where nobody acknowledges**, since the host is away or the cable off, the FDCAN sends the same frame again and again by
//! itself; what comes after it waits, and is dropped as where any link is too slow. It goes on as soon as somebody listens.
//!
//! **Off the bus**, after some thirty frames in a row that met an error, the FDCAN waits to be told to come back. What was to
//! be sent is dropped then. It comes back after 129 times 11 bits of silence, 1.4 ms where nobody else speaks, and begins with a zero byte, which ends the packet that
//! broke off.

use core::{
    cell::Cell,
    marker::PhantomData,
    sync::atomic::{AtomicBool, Ordering},
};

use defmt::warn;
use dermatome_shared::protocol::can::{Carries, DATA_RATE, FRAME_BYTES, LENGTHS, NOMINAL_RATE, filled};
use embassy_stm32::{
    can::{RxPin, TxPin},
    gpio::{AfType, Flex, OutputType, Pull, Speed},
    pac::can::vals::{Anfe, Anfs, Tfqm},
    rcc,
};
use embassy_sync::blocking_mutex::CriticalSectionMutex;

use super::{
    OUTGOING_BYTES, Outgoing, Urgency,
    lanes::{Error, Lane, LinkRx, Taken, hand_on},
};
use crate::board::{CAN, CAN_CLOCK, CAN_MEMORY, LinkCan, LinkParts, call_can_interrupt, on_can_interrupt};

/// Bytes before a packet.
pub const HEAD_BYTES: usize = 0;
/// Short packets share frames, but a reply must not wait for many.
pub const BYTES_IN_ONE_GO: usize = 2 * FRAME_BYTES;
/// Memory that it needs beside packets: less than a ring takes.
pub const OWN_BYTES: usize = 0;
/// There is no ring.
pub const RING_BYTES: usize = 0;
/// Requests that come while the CPU stands still would be lost.
pub const SETTLES_FIRST: bool = true;

/// Words of a frame in the FDCAN's memory: two of its head, and its data.
const WORDS: usize = 2 + FRAME_BYTES / 4;
/// Transmit buffers.
const BUFFERS: usize = 3;
/// Bits of a frame's second word: FD format, bit rate switch, and where its length code begins.
const FD: u32 = 1 << 21;
const SWITCHES_RATE: u32 = 1 << 20;
const LENGTH: u32 = 16;
/// Where an 11-bit identifier begins in a frame's first word.
const IDENTIFIER: u32 = 18;
/// A filter that puts frames with one of two identifiers into the first FIFO.
const ONE_OF_TWO: u32 = 1 << 30 | 1 << 27;

/// Quanta of a bit: those before its sample point, without its first one, and those after it.
struct Bit {
    before: u8,
    after: u8,
}

const NOMINAL: Bit = Bit::of(NOMINAL_RATE);
const DATA: Bit = Bit::of(DATA_RATE);

impl Bit {
    /// Of periods of the clock, sampled at about 80 %: 79.2 % of 24 and 83.3 % of 12.
    const fn of(rate: u32) -> Self {
        let quanta = CAN_CLOCK / rate;
        assert!(CAN_CLOCK.is_multiple_of(rate) && quanta >= 8 && quanta <= 40, "the clock makes such bits");
        let after = (quanta + 2) / 5;
        Self { before: (quanta - 1 - after) as u8, after: after as u8 }
    }
}

/// What is being sent, and how much of it lies in frames already.
struct Sending {
    taken: Taken<Outgoing>,
    done: usize,
}

impl Sending {
    /// What does not lie in frames yet.
    fn left(&self) -> &[u8] {
        self.taken.packets.as_ref().map_or(&[], |packets| &packets.packets()[self.done..])
    }
}

/// By urgency.
static LANES: [Lane<Outgoing>; 2] = [Lane::new(), Lane::new()];
static SENDING: CriticalSectionMutex<Cell<Option<Sending>>> = CriticalSectionMutex::new(Cell::new(None));
/// Whether a packet may have broken off before.
static IS_BROKEN: AtomicBool = AtomicBool::new(true);
/// The first word of what the board sends.
static HEAD: CriticalSectionMutex<Cell<u32>> = CriticalSectionMutex::new(Cell::new(0));

/// What the link's owner holds.
pub struct LinkPort {
    _parts: LinkParts,
}

/// Gives packets to the bus.
pub struct LinkTx<'a>(PhantomData<&'a mut LinkPort>);

impl LinkPort {
    /// Puts the board on the bus. Can be called once.
    pub fn new(mut parts: LinkParts, _ring: &'static mut [u8; RING_BYTES]) -> Self {
        let (rx, tx) = (rx_function(&*parts.rx_pin), tx_function(&*parts.tx_pin));
        rcc::enable_and_reset::<LinkCan>();
        set_up(parts.address);
        // Recessive until now, and from now on by the FDCAN.
        let sends = AfType::output(OutputType::PushPull, Speed::High);
        let (mut rx_pin, mut tx_pin) =
            (Flex::new(parts.rx_pin.reborrow()), Flex::new(parts.tx_pin.reborrow()));
        tx_pin.set_as_af_unchecked(tx, sends);
        // A bus that is not there is recessive.
        rx_pin.set_as_af_unchecked(rx, AfType::input(Pull::Up));
        // Dropped, they would let the pins go.
        core::mem::forget((rx_pin, tx_pin));
        HEAD.lock(|head| head.set(u32::from(Carries::Said.identifier(parts.address)) << IDENTIFIER));
        on_can_interrupt(work);
        go_on();
        Self { _parts: parts }
    }

    /// What packets are sent from, in this memory.
    pub fn outgoing(&self, bytes: &'static mut [u8; OUTGOING_BYTES]) -> Outgoing {
        Outgoing { bytes, head: [], length: 0, last: 0 }
    }

    /// Its two ends, which never fail.
    pub fn open(&mut self) -> (LinkTx<'_>, LinkRx<'_>) {
        (LinkTx(PhantomData), LinkRx::new())
    }
}

impl LinkTx<'_> {
    /// What broke off before is ended in any case.
    pub async fn begin(&mut self) -> Result<(), Error> {
        Ok(())
    }

    /// Sends all packets; the last frames may still wait for the bus when it returns. If this is given up before it ends,
    /// the memory of the packets is lost.
    pub async fn send(&self, packets: &mut Outgoing, urgency: Urgency) -> Result<(), Error> {
        *packets = LANES[urgency as usize].send(packets.hand_over(), call_can_interrupt).await;
        Ok(())
    }
}

fn rx_function(pin: &impl RxPin<LinkCan>) -> u8 {
    pin.af_num()
}

fn tx_function(pin: &impl TxPin<LinkCan>) -> u8 {
    pin.af_num()
}

/// Sets the FDCAN up, which is off the bus after a reset.
fn set_up(address: u8) {
    CAN.cccr().modify(|w| w.set_cce(true));
    CAN.nbtp().write(|w| {
        w.set_ntseg1(NOMINAL.before - 1);
        w.set_ntseg2(NOMINAL.after - 1);
        w.set_nsjw(NOMINAL.after - 1);
    });
    CAN.dbtp().write(|w| {
        w.set_dtseg1(DATA.before - 1);
        w.set_dtseg2(DATA.after - 1);
        w.set_dsjw(DATA.after - 1);
        w.set_tdc(true);
    });
    // What it sends comes back later than half a bit: it is looked at so much later, from the sample point's place on.
    CAN.tdcr().write(|w| w.set_tdco(1 + DATA.before));
    CAN.cccr().modify(|w| {
        w.set_fdoe(true);
        w.set_brse(true);
    });
    let own = u32::from(Carries::Request.identifier(address));
    CAN_MEMORY.flssa(0).write_value(ONE_OF_TWO | own << 16 | own);
    CAN.rxgfc().write(|w| {
        w.set_lss(1);
        w.set_anfs(Anfs::REJECT);
        w.set_anfe(Anfe::REJECT);
        w.set_rrfs(true);
        w.set_rrfe(true);
    });
    CAN.txbc().write(|w| w.set_tfqm(Tfqm::FIFO));
    CAN.txbtie().write(|w| (0..BUFFERS).for_each(|buffer| w.set_tie(buffer, true)));
    CAN.ie().write(|w| {
        w.set_rfne(0, true);
        w.set_rfle(0, true);
        w.set_tce(true);
        w.set_boe(true);
    });
    CAN.ile().write(|w| w.set_eint0(true));
}

/// Lets the FDCAN take part in the bus, as soon as that has been quiet for long enough.
fn go_on() {
    CAN.cccr().modify(|w| {
        w.set_cce(false);
        w.set_init(false);
    });
    // Nothing can be sent before.
    while CAN.cccr().read().init() {}
}

/// Does what is to be done, in the FDCAN's interrupt.
fn work() {
    let flags = CAN.ir().read();
    CAN.ir().write_value(flags);
    receive();
    if flags.bo() && CAN.psr().read().bo() {
        come_back();
    }
    if flags.rfl(0) {
        warn!("frames lost: those before them were not read yet");
        // What they belonged to is lost, so that the next request starts clean.
        hand_on(&[0]);
    }
    send();
}

/// Drops what was to be sent, and begins anew.
fn come_back() {
    warn!("off the bus; coming back");
    // The FDCAN's own clock is another one: what was written there is there once it is read.
    while !CAN.cccr().read().init() {}
    // That forgets all frames.
    CAN.cccr().modify(|w| w.set_cce(true));
    drop(SENDING.lock(Cell::take));
    IS_BROKEN.store(true, Ordering::Relaxed);
    go_on();
}

/// Hands on all that came.
fn receive() {
    loop {
        let fifo = CAN.rxfs(0).read();
        if fifo.ffl() == 0 {
            return;
        }
        let frame = usize::from(fifo.fgi());
        let word = |place| CAN_MEMORY.rxfifo0(frame * WORDS + place).read();
        let is_ours = word(1) & FD != 0;
        let length = if is_ours { LENGTHS[(word(1) >> LENGTH & 0xF) as usize] } else { 0 };
        let mut bytes = [0; FRAME_BYTES];
        for (place, four) in bytes[..length.next_multiple_of(4)].chunks_exact_mut(4).enumerate() {
            four.copy_from_slice(&word(2 + place).to_le_bytes());
        }
        CAN.rxfa(0).write(|w| w.set_fai(frame as u8));
        if !hand_on(&bytes[..length]) {
            warn!("bytes of a request dropped: those before them were not read yet");
        }
    }
}

/// Fills transmit buffers as long as there are free ones, and something to send.
fn send() {
    let mut sending = SENDING.lock(Cell::take);
    loop {
        let buffers = CAN.txfqs().read();
        if buffers.tfqf() {
            break;
        }
        let buffer = buffers.tfqpi();
        let next =
            || LANES.iter().find_map(|lane| lane.take(|_| true)).map(|taken| Sending { taken, done: 0 });
        let Some(mut now) = sending.take().or_else(next) else { break };
        if IS_BROKEN.swap(false, Ordering::Relaxed) {
            put(buffer, &[0]);
        } else {
            put(buffer, now.left());
            now.done += now.left().len().min(FRAME_BYTES);
        }
        // At its end its memory goes back.
        sending = Some(now).filter(|now| !now.left().is_empty());
    }
    SENDING.lock(|cell| cell.set(sending));
}

/// Sends a frame with as many of these bytes as it can have.
fn put(buffer: u8, bytes: &[u8]) {
    let mut room = [0; FRAME_BYTES];
    let data = filled(bytes, &mut room);
    let code = LENGTHS.iter().position(|&length| length == data.len()).unwrap_or_default() as u32;
    let words = data.len().div_ceil(4);
    let word = |place| CAN_MEMORY.txbuf(usize::from(buffer) * WORDS + place);
    word(0).write_value(HEAD.lock(Cell::get));
    word(1).write_value(FD | SWITCHES_RATE | code << LENGTH);
    for (place, four) in room.chunks_exact(4).take(words).enumerate() {
        word(2 + place).write_value(u32::from_le_bytes([four[0], four[1], four[2], four[3]]));
    }
    CAN.txbar().write(|w| w.set_ar(buffer.into(), true));
}
