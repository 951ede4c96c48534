//! Checksum of patches, packets and whatever the board keeps.

use crc::{CRC_32_ISO_HDLC, Crc};

/// With a table of 1 kB: without one, images that are streamed cost the board frames.
static CRC32: Crc<u32> = Crc::<u32>::new(&CRC_32_ISO_HDLC);

/// CRC-32/ISO-HDLC of some parts, one after the other.
// Once on the board, not wherever it is asked for.
#[inline(never)]
#[must_use]
pub fn crc32(parts: &[&[u8]]) -> u32 {
    let mut digest = CRC32.digest();
    parts.iter().for_each(|part| digest.update(part));
    digest.finalize()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_is_the_catalogues_in_one_part_or_several() {
        // Check value of CRC-32/ISO-HDLC in the catalogue of parametrised CRC algorithms.
        assert_eq!(crc32(&[b"123456789"]), 0xcbf4_3926);
        assert_eq!(crc32(&[b"1234", b"", b"56789"]), 0xcbf4_3926);
    }
}
