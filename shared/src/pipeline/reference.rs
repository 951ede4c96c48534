//! Reference and difference data: the untouched skin is averaged once (the *tare*), and every
//! later frame becomes its change relative to that.
//!
//! Both kinds of difference data are ratios of codes, so gain, drive amplitude and the scale of
//! the converter cancel, and the reconstruction matrix always yields relative conductivity:
//!
//! - normalised: y = (v - v_ref) / v_ref
//! - plain: y = (v - v_ref) / mean |v_ref|, the mean taken over all measurements
//!
//! Subtraction is exact (64-bit integers); the one rounding before quantisation is in single
//! precision, which every IEEE machine does alike.

use crate::{
    frame::Frame,
    limits::MAX_MEASUREMENTS,
    patch::{Difference, PatchView},
};
use heapless::Vec;

/// Frames averaged by default for one reference (thesis section 4.1: twenty).
pub const DEFAULT_TARE_FRAMES: u16 = 20;

/// The averaged untouched frame, as exact sums.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Reference {
    /// Frames summed.
    frames: u16,
    /// Sum of codes over the frames: `[measurement]`.
    sums: Vec<i64, MAX_MEASUREMENTS>,
    /// What turns `frames * v - sum` into difference data: `[measurement]`.
    scales: Changes,
    /// What all voltages changing by their own size would read: `[measurement]`.
    weights: Changes,
    /// Variance of its noise, that of one frame being 1.
    variance: f32,
}

/// Voltages of one frame, or their differences from a reference, exact: `[measurement]`.
pub type Measured = Vec<i64, MAX_MEASUREMENTS>;

/// Relative changes: `[measurement]`.
pub type Changes = Vec<f32, MAX_MEASUREMENTS>;

/// A reference that is still being averaged.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Tare {
    remaining: u16,
    reference: Reference,
    /// Frames it starts with anew when one differs from those before; none if it takes any.
    steady_frames: Option<u16>,
    /// Frames that were not fit for it.
    unfit: u16,
}

/// Sum of changes over sum of voltages above which a frame is not steady: far more than noise.
const UNSTEADY: f32 = 0.02;

impl Tare {
    /// Starts to average `frames` frames (at least one).
    #[must_use]
    pub fn new(frames: u16) -> Self {
        Self { remaining: frames.max(1), ..Self::default() }
    }

    /// Starts to average `frames` frames that resemble each other.
    #[must_use]
    pub fn of_steady_frames(frames: u16) -> Self {
        Self { steady_frames: Some(frames), ..Self::new(frames) }
    }

    /// Whether it takes steady frames only, and began by itself.
    #[must_use]
    pub fn is_automatic(&self) -> bool {
        self.steady_frames.is_some()
    }

    /// Frames that it takes.
    #[must_use]
    pub fn frames(&self) -> u16 {
        self.remaining.saturating_add(self.reference.frames)
    }

    /// Whether the frame added last was the first, perhaps after others that differed from it.
    #[must_use]
    pub fn has_begun(&self) -> bool {
        self.reference.frames == 1
    }

    /// A frame is not fit for it; says whether there were four times as many as it needs, so that it gives up. One that
    /// began by itself never does.
    pub fn gives_up(&mut self) -> bool {
        self.unfit = self.unfit.saturating_add(1);
        !self.is_automatic() && self.unfit / 4 >= self.frames()
    }

    /// Adds one frame's measurements; gives the finished reference with the last one.
    pub fn add(&mut self, patch: &PatchView<'_>, measured: &[i64]) -> Option<Reference> {
        if let Some(frames) = self.steady_frames.filter(|_| self.reference.is_unlike(measured)) {
            *self = Self::of_steady_frames(frames);
        }
        let sums = &mut self.reference.sums;
        if sums.len() != measured.len() {
            sums.clear();
            resize(sums, measured.len());
        }
        for (sum, value) in sums.iter_mut().zip(measured) {
            *sum += value;
        }
        self.reference.frames = self.reference.frames.saturating_add(1);
        self.remaining = self.remaining.saturating_sub(1);
        if self.remaining > 0 {
            return None;
        }
        let mut reference = core::mem::take(&mut self.reference);
        reference.set_scales(patch);
        reference.variance = 1.0 / f32::from(reference.frames);
        Some(reference)
    }
}

