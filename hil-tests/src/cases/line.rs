//! Cases of the line: hello, versions, noise.

use super::{Case, Failure, ensure};
use crate::{
    board::START_TIME,
    chip::{time::Time, usart::Symbol},
    rig::{Capability, Rig},
};
use dermatome_shared::protocol::{
    BoardPacket, FrameSource, MAX_PACKET_BYTES, PROTOCOL_VERSION, PacketReader, Refusal, Reply, Request,
    RequestPacket, Version, encode,
};
use rand::{Rng, SeedableRng};
use rand_pcg::Pcg64;

/// Bytes that the noise case sends.
const NOISE_BYTES: usize = 1_000_000;
/// Bytes between two checks of the board.
const NOISE_PIECE: usize = 10_000;

pub(super) const CASES: &[Case] = &[
    Case { name: "a board says hello, who it is and where its frames come from", needs: &[], run: hello },
    Case {
        name: "a host of another protocol version is refused by name",
        needs: &[Capability::RawLine],
        run: other_version,
    },
    Case {
        name: "a million bytes of noise: no hang, no reset, no wrong state",
        needs: &[Capability::RawLine, Capability::VirtualTime],
        run: noise,
    },
];

fn hello(rig: &Rig) -> Result<String, Failure> {
    let mut link = rig.link()?;
    let info = link.info()?;
    ensure(info.frame_source == FrameSource::Skin, || format!("frames come from {:?}", info.frame_source))?;
    let identity = link.identity();
    Ok(format!("{} {}, {} electrodes", identity.board, identity.firmware, info.electrodes))
}

fn other_version(rig: &Rig) -> Result<String, Failure> {
    let version = Version { protocol: PROTOCOL_VERSION + 1, schema: [0; 8] };
    let mut buffer = [0; MAX_PACKET_BYTES];
    let packet = RequestPacket { sequence: 7, request: Request::Hello(version) };
    rig.emulated().run(START_TIME)?;
    rig.send_raw(&[0]);
    rig.send_raw(encode(&packet, &mut buffer).map_err(Failure::wrong)?);
    let mut reader = PacketReader::default();
    let wanted = Reply::Refused(Refusal::Version { board: PROTOCOL_VERSION });
    for _ in 0..100 {
        let bytes = rig.emulated().receive(Time::from_millis(10))?;
        for packet in bytes.into_iter().filter_map(|byte| reader.push::<BoardPacket>(byte)).flatten() {
            if let BoardPacket::Reply { sequence: 7, reply } = packet {
                ensure(reply == wanted, || format!("it replies {reply:?}"))?;
                return Ok(String::new());
            }
        }
    }
    Err(Failure::wrong("no reply within a second"))
}

/// Pieces of valid packets, flipped bits, cuts, plain noise and damaged symbols.
fn noise(rig: &Rig) -> Result<String, Failure> {
    let mut random = Pcg64::seed_from_u64(4);
    let before = rig.link()?.info()?;
    let mut sent = 0;
    while sent < NOISE_BYTES {
        let piece: Vec<Symbol> =
            (0..NOISE_PIECE / 20).flat_map(|_| burst(&mut random)).take(NOISE_PIECE).collect();
        sent += piece.len();
        rig.emulated().send(piece);
        while rig.emulated().with(|machine| machine.chip(|chip| chip.uart.coming())) > 0 {
            rig.emulated().run(Time::from_millis(5))?;
        }
        rig.emulated().run(Time::from_millis(10))?;
        let after = rig.link()?.info()?;
        let same = after.started_after == before.started_after && after.uptime_ms > before.uptime_ms;
        ensure(same, || format!("after {sent} bytes it has started again: {:?}", after.started_after))?;
        ensure(after.patch == before.patch && !after.tared, || {
            format!("after {sent} bytes it holds {after:?}")
        })?;
    }
    Ok(format!("{sent} bytes"))
}

fn burst(random: &mut Pcg64) -> Vec<Symbol> {
    let mut bytes = match random.random_range(0..4) {
        0 => (0..random.random_range(1..60)).map(|_| random.random()).collect(),
        _ => request(random),
    };
    match random.random_range(0..3) {
        0 => {
            let place = random.random_range(0..bytes.len());
            bytes[place] ^= 1 << random.random_range(0..8);
        }
        1 => bytes.truncate(random.random_range(1..=bytes.len())),
        _ => {
            let place = random.random_range(0..bytes.len());
            bytes[place] = random.random();
        }
    }
    bytes.into_iter().map(|byte| Symbol { byte, damaged: random.random_range(0..500) == 0 }).collect()
}

/// A valid packet that changes nothing, should it come through whole.
fn request(random: &mut Pcg64) -> Vec<u8> {
    let request = match random.random_range(0..5) {
        0 => Request::Info,
        1 => Request::ReadPatch { offset: random.random_range(0..300_000) },
        2 => Request::CommitUpload,
        3 => Request::Hello(Version::current()),
        _ => Request::UploadChunk {
            offset: 0,
            bytes: heapless::Vec::from_slice(&[0x55; 300]).unwrap_or_default(),
        },
    };
    let mut buffer = [0; MAX_PACKET_BYTES];
    let packet = RequestPacket { sequence: random.random(), request };
    encode(&packet, &mut buffer).map(<[u8]>::to_vec).unwrap_or_else(|_| vec![0])
}
