//! Bus: packets of up to sixteen boards and one host on a line that only one of them drives at a time (RS-485).
//!
//! What goes over the line are blocks: a mark that says what follows and whose it is, its complement, perhaps a packet, one
//! zero byte. Packets are COBS and so have no zero byte: whoever listens is in step again with the next one.
//!
//! | mark | from | packet | what it means |
//! |---|---|---|---|
//! | `0x10` + address | host | yes | a request |
//! | `0x20` + address | host | | the board may speak now |
//! | `0x30` + address | board | yes | a reply or an event |
//! | `0x40` + address | board | | the turn ends |
//!
//! Whoever begins to speak sends a zero byte first, which ends what noise or a speaker that was cut off have left.
//!
//! A board speaks in its turn only. It begins within [`TURN_LAPSES_MS`] of the turn, or not at all; it begins packets as
//! long as it has sent fewer than [`TURN_BYTES`], and then ends the turn. So a host that has heard nothing for longer may
//! give the line to another board.

/// Boards on one bus: addresses 0 to 15.
pub const ADDRESSES: u8 = 16;
/// Bytes after which a board begins no other packet in its turn.
pub const TURN_BYTES: usize = 1024;
/// Longest time from the end of a turn's block to the first byte of the board whose turn it is, ms.
pub const TURN_LAPSES_MS: u64 = 10;

/// What a block is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub enum Mark {
    /// A packet for a board.
    Request = 0x10,
    /// A board may speak.
    Turn = 0x20,
    /// A packet of a board.
    Said = 0x30,
    /// A board has spoken.
    End = 0x40,
}

impl Mark {
    const ALL: [Self; 4] = [Self::Request, Self::Turn, Self::Said, Self::End];

    /// The mark's byte for an address, of which the four low bits count.
    #[must_use]
    pub const fn byte(self, address: u8) -> u8 {
        self as u8 | (address % ADDRESSES)
    }

    /// What a block begins with.
    #[must_use]
    pub const fn head(self, address: u8) -> [u8; 2] {
        let mark = self.byte(address);
        [mark, !mark]
    }

    /// The whole block of a [`Mark::Turn`] or [`Mark::End`].
    #[must_use]
    pub const fn block(self, address: u8) -> [u8; 3] {
        let [mark, check] = self.head(address);
        [mark, check, 0]
    }

    fn of(byte: u8) -> Option<(Self, u8)> {
        let mark = Self::ALL.into_iter().find(|&mark| mark as u8 == byte & 0xF0)?;
        Some((mark, byte % ADDRESSES))
    }
}

/// Something heard on the line, and whose it is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Heard {
    /// The next byte of a packet ([`Mark::Request`] or [`Mark::Said`]), its zero byte included.
    Byte {
        /// Which of the two.
        mark: Mark,
        /// The board's address.
        address: u8,
        /// The byte.
        byte: u8,
    },
    /// A whole [`Mark::Turn`] or [`Mark::End`].
    Token {
        /// Which of the two.
        mark: Mark,
        /// The board's address.
        address: u8,
    },
}

/// Listens to a line, of which it may have missed the start.
#[derive(Clone, Copy, Debug, Default)]
pub struct Ear(Place);

/// Where in a block the last byte was.
#[derive(Clone, Copy, Debug, Default)]
enum Place {
    /// In one that is not understood.
    #[default]
    Lost,
    /// Before one.
    Between,
    /// After the mark of one.
    Marked(Mark, u8),
    /// In its packet.
    Packet(Mark, u8),
    /// At the end of one without.
    Token(Mark, u8),
}

impl Ear {
    /// Whether a block has begun, as far as is known, and not ended.
    #[must_use]
    pub fn is_in_block(&self) -> bool {
        !matches!(self.0, Place::Between)
    }

    /// Takes one byte, and says what it was or what it made whole.
    pub fn hear(&mut self, byte: u8) -> Option<Heard> {
        let ends = byte == 0;
        let (next, heard) = match self.0 {
            Place::Packet(mark, address) => {
                let next = if ends { Place::Between } else { self.0 };
                (next, Some(Heard::Byte { mark, address, byte }))
            }
            Place::Token(mark, address) if ends => (Place::Between, Some(Heard::Token { mark, address })),
            _ if ends => (Place::Between, None),
            Place::Between => {
                (Mark::of(byte).map_or(Place::Lost, |(mark, own)| Place::Marked(mark, own)), None)
            }
            Place::Marked(mark, address) if byte == !mark.byte(address) => match mark {
                Mark::Request | Mark::Said => (Place::Packet(mark, address), None),
                Mark::Turn | Mark::End => (Place::Token(mark, address), None),
            },
            _ => (Place::Lost, None),
        };
        self.0 = next;
        heard
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use std::vec::Vec;

    fn heard(bytes: impl IntoIterator<Item = u8>) -> Vec<Heard> {
        let mut ear = Ear::default();
        bytes.into_iter().filter_map(|byte| ear.hear(byte)).collect()
    }

    fn packet(mark: Mark, address: u8, content: &[u8]) -> Vec<u8> {
        [&mark.head(address)[..], content, &[0]].concat()
    }

    #[test]
    fn a_packet_is_heard_byte_by_byte_with_whose_it_is() {
        let line = [&[0][..], &packet(Mark::Said, 3, &[7, 0x23])].concat();
        let byte = |byte| Heard::Byte { mark: Mark::Said, address: 3, byte };
        assert_eq!(heard(line), [byte(7), byte(0x23), byte(0)]);
    }

    #[test]
    fn nothing_is_heard_without_the_complement_of_its_mark() {
        let turn = Mark::Turn.block(15);
        let token = Heard::Token { mark: Mark::Turn, address: 15 };
        let mut ear = Ear::default();
        let in_block = [0, turn[0], turn[1], turn[2]].map(|byte| (ear.hear(byte), ear.is_in_block()).1);
        assert_eq!(in_block, [false, true, true, false]);
        assert_eq!(heard([0].into_iter().chain(turn).chain(turn)), [token, token]);
        for bit in 0..16 {
            let mut damaged = turn;
            damaged[bit / 8] ^= 1 << (bit % 8);
            assert_eq!(heard([0].into_iter().chain(damaged)), [], "bit {bit}");
            let mut request = packet(Mark::Request, 3, &[7, 7]);
            request[bit / 8] ^= 1 << (bit % 8);
            assert_eq!(heard([0].into_iter().chain(request)), [], "bit {bit}");
        }
    }

    #[test]
    fn who_begins_in_the_middle_is_in_step_with_the_next_zero_byte() {
        // The rest of a packet that looks like a turn.
        let line = [&Mark::Turn.block(2)[..], &Mark::End.block(2)].concat();
        assert_eq!(heard(line), [Heard::Token { mark: Mark::End, address: 2 }]);
    }

    proptest! {
        #[test]
        fn blocks_between_noise_are_heard_where_a_zero_byte_came_before(
            noise in prop::collection::vec(any::<u8>(), 0..50),
            content in prop::collection::vec(1_u8..=255, 0..50),
            address in 0..ADDRESSES,
        ) {
            let line = [&noise[..], &[0], &packet(Mark::Request, address, &content), &Mark::Turn.block(address)].concat();
            let all = heard(line);
            let wanted: Vec<Heard> = content.iter().chain(&[0])
                .map(|&byte| Heard::Byte { mark: Mark::Request, address, byte })
                .chain([Heard::Token { mark: Mark::Turn, address }])
                .collect();
            prop_assert!(all.ends_with(&wanted));
        }
    }
}
