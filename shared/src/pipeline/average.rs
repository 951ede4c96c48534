//! Average: still frames are averaged, and a change opens the average, so that it costs no speed.
//!
//! A frame joins the mean with the weight of one among those that are in it, up to as many as come in the wanted time. One
//! that differs from it by more than noise does is for whoever sees it to [`Average::restart`] from. That test is the sum
//! of the squares, each in units of its own variance (chi square).

use super::reference::{Changes, resize};

/// A frame opens the average by so many standard deviations of chi square: one in a hundred still frames does.
pub const OPENS: f32 = 2.5;

/// The mean of the latest frames that are alike.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Average {
    /// Relative changes: `[measurement]`.
    mean: Changes,
    /// Frames averaged; 0 before the first.
    frames: f32,
    /// Variance of the mean's noise, that of one frame being 1.
    variance: f32,
    frame_us: u64,
}

impl Average {
    /// Forgets all.
    pub fn restart(&mut self) {
        self.frames = 0.0;
    }

    /// Variance of the mean's noise, that of one frame being 1.
    #[must_use]
    pub fn variance(&self) -> f32 {
        if self.frames < 1.0 { 1.0 } else { self.variance }
    }

    /// Replaces relative changes by their mean over the frames since it began, `[measurement]`, over a time in seconds. Those
    /// that are not finite join no average.
    pub fn take(&mut self, relative: &mut Changes, now_us: u64, time: f32) {
        let last_us = core::mem::replace(&mut self.frame_us, now_us);
        let seconds = now_us.saturating_sub(last_us) as f32 * 1e-6;
        if self.mean.len() != relative.len() || self.frames < 1.0 {
            resize(&mut self.mean, relative.len());
            self.mean.copy_from_slice(relative);
            (self.frames, self.variance) = (1.0, 1.0);
            return;
        }
        let most = if seconds > 0.0 { (time / seconds).max(1.0) } else { 1.0 };
        self.frames = (self.frames + 1.0).min(most);
        let part = 1.0 / self.frames;
        self.variance = (1.0 - part) * (1.0 - part) * self.variance + part * part;
        for (mean, value) in self.mean.iter_mut().zip(relative) {
            *mean = if mean.is_finite() { *mean + part * (*value - *mean) } else { *value };
            *value = if value.is_finite() { *mean } else { *value };
        }
    }

    /// By how many standard deviations of chi square a frame differs from the mean by more than noise does.
    pub fn excess(&self, relative: &[f32], inverse_variances: &[f32]) -> f32 {
        let (mut squares, mut count) = (0.0, 0.0);
        for ((value, mean), weight) in relative.iter().zip(&self.mean).zip(inverse_variances) {
            let away = value - mean;
            if away.is_finite() && *weight > 0.0 {
                squares += weight * away * away;
                count += 1.0;
            }
        }
        (squares / (1.0 + self.variance()) - count) / libm::sqrtf(2.0 * count.max(1.0))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::{Rng, SeedableRng};
    use rand_pcg::Pcg64Mcg;

    const FRAME_US: u64 = 2_500;
    /// Deviation of the noise of each of 104 measurements.
    const NOISE: f32 = 1e-3;

    struct Trial {
        average: Average,
        random: Pcg64Mcg,
        now_us: u64,
    }

    impl Trial {
        fn new() -> Self {
            Self { average: Average::default(), random: Pcg64Mcg::seed_from_u64(3), now_us: 0 }
        }

        /// What becomes of a frame in which all measurements have changed by `change`: mean and deviation.
        fn take(&mut self, change: f32, time: f32) -> (f32, f32) {
            let mut noise = || (0..12).map(|_| self.random.random_range(-0.5..0.5)).sum::<f32>() * NOISE;
            let mut frame: Changes = (0..104).map(|_| change + noise()).collect();
            self.now_us += FRAME_US;
            if self.average.excess(&frame, &[1.0 / (NOISE * NOISE); 104]) > OPENS {
                self.average.restart();
            }
            self.average.take(&mut frame, self.now_us, time);
            let mean = frame.iter().sum::<f32>() / 104.0;
            let square = frame.iter().map(|value| (value - mean) * (value - mean)).sum::<f32>() / 104.0;
            (mean, square.sqrt())
        }
    }

    #[test]
    fn still_frames_lose_noise_by_the_root_of_their_number_up_to_the_time() {
        let mut trial = Trial::new();
        for _ in 0..60 {
            trial.take(0.0, 0.04);
        }
        let (mut deviations, mut expected) = (0.0, 0.0);
        for _ in 0..300 {
            deviations += trial.take(0.0, 0.04).1;
            expected += NOISE * trial.average.variance().sqrt();
        }
        let ratio = deviations / expected;
        assert!((0.9..1.1).contains(&ratio), "{ratio}");
        assert!(trial.average.frames <= 16.0 && trial.average.frames > 1.0);
    }

    #[test]
    fn a_step_is_there_in_its_first_frame() {
        for step in [0.5 * NOISE, NOISE, 10.0 * NOISE] {
            let mut trial = Trial::new();
            for _ in 0..100 {
                trial.take(0.0, 0.2);
            }
            let (first, _) = trial.take(step, 0.2);
            let is_seen = step >= NOISE;
            assert_eq!(first > 0.7 * step, is_seen, "{step}: {first}");
            for _ in 0..400 {
                trial.take(step, 0.2);
            }
            let (last, _) = trial.take(step, 0.2);
            assert!((last / step - 1.0).abs() < 0.25, "{step}: {last}");
        }
    }

    #[test]
    fn one_frame_in_a_hundred_opens_it_on_its_own() {
        let mut trial = Trial::new();
        let opened = (0..5000).filter(|_| {
            trial.take(0.0, 0.2);
            trial.average.frames == 1.0
        });
        let opened = opened.count();
        assert!((5..150).contains(&opened), "{opened} of 5000");
    }

    #[test]
    fn without_a_time_each_frame_is_its_own_and_unknown_values_stay_so() {
        let mut trial = Trial::new();
        for _ in 0..20 {
            trial.take(0.0, 0.0);
            assert_eq!(trial.average.frames, 1.0);
        }
        let mut average = Average::default();
        for frame in 1..4 {
            let mut values = Changes::from_slice(&[f32::NAN, 1.0]).unwrap();
            average.take(&mut values, frame * FRAME_US, 1.0);
            assert!(values[0].is_nan() && values[1] == 1.0);
        }
        let mut values = Changes::from_slice(&[0.5, 1.0]).unwrap();
        average.take(&mut values, 4 * FRAME_US, 1.0);
        assert_eq!(values[..], [0.5, 1.0]);
    }
}
