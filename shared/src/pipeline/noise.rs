//! Noise: how much each measurement varies from frame to frame on the skin that the board is on.
//!
//! Half of the mean square of what changes from one frame to the next is the variance of a single one, whatever drifts
//! slowly. It is averaged over frames without contacts. Few frames say little about one measurement, so that it leans
//! on the mean of all, by steps, as if that had been seen for thirty frames.

use super::reference::{Reference, resize, to_f32};
use crate::{limits::MAX_MEASUREMENTS, patch::PatchView};
use heapless::Vec;

/// Frames that the mean over all measurements counts for.
const PRIOR_FRAMES: f32 = 30.0;
/// Untouched frames before which nothing is known, and no contact found in the voltages.
pub const LEAST_FRAMES: u16 = 8;
/// Frames that are averaged at most, exponentially.
const MOST_FRAMES: u16 = 1000;
/// A change counts for so many times the variance at most.
const LOUDEST: f32 = 25.0;
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
    /// Whether the frame seen last counts, and the one before did.
    counts: [bool; 2],
}

impl Noise {
    /// Takes in a frame, which counts once [`Self::count`] says so.
    // Not inlined, so that what it needs of the registers is free for all else.
    #[inline(never)]
    pub fn see(&mut self, measured: &[i64]) {
        let is_first = self.last.len() != measured.len();
        resize(&mut self.last, measured.len());
        resize(&mut self.latest, measured.len());
        for ((&now, last), latest) in measured.iter().zip(&mut self.last).zip(&mut self.latest) {
            let now = to_f32(now);
            let change = now - *last;
            (*last, *latest) = (now, 0.5 * change * change);
        }
        self.counts = [false, self.counts[0] && !is_first];
    }

    /// Half of the squares of the changes of the frame seen last, `[measurement]`: what is not a number counts for nothing.
    pub fn latest_mut(&mut self) -> &mut [f32] {
        &mut self.latest
    }

    /// Forgets what it knows.
    pub fn restart(&mut self) {
        self.variance.clear();
        (self.frames, self.counts) = (0, [false; 2]);
    }

    /// Whether enough frames were averaged to judge others by.
    #[must_use]
    pub fn is_known(&self) -> bool {
        self.frames >= LEAST_FRAMES
    }

    /// The frame seen last was of an untouched skin. Its change counts if the one before was, too.
    pub fn count(&mut self) {
        self.counts[0] = true;
        if !self.counts[1] {
            return;
        }
        if self.variance.len() != self.latest.len() {
            (self.variance, self.frames) = (self.latest.clone(), 0);
        }
        // A jump is no noise. Where noise did become louder, some frames say so.
        let mean = mean_of_known(self.variance.iter().copied());
        let loudest = if self.is_known() { LOUDEST } else { f32::INFINITY };
        self.frames = (self.frames + 1).min(MOST_FRAMES);
        let part = 1.0 / f32::from(self.frames);
        for (variance, latest) in
            self.variance.iter_mut().zip(&self.latest).filter(|(_, new)| new.is_finite())
        {
            if variance.is_nan() {
                *variance = *latest;
            }
            *variance += part * (latest.min(loudest * variance.max(mean)) - *variance);
        }
    }

    /// Inverse variances of one frame's relative changes: `[measurement]`; 0 where one says nothing.
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
        let sizes = reference.sums().iter().zip(&steps);
        let floor =
            FLOOR * mean_of_known(sizes.map(|(sum, count)| sum.unsigned_abs() as f32 / (count * frames)));
        let of_one =
            mean_of_known(self.variance.iter().zip(&steps).map(|(variance, count)| variance / count));
        let of_one = of_one.max(floor * floor);
        let seen = f32::from(self.frames);
        out.clear();
        for ((m, count), scale) in steps.iter().enumerate().zip(reference.scales()) {
            let own = self.variance.get(m).copied().filter(|own| own.is_finite()).unwrap_or(0.0);
            let codes = (seen * own + PRIOR_FRAMES * of_one * count) / (seen + PRIOR_FRAMES);
            let deviation = scale * frames;
            let variance = codes * deviation * deviation;
            let _ = out.push(if variance > 0.0 && variance.is_finite() { 1.0 / variance } else { 0.0 });
        }
    }
}

