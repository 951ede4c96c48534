//! One turn of a controller's loop: `cargo bench -p dermatome-c --bench poll`. A thread plays a board over TCP, as fast as it is
//! read; so a frame that is taken has in it its share of a read of the system's, and a turn in which nothing has come is one
//! such read.

use dermatome_c::{board::Board, records::Options};
use dermatome_shared::{
    contact::{Contact, Evidence},
    drive::Drive,
    protocol::{
        BoardPacket, Event, FrameStamp, Info, MAX_PACKET_BYTES, PackedImage, PacketReader, PatchInfo, Reply,
        Request, RequestPacket, Version, encode,
    },
    track::Identity,
};
use divan::{AllocProfiler, Bencher, black_box};
use std::{
    io::{Read, Write},
    net::{TcpListener, TcpStream},
    thread,
};

#[path = "../../tests/testbench/mod.rs"]
mod testbench;

#[global_allocator]
static MEMORY: AllocProfiler = AllocProfiler::system();

fn main() {
    divan::main();
}

/// Contacts and, where there are pixels, images.
#[divan::bench(args = [0, 196, 784])]
fn a_frame_with_two_contacts_and_an_image_of_pixels(bencher: Bencher, pixels: usize) {
    let mut board = streaming(Some(pixels));
    bencher.bench_local(|| {
        loop {
            if let Some(frame) = board.poll().expect("the board plays on") {
                break black_box(frame);
            }
        }
    });
}

#[divan::bench]
fn nothing_has_come(bencher: Bencher) {
    let mut board = streaming(None);
    bencher.bench_local(|| black_box(board.poll().expect("the board is there").is_none()));
}

/// A board that streams, frames with so many pixels or none at all.
fn streaming(pixels: Option<usize>) -> Board {
    let listener = TcpListener::bind("127.0.0.1:0").expect("a port is free");
    let port = format!("tcp:{}", listener.local_addr().expect("it is bound"));
    thread::spawn(move || {
        let (mut line, _) = listener.accept().expect("the bench connects");
        answer_until_it_streams(&mut line);
        if let Some(pixels) = pixels {
            play(&mut line, pixels);
        }
        // Until the bench lets go.
        while line.read(&mut [0; 64]).is_ok_and(|length| length > 0) {}
    });
    let mut board = Board::open(&port).expect("the board answers");
    let images_every = u16::from(pixels.is_some_and(|pixels| pixels > 0));
    let options = Options { images_every, silence_ms: u32::MAX, ..Options::default() };
    board.start(options).expect("the board streams");
    board
}

fn answer_until_it_streams(line: &mut TcpStream) {
    let (mut reader, mut byte) = (PacketReader::default(), [0]);
    while line.read(&mut byte).is_ok_and(|length| length == 1) {
        let Some(Ok(RequestPacket { sequence, request })) = reader.push(byte[0]) else { continue };
        let reply = match request {
            Request::Hello(_) => testbench::hello(Version::current()),
            Request::Stream(_) => Reply::Streaming { first_sequence: 0 },
            _ => Reply::Info(info()),
        };
        if !send(line, &BoardPacket::Reply { sequence, reply }) || matches!(request, Request::Stream(_)) {
            return;
        }
    }
}

fn info() -> Info {
    let Reply::Info(info) = testbench::info(16, 100_000) else { unreachable!("it is one") };
    let skin = "played".try_into().expect("it is short");
    let drive = Drive::new(50e3, 1e-3, 50.0);
    let patch = PatchInfo { crc: 1, skin, electrodes: 16, steps: 208, measurements: 104, pixels: 784, drive };
    Info { patch: Some(patch), ..info }
}

fn play(line: &mut TcpStream, pixels: usize) {
    let contact = Contact {
        position: [0.01, 0.02, 0.03],
        normal: [0.0, 0.6, 0.8],
        area: 1e-4,
        strength: 0.1,
        peak: 0.2,
        pressure: Some(2e4),
        load_area: Some(1e-4),
        evidence: Some(Evidence { significance: 20.0, position_deviation: 1e-3, strength_deviation: 0.01 }),
        identity: Some(Identity { number: 1, velocity: [0.0; 3], merged: None, split_from: None }),
    };
    let image =
        PackedImage { exponent: 15, mantissas: (0..pixels).map(|pixel| (37 * pixel) as i16).collect() };
    let mut number = 0..;
    for sequence in 0_u32.. {
        let at =
            FrameStamp { sequence, timestamp_us: 20_000 * u64::from(sequence), flags: Default::default() };
        let image = (pixels > 0).then(|| Event::Image { at, image: image.clone() });
        let contacts = Event::Contacts { at, contacts: [contact; 2].into_iter().collect() };
        for event in image.into_iter().chain([contacts]) {
            let number = number.next().unwrap_or(0);
            if !send(line, &BoardPacket::Event { number, event }) {
                return;
            }
        }
    }
}

/// Whether the other end still takes it.
fn send(line: &mut TcpStream, packet: &BoardPacket) -> bool {
    let mut buffer = [0; MAX_PACKET_BYTES];
    encode(packet, &mut buffer).is_ok_and(|bytes| line.write_all(bytes).is_ok())
}