impl Reference {
    /// Sums of codes over [`Self::frames`] frames: `[measurement]`.
    #[must_use]
    pub fn sums(&self) -> &[i64] {
        &self.sums
    }

    /// How many frames were averaged.
    #[must_use]
    pub fn frames(&self) -> u16 {
        self.frames
    }

    /// Turns measurements into their differences from this reference, times its [`Self::frames`].
    pub fn subtract(&self, measured: &mut [i64]) {
        for (value, sum) in measured.iter_mut().zip(&self.sums) {
            *value = self.difference(*value, *sum);
        }
    }

    fn difference(&self, value: i64, sum: i64) -> i64 {
        value * i64::from(self.frames) - sum
    }

    /// Differences relative to this reference: `[measurement]`.
    ///
    /// A measurement whose reference is zero cannot be normalised and reads zero.
    // Once on the board, for all that asks.
    #[inline(never)]
    pub fn relative_change(&self, differences: &[i64], out: &mut Changes) {
        resize(out, differences.len());
        for ((change, &difference), scale) in out.iter_mut().zip(differences).zip(&self.scales) {
            *change = to_f32(difference) * scale;
        }
    }

    /// Whether a frame's measurements differ from the mean by more than noise does.
    fn is_unlike(&self, measured: &[i64]) -> bool {
        let (mut change, mut size) = (0.0, 0.0);
        for (&sum, &value) in self.sums.iter().zip(measured) {
            change += self.difference(value, sum).unsigned_abs() as f32;
            size += sum.unsigned_abs() as f32;
        }
        change > UNSTEADY * size
    }

    /// What [`Self::relative_change`] reads if all voltages change by their own size: `[measurement]`.
    #[must_use]
    pub fn weights(&self) -> &[f32] {
        &self.weights
    }

    /// What turns a difference, times [`Self::frames`], into a relative change: `[measurement]`.
    #[must_use]
    pub fn scales(&self) -> &[f32] {
        &self.scales
    }

    /// Variance of its noise, that of one frame being 1.
    #[must_use]
    pub fn variance(&self) -> f32 {
        self.variance
    }

    fn set_scales(&mut self, patch: &PatchView<'_>) {
        self.scales = scales(patch, self);
        self.weights = self.sums.iter().zip(&self.scales).map(|(&sum, scale)| sum as f32 * scale).collect();
    }

    /// Takes back sums that it had, `[measurement]`, with this variance.
    pub fn return_to(&mut self, patch: &PatchView<'_>, sums: &[i64], variance: f32) {
        self.variance = variance;
        self.sums.iter_mut().zip(sums).for_each(|(sum, former)| *sum = *former);
        self.set_scales(patch);
    }

    /// It moved this part of the way to a frame, 0 to 1, and has that part of its noise.
    pub fn blur(&mut self, part: f32) {
        self.variance = (1.0 - part) * (1.0 - part) * self.variance + part * part;
    }

    /// Moves the reference these parts of the way to a frame that differs from it like that, 0 to 1:
    /// `[measurement]`; not a number moves nothing.
    pub fn follow(&mut self, patch: &PatchView<'_>, differences: &[i64], parts: &[f32]) {
        for ((sum, way), part) in self.sums.iter_mut().zip(differences).zip(parts) {
            let part = (part.clamp(0.0, 1.0) * FOLLOW_ONE as f32) as i64;
            // A code has 25 bits, two of them add up, and a tare has 10 bits of frames: 60 bits.
            *sum += (way * part + FOLLOW_ONE / 2).div_euclid(FOLLOW_ONE);
        }
        self.set_scales(patch);
    }
}

