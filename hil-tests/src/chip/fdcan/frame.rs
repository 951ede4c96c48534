//! Frames: what goes over a CAN bus, and how long it takes (ISO 11898-1, RM0440 44.3.3): data frames with identifiers of 11
//! bits.

use crate::chip::time::Time;

/// How many bytes a frame can have, by its length code; a classic one has 8 at most.
pub const LENGTHS: [usize; 16] = [0, 1, 2, 3, 4, 5, 6, 7, 8, 12, 16, 20, 24, 32, 48, 64];
/// Bits from the acknowledgement on: itself, its delimiter and the end of the frame.
pub const AFTER_CRC: u64 = 9;
/// Bits between two frames.
pub const INTERMISSION: u64 = 3;
/// Bits of an error frame, at its longest: the flags of two that notice one after the other, and the delimiter.
pub const ERROR: u64 = 12 + 8;

/// How a frame is laid out.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// Up to 8 bytes, as CAN always had them.
    Classic,
    /// The FD format at one rate.
    Fd,
    /// The FD format, its middle at the data rate.
    Switching,
}

/// One data frame.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Frame {
    /// Its identifier, 11 bits.
    pub identifier: u16,
    /// How it is laid out.
    pub format: Format,
    /// Its data, of one of [`LENGTHS`].
    pub data: Vec<u8>,
}

/// Bits per second.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Rates {
    /// Where several may send at once.
    pub nominal: u64,
    /// In the middle of frames that switch.
    pub data: u64,
}

impl Rates {
    /// So many bits at the nominal rate.
    #[must_use]
    pub fn bits(self, count: u64) -> Time {
        Time::period(self.nominal) * count
    }

    /// Whether a node of these rates understands another one's frame. Half a per cent is what two crystals are never apart.
    #[must_use]
    pub fn agree(self, other: Self, format: Format) -> bool {
        let close = |one: u64, other: u64| one.abs_diff(other) * 200 < one;
        close(self.nominal, other.nominal) && (format != Format::Switching || close(self.data, other.data))
    }
}

impl Frame {
    /// The code of its length.
    #[must_use]
    pub fn length_code(&self) -> u32 {
        LENGTHS.iter().position(|&length| length == self.data.len()).unwrap_or(0) as u32
    }

    /// From the start of the frame to its end, the space to the next one not included.
    #[must_use]
    pub fn duration(&self, rates: Rates) -> Time {
        self.until_acknowledged(rates) + rates.bits(AFTER_CRC)
    }

    /// From the start of the frame to the acknowledgement.
    #[must_use]
    pub fn until_acknowledged(&self, rates: Rates) -> Time {
        let bits = self.bits();
        if self.format == Format::Classic {
            return rates.bits(stuffed(&bits, bits.len()) + 1);
        }
        let switch = if self.format == Format::Switching { 17 } else { bits.len() };
        let nominal = stuffed(&bits, switch);
        // Stuff count and CRC have a stuff bit before each four of their bits; the delimiter follows.
        let check: u64 = if self.data.len() <= 16 { 4 + 17 } else { 4 + 21 };
        let rest = stuffed(&bits, bits.len()) - nominal + check + check.div_ceil(4) + 1;
        let rate = if self.format == Format::Switching { rates.data } else { rates.nominal };
        rates.bits(nominal) + Time::period(rate) * rest
    }

    /// Whether it has a recessive bit where another one of the same identifier has a dominant one first; none if they are
    /// the same.
    #[must_use]
    pub fn is_recessive_beside(&self, other: &Self) -> Option<bool> {
        let (own, other) = (self.bits(), other.bits());
        own.iter().zip(&other).find(|(own, other)| own != other).map(|(&own, _)| own)
    }

