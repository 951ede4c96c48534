//! Untouched: whether a skin whose board has lost its reference looks as it did when it had one.
//!
//! What is pressed while a reference is made is not seen later. A board that has started anew cannot know, and may have
//! made one by itself, but this computer has kept the reference from before. Only firm presses are told: a board that has started anew may measure
//! with other gains, which are right to a per cent.

use super::Link;
use crate::error::{LinkError, LinkErrorKind};
use dermatome_shared::{
    patch::CombinedInto,
    protocol::{PatchInfo, Reply, Request, Selection},
    units::AdcCode,
};
use std::time::{Duration, Instant};

/// Frames to look at: fewer than a board takes for a reference by itself.
const FRAMES: usize = 5;
/// A voltage that has changed by more, relative, beside what changed all of them, is pressed.
const PRESSED: f64 = 0.03;
/// Voltages of less than this of the largest are too small to tell.
const SMALL: f64 = 0.02;

/// A skin as it was when nothing pressed.
#[derive(Clone, Debug)]
pub struct Untouched {
    /// When the board was known to have this reference,
    at: Instant,
    /// and of which patch.
    crc: u32,
    combination: Vec<CombinedInto>,
    /// Sums over the steps of each measurement, in codes: `[measurement]`.
    voltages: Vec<f64>,
}

impl Untouched {
    /// By the reference of a board with this patch.
    pub fn of(link: &mut Link, patch: &PatchInfo) -> Result<Self, LinkError> {
        let combination = link.combination()?;
        let Reply::Reference { frames, sums } = link.request(&Request::Reference)? else {
            return Err(link.error(LinkErrorKind::WrongReply { request: "Reference" }));
        };
        let frames = f64::from(frames.max(1));
        let voltages = sums.iter().map(|sum| *sum as f64 / frames).collect();
        Ok(Self { at: Instant::now(), crc: patch.crc, combination, voltages })
    }

    /// What it measures, in codes: `[measurement]`.
    #[must_use]
    pub fn voltages(&self) -> &[f64] {
        &self.voltages
    }

    /// Whether it is of the skin by this patch.
    #[must_use]
    pub fn is_of(&self, patch: &PatchInfo) -> bool {
        self.crc == patch.crc
    }

    /// Whether a board with this patch needs another reference: it has none, or it has started anew and made one while
    /// something pressed, by what it was like `before`.
    pub fn is_lost(before: Option<&Self>, link: &mut Link, patch: &PatchInfo) -> Result<bool, LinkError> {
        let info = link.info()?;
        let Some(before) = before.filter(|before| info.tared && before.is_of(patch)) else {
            return Ok(!info.tared);
        };
        let has_restarted = Duration::from_millis(info.uptime_ms) < before.at.elapsed();
        Ok(has_restarted && before.change(&Self::of(link, patch)?.voltages) > PRESSED)
    }

    /// Whether something presses, by some frames of the board.
    pub fn is_pressed(&self, link: &mut Link, timeout: Duration) -> Result<bool, LinkError> {
        let mut stream = link.subscribe(Selection { measurements: 1, ..Selection::default() })?;
        let mut now = vec![0.0; self.voltages.len()];
        for _ in 0..FRAMES {
            let frame = stream.next_while(timeout, || true)?;
            if let Some(measurements) = frame.and_then(|frame| frame.measurements) {
                self.add(&measurements.codes, &mut now);
            }
        }
        stream.stop()?;
        now.iter_mut().for_each(|voltage| *voltage /= FRAMES as f64);
        Ok(self.change(&now) > PRESSED)
    }

    /// Adds the codes of a frame, `[step]`, to their measurements.
    fn add(&self, codes: &[AdcCode], sums: &mut [f64]) {
        for (code, into) in codes.iter().zip(&self.combination) {
            if let Some(sum) = sums.get_mut(usize::from(into.measurement)) {
                *sum += f64::from(if into.flipped { -code.0 } else { code.0 });
            }
        }
    }

    /// The largest relative change of a voltage, beside the median one.
    fn change(&self, now: &[f64]) -> f64 {
        let largest = self.voltages.iter().fold(0.0_f64, |largest, voltage| largest.max(voltage.abs()));
        let pairs = self.voltages.iter().zip(now).filter(|(before, _)| before.abs() > SMALL * largest);
        let mut ratios: Vec<f64> = pairs.map(|(before, now)| now / before).collect();
        ratios.sort_by(f64::total_cmp);
        let Some(median) = ratios.get(ratios.len() / 2).filter(|median| **median != 0.0) else { return 0.0 };
        let ends = ratios.first().into_iter().chain(ratios.last());
        ends.fold(0.0, |change: f64, ratio| change.max((ratio / median - 1.0).abs()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn skin() -> Untouched {
        let combination = [(0, false), (1, false), (0, true), (2, false)]
            .map(|(measurement, flipped)| CombinedInto { measurement, flipped });
        let voltages = vec![2000.0, -1000.0, 1.0];
        Untouched { at: Instant::now(), crc: 0, combination: combination.to_vec(), voltages }
    }

    #[test]
    fn what_changes_all_voltages_is_no_press_and_what_changes_one_is() {
        let skin = skin();
        assert!(skin.change(&[2100.0, -1050.0, 7.0]) < 1e-9, "small voltages do not count");
        assert!((skin.change(&[2000.0, -1100.0, 1.0]) - 1.0 / 11.0).abs() < 1e-9);
    }

    #[test]
    fn steps_of_a_measurement_are_added_with_their_sign() {
        let (skin, mut sums) = (skin(), vec![0.0; 3]);
        skin.add(&[1010, -1000, -990, 1].map(AdcCode), &mut sums);
        assert_eq!(sums, skin.voltages);
    }
}
