//! Whole: whether the lengths in a record fit into it, as the library takes them for granted and makes room first.

use mcap::records::op;

/// Whether all that a record of this kind says it holds is in it; of other kinds than are read here nothing is known.
pub(crate) fn is_whole(opcode: u8, data: &[u8]) -> bool {
    let mut rest = Rest(data);
    let fits = match opcode {
        // Numbers of channel and schema, topic, encoding, metadata.
        op::CHANNEL => {
            rest.skip(4).and_then(|()| rest.text()).and_then(|()| rest.text()).and_then(|()| rest.map())
        }
        // Name, metadata.
        op::METADATA => rest.text().and_then(|()| rest.map()),
        // Two times, name, type, and at least content's length and checksum.
        op::ATTACHMENT => {
            rest.skip(16).and_then(|()| rest.text()).and_then(|()| rest.text()).and_then(|()| rest.skip(12))
        }
        _ => Some(()),
    };
    fits.is_some()
}

/// What is left of a record.
struct Rest<'a>(&'a [u8]);

impl Rest<'_> {
    fn skip(&mut self, count: usize) -> Option<()> {
        self.0 = self.0.get(count..)?;
        Some(())
    }

    fn length(&mut self) -> Option<usize> {
        let (length, rest) = self.0.split_first_chunk()?;
        self.0 = rest;
        usize::try_from(u32::from_le_bytes(*length)).ok()
    }

    fn text(&mut self) -> Option<()> {
        let length = self.length()?;
        self.skip(length)
    }

    /// Pairs of texts, and how many bytes they all are.
    fn map(&mut self) -> Option<()> {
        let length = self.length()?;
        let mut pairs = Rest(self.0.get(..length)?);
        while !pairs.0.is_empty() {
            pairs.text()?;
            pairs.text()?;
        }
        self.skip(length)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn text(text: &str) -> Vec<u8> {
        [&(text.len() as u32).to_le_bytes(), text.as_bytes()].concat()
    }

    fn map(key: &str, value: &str) -> Vec<u8> {
        let pair = [text(key), text(value)].concat();
        [&(pair.len() as u32).to_le_bytes()[..], &pair].concat()
    }

    #[test]
    fn a_record_that_says_it_holds_more_than_there_is_is_not_whole() {
        let records = [
            (op::CHANNEL, [vec![0; 4], text("/tf"), text("cdr"), map("offered", "x")].concat()),
            (op::METADATA, [text("dermatome"), map("skin", "palm")].concat()),
            (
                op::ATTACHMENT,
                [vec![0; 16], text("skin.toml"), text("application/toml"), vec![0; 12]].concat(),
            ),
        ];
        for (opcode, record) in records {
            assert!(is_whole(opcode, &record), "{opcode}");
            for length in 0..record.len() {
                assert!(!is_whole(opcode, &record[..length]), "{length} bytes of {opcode}");
            }
        }
        // What a fuzzer has found: an encoding of 4 GB.
        let found = [&[0; 4][..], &0_u32.to_le_bytes(), &[0xFF; 4], &[0; 20]].concat();
        assert!(!is_whole(op::CHANNEL, &found));
        assert!(is_whole(op::MESSAGE, &[]));
    }
}