    /// Its bits as far as stuff bits are put between them where five are alike, without those; recessive is true.
    fn bits(&self) -> Vec<bool> {
        let mut bits = vec![false];
        let mut push = |value: u32, count: u32| {
            bits.extend((0..count).rev().map(|bit| value >> bit & 1 == 1));
        };
        push(self.identifier.into(), 11);
        match self.format {
            // RTR, IDE, r0.
            Format::Classic => push(0b000, 3),
            // RRS, IDE, FDF, res, BRS, ESI.
            Format::Fd => push(0b00_1000, 6),
            Format::Switching => push(0b00_1010, 6),
        }
        push(self.length_code(), 4);
        self.data.iter().for_each(|&byte| push(byte.into(), 8));
        if self.format == Format::Classic {
            let crc = crc_15(&bits);
            bits.extend((0..15).rev().map(|bit| crc >> bit & 1 == 1));
        }
        bits
    }
}

/// How long the first so many of these bits are with their stuff bits.
fn stuffed(bits: &[bool], count: usize) -> u64 {
    let (mut length, mut run, mut last) = (0, 0, true);
    for &bit in &bits[..count] {
        run = if bit == last { run + 1 } else { 1 };
        last = bit;
        length += 1;
        if run == 5 {
            (run, last) = (1, !bit);
            length += 1;
        }
    }
    length
}

/// The CRC of a classic frame.
fn crc_15(bits: &[bool]) -> u16 {
    bits.iter().fold(0, |crc, &bit| {
        let flips = bit != (crc >> 14 & 1 == 1);
        (crc << 1 & 0x7FFF) ^ if flips { 0x4599 } else { 0 }
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    const RATES: Rates = Rates { nominal: 1_000_000, data: 2_000_000 };

    fn frame(format: Format, data: &[u8]) -> Frame {
        Frame { identifier: 0x555, format, data: data.to_vec() }
    }

    #[test]
    fn frames_take_the_bits_of_the_standard() {
        let micros = |format, data: &[u8]| frame(format, data).duration(RATES).seconds() * 1e6;
        // A classic frame of 8 bytes has 108 bits, and at most 24 stuff bits.
        let classic = micros(Format::Classic, &[0x55; 8]);
        assert!((108.0..=132.0).contains(&classic), "{classic}");
        // 29 bits at the nominal rate around 4 + 5 + 512 + 32 + 1 others; 0x55 has no stuff bits.
        let long = micros(Format::Switching, &[0x55; 64]);
        assert!((17.0 + 9.0 + 275.0..=17.0 + 9.0 + 278.0).contains(&long), "{long}");
        // After five alike, each four that are alike with the stuff bit before them.
        let mut worst = [0x87; 64];
        worst[0] = 0x07;
        let stuffed = micros(Format::Switching, &worst);
        assert!((stuffed - long - 64.0).abs() < 2.0, "a stuff bit for each four of 512: {stuffed}");
        assert!((micros(Format::Fd, &[0x55; 64]) - 2.0 * 275.0 - 26.0).abs() < 4.0);
    }

    #[test]
    fn stuff_bits_count_towards_the_next_run() {
        assert_eq!(stuffed(&[false; 5], 5), 6);
        assert_eq!(stuffed(&[false, false, false, false, false, true, true, true, true], 9), 11);
        assert_eq!(stuffed(&[false; 9], 9), 10, "four follow the stuff bit");
    }

    #[test]
    fn the_first_bit_that_differs_decides() {
        let (zero, one) = (frame(Format::Switching, &[0x10]), frame(Format::Switching, &[0x18]));
        assert_eq!(one.is_recessive_beside(&zero), Some(true));
        assert_eq!(zero.is_recessive_beside(&one), Some(false));
        assert_eq!(zero.is_recessive_beside(&zero), None);
    }

    #[test]
    fn rates_agree_where_crystals_do() {
        let off = Rates { nominal: 1_001_000, data: 2_002_000 };
        assert!(RATES.agree(off, Format::Switching));
        let wrong = Rates { data: 5_000_000, ..RATES };
        assert!(!RATES.agree(wrong, Format::Switching) && RATES.agree(wrong, Format::Fd));
        assert!(!RATES.agree(Rates { nominal: 500_000, ..RATES }, Format::Classic));
    }
}
