//! Memory: filters and frames of one FDCAN (RM0440 44.3.7, "Message RAM"). The core and the FDCAN read and write it by words.

use super::frame::{Format, Frame, LENGTHS};
use crate::chip::{
    bank::Bank,
    map::Register,
    misuse::Misuse,
    peripheral::{Moment, Peripheral, has_bank},
};

/// Frames in each FIFO, and transmit buffers.
pub(super) const FRAMES: usize = 3;
/// Words of a frame: two of its head, and its data.
const WORDS: usize = 18;

const RECEIVED: [&str; 2] = ["RXFIFO0", "RXFIFO1"];

/// Model of the memory.
#[derive(Clone, Debug)]
pub struct MessageRam {
    bank: Bank,
    /// Transmit buffers that the FDCAN is to send.
    pub(super) pending: [bool; FRAMES],
}

impl MessageRam {
    /// The memory of that name, with what lay there when the power came up.
    #[must_use]
    pub fn new(name: &str) -> Self {
        let mut bank = Bank::new(name, &[]);
        let map = bank.map;
        for register in map.registers() {
            bank.store(register, 0xA5C3_0F69_u32.rotate_left(register.offset));
        }
        Self { bank, pending: [false; FRAMES] }
    }

    /// A standard filter.
    pub(super) fn filter(&self, place: usize) -> u32 {
        self.bank.word("FLSSA", place)
    }

    /// What lies in a transmit buffer.
    pub(super) fn to_send(&self, buffer: usize) -> Result<Frame, String> {
        let word = |place: usize| self.bank.word("TXBUF", buffer * WORDS + place);
        let (head, control) = (word(0), word(1));
        let bit = |word: u32, bit: u32| word >> bit & 1 == 1;
        if bit(head, 30) || bit(head, 29) {
            return Err(
                "frames with long identifiers and remote frames are not modelled (XTD, RTR)".to_owned()
            );
        }
        if bit(control, 23) {
            return Err("the FIFO of transmit events is not modelled (EFC)".to_owned());
        }
        let format = match (bit(control, 21), bit(control, 20)) {
            (true, true) => Format::Switching,
            (true, false) => Format::Fd,
            (false, false) => Format::Classic,
            (false, true) => return Err("BRS without FDF".to_owned()),
        };
        let length = LENGTHS[(control >> 16 & 0xF) as usize];
        if format == Format::Classic && length > 8 {
            return Err("a classic frame of more than 8 bytes".to_owned());
        }
        let data = (0..length.div_ceil(4)).flat_map(|place| word(2 + place).to_le_bytes());
        Ok(Frame { identifier: (head >> 18 & 0x7FF) as u16, format, data: data.take(length).collect() })
    }

    /// Puts a frame into a FIFO, with the filter that it matched if it did.
    pub(super) fn store(&mut self, fifo: usize, place: usize, frame: &Frame, filter: Option<usize>) {
        let bits = match frame.format {
            Format::Classic => 0,
            Format::Fd => 1 << 21,
            Format::Switching => 3 << 20,
        };
        let matched = filter.map_or(1 << 31, |filter| (filter as u32) << 24);
        let words = [u32::from(frame.identifier) << 18, matched | bits | frame.length_code() << 16];
        let data = frame.data.chunks(4).map(|bytes| {
            let mut four = [0; 4];
            four[..bytes.len()].copy_from_slice(bytes);
            u32::from_le_bytes(four)
        });
        for (at, word) in words.into_iter().chain(data).enumerate() {
            self.bank.set_word(RECEIVED[fifo], place * WORDS + at, word);
        }
    }
}

impl Peripheral for MessageRam {
    has_bank!();

    fn models(&self, register: &Register) -> bool {
        register.name != "TXEFIFO"
    }

    fn words_only(&self) -> bool {
        true
    }

    fn write(&mut self, register: &Register, value: u32, _: Moment) -> Result<(), Misuse> {
        if register.name == "TXBUF" && self.pending[register.index / WORDS] {
            let rule = format!("buffer {} is written while it is to be sent", register.index / WORDS);
            return Err(Misuse::rule(self.bank.map.name, rule));
        }
        self.bank.store(register, value);
        Ok(())
    }

    /// A reset leaves memory as it is.
    fn reset(&mut self) {}
}
