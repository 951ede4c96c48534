//! An emulated board as a debug probe sees it: its flash is programmed, its log read out of its RAM.

use crate::{
    board::VirtualBoard,
    chip::{
        RAM_BYTES, RAM_START,
        flash::{Flash, PAGE},
    },
    machine::Machine,
};
use dermatome::link::program::{
    firmware::Firmware,
    log::{DamagedLog, Decoder, Log},
};

/// How a control block of RTT begins.
const IDENTIFICATION: &[u8] = b"SEGGER RTT\0";
/// Bytes of a control block with one channel.
const CONTROL_BLOCK: usize = 48;
/// Where the first channel's place of reading is in the control block.
pub(crate) const READ: u32 = 40;

/// Erases the pages of the firmware, and programs them.
pub fn program(flash: &mut Flash, firmware: &Firmware) {
    for segment in firmware.segments() {
        // A firmware is checked to lie in the flash.
        let (start, end) = (segment.address as u32, segment.address as u32 + segment.bytes.len() as u32);
        for page in (start / PAGE * PAGE..end).step_by(PAGE as usize) {
            flash.load(page, &[0xFF; PAGE as usize]);
        }
    }
    for segment in firmware.segments() {
        flash.load(segment.address as u32, &segment.bytes);
    }
}

/// Reads a board's log.
pub struct LogReader<'a> {
    log: &'a Log,
    decoder: Decoder<'a>,
    in_colour: bool,
    read: Option<u32>,
}

impl<'a> LogReader<'a> {
    /// Nothing is read yet.
    #[must_use]
    pub fn new(log: &'a Log, in_colour: bool) -> Self {
        Self { log, decoder: log.decoder(in_colour), in_colour, read: None }
    }

    /// What the board has logged since this was called last.
    pub fn lines(&mut self, board: &VirtualBoard) -> Result<Vec<String>, DamagedLog> {
        let mut lines = Vec::new();
        let at = self.log.control_block() as u32;
        let Some(piece) = board.with(move |machine| take(machine, at)) else { return Ok(lines) };
        if self.read.replace(piece.end).is_some_and(|read| read != piece.start) {
            lines.push("(the board has restarted)".to_owned());
            self.decoder = self.log.decoder(self.in_colour);
        }
        self.decoder.push(&piece.bytes, |line| lines.push(line.to_owned()))?;
        Ok(lines)
    }
}

/// A piece of the log, and where it was in its ring.
struct Piece {
    start: u32,
    end: u32,
    bytes: Vec<u8>,
}

/// Takes what is new out of the ring of the control block at this address; `None` before there is one.
fn take(machine: &mut Machine, at: u32) -> Option<Piece> {
    let block = machine.peek(at, CONTROL_BLOCK);
    if !block.starts_with(IDENTIFICATION) {
        return None;
    }
    // SEGGER's layout: identification, two counts of channels, the first channel's name, then these.
    let [buffer, size, end, start] = [28, 32, 36, READ as usize].map(|place| word(&block, place));
    let is_in_ram = buffer >= RAM_START && u64::from(buffer) + u64::from(size) <= RAM_END;
    if !is_in_ram || start >= size || end >= size {
        return None;
    }
    let ring = machine.peek(buffer, size as usize);
    let (first, last) = (start as usize, end as usize);
    let bytes =
        if first <= last { ring[first..last].to_vec() } else { [&ring[first..], &ring[..last]].concat() };
    machine.poke(at + READ, &end.to_le_bytes());
    Some(Piece { start, end, bytes })
}

/// The address behind the last byte of RAM.
const RAM_END: u64 = RAM_START as u64 + RAM_BYTES as u64;

fn word(block: &[u8], place: usize) -> u32 {
    block[place..].first_chunk().copied().map_or(0, u32::from_le_bytes)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{chip::flash::START, machine::Options};

    const BLOCK: u32 = RAM_START + 0x100;
    const RING: u32 = RAM_START + 0x200;
    const SIZE: u32 = 8;

    /// A machine in whose RAM a firmware has put this ring, `abcdefgh`.
    fn machine(identification: &[u8], buffer: u32, write: u32, read: u32) -> Machine {
        let mut machine = Machine::new(Flash::default(), Options::default()).unwrap();
        let words = [1, 0, 0, buffer, SIZE, write, read, 1];
        machine.poke(BLOCK, identification);
        machine.poke(BLOCK + 16, &words.map(u32::to_le_bytes).concat());
        machine.poke(RING, b"abcdefgh");
        machine
    }

    fn taken(write: u32, read: u32) -> Vec<u8> {
        let mut machine = machine(b"SEGGER RTT\0\0\0\0\0\0", RING, write, read);
        let piece = take(&mut machine, BLOCK).unwrap();
        assert_eq!((piece.start, piece.end), (read, write));
        let again = take(&mut machine, BLOCK).unwrap();
        assert!(again.bytes.is_empty() && again.start == write, "the board knows what was read");
        piece.bytes
    }

    #[test]
    fn a_ring_is_read_from_where_it_was_left_and_around_its_end() {
        assert_eq!(taken(5, 2), b"cde");
        assert_eq!(taken(2, 5), b"fghab");
        assert_eq!(taken(0, 7), b"h");
        assert_eq!(taken(3, 3), b"");
    }

    #[test]
    fn what_is_no_ring_is_not_read() {
        let wrong = |identification: &[u8], buffer, write, read| {
            take(&mut machine(identification, buffer, write, read), BLOCK).is_none()
        };
        let right = b"SEGGER RTT\0";
        assert!(wrong(b"SEGGER RTX\0", RING, 1, 0));
        assert!(wrong(right, RING, SIZE, 0));
        assert!(wrong(right, RING, 0, SIZE));
        assert!(wrong(right, START, 1, 0));
        assert!(wrong(right, RAM_START + RAM_BYTES - SIZE + 1, 1, 0));
        assert!(wrong(right, u32::MAX, 1, 0));
    }

    #[test]
    fn only_the_pages_of_the_firmware_are_erased() {
        let firmware = crate::probe::tests::firmware();
        let mut flash = Flash::default();
        flash.load(START, &[0; 2 * PAGE as usize]);
        program(&mut flash, &firmware);
        let (page, rest) = flash.content().split_at(PAGE as usize);
        let bytes = &firmware.segments()[0].bytes;
        assert_eq!(&page[..bytes.len()], bytes);
        assert!(page[bytes.len()..].iter().all(|&byte| byte == 0xFF));
        assert!(rest[..PAGE as usize].iter().all(|&byte| byte == 0));
    }
}
