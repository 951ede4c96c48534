//! Wiring: which electrodes count, as their tests go from frame to frame.
//!
//! What needs a bad electrode means nothing. As one becomes bad, or good again, all voltages may change, as a short or an
//! electrode that is gone leads the current another way: that is no press, whatever it looks like.

use crate::{
    frame::ElectrodeTest,
    health::{ElectrodeSet, square},
    limits::MAX_ELECTRODES,
};

/// So many frames after a change the reference takes all that is new: the change may lie within a frame.
const SETTLES: u8 = 3;
/// After so many frames in which nothing is wrong with a bad electrode it counts again.
const RETURNS: u8 = 25;
/// An electrode touches worse if its test has grown to this many times what it was, beside those of the others.
const WORSE: f32 = 1.25;
/// And no longer if it is less than this many times.
const BETTER: f32 = 1.12;
/// A test below this part of the usual one says nothing: an electrode beside it is off, or shorted.
const NOTHING: f32 = 0.2;

/// Which electrodes are bad.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Wiring {
    bad: ElectrodeSet,
    /// Those of the latest frame.
    latest: ElectrodeSet,
    /// Frames to come in which the reference takes all that is new.
    settling: u8,
    /// Frames since bad electrodes seemed to be good again.
    returning: u8,
    /// Squares of the tests when the reference was made, upper halves of an `f32`, as memory is short: `[electrode]`.
    at_reference: [u16; MAX_ELECTRODES],
    /// Electrodes whose tests were clipped then.
    clipped: ElectrodeSet,
}

impl Wiring {
    /// Takes in what a frame says; gives the electrodes that touch worse.
    pub(super) fn see(&mut self, bad: ElectrodeSet, tests: &[ElectrodeTest]) -> ElectrodeSet {
        let worse = self.worse(tests).without(bad);
        self.take(bad.union(worse));
        worse
    }

    /// Takes in which electrodes a frame shows to be bad.
    pub(super) fn take(&mut self, now: ElectrodeSet) {
        let has_changed = core::mem::replace(&mut self.latest, now) != now;
        self.bad = self.bad.union(now);
        self.returning = if has_changed || self.bad == now { 0 } else { self.returning + 1 };
        let have_returned = self.returning > RETURNS;
        if have_returned {
            (self.bad, self.returning) = (now, 0);
        }
        if has_changed || have_returned {
            self.settling = SETTLES;
        }
    }

    /// Electrodes that count for nothing.
    pub(super) fn bad(&self) -> ElectrodeSet {
        self.bad
    }

    /// A reference is being made of frames from here on.
    pub(super) fn begin(&mut self) {
        self.settling = 0;
    }

    /// The reference is made; these are the tests of its last frame.
    pub(super) fn keep(&mut self, tests: &[ElectrodeTest]) {
        let upper_half = |test| (square(test).to_bits() >> 16) as u16;
        self.at_reference.iter_mut().zip(tests).for_each(|(before, test)| *before = upper_half(test));
        self.clipped = clipped(tests);
    }

    /// Whether the reference takes all that is new in this frame.
    pub(super) fn is_settling(&self) -> bool {
        self.settling > 0
    }

    /// It has taken it; says whether that was the last such frame.
    pub(super) fn has_settled(&mut self) -> bool {
        self.settling = self.settling.saturating_sub(1);
        self.settling == 0
    }

    /// Electrodes whose tests have grown, as far as they show it, beside those of the others; none before a reference.
    fn worse(&self, tests: &[ElectrodeTest]) -> ElectrodeSet {
        let before = || self.at_reference.iter().map(|half| f32::from_bits(u32::from(*half) << 16));
        let pairs = || (0..).zip(tests.iter().map(square).zip(before()));
        let (mut all, mut all_before) = (0.0, 0.0);
        for (_, (size, before)) in pairs().filter(|(electrode, _)| !self.bad.contains(*electrode)) {
            (all, all_before) = (all + size, all_before + before);
        }
        let least = NOTHING * NOTHING * all_before / tests.len() as f32;
        // A test that has come to the end of its range is larger than it reads.
        let mut worse = ElectrodeSet::default();
        if all_before > 0.0 {
            worse = clipped(tests).without(self.clipped);
        }
        for (electrode, (size, before)) in pairs() {
            let limit = if self.bad.contains(electrode) { BETTER } else { WORSE };
            if size * all_before > limit * limit * before * all && before > least && size > least {
                worse.insert(electrode);
            }
        }
        worse
    }
}