/// The whole way of [`Reference::follow`].
const FOLLOW_ONE: i64 = 1 << 24;

/// Difference data in block floating point: `y[m] = codes[m] * 2^(column exponent[m] - exponent)`.
///
/// The columns' exponents are those of the patch's matrix, so that measurements that change much leave bits to those
/// that change little. The other is chosen anew for each frame so that the largest code lies in 16,383 to 32,767; the
/// rounding error is at most half a step.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct DifferenceData {
    /// Mantissas: `[measurement]`.
    pub codes: Vec<i16, MAX_MEASUREMENTS>,
    /// Binary places after the point, -61 to 60.
    pub exponent: i32,
}

impl DifferenceData {
    /// Quantises relative changes, `[measurement]`, for a matrix with these exponents of its columns; values that are
    /// not finite read zero.
    pub fn quantise(&mut self, relative: &[f32], column_exponents: impl Iterator<Item = i8> + Clone) {
        let columns = column_exponents.map(i32::from);
        // Sizes that are not negative are in the order of their bits; behind infinity lies what is not a number.
        let finite = |y: f32| y.abs().to_bits() < f32::INFINITY.to_bits();
        let size = |(y, column): (&f32, i32)| {
            let bits = if finite(*y) { y.abs().to_bits() as i32 } else { 0 };
            bits.saturating_sub(column << 23)
        };
        let sizes = relative.iter().zip(columns.clone()).map(size);
        let largest = f32::from_bits(sizes.fold(0, i32::max) as u32);
        let floor_log2 = (largest.to_bits() >> 23) as i32 - 127;
        self.exponent = (14 - floor_log2).clamp(-60, 60);
        if largest * power_of_two(self.exponent) >= 32_767.5 {
            self.exponent -= 1;
        }
        let code = |(y, column): (&f32, i32)| {
            let scaled = if finite(*y) { y * power_of_two(self.exponent - column) } else { 0.0 };
            let rounded = (scaled + 0.5_f32.copysign(scaled)) as i32;
            rounded.clamp(-32_767, 32_767) as i16
        };
        self.codes.clear();
        self.codes.extend(relative.iter().zip(columns).take(MAX_MEASUREMENTS).map(code));
    }
}

/// Makes a list as long as that, as far as it can be; values it had stay.
pub(super) fn resize<T: Copy + Default>(list: &mut Vec<T, MAX_MEASUREMENTS>, length: usize) {
    let _ = list.resize(length.min(MAX_MEASUREMENTS), T::default());
}

/// 2^exponent, exactly; -126 to 127.
pub(super) fn power_of_two(exponent: i32) -> f32 {
    f32::from_bits((((127 + exponent) & 0xFF) as u32) << 23)
}

/// As `value as f32`; most values fit the one instruction that a small chip has for it.
#[inline(always)]
pub(super) fn to_f32(value: i64) -> f32 {
    // The compiler knows that both ways give the same, and would take the long one for all.
    i32::try_from(value).map_or_else(|_| value as f32, |value| core::hint::black_box(value) as f32)
}

/// Steps -> measurements: adds up those that measure the same thing (reciprocal pairs), each with its sign.
// Not inlined: its loop wants registers for itself.
#[inline(never)]
pub fn combine(patch: &PatchView<'_>, frame: &Frame, measured: &mut Measured) {
    measured.clear();
    resize(measured, patch.header.measurements.into());
    for (code, target) in frame.codes.iter().zip(patch.combination()) {
        if let Some(sum) = measured.get_mut(usize::from(target.measurement)) {
            // One instruction, where a choice between the value and its opposite takes nine.
            let sign = 1 - 2 * i32::from(target.flipped);
            *sum += i64::from(code.0) * i64::from(sign);
        }
    }
}

