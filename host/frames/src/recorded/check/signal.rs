//! The signal from frame to frame: noise, drift, clipped values, repeated frames.

use super::{
    super::{
        read::Frames,
        statistics::{median, root_mean_square},
    },
    Readings,
};
use num_complex::Complex64;
use rayon::prelude::*;
use serde::Serialize;
use std::{
    collections::HashMap,
    hash::{DefaultHasher, Hash, Hasher},
};

/// Frames that noise and drift need.
const FEWEST_FRAMES: usize = 3;
/// Median square of a normal distribution over its variance.
const MEDIAN_SQUARE: f64 = 0.4549;

/// How steady the frames are.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Steadiness {
    /// Root mean square of the reference over that of the noise, dB; `null` without noise. The noise is
    /// estimated from frames that follow each other, so that slow changes do not count.
    pub snr_db: Option<f64>,
    /// Change from the first tenth of the frames to the last, root mean square over that of the
    /// reference, %. It is drift, or something that touches the skin.
    pub change_percent: f64,
}

impl Steadiness {
    pub(super) fn of(frames: &Frames, readings: &Readings) -> Option<Self> {
        if frames.frames < FEWEST_FRAMES {
            return None;
        }
        let signal = root_mean_square(readings.measured.iter().map(|value| value.norm()));
        let noise = root_mean_square(readings.noise.iter().copied());
        let tenth = frames.frames.div_ceil(10);
        let mean = |skip: usize, index: usize| {
            frames.iter().skip(skip).take(tenth).map(|frame| frame[index] / tenth as f64).sum::<Complex64>()
        };
        let last = frames.frames - tenth;
        let change = root_mean_square(
            readings.indices.iter().map(|&index| (mean(last, index) - mean(0, index)).norm()),
        );
        Some(Self {
            snr_db: (noise > 0.0).then(|| 20.0 * (signal / noise).log10()),
            change_percent: if signal > 0.0 { 100.0 * change / signal } else { 0.0 },
        })
    }
}

/// Standard deviation of the noise of one frame, along the direction of the mean, from the median square of the
/// difference of frames that follow each other: `[index in a frame]`. 0 where there are too few frames.
#[must_use]
pub fn noise(frames: &Frames) -> Vec<f64> {
    let of_index = |(index, mean): (usize, &Complex64)| {
        let back = mean.conj() / mean.norm();
        let back = if back.is_finite() { back } else { Complex64::ONE };
        let along = |frame: &[Complex64]| (frame[index] * back).re;
        let squares = frames.iter().zip(frames.iter().skip(1)).map(|(a, b)| (along(b) - along(a)).powi(2));
        if frames.frames < FEWEST_FRAMES { 0.0 } else { (median(squares) / MEDIAN_SQUARE / 2.0).sqrt() }
    };
    frames.mean().par_iter().enumerate().map(of_index).collect()
}

/// Values at the end of the range.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Saturation {
    /// The end of the range, in the file's unit.
    pub limit: f64,
    /// Values there.
    pub values: usize,
    /// Steps with such values.
    pub steps: Vec<usize>,
    /// Frames with such values.
    pub frames: usize,
}

/// Largest values that are looked at beside the extreme one.
const NEXT_VALUES: usize = 10;
/// How often the extreme value must come, for each time that one of the next ones does.
const CROWDED: usize = 4;

impl Saturation {
    /// Values crowd at the end of a range where they are cut off; elsewhere the largest values are
    /// the rarest.
    pub(super) fn of(frames: &Frames, readings: &Readings) -> Option<Self> {
        let of_frame = |frame: &[Complex64]| -> Vec<f64> {
            readings.indices.iter().flat_map(|&index| parts(frame[index], frames.complex)).collect()
        };
        let mut values: Vec<f64> = frames.iter().flat_map(of_frame).collect();
        values.par_sort_unstable_by(f64::total_cmp);
        let alike: Vec<&[f64]> = values.chunk_by(|a, b| a == b).collect();
        let limit = crowded(alike.iter().rev()).or_else(|| crowded(alike.iter()))?;
        Some(Self::at(limit, frames, readings))
    }

    fn at(limit: f64, frames: &Frames, readings: &Readings) -> Self {
        let clipped = |frame: &[Complex64], index: usize| {
            parts(frame[index], frames.complex).filter(|&part| part == limit).count()
        };
        let in_step = |index: usize| frames.iter().map(|frame| clipped(frame, index)).sum::<usize>();
        let of_steps: Vec<usize> = readings.indices.iter().map(|&index| in_step(index)).collect();
        let has = |frame: &&[Complex64]| readings.indices.iter().any(|&index| clipped(frame, index) > 0);
        Self {
            limit,
            values: of_steps.iter().sum(),
            steps: (0..of_steps.len()).filter(|&step| of_steps[step] > 0).collect(),
            frames: frames.iter().filter(has).count(),
        }
    }
}

/// Real part, and imaginary part of complex data. Zero is no limit: it is a dead measurement.
fn parts(value: Complex64, complex: bool) -> impl Iterator<Item = f64> {
    [Some(value.re), complex.then_some(value.im)].into_iter().flatten().filter(|&part| part != 0.0)
}

/// The first value, if it comes far more often than those next to it.
fn crowded<'a>(mut from_the_end: impl Iterator<Item = &'a &'a [f64]>) -> Option<f64> {
    let first = from_the_end.next()?;
    let next: Vec<usize> = from_the_end.take(NEXT_VALUES).map(|alike| alike.len()).collect();
    let most = *next.iter().max()?;
    (next.len() == NEXT_VALUES && first.len() > CROWDED * most).then_some(first[0])
}

/// Frames that come more than once.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Repeats {
    /// Frames that are equal to the one before them.
    pub in_a_row: Vec<usize>,
    /// Frames that are equal to any earlier one.
    pub frames: usize,
}

impl Repeats {
    pub(super) fn of(frames: &Frames) -> Self {
        let mut last_with: HashMap<u64, usize> = HashMap::new();
        let mut repeats = Self::default();
        for (number, frame) in frames.iter().enumerate() {
            let Some(last) = last_with.insert(hash(frame), number) else { continue };
            let is_same = frames.iter().nth(last) == Some(frame);
            repeats.frames += usize::from(is_same);
            if is_same && last + 1 == number {
                repeats.in_a_row.push(number);
            }
        }
        repeats
    }
}

fn hash(frame: &[Complex64]) -> u64 {
    let mut hasher = DefaultHasher::new();
    frame.iter().for_each(|value| [value.re.to_bits(), value.im.to_bits()].hash(&mut hasher));
    hasher.finish()
}
