//! Any bytes as a stream of packets, in both directions. What decodes must encode and decode to
//! itself, and a good packet behind any bytes must be understood once the line has been cleared.
#![no_main]

use dermatome_shared::protocol::{
    BoardPacket, MAX_PACKET_BYTES, PacketReader, Reply, Request, RequestPacket, encode,
};
use libfuzzer_sys::fuzz_target;
use std::fmt::Debug;

trait Message: PartialEq + Debug {
    fn encoded(&self) -> Vec<u8>;
}

macro_rules! message {
    ($kind:ty) => {
        impl Message for $kind {
            fn encoded(&self) -> Vec<u8> {
                let mut buffer = [0; MAX_PACKET_BYTES];
                encode(self, &mut buffer).expect("every message fits").to_vec()
            }
        }
    };
}
message!(RequestPacket);
message!(BoardPacket);

macro_rules! read {
    ($kind:ty, $bytes:expr, $good:expr) => {{
        let mut reader = PacketReader::default();
        for &byte in $bytes {
            if let Some(Ok(message)) = reader.push::<$kind>(byte) {
                let again = message.encoded();
                let mut reader = PacketReader::default();
                let decoded = again.iter().find_map(|&byte| reader.push::<$kind>(byte));
                // NaN is not equal to itself; its bytes are.
                assert_eq!(decoded.expect("a packet").expect("decodes").encoded(), again);
            }
        }
        let good: $kind = $good;
        let clear_line = std::iter::once(0);
        let read = clear_line.chain(good.encoded()).filter_map(|byte| reader.push::<$kind>(byte)).last();
        assert_eq!(read, Some(Ok(good)));
    }};
}

fuzz_target!(|bytes: &[u8]| {
    read!(RequestPacket, bytes, RequestPacket { sequence: 7, request: Request::Info });
    read!(BoardPacket, bytes, BoardPacket::Reply { sequence: 7, reply: Reply::Done });
    // The same as the content of packets whose framing and checksum are right.
    for message in bytes.split(|&byte| byte == 0xFF) {
        let framed = framed(message);
        read!(RequestPacket, &framed, RequestPacket { sequence: 7, request: Request::Info });
        read!(BoardPacket, &framed, BoardPacket::Reply { sequence: 7, reply: Reply::Done });
    }
});

/// Content with checksum and framing: COBS in its simplest form, one block for every zero byte.
fn framed(message: &[u8]) -> Vec<u8> {
    let crc = dermatome_shared::patch::checksum::crc32(&[message]).to_le_bytes();
    let mut packet = Vec::new();
    for part in [message, &crc].concat().split(|&byte| byte == 0) {
        // A full block stands for no zero behind it.
        for block in part.chunks(254) {
            packet.push(block.len() as u8 + 1);
            packet.extend(block);
        }
        if part.is_empty() || part.len() % 254 == 0 {
            packet.push(1);
        }
    }
    packet.push(0);
    packet
}
