//! Packets: a message in postcard encoding, its CRC-32, COBS framing and a final zero byte.

use super::MAX_PACKET_BYTES;
use crate::patch::checksum::crc32;
use serde::{Serialize, de::DeserializeOwned};

/// Encodes a message as one packet, its final zero byte included, at the start of `out`.
///
/// Fails only if `out` is too short; [`MAX_PACKET_BYTES`] are always enough.
pub fn encode<'a, T: Serialize>(message: &T, out: &'a mut [u8]) -> Result<&'a [u8], PacketError> {
    // One after the other: to do all for each byte takes the board twice as long, and postcard's own function for message
    // and CRC 5.6 kB of flash more.
    let mut plain = [0; MAX_PACKET_BYTES];
    let (length, crc) = {
        let message = postcard::to_slice(message, &mut plain).map_err(|_| PacketError::TooLong)?;
        (message.len(), crc32(&[message]))
    };
    let plain = with_crc(&mut plain, length, crc).ok_or(PacketError::TooLong)?;
    let length = cobs::try_encode(plain, out).map_err(|_| PacketError::TooLong)?;
    *out.get_mut(length).ok_or(PacketError::TooLong)? = 0;
    Ok(&out[..=length])
}

/// Puts a message's CRC behind it.
fn with_crc(plain: &mut [u8], length: usize, crc: u32) -> Option<&[u8]> {
    plain.get_mut(length..)?.first_chunk_mut().map(|end| *end = crc.to_le_bytes())?;
    plain.get(..length + 4)
}

/// Decodes one packet, without its final zero byte; `packet` is overwritten.
pub fn decode<T: DeserializeOwned>(packet: &mut [u8]) -> Result<T, PacketError> {
    let length = cobs::decode_in_place(packet).map_err(|_| PacketError::Framing)?;
    let (message, crc) = packet[..length].split_last_chunk::<4>().ok_or(PacketError::Framing)?;
    if crc32(&[message]) != u32::from_le_bytes(*crc) {
        return Err(PacketError::Crc);
    }
    postcard::from_bytes(message).map_err(|_| PacketError::Message)
}

/// Why bytes are not a packet.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum PacketError {
    /// The message does not fit the buffer.
    #[error("packet is longer than {MAX_PACKET_BYTES} bytes")]
    TooLong,
    /// Not COBS, or too short to hold a checksum.
    #[error("packet is not framed as COBS")]
    Framing,
    /// The checksum does not match.
    #[error("packet is damaged (CRC-32 mismatch)")]
    Crc,
    /// Checksum correct, message unknown: another protocol version.
    #[error("packet holds no message this protocol version knows")]
    Message,
}

/// Collects received bytes into packets.
#[derive(Clone, Debug)]
pub struct PacketReader {
    buffer: [u8; MAX_PACKET_BYTES],
    length: usize,
    overflown: bool,
}

impl Default for PacketReader {
    fn default() -> Self {
        Self { buffer: [0; MAX_PACKET_BYTES], length: 0, overflown: false }
    }
}

impl PacketReader {
    /// Takes one byte; gives a result where it ends a packet. Empty packets are skipped, so that
    /// a sender can end line noise with a zero byte before its first packet.
    pub fn push<T: DeserializeOwned>(&mut self, byte: u8) -> Option<Result<T, PacketError>> {
        if byte != 0 {
            match self.buffer.get_mut(self.length) {
                Some(place) => *place = byte,
                None => self.overflown = true,
            }
            self.length = (self.length + 1).min(MAX_PACKET_BYTES);
            return None;
        }
        let length = core::mem::take(&mut self.length);
        if core::mem::take(&mut self.overflown) {
            return Some(Err(PacketError::TooLong));
        }
        (length > 0).then(|| decode(&mut self.buffer[..length]))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::protocol::{Request, RequestPacket, Version};
    use proptest::prelude::*;

    fn feed(bytes: &[u8]) -> std::vec::Vec<Result<RequestPacket, PacketError>> {
        let mut reader = PacketReader::default();
        bytes.iter().filter_map(|&byte| reader.push(byte)).collect()
    }

    fn hello(sequence: u16) -> RequestPacket {
        RequestPacket { sequence, request: Request::Hello(Version::current()) }
    }

    #[test]
    fn packets_survive_the_wire_between_noise() {
        let mut buffer = [0; 64];
        let mut stream = std::vec![7, 7, 0];
        stream.extend(encode(&hello(5), &mut buffer).unwrap());
        stream.extend(encode(&RequestPacket { sequence: 6, request: Request::Info }, &mut buffer).unwrap());
        let got = feed(&stream);
        assert_eq!(got.len(), 3);
        assert!(got[0].is_err());
        assert_eq!(got[1], Ok(hello(5)));
        assert_eq!(got[2], Ok(RequestPacket { sequence: 6, request: Request::Info }));
    }

    #[test]
    fn every_single_flipped_bit_is_noticed() {
        let mut buffer = [0; 64];
        let packet = encode(&hello(1), &mut buffer).unwrap().to_vec();
        for bit in 0..packet.len() * 8 {
            let mut damaged = packet.clone();
            damaged[bit / 8] ^= 1 << (bit % 8);
            assert!(!feed(&damaged).contains(&Ok(hello(1))), "bit {bit}");
        }
    }

    #[test]
    fn a_packet_that_overflows_is_an_error_and_the_next_one_is_read() {
        let mut stream = std::vec![1; MAX_PACKET_BYTES + 1];
        stream.push(0);
        let mut buffer = [0; 64];
        stream.extend(encode(&hello(2), &mut buffer).unwrap());
        assert_eq!(feed(&stream), [Err(PacketError::TooLong), Ok(hello(2))]);
    }

    proptest! {
        #[test]
        fn no_bytes_make_the_reader_panic(bytes in prop::collection::vec(any::<u8>(), 0..600)) {
            let mut reader = PacketReader::default();
            for byte in bytes {
                let _ = reader.push::<RequestPacket>(byte);
            }
        }
    }
}
