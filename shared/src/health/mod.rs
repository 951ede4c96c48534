//! Health: what each frame says about electrodes, multiplexers and the current source.
//!
//! The test of an electrode ([`crate::acquire::scan::test_step`]) reads its contact impedance and what the sheet
//! adds. Compared with the median of all electrodes:
//!
//! | test reads              | means                                                        |
//! |-------------------------|--------------------------------------------------------------|
//! | far more; clipped, and more or next to nothing | the electrode is open                 |
//! | something, but the one before next to nothing | the same                                |
//! | next to nothing         | it is shorted to a neighbour, or that neighbour is open      |
//! | all next to nothing     | no current flows                                             |
//!
//! A multiplexer that connects the wrong electrode shows in voltages that are no longer equal when
//! drive and sense are exchanged, or that differ from the reference more than any press could explain.

pub(crate) mod median;
pub mod restart;

use crate::{
    frame::{ElectrodeTest, Frame, FrameFlags},
    limits::{MAX_ELECTRODES, MAX_MEASUREMENTS},
    patch::PatchView,
};
use heapless::Vec;
use median::median;
use postcard_schema::Schema;
use serde::{Deserialize, Serialize};

/// A test this many times the median reads open.
const OPEN_RATIO: f32 = 5.0;
/// One that is clipped reads open at this many times: it is larger than it reads.
const CLIPPED_RATIO: f32 = 2.0;
/// A test this part of the median reads shorted.
const SHORTED_RATIO: f32 = 0.2;
/// A median below this reads no current: two LSB at gain 1.
const NO_CURRENT: f32 = 8192.0;
/// Voltages that differ by more than this part of them are not reciprocal.
const RECIPROCITY: f32 = 0.3;
/// Share of pairs that may, since a voltage near zero says nothing: one in this many.
const RECIPROCITY_SHARE: usize = 12;
/// Fastest carrier, Hz, at which they say that something is wrong: above it the capacitance of all leads makes those of
/// a good skin differ (docs/hardware.md).
const RECIPROCAL_UP_TO: f32 = 60e3;

/// Electrodes, one bit each.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub struct ElectrodeSet(pub u16);

impl ElectrodeSet {
    /// Whether it holds an electrode, from 0.
    #[must_use]
    pub const fn contains(self, electrode: u8) -> bool {
        self.0 >> (electrode & 15) & 1 == 1
    }

    /// Adds an electrode, from 0.
    pub const fn insert(&mut self, electrode: u8) {
        self.0 |= 1 << (electrode & 15);
    }

    /// Electrodes in either set.
    #[must_use]
    pub const fn union(self, other: Self) -> Self {
        Self(self.0 | other.0)
    }

    /// Electrodes of this set that another does not hold.
    #[must_use]
    pub const fn without(self, other: Self) -> Self {
        Self(self.0 & !other.0)
    }

    /// Whether it holds none.
    #[must_use]
    pub const fn is_empty(self) -> bool {
        self.0 == 0
    }

    /// The electrodes, from 0.
    pub fn iter(self) -> impl Iterator<Item = u8> {
        (0..MAX_ELECTRODES as u8).filter(move |&electrode| self.contains(electrode))
    }
}

/// What one frame says.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, Schema)]
pub struct Health {
    /// Contact impedance, ohm: `[electrode]`; the whole test's impedance where the patch does not know
    /// what the sheet adds; infinite where the test is clipped, so that a smaller current is needed to measure
    /// it, and without current. Empty if electrodes are not tested, and until [`Self::measure_contacts`].
    pub contact_impedance: Vec<f32, MAX_ELECTRODES>,
    /// Electrodes without contact.
    pub open: ElectrodeSet,
    /// Electrodes connected to a neighbour.
    pub shorted: ElectrodeSet,
    /// Electrodes that touch worse than when the reference was made.
    pub worse: ElectrodeSet,
    /// Sum of |v - v exchanged| over sum of |v|, for patches that measure both.
    pub reciprocity_error: Option<f32>,
}

/// What a board knows of itself beside its frames.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize, Schema)]
pub struct Vitals {
    /// Temperature of the chip, degrees Celsius; none if it cannot tell.
    pub temperature: Option<f32>,
    /// Share of time in which its CPU works, 0 to 1.
    pub load: f32,
    /// Bytes of stack that were never used.
    pub free_stack: u32,
}

