//! Known changes that are no press: smooth ones of the sheet, such as a part of it that warms, and electrodes that slip along
//! the rim, or a stretch of the whole skin where they lie inside it. What they explain of data, beside presses.
//!
//! The patch has the responses to them behind those of the places ([`crate::patch::places`]). A press resembles them more or
//! less; what resembles them clearly more than any press is none.

use super::spot::each;
use crate::{
    patch::{
        matrix::GROUP,
        places::{DetectionLayout, MAX_KNOWN, Places},
    },
    pipeline::reference::power_of_two,
};

/// Entries of a lower triangle, row after row.
const TRIANGLE: usize = MAX_KNOWN * (MAX_KNOWN + 1) / 2;

/// Where row `i` of a lower triangle begins.
fn row(i: usize) -> usize {
    i * (i + 1) / 2
}

/// Cholesky factor of the normal equations of the known changes, without what they have in common with a change that is
/// common to all: lower triangle.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Known {
    factor: [f32; TRIANGLE],
    /// How many of them are smooth; they come first.
    smooth: usize,
}

impl Default for Known {
    fn default() -> Self {
        Self { factor: [0.0; TRIANGLE], smooth: 0 }
    }
}

impl Known {
    /// Under inverse variances, `[measurement]`. Changes that cannot be told from others count for nothing.
    // Not inlined, so that what it needs of the stack is free again for all else.
    #[inline(never)]
    pub(super) fn take(
        &mut self,
        places: &Places<'_>,
        layout: &DetectionLayout,
        weights: &[f32],
        common: &[f32],
    ) {
        let count = places.known().min(MAX_KNOWN);
        self.smooth = usize::from(layout.smooth);
        let mut with_common = [0.0; MAX_KNOWN];
        let mut of_common = 0.0;
        let matrix = &mut self.factor;
        matrix.fill(0.0);
        let mut exponents = places.column_exponents();
        for (four, (weights, common)) in weights.chunks(GROUP).zip(common.chunks(GROUP)).enumerate() {
            let mut rows = [[0.0; GROUP]; MAX_KNOWN];
            for (row, values) in rows[..count].iter_mut().enumerate() {
                *values = Places::four(places.row(places.count() + row), four);
            }
            for (n, (weight, common)) in weights.iter().zip(common).enumerate() {
                let scale = power_of_two(-i32::from(exponents.next().unwrap_or(0)));
                of_common += weight * common * common;
                for i in 0..count {
                    let weighted = weight * scale * rows[i][n];
                    // Most measurements do not need a certain electrode.
                    if weighted == 0.0 {
                        continue;
                    }
                    with_common[i] += weighted * common;
                    for (entry, other) in matrix[row(i)..=row(i) + i].iter_mut().zip(&rows) {
                        *entry += weighted * scale * other[n];
                    }
                }
            }
        }
        let inverse = if of_common > 0.0 { 1.0 / of_common } else { 0.0 };
        for i in 0..count {
            for j in 0..=i {
                let known: f32 = (0..j).map(|k| matrix[row(i) + k] * matrix[row(j) + k]).sum();
                let entry = matrix[row(i) + j];
                let rest = entry - with_common[i] * with_common[j] * inverse - known;
                let other = matrix[row(j) + j];
                matrix[row(i) + j] = match (i == j, rest > 1e-4 * entry) {
                    (true, true) => libm::sqrtf(rest),
                    (true, false) => 0.0,
                    (false, _) if other > 0.0 => rest / other,
                    (false, _) => 0.0,
                };
            }
        }
    }

    /// What they explain of data, by the data's sums with their rows, `[known change]`, without the rows' exponents.
    pub(super) fn fit(&self, places: &Places<'_>, sums: impl Iterator<Item = f32>) -> KnownFit {
        let factor = &self.factor;
        let mut parts = [0.0; MAX_KNOWN];
        let mut explained = [0.0; 2];
        for (i, sum) in sums.take(places.known().min(MAX_KNOWN)).enumerate() {
            let known: f32 = (0..i).map(|k| factor[row(i) + k] * parts[k]).sum();
            let own = factor[row(i) + i];
            parts[i] = if own > 0.0 { (sum - known) / own } else { 0.0 };
            explained[usize::from(i >= self.smooth)] += parts[i] * parts[i];
        }
        KnownFit { parts, explained: explained[0], with_slips: explained[0] + explained[1] }
    }

    /// What known changes that have these parts add to the data, measurement by measurement: smooth ones, or all.
    // Once on the board, for all that is done with them.
    #[inline(never)]
    pub(super) fn add(
        &self,
        parts: &Parts,
        only_smooth: bool,
        places: &Places<'_>,
        add: &mut dyn FnMut(usize, f32),
    ) {
        let count = if only_smooth { self.smooth } else { MAX_KNOWN }.min(places.known());
        let mut sizes = *parts;
        for i in (0..count).rev() {
            let known: f32 = (i + 1..count).map(|k| self.factor[row(k) + i] * sizes[k]).sum();
            let own = self.factor[row(i) + i];
            sizes[i] = if own > 0.0 { (sizes[i] - known) / own } else { 0.0 };
        }
        let four = |at| {
            let mut sum = [0.0; GROUP];
            for (row, size) in sizes[..count].iter().enumerate() {
                let responses = Places::four(places.row(places.count() + row), at);
                sum.iter_mut().zip(responses).for_each(|(sum, response)| *sum += size * response);
            }
            sum
        };
        each(places, four, add);
    }
}

/// Parts of data along known changes, each without what it has in common with those before: `[known change]`. Sums of
/// their products are what known changes explain, in units of one frame's variance.
pub(super) type Parts = [f32; MAX_KNOWN];

/// The known changes that explain data best.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct KnownFit {
    /// The data's parts along them.
    pub(super) parts: Parts,
    /// How much smooth ones explain, in units of one frame's variance.
    pub(super) explained: f32,
    /// The same with electrodes that slip.
    pub(super) with_slips: f32,
}
