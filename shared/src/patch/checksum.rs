//! Checksum of patches, packets and whatever the board keeps.

/// Reflected polynomial of CRC-32/ISO-HDLC.
const POLYNOMIAL: u32 = 0xEDB8_8320;
/// Remainders of half a byte. A table for whole bytes, as libraries have, would take 1 kB of a flash that is full; without
/// any, images that are streamed cost the board frames.
static HALVES: [u32; 16] = remainders();

const fn remainders() -> [u32; 16] {
    let mut table = [0; 16];
    let mut half = 0;
    while half < 16 {
        let (mut rest, mut bit) = (half as u32, 0);
        while bit < 4 {
            rest = if rest & 1 == 1 { rest >> 1 ^ POLYNOMIAL } else { rest >> 1 };
            bit += 1;
        }
        table[half] = rest;
        half += 1;
    }
    table
}

/// CRC-32/ISO-HDLC of some parts, one after the other.
// Once on the board, not wherever it is asked for.
#[inline(never)]
#[must_use]
pub fn crc32(parts: &[&[u8]]) -> u32 {
    let mut rest = u32::MAX;
    for byte in parts.iter().flat_map(|part| part.iter()) {
        rest ^= u32::from(*byte);
        rest = rest >> 4 ^ HALVES[(rest & 15) as usize];
        rest = rest >> 4 ^ HALVES[(rest & 15) as usize];
    }
    !rest
}

#[cfg(test)]
mod tests {
    use super::*;
    use crc::{CRC_32_ISO_HDLC, Crc};

    #[test]
    fn it_is_the_catalogues_in_one_part_or_several() {
        // Check value of CRC-32/ISO-HDLC in the catalogue of parametrised CRC algorithms.
        assert_eq!(crc32(&[b"123456789"]), 0xcbf4_3926);
        assert_eq!(crc32(&[b"1234", b"", b"56789"]), 0xcbf4_3926);
    }

    proptest::proptest! {
        #[test]
        fn it_is_that_of_a_library(bytes in proptest::collection::vec(proptest::prelude::any::<u8>(), 0..300)) {
            let library = Crc::<u32>::new(&CRC_32_ISO_HDLC).checksum(&bytes);
            proptest::prop_assert_eq!(crc32(&[&bytes]), library);
        }
    }
}
