//! Drift: the untouched skin changes with temperature and age, and the reference has to follow without
//! ever swallowing a press.
//!
//! Untouched, the whole reference follows the frames with the patch's time constant, and faster where what changed is known
//! to be no press ([`Change`]). Touched, what is smooth beside presses does, and a factor common to all voltages, as
//! slowly as a skin drifts: a press that is held adds the same to every frame, one that changes does so at once, and
//! neither passes for drift.
//!
//! The common factor is the median over the measurements of v / v_ref, which no press moves far.

use super::{detect::Change, reference::Changes};
use crate::health::median::median;

/// Fastest common change that passes for drift, 1/s: 3 % a minute.
const FASTEST: f32 = 5e-4;
/// A common change this large at once is a press.
const JUMP: f32 = 0.005;
/// After the last contact the skin counts as touched for this long, us.
const REST_US: u64 = 1_000_000;
/// The common change is looked at no more often than this, s: a median costs as much as a hundred pixels.
const LOOK_EVERY: f32 = 0.02;
/// The reference follows in steps of at least this long, s.
const FOLLOW_EVERY: f32 = 0.1;
/// After a tare or a mend a still skin is averaged further, over this part of its time constant, and so many frames.
const RIPENS_IN: f32 = 1.0 / 8.0;
const RIPE_FRAMES: f32 = 256.0;
/// At fast frames not each of them is taken, but one in this time, s.
const RIPENS_EVERY: f32 = 0.008;
/// In this time, s, the reference follows a sheet that changes smoothly.
const SMOOTH_TIME: f32 = 0.5;
/// The same beside a press.
const BESIDE_TIME: f32 = 1.0;
/// The same where a press was lifted that was part of it.
const LIFTED_TIME: f32 = 0.2;
/// The same after a change that no press makes: a thousandth of it is left after 30 s.
const UNLIKE_TIME: f32 = 4.0;
/// Longest time between frames that counts, us.
const LONGEST_US: u64 = 60_000_000;

/// The common change since the reference was made, and what moves it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Drift {
    /// Drift of all voltages, relative.
    common: f32,
    /// Common change that a press makes.
    press: f32,
    frame_us: Option<u64>,
    touched_us: Option<u64>,
    /// Whether the skin was touched in the frame before the latest, or not long ago.
    rests: bool,
    /// Time since the common change was looked at, s.
    unseen: f32,
    /// Time untouched that the reference has not followed yet, s.
    pending: f32,
}

impl Drift {
    /// Takes drift out of relative changes, `[measurement]`, `weights` being what a change of all voltages by 1 would
    /// read. Changes that are not finite stay so.
    pub fn correct(&mut self, relative: &mut Changes, weights: &[f32], now_us: u64, time_constant: f32) {
        if time_constant <= 0.0 {
            return;
        }
        let last_us = self.frame_us.replace(now_us).unwrap_or(now_us);
        let seconds = now_us.saturating_sub(last_us).min(LONGEST_US) as f32 * 1e-6;
        self.rests = self.is_touched(last_us, now_us);
        self.pending += seconds;
        self.unseen += seconds;
        if self.unseen >= LOOK_EVERY {
            let unseen = core::mem::take(&mut self.unseen);
            self.follow_common(relative, weights, unseen);
        }
        let scale = 1.0 / (1.0 + self.common);
        for (change, weight) in relative.iter_mut().zip(weights) {
            *change = (*change - self.common * weight) * scale;
        }
    }

    /// What part of the way to the latest frame the reference goes now, if it does, after such a change; `time_constant`, s,
    /// is that of an untouched skin, and `variance` that of the reference's noise, that of one frame being 1.
    pub fn part(&mut self, change: Change, time_constant: f32, variance: f32) -> Option<f32> {
        let time = match change {
            _ if time_constant <= 0.0 => return None,
            Change::Still if self.rests => {
                self.pending = 0.0;
                return None;
            }
            Change::Still if self.pending >= RIPENS_EVERY && self.is_unripe(variance, time_constant) => {
                self.pending = 0.0;
                // As a mean takes in one frame more.
                return Some(variance / (1.0 + variance));
            }
            Change::Still => time_constant,
            Change::Smooth => SMOOTH_TIME.min(time_constant),
            Change::Unlike => UNLIKE_TIME.min(time_constant),
            Change::Lifted => LIFTED_TIME.min(time_constant),
            Change::PressedAndSmooth | Change::PressedAndDrifted => BESIDE_TIME.min(time_constant),
            Change::Pressed => return None,
            Change::PressedAndSlipped => return Some(1.0),
        };
        if self.pending < FOLLOW_EVERY {
            return None;
        }
        Some((core::mem::take(&mut self.pending) / time).min(1.0))
    }

