//! Sequence: numbers that tell the requests of one link from each other, and from those of the host before.
//!
//! A serial line outlives its hosts: a reply to the last one may still be on its way when the next one asks. So each
//! link begins at a number that it draws, and takes one such reply in 65,535 for its own.

use super::hello::HELLO_SEQUENCE;
use std::hash::{BuildHasher, Hasher, RandomState};

/// The number before a link's first request.
pub(super) fn begin() -> u16 {
    // The standard library seeds it with the system's random numbers.
    RandomState::new().build_hasher().finish() as u16
}

/// The number of the request after that one.
pub(super) fn next(sequence: u16) -> u16 {
    sequence.checked_add(1).unwrap_or(HELLO_SEQUENCE + 1)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeSet;

    #[test]
    fn a_link_uses_all_numbers_but_that_of_hello() {
        let mut sequence = begin();
        let mut used = BTreeSet::new();
        for _ in 0..u16::MAX {
            sequence = next(sequence);
            assert!(used.insert(sequence));
        }
        assert!(!used.contains(&HELLO_SEQUENCE));
    }

    #[test]
    fn links_begin_anywhere() {
        let begins: BTreeSet<_> = (0..100).map(|_| begin()).collect();
        assert!(begins.len() > 90, "{begins:?}");
    }
}