/// Electrodes whose tests are clipped.
fn clipped(tests: &[ElectrodeTest]) -> ElectrodeSet {
    let mut set = ElectrodeSet::default();
    (0..).zip(tests).filter(|(_, test)| test.is_clipped).for_each(|(electrode, _)| set.insert(electrode));
    set
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::units::AdcCode;

    fn tests_of(values: [i32; 8]) -> std::vec::Vec<ElectrodeTest> {
        values.map(|value| ElectrodeTest { in_phase: AdcCode(value), ..ElectrodeTest::default() }).to_vec()
    }

    /// Takes in a frame as the pipeline does; gives worse electrodes, bad ones, and whether it settles.
    fn see(wiring: &mut Wiring, open: u16, values: [i32; 8]) -> (u16, u16, bool) {
        let worse = wiring.see(ElectrodeSet(open), &tests_of(values));
        let is_settling = wiring.is_settling();
        if is_settling {
            wiring.has_settled();
        }
        (worse.0, wiring.bad().0, is_settling)
    }

    fn tared() -> Wiring {
        let mut wiring = Wiring::default();
        wiring.keep(&tests_of([1_000_000; 8]));
        wiring
    }

    #[test]
    fn an_electrode_that_comes_off_and_back_settles_both_times_and_counts_again_later() {
        let (mut wiring, good) = (tared(), [1_000_000; 8]);
        assert_eq!(see(&mut wiring, 0, good), (0, 0, false));
        for is_settling in [true, true, true, false, false] {
            assert_eq!(see(&mut wiring, 4, good), (0, 4, is_settling));
        }
        for frame in 0..=i32::from(RETURNS) {
            assert_eq!(see(&mut wiring, 0, good), (0, 4, frame < 3), "{frame}");
        }
        for is_settling in [true, true, true, false] {
            assert_eq!(see(&mut wiring, 0, good), (0, 0, is_settling));
        }
    }

    #[test]
    fn a_contact_is_worse_beside_the_others_and_stays_so_until_it_is_clearly_better() {
        let mut wiring = tared();
        let one = |value: i32, others: i32| {
            let mut values = [others; 8];
            values[5] = value;
            values
        };
        assert_eq!(see(&mut wiring, 0, one(1_200_000, 1_000_000)).0, 0);
        assert_eq!(see(&mut wiring, 0, one(2_000_000, 2_000_000)).0, 0, "the sheet changed");
        assert_eq!(see(&mut wiring, 0, one(2_700_000, 2_000_000)).0, 1 << 5);
        assert_eq!(see(&mut wiring, 0, one(1_200_000, 1_000_000)).0, 1 << 5);
        assert_eq!(see(&mut wiring, 0, one(1_050_000, 1_000_000)).0, 0);
    }

    #[test]
    fn a_test_that_has_come_to_the_end_of_its_range_has_grown() {
        let mut wiring = tared();
        let mut now = tests_of([1_000_000; 8]);
        now[4] = ElectrodeTest { in_phase: AdcCode(1_100_000), is_clipped: true, ..now[4] };
        assert_eq!(wiring.see(ElectrodeSet(0), &now).0, 1 << 4);
        assert_eq!(wiring.see(ElectrodeSet(1 << 4), &now).0, 0, "it is known to be off");
        wiring.keep(&now);
        assert_eq!(wiring.see(ElectrodeSet(0), &now).0, 0, "it was so in the tare");
        assert_eq!(Wiring::default().see(ElectrodeSet(0), &now).0, 0, "nothing is known of before");
    }

    #[test]
    fn tests_that_say_nothing_blame_no_electrode() {
        let mut wiring = Wiring::default();
        let mut values = [1_000_000; 8];
        values[2] = 900;
        wiring.keep(&tests_of(values));
        assert_eq!(see(&mut wiring, 1 << 3, values).0, 0);
        values[2] = 3000;
        assert_eq!(see(&mut wiring, 1 << 3, values).0, 0, "the electrode behind it was off in the tare");
        assert_eq!(see(&mut tared(), 0, [0; 8]).0, 0, "no current");
        assert_eq!(Wiring::default().see(ElectrodeSet(0), &tests_of([1_000_000; 8])).0, 0, "no reference");
    }
}