/// Mean of the values that are finite; 0 of none.
fn mean_of_known(values: impl Iterator<Item = f32>) -> f32 {
    let (mut sum, mut count) = (0.0, 0.0_f32);
    for value in values.filter(|value| value.is_finite()) {
        sum += value;
        count += 1.0;
    }
    sum / count.max(1.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        frame::Frame,
        patch::{
            Difference,
            tests::{flat_frame, small_patch},
        },
        pipeline::{Outcome, PipelineState, process},
        units::AdcCode,
    };
    use rand::{Rng, SeedableRng};
    use rand_pcg::Pcg64Mcg;

    /// Noise of frames whose measurements vary by these deviations.
    fn seen(noise: &mut Noise, deviations: &[f64], frames: usize, random: &mut Pcg64Mcg) {
        for _ in 0..frames {
            let mut uniform = |deviation: &f64| random.random_range(-1.0..1.0) * 3f64.sqrt() * deviation;
            let measured: std::vec::Vec<_> = deviations.iter().map(|d| (1e6 + uniform(d)) as i64).collect();
            noise.see(&measured);
            noise.count();
        }
    }

    #[test]
    fn variances_are_those_of_the_measurements() {
        let deviations = [100.0, 1000.0, 5000.0];
        let mut noise = Noise::default();
        seen(&mut noise, &deviations, 1000, &mut Pcg64Mcg::seed_from_u64(1));
        for (variance, deviation) in noise.variance.iter().zip(deviations) {
            assert!((f64::from(*variance).sqrt() / deviation - 1.0).abs() < 0.1, "{variance} {deviation}");
        }
    }

    #[test]
    fn a_touch_counts_neither_as_it_comes_nor_as_it_goes() {
        let mut noise = Noise::default();
        let mut random = Pcg64Mcg::seed_from_u64(2);
        seen(&mut noise, &[100.0; 4], 100, &mut random);
        let before = noise.variance.clone();
        noise.see(&[2_000_000; 4]);
        noise.see(&[1_000_000; 4]);
        noise.count();
        assert_eq!(noise.variance, before);
        noise.see(&[1_000_010; 4]);
        noise.count();
        assert!(noise.variance.iter().zip(&before).all(|(now, before)| now < before));
    }

    #[test]
    fn a_jump_is_no_noise_and_louder_noise_is() {
        let mut noise = Noise::default();
        let mut random = Pcg64Mcg::seed_from_u64(3);
        seen(&mut noise, &[100.0; 4], 500, &mut random);
        let before = noise.variance[0];
        noise.see(&[2_000_000; 4]);
        noise.count();
        assert!(noise.variance[0] < 1.1 * before, "{} {before}", noise.variance[0]);
        seen(&mut noise, &[400.0; 4], 3000, &mut random);
        let louder = noise.variance[0] / before;
        assert!((10.0..20.0).contains(&louder), "{louder}");
    }

    #[test]
    fn inverse_variances_lean_on_the_mean_of_all_while_little_is_known() {
        let bytes = small_patch(Difference::Normalised);
        let patch = PatchView::validate(&bytes).unwrap();
        let mut state = PipelineState::default();
        state.start_tare(2);
        process(&patch, &mut state, &flat_frame(1_000_000));
        assert_eq!(process(&patch, &mut state, &flat_frame(1_000_000)), Outcome::Tared);
        let reference = state.reference().unwrap();
        let mut random = Pcg64Mcg::seed_from_u64(4);
        let mut deviations = [100.0; 40];
        deviations[7] = 300.0;
        for (frames, least, most) in [(10, 1.2, 2.5), (1000, 2.8, 3.2)] {
            let mut noise = Noise::default();
            seen(&mut noise, &deviations, frames, &mut random);
            let mut weights = Values::new();
            noise.inverse_variances(&patch, reference, &mut weights);
            assert_eq!(weights.len(), 40);
            let louder = (weights[8] / weights[7]).sqrt();
            assert!((least..most).contains(&louder), "{frames} frames: {louder}");
            let deviation = 1.0 / weights[8].sqrt();
            assert!((0.7e-4..1.6e-4).contains(&deviation), "{frames} frames: {deviation}");
        }
        let dead = Frame { codes: (0..40).map(|_| AdcCode(0)).collect(), ..Frame::default() };
        let mut state = PipelineState::default();
        state.start_tare(1);
        process(&patch, &mut state, &dead);
        let mut weights = Values::new();
        Noise::default().inverse_variances(&patch, state.reference().unwrap(), &mut weights);
        assert!(weights.iter().all(|weight| *weight == 0.0), "{weights:?}");
    }
}