/// Hottest a chip may be, degrees Celsius (the STM32G474's ambient limit is 85).
pub const HOT: f32 = 85.0;

impl Health {
    /// Looks at one frame with a carrier of this `frequency` (Hz); gives the flags that follow.
    #[must_use]
    pub fn examine(patch: &PatchView<'_>, frequency: f32, frame: &Frame) -> (Self, FrameFlags) {
        let mut flags = FrameFlags::default();
        let mut health = Self::default();
        health.judge_electrodes(&frame.tests, &mut flags);
        let is_off = health.compare_reciprocal(patch, frame);
        flags.insert_if(FrameFlags::NOT_RECIPROCAL, is_off && frequency <= RECIPROCAL_UP_TO);
        (health, flags)
    }

    /// Electrodes whose measurements mean nothing.
    #[must_use]
    pub fn bad_electrodes(&self) -> ElectrodeSet {
        self.open.union(self.shorted).union(self.worse)
    }

    fn judge_electrodes(&mut self, tests: &[ElectrodeTest], flags: &mut FrameFlags) {
        if are_alike(tests) {
            return;
        }
        let count = tests.len();
        // Squares are in the same order, and cost no root.
        let sizes: Vec<f32, MAX_ELECTRODES> = tests.iter().map(square).collect();
        let Some(median) = median(&mut sizes.clone()) else { return };
        if median < NO_CURRENT * NO_CURRENT {
            flags.insert(FrameFlags::NO_CURRENT);
            return;
        }
        let is_low = |e: usize| {
            sizes.get(e % count).is_some_and(|&size| size < SHORTED_RATIO * SHORTED_RATIO * median)
        };
        // Without an electrode no current flows in the test before its own, and often none in the one after.
        let is_behind_low = |e: usize| is_low(e + count - 1) && !is_low(e) && !is_low(e + count - 2);
        let is_open = |e: usize| {
            let test = tests.get(e % count).zip(sizes.get(e % count));
            let is_far = test.is_some_and(|(test, &size)| {
                let ratio = open_ratio(test.is_clipped);
                size > ratio * ratio * median || test.is_clipped && is_low(e)
            });
            is_far || (is_behind_low(e) && !is_behind_low(e + count - 2))
        };
        for electrode in 0..count {
            if is_open(electrode) {
                self.open.insert(electrode as u8);
            } else if is_low(electrode) && !is_open(electrode + 1) && !is_open(electrode + count - 1) {
                self.shorted.insert(electrode as u8);
            }
        }
        flags.insert_if(FrameFlags::OPEN_ELECTRODE, !self.open.is_empty());
        flags.insert_if(FrameFlags::SHORTED_ELECTRODE, !self.shorted.is_empty());
    }

    /// Contact impedances from the electrodes' tests, for those who want to see them: what the tests' impedances
    /// Z are as a resistance with a capacitance beside it, |Z|^2 / Re Z, less what the sheet adds. The capacitance
    /// is mostly that of all leads, through which current leaves the skin.
    pub fn measure_contacts(&mut self, patch: &PatchView<'_>, ohms_per_code: f32, tests: &[ElectrodeTest]) {
        self.contact_impedance.clear();
        let of_sheet = &patch.header.test_resistances;
        for (electrode, test) in tests.iter().enumerate() {
            let beside = square(test) / test.in_phase.0 as f32 * ohms_per_code;
            let is_measured = !test.is_clipped && beside.is_finite();
            let ohms = beside - of_sheet.get(electrode).unwrap_or(&0.0);
            let _ = self.contact_impedance.push(if is_measured { ohms } else { f32::INFINITY });
        }
    }

