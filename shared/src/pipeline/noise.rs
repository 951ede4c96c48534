//! Noise: how much each measurement varies from frame to frame on the skin that the board is on.
//!
//! Half of the mean square of what changes from one frame to the next is the variance of a single one, whatever drifts
//! slowly. It is averaged over frames without contacts. Few frames say little about one measurement, so that it leans
//! on the mean of all, by steps, as if that had been seen for thirty frames.

use super::reference::Reference;
use crate::{limits::MAX_MEASUREMENTS, patch::PatchView};
use heapless::Vec;

/// Frames that the mean over all measurements counts for.
const PRIOR_FRAMES: f32 = 30.0;
/// Frames that are averaged at most, exponentially.
const MOST_FRAMES: u16 = 1000;
/// Nothing is quieter than this share of the mean voltage: 100 dB.
const FLOOR: f32 = 1e-5;

/// By measurement.
type Values = Vec<f32, MAX_MEASUREMENTS>;

/// Variance of the measurements.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Noise {
    /// The latest frame, codes.
    last: Values,
    /// Half of the square of its change: `[measurement]`.
    latest: Values,
    /// Averaged variance, codes squared: `[measurement]`.
    variance: Values,
    /// Frames averaged.
    frames: u16,
}

impl Noise {
    /// Takes in a frame, which counts once [`Self::count`] says so.
    pub fn see(&mut self, measured: &[i64]) {
        let half_square = |(&now, &last): (&i64, &f32)| 0.5 * (now as f32 - last) * (now as f32 - last);
        self.latest = measured.iter().zip(&self.last).map(half_square).collect();
        self.last = measured.iter().map(|&now| now as f32).collect();
    }

    /// The frame seen last was of an untouched skin, as the one before it.
    pub fn count(&mut self) {
        if self.latest.is_empty() {
            return;
        }
        if self.variance.len() != self.latest.len() {
            (self.variance, self.frames) = (self.latest.clone(), 0);
        }
        self.frames = (self.frames + 1).min(MOST_FRAMES);
        let part = 1.0 / f32::from(self.frames);
        for (variance, latest) in self.variance.iter_mut().zip(&self.latest) {
            *variance += part * (latest - *variance);
        }
    }

    /// Inverse variances of relative changes against a reference: `[measurement]`; 0 where one says nothing.
    // Not inlined, so that what it needs of the stack is free again for all else.
    #[inline(never)]
    pub fn inverse_variances(&self, patch: &PatchView<'_>, reference: &Reference, out: &mut Values) {
        let mut steps = Values::new();
        let _ = steps.resize(reference.sums().len(), 0.0);
        for target in patch.combination() {
            if let Some(count) = steps.get_mut(usize::from(target.measurement)) {
                *count += 1.0;
            }
        }
        let frames = f32::from(reference.frames());
        let (mut of_one, mut size) = (0.0, 0.0);
        for ((&variance, &sum), count) in self.variance.iter().zip(reference.sums()).zip(&steps) {
            of_one += variance / count;
            size += sum.unsigned_abs() as f32 / (count * frames);
        }
        let all = steps.len().max(1) as f32;
        let floor = FLOOR * size / all;
        let of_one = (of_one / all).max(floor * floor);
        let seen = f32::from(self.frames);
        let averaged = 1.0 + 1.0 / frames;
        out.clear();
        for ((m, count), scale) in steps.iter().enumerate().zip(reference.scales()) {
            let own = self.variance.get(m).copied().unwrap_or(0.0);
            let codes = (seen * own + PRIOR_FRAMES * of_one * count) / (seen + PRIOR_FRAMES);
            let deviation = scale * frames;
            let variance = codes * deviation * deviation * averaged;
            let _ = out.push(if variance > 0.0 && variance.is_finite() { 1.0 / variance } else { 0.0 });
        }
    }
}
