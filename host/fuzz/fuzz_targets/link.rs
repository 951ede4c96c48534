//! Any bytes after a board's hello: the host counts, refuses or shows them, and its words hold no control characters.
#![no_main]

use dermatome::link::{Link, Transport};
use dermatome_shared::protocol::{
    BoardPacket, Identity, MAX_PACKET_BYTES, Reply, Selection, Version, encode,
};
use libfuzzer_sys::fuzz_target;
use std::{
    io::{self, Cursor, Read, Write},
    time::Duration,
};

/// Plays bytes and then closes; swallows what the host says.
struct Played(Cursor<Vec<u8>>);

impl Read for Played {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        self.0.read(buffer)
    }
}

impl Write for Played {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        Ok(bytes.len())
    }
    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

impl Transport for Played {}

fn packet(message: &BoardPacket) -> Vec<u8> {
    encode(message, &mut [0; MAX_PACKET_BYTES]).unwrap().to_vec()
}

fuzz_target!(|input: (&str, Vec<Vec<u8>>, bool)| {
    let (name, packets, framed) = input;
    let board = name.chars().take(8).collect::<String>();
    let identity = Identity { board: board.as_str().try_into().unwrap(), firmware: Default::default() };
    let hello = Reply::Hello { version: Version::current(), identity };
    let mut bytes = packet(&BoardPacket::Reply { sequence: 0, reply: hello });
    for plain in packets {
        bytes.extend(if framed { with_checksum(plain) } else { plain });
    }
    let Ok(mut link) = Link::connect("played", Played(Cursor::new(bytes))) else { return };
    assert!(!link.identity().board.contains(char::is_control));
    if let Ok(info) = link.info() {
        assert!(info.patch.is_none_or(|patch| !patch.skin.contains(char::is_control)));
    }
    let contacts = Selection { contacts: 1, images: 1, health: 1, ..Selection::default() };
    let Ok(mut stream) = link.subscribe(contacts) else { return };
    while let Ok(Some(frame)) = stream.next(Duration::ZERO) {
        let positions = frame.contacts.iter().flatten().flat_map(|contact| contact.position);
        assert!(positions.into_iter().all(f32::is_finite));
    }
});

/// A message as it goes over the wire, so that more than the checksum is tried.
fn with_checksum(mut message: Vec<u8>) -> Vec<u8> {
    message.truncate(MAX_PACKET_BYTES / 2);
    let crc = dermatome_shared::patch::checksum::crc32(&[&message]);
    message.extend(crc.to_le_bytes());
    let mut framed = cobs::encode_vec(&message);
    framed.push(0);
    framed
}