    /// Compares each measurement's two steps, where it has two; says whether too many are apart.
    fn compare_reciprocal(&mut self, patch: &PatchView<'_>, frame: &Frame) -> bool {
        if patch.header.steps <= patch.header.measurements {
            return false;
        }
        let mut first: Vec<Option<i32>, MAX_MEASUREMENTS> = Vec::new();
        let _ = first.resize(usize::from(patch.header.measurements).min(MAX_MEASUREMENTS), None);
        let (mut pairs, mut off) = (0, 0);
        let (mut difference, mut size) = (0.0_f32, 0.0_f32);
        for (code, target) in frame.codes.iter().zip(patch.combination()) {
            let Some(entry) = first.get_mut(usize::from(target.measurement)) else { continue };
            let value = if target.flipped { -code.0 } else { code.0 };
            let Some(other) = entry.replace(value) else { continue };
            let (apart, both) =
                (value.abs_diff(other) as f32, (value.unsigned_abs() as f32) + other.unsigned_abs() as f32);
            pairs += 1;
            off += usize::from(apart > RECIPROCITY * both / 2.0);
            difference += apart;
            size += both / 2.0;
        }
        if pairs > 0 {
            self.reciprocity_error = Some(if size > 0.0 { difference / size } else { 0.0 });
        }
        off * RECIPROCITY_SHARE > pairs
    }
}

/// Whether tests lie so close together that, whichever is the median, no electrode is open or shorted: as
/// they do on most frames.
fn are_alike(tests: &[ElectrodeTest]) -> bool {
    let (mut least, mut most) = (f32::INFINITY, 0.0);
    for size in tests.iter().map(square) {
        // Not `min` and `max`, which are calls on the board.
        least = if size < least { size } else { least };
        most = if size > most { size } else { most };
    }
    let ratio = open_ratio(tests.iter().any(|test| test.is_clipped));
    let is_low = least < SHORTED_RATIO * SHORTED_RATIO * most || least < NO_CURRENT * NO_CURRENT;
    !is_low && most <= ratio * ratio * least
}

fn open_ratio(is_clipped: bool) -> f32 {
    if is_clipped { CLIPPED_RATIO } else { OPEN_RATIO }
}

