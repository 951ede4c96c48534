//! Offset: how far another computer's clock is ahead of this one's.
//!
//! It is asked for its time. If question and answer took equally long it was read in the middle of both, so the offset is
//! its time less that middle, and wrong by half of the round trip at most (Mills, "Internet time synchronization: the
//! Network Time Protocol", 1991). Of the last answers the one that came fastest counts.

use std::collections::VecDeque;

/// So many answers are kept: those of some seconds, in which crystals run apart by less than a millisecond.
const KEPT: usize = 8;

/// What is known of another computer's clock.
#[derive(Clone, Debug, Default)]
pub(crate) struct Offset {
    answers: VecDeque<Answer>,
}

/// One answer, ns.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Answer {
    /// By how much its clock was ahead.
    pub(crate) ahead: i64,
    /// By how much that is wrong at most.
    pub(crate) doubt: u64,
}

impl Offset {
    /// It was asked at `asked` and answered at `answered` by this computer's clock, and said `theirs`, ns since 1970.
    pub(crate) fn hear(&mut self, asked: u64, theirs: u64, answered: u64) {
        // The clock was set back meanwhile.
        let Some(round_trip) = answered.checked_sub(asked) else { return };
        if self.answers.len() == KEPT {
            self.answers.pop_front();
        }
        let middle = asked + round_trip / 2;
        self.answers
            .push_back(Answer { ahead: theirs.wrapping_sub(middle) as i64, doubt: round_trip.div_ceil(2) });
    }

    /// The best answer; none before there is one.
    pub(crate) fn best(&self) -> Option<Answer> {
        self.answers.iter().copied().min_by_key(|answer| answer.doubt)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const START: u64 = 1_700_000_000_000_000_000;

    proptest! {
        #[test]
        fn it_is_within_its_doubt_whatever_the_way_takes(
            ahead in -5_000_000_000_i64..5_000_000_000,
            ways in prop::collection::vec((0_u64..20_000_000, 0_u64..20_000_000), 1..30),
        ) {
            let mut offset = Offset::default();
            for (index, (there, back)) in ways.iter().enumerate() {
                let asked = START + index as u64 * 1_000_000_000;
                offset.hear(asked, (asked + there).saturating_add_signed(ahead), asked + there + back);
            }
            let best = offset.best().unwrap();
            prop_assert!((best.ahead - ahead).unsigned_abs() <= best.doubt + 1, "{best:?}");
            let last = &ways[ways.len().saturating_sub(KEPT)..];
            let fastest = last.iter().map(|(there, back)| (there + back).div_ceil(2)).min();
            prop_assert_eq!(Some(best.doubt), fastest);
        }

        #[test]
        fn no_times_panic(asked: u64, theirs: u64, answered: u64) {
            Offset::default().hear(asked, theirs, answered);
        }
    }

    #[test]
    fn answers_across_a_clock_that_was_set_back_do_not_count() {
        let mut offset = Offset::default();
        offset.hear(START, START, START - 1);
        assert_eq!(offset.best(), None);
    }
}
