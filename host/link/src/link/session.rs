//! Session: numbers that tell the requests of one link from those of all others.
//!
//! A serial line outlives its hosts: a reply to the last one may still be on its way, or come late, when the next one
//! asks. So the upper half of a request's sequence number is drawn anew for each link; the lower half counts.

use std::hash::{BuildHasher, Hasher, RandomState};

/// The number before a session's first request.
pub(super) fn begin() -> u32 {
    // The standard library seeds it with the system's random numbers.
    let drawn = RandomState::new().build_hasher().finish() as u16;
    u32::from(drawn.max(1)) << 16
}

/// The number of the request after that one: of the same session, and never of none.
pub(super) fn next(sequence: u32) -> u32 {
    sequence & 0xffff_0000 | u32::from((sequence as u16).wrapping_add(1))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_session_keeps_its_number_and_belongs_to_somebody() {
        let mut sequence = begin();
        let session = sequence >> 16;
        assert_ne!(session, 0);
        for _ in 0..70_000 {
            let before = sequence;
            sequence = next(sequence);
            assert_eq!(sequence >> 16, session);
            assert_ne!(sequence, before);
        }
    }

    #[test]
    fn sessions_differ() {
        let sessions: std::collections::BTreeSet<_> = (0..100).map(|_| begin()).collect();
        assert!(sessions.len() > 95, "{sessions:?}");
    }
}