/// Square of a test's magnitude.
pub(crate) fn square(test: &ElectrodeTest) -> f32 {
    let (real, imaginary) = (test.in_phase.0 as f32, test.quadrature.0 as f32);
    real * real + imaginary * imaginary
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        acquire::tests::FRONT_END,
        patch::{
            Difference,
            tests::{flat_frame, small_patch},
        },
        units::AdcCode,
    };

    /// 30 ohm at 1 mA.
    const GOOD: ElectrodeTest =
        ElectrodeTest { in_phase: AdcCode(1_500_000), quadrature: AdcCode(0), is_clipped: false };
    const DEAD: ElectrodeTest =
        ElectrodeTest { in_phase: AdcCode(900), quadrature: AdcCode(-900), is_clipped: false };
    const CLIPPED: ElectrodeTest =
        ElectrodeTest { in_phase: AdcCode(4_000_000), is_clipped: true, quadrature: AdcCode(0) };

    fn examine(tests: [ElectrodeTest; 8]) -> (Health, FrameFlags) {
        let bytes = small_patch(Difference::Plain);
        let patch = PatchView::validate(&bytes).unwrap();
        let frame = Frame { tests: tests.into_iter().collect(), ..flat_frame(5) };
        let (mut health, flags) = Health::examine(&patch, 50e3, &frame);
        health.measure_contacts(&patch, FRONT_END.volts_per_code / 1e-3, &frame.tests);
        (health, flags)
    }

    #[test]
    fn a_healthy_skin_raises_no_flag_and_shows_its_contact_impedances() {
        let (health, flags) = examine([GOOD; 8]);
        assert_eq!(flags, FrameFlags::default());
        assert!(health.contact_impedance.iter().all(|ohms| (ohms - 30.0).abs() < 1e-3));
        assert_eq!(health.reciprocity_error, None, "each step is a measurement of its own");
    }

    #[test]
    fn an_open_electrode_is_found_and_its_neighbour_is_not_blamed() {
        let mut tests = [GOOD; 8];
        (tests[3], tests[2]) = (CLIPPED, DEAD);
        let (health, flags) = examine(tests);
        assert_eq!((health.open, health.shorted), (ElectrodeSet(1 << 3), ElectrodeSet(0)));
        assert_eq!(flags, FrameFlags::OPEN_ELECTRODE);
        let far = ElectrodeTest { in_phase: AdcCode(8_000_000), ..GOOD };
        tests = [GOOD; 8];
        (tests[0], tests[7]) = (far, DEAD);
        assert_eq!(examine(tests).0.open.iter().collect::<std::vec::Vec<_>>(), [0]);
    }

    #[test]
    fn an_electrode_that_reads_something_behind_one_that_reads_nothing_is_open() {
        let mut tests = [GOOD; 8];
        (tests[2], tests[4]) = (DEAD, DEAD);
        let (health, flags) = examine(tests);
        assert_eq!((health.open, health.shorted), (ElectrodeSet(1 << 3), ElectrodeSet(0)));
        assert_eq!(flags, FrameFlags::OPEN_ELECTRODE);
        tests[4] = GOOD;
        assert_eq!(examine(tests).0.open, ElectrodeSet(1 << 3));
    }

    #[test]
    fn tests_that_the_amplifier_clips_on_a_good_skin_say_so_and_nothing_else() {
        let clipped = ElectrodeTest { is_clipped: true, ..GOOD };
        let mut tests = [clipped; 8];
        tests[3] = GOOD;
        let (health, flags) = examine(tests);
        assert_eq!((flags, health.bad_electrodes()), (FrameFlags::default(), ElectrodeSet(0)));
        let measured = health.contact_impedance.iter().map(|ohms| ohms.is_finite());
        assert!(measured.eq((0..8).map(|electrode| electrode == 3)));
    }

    #[test]
    fn a_short_of_two_neighbours_is_found() {
        let mut tests = [GOOD; 8];
        (tests[7], tests[0]) = (DEAD, DEAD);
        let (health, flags) = examine(tests);
        assert_eq!(health.shorted, ElectrodeSet(1 | 1 << 7));
        assert_eq!(health.bad_electrodes(), health.shorted);
        assert_eq!(flags, FrameFlags::SHORTED_ELECTRODE);
    }

    #[test]
    fn voltages_that_are_not_reciprocal_say_something_where_leads_do_not() {
        let bytes = crate::patch::tests::reciprocal_patch();
        let patch = PatchView::validate(&bytes).unwrap();
        let mut frame = flat_frame(1000);
        frame.codes.truncate(patch.header.steps.into());
        assert_eq!(Health::examine(&patch, 50e3, &frame).1, FrameFlags::NOT_RECIPROCAL);
        frame.codes.iter_mut().skip(1).step_by(2).for_each(|code| code.0 *= -1);
        assert_eq!(Health::examine(&patch, 50e3, &frame).1, FrameFlags::default());
        frame.codes.iter_mut().step_by(3).for_each(|code| code.0 *= 2);
        let (health, flags) = Health::examine(&patch, 50e3, &frame);
        assert_eq!(flags, FrameFlags::NOT_RECIPROCAL);
        assert_eq!(Health::examine(&patch, 100e3, &frame), (health, FrameFlags::default()));
    }

    #[test]
    fn the_reciprocity_error_is_the_difference_over_the_size_and_one_pair_in_twelve_may_be_off() {
        let bytes = crate::patch::tests::reciprocal_patch();
        let patch = PatchView::validate(&bytes).unwrap();
        let pairs = usize::from(patch.header.measurements);
        // The second voltage of a pair has the opposite sign.
        let examined = |off: usize, second: i32| {
            let mut frame = flat_frame(1000);
            frame.codes.truncate(patch.header.steps.into());
            for (pair, code) in frame.codes.iter_mut().skip(1).step_by(2).enumerate() {
                code.0 = if pair < off { -second } else { -1000 };
            }
            let (health, flags) = Health::examine(&patch, 50e3, &frame);
            (health.reciprocity_error.unwrap(), flags.contains(FrameFlags::NOT_RECIPROCAL))
        };
        assert_eq!(examined(0, 1000), (0.0, false));
        let (error, _) = examined(1, 1200);
        let size = 1000.0 * (pairs - 1) as f32 + 1100.0;
        assert!((error - 200.0 / size).abs() < 1e-6, "{error}");
        for off in 0..=pairs {
            // Three tenths of the mean of 1000 and 1353 are 353.
            assert!(!examined(off, 1352).1, "{off}");
            assert_eq!(examined(off, 1354).1, 12 * off > pairs, "{off} of {pairs}");
        }
        assert_eq!(examined(pairs, 0), (2.0, true));
    }

    #[test]
    fn no_current_is_told_from_bad_electrodes() {
        let (health, flags) = examine([DEAD; 8]);
        assert_eq!(flags, FrameFlags::NO_CURRENT);
        assert!(health.bad_electrodes().is_empty());
    }
}
