//! CAN: packets of up to sixteen boards and their host on a CAN FD bus.
//!
//! Data frames in the FD format with 11-bit identifiers, 1 Mbit/s until the bit rate switches and 2 Mbit/s from there. Each
//! carries up to 64 bytes of what is for one board, or comes from it, in order and as over a line of its own; packets may
//! share frames. What a frame can be no shorter than is filled with zero bytes: they end packets, and between packets mean
//! nothing.
//!
//! | identifier | from | |
//! |---|---|---|
//! | `0x100` + address | host | requests |
//! | `0x200` + address | board | replies and events |
//!
//! Nobody needs a turn: where several begin at once, the lowest identifier goes on. So requests come first, and then the
//! boards with the lowest addresses. A frame that somebody has received damaged is sent again by the hardware, unless only
//! nodes have that are error passive; one that the receiver had no room for is lost, which shows as any damage to a packet
//! does.

/// Boards on one bus: addresses 0 to 15.
pub const ADDRESSES: u8 = 16;
/// Bits per second until the bit rate switches.
pub const NOMINAL_RATE: u32 = 1_000_000;
/// Bits per second after that.
pub const DATA_RATE: u32 = 2_000_000;
/// Most bytes in one frame.
pub const FRAME_BYTES: usize = 64;
/// How many bytes a frame can have: by its length code, 0 to 15.
pub const LENGTHS: [usize; 16] = [0, 1, 2, 3, 4, 5, 6, 7, 8, 12, 16, 20, 24, 32, 48, FRAME_BYTES];

/// Whose bytes a frame carries.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u16)]
pub enum Carries {
    /// A host's, for a board.
    Request = 0x100,
    /// A board's.
    Said = 0x200,
}

impl Carries {
    /// The identifier for an address, of which the four low bits count.
    #[must_use]
    pub const fn identifier(self, address: u8) -> u16 {
        self as u16 | (address % ADDRESSES) as u16
    }

    /// What a frame with this identifier carries, and the board's address; none of a stranger's.
    #[must_use]
    pub fn of(identifier: u16) -> Option<(Self, u8)> {
        let carries = [Self::Request, Self::Said].into_iter().find(|&it| it as u16 == identifier & !0xF)?;
        Some((carries, identifier as u8 % ADDRESSES))
    }
}

/// The data of a frame with these bytes, of which [`FRAME_BYTES`] at most count: filled up to the next of [`LENGTHS`].
pub fn filled<'a>(bytes: &[u8], room: &'a mut [u8; FRAME_BYTES]) -> &'a [u8] {
    let bytes = &bytes[..bytes.len().min(FRAME_BYTES)];
    let (data, rest) = room.split_at_mut(bytes.len());
    data.copy_from_slice(bytes);
    rest.fill(0);
    let length = LENGTHS.into_iter().find(|&length| length >= bytes.len());
    &room[..length.unwrap_or(FRAME_BYTES)]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn identifiers_name_direction_and_address_and_strangers_have_none() {
        for address in 0..ADDRESSES {
            for carries in [Carries::Request, Carries::Said] {
                assert_eq!(Carries::of(carries.identifier(address)), Some((carries, address)));
            }
        }
        for stranger in [0, 0xFF, 0x110, 0x1FF, 0x210, 0x300, 0x600, 0x7FF] {
            assert_eq!(Carries::of(stranger), None, "{stranger:#x}");
        }
        assert!(Carries::Request.identifier(15) < Carries::Said.identifier(0));
    }

    #[test]
    fn data_is_filled_with_zero_bytes_to_a_length_that_there_is() {
        let bytes: std::vec::Vec<u8> = (1..=80).collect();
        for length in 0..=bytes.len() {
            let mut room = [0xAA; FRAME_BYTES];
            let data = filled(&bytes[..length], &mut room);
            let taken = length.min(FRAME_BYTES);
            assert!(LENGTHS.contains(&data.len()) && data.len() >= taken, "{length}");
            assert!(LENGTHS.iter().all(|&it| it < taken || it >= data.len()), "{length}: the shortest");
            assert_eq!(data[..taken], bytes[..taken]);
            assert!(data[taken..].iter().all(|&byte| byte == 0));
        }
    }
}