    /// Whether the mean of a still skin, of this variance, takes in one frame more.
    fn is_unripe(&self, variance: f32, time_constant: f32) -> bool {
        variance > (self.pending / (RIPENS_IN * time_constant)).max(1.0 / RIPE_FRAMES)
    }

    /// The reference has moved this part of the way: by as much less is common.
    pub fn followed(&mut self, part: f32) {
        self.common *= 1.0 - part;
    }

    /// The skin was touched in the frame at this time.
    pub fn touch(&mut self, now_us: u64) {
        self.touched_us = Some(now_us);
    }

    /// Drift of all voltages since the reference was made, relative.
    #[must_use]
    pub fn common(&self) -> f32 {
        self.common
    }

    /// Whether the skin was touched in the frame before, or not long ago.
    fn is_touched(&self, last_us: u64, now_us: u64) -> bool {
        self.touched_us.is_some_and(|touched| touched >= last_us || now_us.saturating_sub(touched) < REST_US)
    }

    // Not inlined, so that what it needs of the stack is free again for all else.
    #[inline(never)]
    fn follow_common(&mut self, relative: &Changes, weights: &[f32], seconds: f32) {
        let of_its_own = relative.iter().zip(weights).map(|(y, w)| y / w);
        let mut changes: Changes = of_its_own.filter(|change| change.is_finite()).collect();
        let Some(now) = median(&mut changes) else { return };
        let rest = now - self.common - self.press;
        if !self.rests || rest.abs() > JUMP.max(2.0 * FASTEST * seconds) {
            // Untouched, the reference follows by itself; a jump is a press, or the end of one.
            self.press += rest;
        } else {
            // Not `clamp`, whose panic would bring the formatting of floats to the board.
            self.common += rest.max(-FASTEST * seconds).min(FASTEST * seconds);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Weights of three measurements.
    const WEIGHTS: [f32; 3] = [1.0, -0.5, 2.0];
    /// Time from frame to frame, us.
    const FRAME_US: u64 = 25_000;
    const TIME_CONSTANT: f32 = 10.0;

    /// A skin, all of whose voltages have changed by `common`.
    fn changes(common: f32) -> Changes {
        WEIGHTS.iter().map(|weight| common * weight).collect()
    }

    /// Takes `frames` frames with these common changes, touched in all or none; gives what is left of the last.
    fn take(drift: &mut Drift, from_us: u64, frames: u64, touched: bool, common: impl Fn(u64) -> f32) -> f32 {
        let mut left = f32::NAN;
        for frame in 1..=frames {
            let now_us = from_us + frame * FRAME_US;
            let mut relative = changes(common(frame));
            drift.correct(&mut relative, &WEIGHTS, now_us, TIME_CONSTANT);
            if touched {
                drift.touch(now_us);
            }
            left = relative[0];
        }
        left
    }

    /// A skin that is touched from the first frame on.
    fn touched() -> Drift {
        let mut drift = Drift::default();
        drift.correct(&mut changes(0.0), &WEIGHTS, 0, TIME_CONSTANT);
        drift.touch(0);
        drift
    }

    #[test]
    fn while_touched_a_skin_is_followed_as_fast_as_it_drifts_and_no_faster() {
        let seconds = |frame: u64| (frame * FRAME_US) as f32 * 1e-6;
        for speed in [0.9 * FASTEST, -0.9 * FASTEST] {
            let mut drift = touched();
            take(&mut drift, 0, 2400, true, |frame| speed * seconds(frame));
            assert!((drift.common() - 60.0 * speed).abs() < 2e-5, "{}", drift.common());
        }
        // Below a jump, and far faster than a skin drifts: 0.4 % at once.
        let mut drift = touched();
        let left = take(&mut drift, 0, 80, true, |_| 0.004);
        assert!((drift.common() - 2.0 * 5e-4).abs() < 2e-5, "3 % a minute, for 2 s: {}", drift.common());
        assert!((left - 0.003).abs() < 2e-5, "{left}");
    }

    #[test]
    fn a_press_on_all_voltages_is_no_drift_nor_is_its_end() {
        let mut drift = touched();
        let left = take(&mut drift, 0, 400, true, |_| 0.006);
        assert!(drift.common().abs() < 1e-6 && (left - 0.006).abs() < 1e-6, "{drift:?}");
        let left = take(&mut drift, 400 * FRAME_US, 400, true, |_| 0.0);
        assert!(drift.common().abs() < 1e-6 && left.abs() < 1e-6, "{drift:?}");
    }

    #[test]
    fn the_reference_rests_for_a_second_after_the_last_touch_and_then_follows() {
        let mut drift = touched();
        let mut follows = |now_us| {
            drift.correct(&mut changes(0.0), &WEIGHTS, now_us, TIME_CONSTANT);
            drift.part(Change::Still, TIME_CONSTANT, 0.0)
        };
        for now_us in (FRAME_US..1_000_000).step_by(FRAME_US as usize) {
            assert_eq!(follows(now_us), None, "{now_us}");
        }
        let parts: std::vec::Vec<f32> =
            (0..40).filter_map(|frame| follows(1_000_000 + frame * FRAME_US)).collect();
        assert_eq!(parts.len(), 10, "every 0.1 s");
        assert!(parts.iter().all(|part| (part - 0.1 / TIME_CONSTANT).abs() < 1e-6), "{parts:?}");
    }

    #[test]
    fn a_contact_in_the_frame_before_counts_however_long_ago_that_was() {
        let mut drift = touched();
        let mut follows = |now_us| {
            drift.correct(&mut changes(0.0), &WEIGHTS, now_us, TIME_CONSTANT);
            drift.part(Change::Still, TIME_CONSTANT, 0.0)
        };
        assert_eq!(follows(20_000_000), None);
        assert_eq!(follows(40_000_000), Some(1.0), "twice the time constant");
    }

    #[test]
    fn a_reference_that_is_wrong_does_not_rest_after_a_touch() {
        let mut drift = touched();
        drift.correct(&mut changes(0.0), &WEIGHTS, 200_000, TIME_CONSTANT);
        let part = drift.part(Change::Smooth, TIME_CONSTANT, 0.0);
        assert!(part.is_some_and(|part| (part - 0.4).abs() < 1e-6), "{part:?}");
    }

    #[test]
    fn a_still_skin_is_averaged_further_frame_by_frame_up_to_some_frames_and_some_time() {
        // 15 s of a time constant of 120 s.
        for (frame_us, frames) in
            [(2_500, 256.0), (10_000, 256.0), (25_000, 256.0), (100_000, 150.0), (200_000, 75.0)]
        {
            let (mut drift, mut variance) = (Drift::default(), 1.0 / 20.0);
            for frame in 0..=1000_u64 {
                drift.correct(&mut changes(0.0), &WEIGHTS, frame * frame_us, 120.0);
                let Some(part) = drift.part(Change::Still, 120.0, variance) else { continue };
                if frame == 10 && frame_us >= 10_000 {
                    assert!((part - 1.0 / 30.0).abs() < 1e-4, "{part}: as a mean of 20 frames and 10");
                }
                if part < 1.0 / 300.0 {
                    break;
                }
                variance = (1.0 - part) * (1.0 - part) * variance + part * part;
            }
            assert!((1.0 / variance - frames).abs() <= 1.5, "{}, not {frames}", 1.0 / variance);
        }
    }

    #[test]
    fn without_a_time_constant_nothing_is_followed_or_taken_out() {
        let (mut drift, mut relative) = (Drift::default(), changes(0.3));
        drift.correct(&mut relative, &WEIGHTS, 1_000_000, 0.0);
        assert_eq!([Change::Still, Change::Smooth].map(|change| drift.part(change, 0.0, 1.0)), [None, None]);
        assert_eq!(relative, changes(0.3));
    }
}