fn scales(patch: &PatchView<'_>, reference: &Reference) -> Changes {
    match patch.header.difference {
        Difference::Normalised => reference.sums.iter().map(|&sum| inverse_or_zero(sum as f32)).collect(),
        Difference::Plain => plain_scales(patch, reference),
    }
}

/// 1 / (steps of this measurement * frames * mean |v_ref|): see the module's formula.
fn plain_scales(patch: &PatchView<'_>, reference: &Reference) -> Changes {
    let mut steps = Changes::new();
    let _ = steps.resize(reference.sums.len(), 0.0);
    for target in patch.combination() {
        if let Some(count) = steps.get_mut(usize::from(target.measurement)) {
            *count += 1.0;
        }
    }
    let total: f32 =
        reference.sums.iter().zip(&steps).map(|(&sum, &count)| sum.unsigned_abs() as f32 / count).sum();
    let mean_times_frames = total / reference.sums.len().max(1) as f32;
    steps.iter().map(|&count| inverse_or_zero(count * mean_times_frames)).collect()
}

fn inverse_or_zero(value: f32) -> f32 {
    if value == 0.0 || !value.is_finite() { 0.0 } else { 1.0 / value }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::patch::matrix::COLUMN_EXPONENTS;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn an_integer_becomes_a_float_by_one_rounding(value in any::<i64>(), shift in 0_u32..63) {
            let value = value >> shift;
            prop_assert_eq!(to_f32(value).to_bits(), (value as f32).to_bits());
        }

        #[test]
        fn every_value_is_kept_to_half_a_step(
            values in prop::collection::vec((-1.0_f32..1.0, COLUMN_EXPONENTS), 1..50),
            scale in -40_i32..40,
        ) {
            let columns = values.iter().map(|(_, column)| *column);
            let of = |(v, column): &(f32, i8)| v * power_of_two(scale + i32::from(*column));
            let relative: std::vec::Vec<f32> = values.iter().map(of).collect();
            let mut data = DifferenceData::default();
            data.quantise(&relative, columns.clone());
            for ((code, y), column) in data.codes.iter().zip(&relative).zip(columns) {
                let step = f64::from(i32::from(column) - data.exponent).exp2();
                prop_assert!((f64::from(*code) * step - f64::from(*y)).abs() <= 0.5 * step);
            }
            let largest = data.codes.iter().map(|code| code.unsigned_abs()).max().unwrap();
            prop_assert!((16_383..=32_767).contains(&largest) || relative.iter().all(|&y| y == 0.0));
        }
    }

    #[test]
    fn steps_of_opposite_sign_are_taken_from_each_other() {
        let bytes = crate::patch::tests::reciprocal_patch();
        let patch = PatchView::validate(&bytes).unwrap();
        let mut frame = Frame::default();
        for step in 0..i32::from(patch.header.steps) {
            frame.codes.push(crate::units::AdcCode(1000 + step * step)).unwrap();
        }
        let mut measured = Measured::new();
        combine(&patch, &frame, &mut measured);
        let expected = |m: i64| 4 * m * m - (2 * m + 1) * (2 * m + 1);
        assert_eq!(measured.len(), usize::from(patch.header.measurements));
        assert!((0..).zip(&measured).all(|(m, &sum)| sum == expected(m)), "{measured:?}");
    }

    #[test]
    fn a_value_just_below_a_power_of_two_is_kept_to_half_a_step() {
        let mut data = DifferenceData::default();
        data.quantise(&[0.999_999_94], [0].into_iter());
        assert_eq!((data.codes[0], data.exponent), (16_384, 14));
    }

    #[test]
    fn values_that_are_not_finite_read_zero() {
        let mut data = DifferenceData::default();
        data.quantise(&[f32::NAN, f32::INFINITY, 0.5], [0; 3].into_iter());
        assert_eq!(data.codes[..], [0, 0, 16_384]);
    }
}
