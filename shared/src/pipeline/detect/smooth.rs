//! Smooth changes of the sheet, such as a part of it that warms: what they explain of data, beside presses.
//!
//! The patch has the responses to them behind those of the places ([`crate::patch::places`]). A press resembles them more or
//! less; what resembles them clearly more than any press is none.

use super::sums::each;
use crate::{
    patch::{
        matrix::GROUP,
        places::{MAX_SMOOTH, Places},
    },
    pipeline::reference::power_of_two,
};

/// Cholesky factor of the normal equations of the smooth changes, without what they have in common with a change that is
/// common to all: lower triangle.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Smooth {
    factor: [[f32; MAX_SMOOTH]; MAX_SMOOTH],
}

impl Smooth {
    /// Under inverse variances, `[measurement]`. Changes that cannot be told from others count for nothing.
    // Not inlined, so that what it needs of the stack is free again for all else.
    #[inline(never)]
    pub(super) fn take(&mut self, places: &Places<'_>, weights: &[f32], common: &[f32]) {
        let count = places.smooth().min(MAX_SMOOTH);
        let mut with_common = [0.0; MAX_SMOOTH];
        let mut of_common = 0.0;
        let matrix = &mut self.factor;
        *matrix = Default::default();
        let mut exponents = places.column_exponents();
        for (four, (weights, common)) in weights.chunks(GROUP).zip(common.chunks(GROUP)).enumerate() {
            let mut rows = [[0.0; GROUP]; MAX_SMOOTH];
            for (row, values) in rows[..count].iter_mut().enumerate() {
                *values = Places::four(places.row(places.count() + row), four);
            }
            for (n, (weight, common)) in weights.iter().zip(common).enumerate() {
                let scale = power_of_two(-i32::from(exponents.next().unwrap_or(0)));
                of_common += weight * common * common;
                for i in 0..count {
                    let weighted = weight * scale * rows[i][n];
                    with_common[i] += weighted * common;
                    for j in 0..=i {
                        matrix[i][j] += weighted * scale * rows[j][n];
                    }
                }
            }
        }
        let inverse = if of_common > 0.0 { 1.0 / of_common } else { 0.0 };
        for i in 0..count {
            for j in 0..=i {
                let known: f32 = (0..j).map(|k| matrix[i][k] * matrix[j][k]).sum();
                let rest = matrix[i][j] - with_common[i] * with_common[j] * inverse - known;
                matrix[i][j] = match (i == j, rest > 1e-4 * matrix[i][i]) {
                    (true, true) => libm::sqrtf(rest),
                    (true, false) => 0.0,
                    (false, _) if matrix[j][j] > 0.0 => rest / matrix[j][j],
                    (false, _) => 0.0,
                };
            }
        }
    }

    /// What they explain of data, by the data's sums with their rows, `[smooth change]`, without the rows' exponents.
    pub(super) fn fit(&self, places: &Places<'_>, sums: impl Iterator<Item = f32>) -> SmoothFit {
        let count = places.smooth().min(MAX_SMOOTH);
        let factor = &self.factor;
        let mut parts = [0.0; MAX_SMOOTH];
        for (i, sum) in sums.take(count).enumerate() {
            let known: f32 = (0..i).map(|k| factor[i][k] * parts[k]).sum();
            parts[i] = if factor[i][i] > 0.0 { (sum - known) / factor[i][i] } else { 0.0 };
        }
        let explained = parts.iter().map(|part| part * part).sum();
        for i in (0..count).rev() {
            let known: f32 = (i + 1..count).map(|k| factor[k][i] * parts[k]).sum();
            parts[i] = if factor[i][i] > 0.0 { (parts[i] - known) / factor[i][i] } else { 0.0 };
        }
        SmoothFit { sizes: parts, explained }
    }
}

/// The smooth changes that explain data best.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct SmoothFit {
    /// How large each is, without its row's exponent: `[smooth change]`.
    sizes: [f32; MAX_SMOOTH],
    /// How much they explain, in units of one frame's variance.
    pub(super) explained: f32,
}

impl SmoothFit {
    /// What they add to the data, measurement by measurement.
    pub(super) fn add_responses(&self, places: &Places<'_>, add: impl FnMut(usize, f32)) {
        let four = |at| {
            let mut sum = [0.0; GROUP];
            for (row, size) in self.sizes[..places.smooth().min(MAX_SMOOTH)].iter().enumerate() {
                let responses = Places::four(places.row(places.count() + row), at);
                sum.iter_mut().zip(responses).for_each(|(sum, response)| *sum += size * response);
            }
            sum
        };
        each(places, four, add);
    }
}
